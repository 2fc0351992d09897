"""How long cone maps take to bake: fractal noise, stones and bricks, on the CPU or on a GPU.

    python benchmarks/cones.py             maps of 1024², on all cores
    python benchmarks/cones.py --large     maps of 4096²
    python benchmarks/cones.py --gpu       on a GPU

A cone map of 1024² should take at most 2 s on two cores.
"""

from __future__ import annotations

import argparse
import time

from exact import maps

from basrelief import baking
from basrelief.engine.select import choose_engine


def main() -> None:
    wanted = argparse.ArgumentParser()
    wanted.add_argument("--large", action="store_true")
    wanted.add_argument("--gpu", action="store_true")
    given = wanted.parse_args()
    engine = choose_engine("gpu" if given.gpu else "cpu")
    texels = 4096 if given.large else 1024
    print(f"{engine.device}, maps of {texels}²")
    for name, heights in maps(texels).items():
        for make in (baking.cone_map, baking.relaxed_cone_map):
            make(heights[:16, :16], "wrap", engine)  # compiled before the clock starts
            start = time.perf_counter(), time.process_time()
            make(heights, "wrap", engine)
            wall, busy = time.perf_counter() - start[0], time.process_time() - start[1]
            print(f"{name}: {make.__name__} {wall:.2f} s, of processor time {busy:.2f} s")


if __name__ == "__main__":
    main()
