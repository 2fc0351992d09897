"""How long `basrelief --help` takes, from start to end of the process: the median of five runs."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from pathlib import Path

RUNS = 5
SHOULD_BE_WITHIN = 0.4
"""Seconds: long enough to be noticed, short enough not to be waited for."""


def seconds(command: list[str]) -> float:
    """The wall time of a command that must succeed."""
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def main() -> None:
    program = str(Path(sys.executable).with_name("basrelief"))
    seconds([program, "--help"])  # compiles the bytecode and warms the file cache
    empty = statistics.median(seconds([sys.executable, "-c", ""]) for _ in range(RUNS))
    taken = statistics.median(seconds([program, "--help"]) for _ in range(RUNS))
    print(f"basrelief --help   {taken:.3f} s   ({SHOULD_BE_WITHIN} s at most)")
    print(f"an empty Python    {empty:.3f} s   ratio {taken / empty:.1f}")


if __name__ == "__main__":
    main()
