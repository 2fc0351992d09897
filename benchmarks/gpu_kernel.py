"""A march of 32 steps on a GPU, by timestamps: generated WGSL against WGSL by hand."""

from __future__ import annotations

import statistics
from pathlib import Path
from typing import Any

import numpy as np
from figures import option_parser, store

import basrelief
from basrelief.engine.gpu import GpuEngine, Job
from basrelief.lang import HeightField, IVec2, Vec2, shader, struct
from basrelief.lang.program import Program
from basrelief.rendering import textures
from basrelief.techniques.march import March, parallax_occlusion
from basrelief.techniques.ray import Ray

SIZE = (1920, 1080)
STEPS = 32
MAX_RATIO = 1.05
DISPATCHES = 8
RUNS = 15
HERE = Path(__file__).parent


@struct
class Sweep:
    """Texture coordinates and the ray's travel, linear over the picture."""

    origin: Vec2
    right: Vec2
    down: Vec2
    travel: Vec2
    travel_right: Vec2
    travel_down: Vec2


@struct
class Displaced:
    """Displaced texture coordinates."""

    uv: Vec2


@shader
def kernel(at: IVec2, sweep: Sweep, march: March, heights: HeightField) -> Displaced:
    """Displace the texture coordinates of one pixel."""
    x = float(at.x)
    y = float(at.y)
    start = sweep.origin + sweep.right * x + sweep.down * y
    travel = sweep.travel + sweep.travel_right * x + sweep.travel_down * y
    ray = Ray(start, travel, height=1.0, drop=1.0, cosine=0.0)
    return Displaced(parallax_occlusion(heights, ray, march).uv)


def values(sample: str, size: tuple[int, int], maps: int = 1024) -> dict[str, Any]:
    """Values of the kernel: a plane at an angle, steeper towards the top."""
    w, h = size
    field = textures.height_field(basrelief.sample(sample, maps), "wrap")
    return {
        "sweep": Sweep(
            Vec2(0.1, 0.2), Vec2(2.0 / w, 0.2 / w), Vec2(-0.1 / h, 1.3 / h),
            Vec2(0.12, -0.2), Vec2(0.05 / w, 0.0), Vec2(0.0, 0.1 / h),
        ),
        "march": March(STEPS, STEPS),
        "heights": field,
    }  # fmt: skip


def milliseconds(
    engine: GpuEngine, jobs: dict[str, Job], rows: int, runs: int = RUNS
) -> dict[str, float]:
    """Median time of a dispatch of each job in ms; jobs alternate, with several dispatches each."""
    times: dict[str, list[float]] = {name: [] for name in jobs}
    for run in range(runs + 3):
        for name, job in jobs.items():
            seconds = engine.seconds(job, rows, DISPATCHES)
            if run >= 3:
                times[name].append(seconds * 1e3)
    return {name: statistics.median(t) for name, t in times.items()}


def main() -> None:
    options = option_parser(__doc__).parse_args()
    size, texels, runs = ((96, 54), 64, 1) if options.quick else (SIZE, 1024, RUNS)
    engine = GpuEngine()
    print(f"{engine.adapter}, {size[0]} × {size[1]}, {STEPS} steps, {texels}² map, ms a dispatch")
    figures = {}
    for sample in ("bricks", "gravel", "terrain"):
        program, inputs = Program(kernel), values(sample, size, texels)
        with engine.prepare(program, inputs, size) as generated:
            by_hand = engine.prepare_text(
                (HERE / "kernel_by_hand.wgsl").read_text(), program, inputs, size
            )
            jobs = {"generated": generated, "by hand": by_hand}
            times = milliseconds(engine, jobs, size[1], runs)
            for job in jobs.values():
                job.dispatch(0, size[1])
            a, b = (job.read(size[1]).view(np.float32) for job in jobs.values())
            differing = float((np.abs(a - b).max(0) * texels > 0.05).mean())
        ratio = times["generated"] / times["by hand"]
        shown = ", ".join(f"{name} {time:.4f}" for name, time in times.items())
        print(
            f"{sample:8} {shown}, ratio {ratio:.3f} (at most {MAX_RATIO}); differ {differing:.5%}"
        )
        figures |= {f"{sample}, {name} ms": time for name, time in times.items()}
        figures |= {
            f"{sample}, generated ÷ by hand": ratio,
            f"{sample}, share that differs": differing,
        }
    store(options.json, figures)


if __name__ == "__main__":
    main()
