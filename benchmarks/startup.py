"""Duration of `basrelief --help`, from start to end of the process: median of five runs."""

from __future__ import annotations

import os
import subprocess
import sys
import time

from figures import option_parser, store
from scenes import Seconds, median

RUNS = 5
MAX_SECONDS = 0.4
"""Up to this, a command seems to answer at once."""


def seconds_of_command(command: list[str]) -> Seconds:
    """Time of a command that must succeed, in a process of its own."""
    before, start = os.times(), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, os.times()
    user = after.children_user - before.children_user
    return Seconds(wall, user + after.children_system - before.children_system)


def main() -> None:
    options = option_parser(__doc__).parse_args()
    runs = 1 if options.quick else RUNS
    basrelief = [sys.executable, "-m", "basrelief", "--help"]
    seconds_of_command(basrelief)  # compiles the bytecode and warms the file cache
    empty = median([seconds_of_command([sys.executable, "-c", ""]) for _ in range(runs)])
    taken = median([seconds_of_command(basrelief) for _ in range(runs)])
    ratio = taken.wall / empty.wall
    print(f"basrelief --help   {taken.wall:.3f} s   ({MAX_SECONDS} s at most)")
    print(f"of processor time  {taken.processor:.3f} s")
    print(f"an empty Python    {empty.wall:.3f} s   ratio {ratio:.1f}")
    store(
        options.json,
        {
            "basrelief --help, wall s": taken.wall,
            "basrelief --help, processor s": taken.processor,
            "basrelief --help ÷ an empty Python": ratio,
        },
    )


if __name__ == "__main__":
    main()
