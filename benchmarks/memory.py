"""Peak memory of a process with seven maps of 4096² and a picture of 3840 × 2160."""

from __future__ import annotations

import sys
import time

import numpy as np
from figures import option_parser, store

import basrelief

SIDE = 4096
SIZE = (3840, 2160)
MAX_GIGABYTES = 3.0


def peak() -> float:
    """The largest resident size of this process so far, in gigabytes (10⁹ bytes)."""
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e9


def material(side: int) -> basrelief.Material:
    """Seven maps as a loader stores them: 8 bits a channel, 16 for heights."""
    random = np.random.default_rng(0)

    def noise(channels: int, srgb: bool = False, kind: type = np.uint8) -> basrelief.Map:
        pixels = random.integers(0, np.iinfo(kind).max, (side, side, channels), kind)
        return basrelief.Map(pixels, srgb, "noise")

    return basrelief.Material(
        "seven maps", noise(3, srgb=True), noise(3), noise(1, kind=np.uint16), noise(1),
        noise(1), noise(1), noise(3, srgb=True),
    )  # fmt: skip


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("device", nargs="?", default="cpu")
    options = parser.parse_args()
    side, size = (64, (96, 54)) if options.quick else (SIDE, SIZE)
    start = time.perf_counter()
    maps = material(side)
    print(f"maps made: {peak():.2f} GB")
    frame = basrelief.render(maps, size=size, samples=2, device=options.device, technique="relief")
    peak_memory = peak()
    print(f"{frame.device}: at most {peak_memory:.2f} GB (under {MAX_GIGABYTES})")
    print(f"in {time.perf_counter() - start:.0f} s, maps and all")
    store(options.json, {f"{options.device}, most held, GB": peak_memory})


if __name__ == "__main__":
    main()
