"""Time and error of every technique, as a table in Markdown.

    python benchmarks/techniques.py [--device cpu|gpu] [--filter texel|hardware]

Two samples of 512 × 512 texels, bricks (walls) and gravel (round), seen from 60, 75 and 85 degrees:
`basrelief.compare` with each technique's own settings. Times are shares of that of parallax
occlusion in the same run; errors are against the exact first hit.
"""

from __future__ import annotations

import numpy as np
from figures import option_parser, store

import basrelief

ANGLES = (60.0, 75.0, 85.0)
SCALE = 0.08


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--filter", default="texel")
    options = parser.parse_args()
    texels, overrides = 512, {}
    if options.quick:
        texels = 64
        overrides = {
            "techniques": ("parallax_occlusion",),
            "size": (48, 27),
            "samples": 1,
            "runs": 1,
        }
    figures = {}
    for name in ("bricks", "gravel"):
        comparison = basrelief.compare(
            basrelief.sample(name, texels),
            angles=ANGLES,
            device=options.device,
            scale=SCALE,
            filter=options.filter,
            **overrides,
        )
        usual = mean([each.seconds for each in comparison.of("parallax_occlusion")])
        print(f"\n{name}, scale {SCALE}, {comparison.device}. {comparison.filter_text}\n")
        print("| technique | time | reads | missed at 60°, 75°, 85° |", end="")
        print(" uv error at 75°, texels: half, 99 %, worst | FLIP at 75° |")
        print("|---|---|---|---|---|---|")
        rows = []
        for technique in {each.technique: None for each in comparison.results}:
            results = comparison.of(technique)
            time = mean([each.seconds for each in results]) / usual
            missed = ", ".join(f"{100 * each.errors.missed:.3g} %" for each in results)
            at_75 = results[ANGLES.index(75.0)]
            uv = at_75.errors.uv
            flip = "" if at_75.flip is None else f"{at_75.flip:.3f}"
            reads = float(np.mean([each.errors.reads for each in results]))
            rows.append(
                (time, f"| `{technique}` | {time:.2f} | {reads:.1f} | {missed} | "
                 f"{uv.median:.3g}, {uv.percentile_99:.3g}, {uv.worst:.3g} | {flip} |")
            )  # fmt: skip
            case = f"{options.device}, {name}, {technique}"
            case += "" if options.filter == "texel" else f", filter {options.filter}"
            figures |= {
                f"{case}, time ÷ parallax_occlusion": time,
                f"{case}, reads": reads,
                f"{case}, uv error at 75°, 99 %, texels": uv.percentile_99,
            }
            for each in results:
                figures[f"{case}, missed at {each.angle:.0f}°, share"] = each.errors.missed
        print("\n".join(row for _, row in sorted(rows)))
    store(options.json, figures)


def mean(values: list[float]) -> float:
    """The geometric mean."""
    return float(np.exp(np.mean(np.log(values))))


if __name__ == "__main__":
    main()
