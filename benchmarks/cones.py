"""Time to bake cone maps of fractal noise, stones and bricks, on the CPU or on a GPU.

    python benchmarks/cones.py             maps of 1024², on all cores
    python benchmarks/cones.py --large     maps of 4096²
    python benchmarks/cones.py --gpu       on a GPU

A cone map of 1024² should take at most 2 s on two cores.
"""

from __future__ import annotations

from exact import maps
from figures import option_parser, store
from scenes import seconds_of

from basrelief import baking
from basrelief.engine.select import choose_device


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--gpu", action="store_true")
    options = parser.parse_args()
    engine = choose_device("gpu" if options.gpu else "cpu")
    texels = 96 if options.quick else 4096 if options.large else 1024
    print(f"{engine.adapter}, maps of {texels}²")
    figures = {}
    for name, heights in maps(texels).items():
        for bake in (baking.cone_map, baking.relaxed_cone_map):
            bake(heights[:16, :16], "wrap", engine)  # compile before timing
            taken = seconds_of(lambda bake=bake, heights=heights: bake(heights, "wrap", engine))
            print(
                f"{name}: {bake.__name__} {taken.wall:.2f} s, "
                f"of processor time {taken.processor:.2f} s"
            )
            case = f"{engine.name}, {texels}², {name}, {bake.__name__}"
            figures |= {f"{case}, {clock} s": t for clock, t in taken._asdict().items()}
    store(options.json, figures)


if __name__ == "__main__":
    main()
