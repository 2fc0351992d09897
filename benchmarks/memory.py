"""Seven maps of 4096² and a picture of 3840 × 2160: the most memory that the process ever holds."""

from __future__ import annotations

import sys
import time

import numpy as np
from figures import option_parser, store

import basrelief

SIDE = 4096
SIZE = (3840, 2160)
MOST = 3.0


def peak() -> float:
    """The largest resident size of this process so far, in gigabytes (10⁹ bytes)."""
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e9


def material(side: int) -> basrelief.Material:
    """Seven maps as a loader holds them: 8 bits a channel, the heights 16."""
    random = np.random.default_rng(0)

    def one(channels: int, srgb: bool = False, kind: type = np.uint8) -> basrelief.Map:
        pixels = random.integers(0, np.iinfo(kind).max, (side, side, channels), kind)
        return basrelief.Map(pixels, srgb, "noise")

    return basrelief.Material(
        "seven maps", one(3, srgb=True), one(3), one(1, kind=np.uint16), one(1), one(1), one(1),
        one(3, srgb=True),
    )  # fmt: skip


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("device", nargs="?", default="cpu")
    options = parser.parse_args()
    side, size = (64, (96, 54)) if options.quick else (SIDE, SIZE)
    start = time.perf_counter()
    made = material(side)
    print(f"maps made: {peak():.2f} GB")
    frame = basrelief.render(made, size=size, samples=2, device=options.device, technique="relief")
    held = peak()
    print(f"{frame.device}: at most {held:.2f} GB held (under {MOST})")
    print(f"in {time.perf_counter() - start:.0f} s, maps and all")
    store(options.json, {f"{options.device}, most held, GB": held})


if __name__ == "__main__":
    main()
