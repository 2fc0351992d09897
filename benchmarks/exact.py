"""The technique `exact` against parallax occlusion in the same run: nine cases, by timestamps.

    python benchmarks/exact.py                 on a GPU, 1920 × 1080 with a map of 1024²
    python benchmarks/exact.py --large         3840 × 2160 with a map of 4096²
    python benchmarks/exact.py --growth        on a GPU, maps from 256² to 8192² at one picture size
    python benchmarks/exact.py --cpu           on the CPU, against 32 steps

Bricks, stones and fractal noise, each shallow, steep and grazing; only texture coordinates are
computed. `exact` should take at most 1.3 times as long as 64 steps in the geometric mean and 2
times in any case; on the CPU at most 2 times as long as 32 steps in the mean.
"""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
from figures import option_parser, store
from scenes import Seconds, alternate

from basrelief import baking
from basrelief.lang import HeightField, IVec2, Texture, Vec2, Vec3, normalize, shader, struct
from basrelief.lang.program import Program
from basrelief.techniques import Nothing, displace, exact, parallax_occlusion
from basrelief.techniques.march import March
from basrelief.techniques.ray import Ray
from basrelief.techniques.technique import Settings

VIEWS = {
    # scale of the relief, and a view vector
    "shallow": (0.03, Vec3(0.5, 0.3, 1.0)),
    "steep": (0.1, Vec3(0.5, 0.3, 0.5)),
    "grazing": (0.1, Vec3(0.5, 0.3, 0.2)),
}

WARM_UP = 0.035
"""Seconds of warm-up for each timed run; the clocks of a GPU drop while a map is baked."""


@struct
class PlaneView:
    """A plane whose view vector varies a little over the picture."""

    size: Vec2
    view: Vec3
    scale: float


@struct
class Displaced:
    """Displaced texture coordinates."""

    uv: Vec2


@shader
def kernel(
    at: IVec2, plane: PlaneView, settings: Settings, field: HeightField, baked: Texture
) -> Displaced:
    """Displace the texture coordinates of one pixel."""
    uv = (Vec2(float(at.x), float(at.y)) + 0.5) / plane.size
    view = normalize(plane.view + Vec3((uv - 0.5) * 0.5, 0.0))
    travel = view.xy * (-plane.scale / view.z)
    ray = Ray(uv, travel, height=1.0, drop=1.0, cosine=view.z)
    return Displaced(displace(field, baked, ray, settings).uv)


def maps(size: int) -> dict[str, np.ndarray]:
    """Height maps: fractal noise, stones, bricks."""
    random = np.random.default_rng(0)
    f = np.fft.fftfreq(size)
    wave = np.hypot(*np.meshgrid(f, f))
    wave[0, 0] = 1.0
    noise = np.fft.fft2(random.standard_normal((size, size))) * wave**-1.6
    bricks = np.zeros((size, size))
    row = size // 16
    for j in range(16):
        for i in range(8):
            across = np.arange(
                i * 2 * row + (j % 2) * row + 2, (i + 1) * 2 * row + (j % 2) * row - 2
            )
            bricks[j * row + 2 : (j + 1) * row - 2, across % size] = 0.85 + 0.15 * random.random()
    return {
        "fractal": _unit(np.real(np.fft.ifft2(noise))),
        "stones": _unit(_stones(random.random((900, 2)), size)),
        "bricks": bricks.astype(np.float32),
    }


def _stones(points: np.ndarray, size: int) -> np.ndarray:
    """Worley noise: root of the difference of the distances to the two nearest points."""
    if size > 4096:
        return _doubled(_doubled(_stones(points, size // 2), 0), 1)
    near = np.full((2, size, size), 9.0, np.float32)
    place = (np.arange(size) + 0.5) / size
    for x, y in points:
        across, down = (np.abs(place - c) for c in (x, y))
        across, down = (np.minimum(d, 1.0 - d) for d in (across, down))
        rows, columns = np.flatnonzero(down < 0.08), np.flatnonzero(across < 0.08)
        part = np.ix_([0, 1], rows, columns)
        away = np.hypot(down[rows][:, None], across[columns]).astype(np.float32)
        nearest = near[part]
        near[part] = np.sort(np.concatenate([nearest, away[None]]), axis=0)[:2]
    return np.sqrt(np.clip((near[1] - near[0]) * 30.0, 0.0, 1.0))


def _doubled(values: np.ndarray, axis: int) -> np.ndarray:
    """Twice as many texels along an axis, interpolated."""
    before, after = (0.75 * values + 0.25 * np.roll(values, k, axis) for k in (1, -1))
    return np.stack([before, after], axis + 1).reshape(
        [n * (1 + (a == axis)) for a, n in enumerate(values.shape)]
    )


def _unit(values: np.ndarray) -> np.ndarray:
    return ((values - values.min()) / (values.max() - values.min())).astype(np.float32)


def programs(steps: int) -> dict[str, tuple[Program, Any]]:
    """Each technique's program and settings."""
    return {
        "march": (Program(kernel, {displace: parallax_occlusion}), March(steps, steps)),
        "exact": (Program(kernel, {displace: exact}), Nothing()),
    }


def programs_of_gpu(steps: int) -> dict[str, tuple[Program, Any]]:
    """The same, and the march with the filter of the hardware, which has 8-bit weights."""
    march = Program(kernel, {displace: parallax_occlusion}, sampling="hardware")
    return {**programs(steps), "filter": (march, March(steps, steps))}


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("--large", action="store_true")
    measured = parser.add_mutually_exclusive_group()
    measured.add_argument("--growth", action="store_true")
    measured.add_argument("--cpu", action="store_true")
    options = parser.parse_args()
    size, texels = ((3840, 2160), 4096) if options.large else ((1920, 1080), 1024)
    sides = (256, 1024, 4096, 8192)
    runs = 5 if options.cpu else 15
    if options.quick:
        size, texels, sides, runs = (64, 36), 128, (128, 144), 1
    engine: Any
    if options.cpu:
        from basrelief.engine.cpu import CpuEngine

        engine = CpuEngine()
    else:
        from basrelief.engine.gpu import GpuEngine

        engine = GpuEngine()
    if options.growth:
        figures = grow(engine, size, sides, runs)
    else:
        figures = against_steps(engine, size, texels, 32 if options.cpu else 64, runs)
    store(options.json, figures)


def against_steps(
    engine: Any, size: tuple[int, int], texels: int, steps: int, runs: int
) -> dict[str, float]:
    """The nine cases; on a GPU also the march with the hardware filter."""
    print(f"{engine.adapter}, {size[0]} × {size[1]}, map {texels}², {steps} steps")
    if engine.filtered_format is not None:
        print(f"the hardware filters heights of {engine.filtered_format}")
    figures: dict[str, float] = {}
    ratios: dict[str, list[float]] = {}
    for name, heights in maps(texels).items():
        field = HeightField([heights])
        baked, spent = bounds_of(engine, heights)
        each = baked.levels[0].nbytes / heights.size
        shown = ", ".join(f"{seconds * 1000:.1f} ms ({c})" for c, seconds in spent.items())
        print(f"{name}: bounds in {shown}, {each:.1f} bytes a texel")
        case = f"{engine.name}, {texels}², bounds of {name}"
        figures |= {f"{case}, {clock} ms": seconds * 1000 for clock, seconds in spent.items()}
        for view, (scale, towards) in VIEWS.items():
            values = {
                "plane": PlaneView(Vec2(*size), towards, scale),
                "field": field,
                "baked": baked,
            }
            compared_programs = programs_of_gpu if engine.name == "gpu" else programs
            by_clock = timed(engine, compared_programs(steps), values, size, runs)
            for clock, times in by_clock.items():
                shown = ", ".join(f"{what} {t * 1000:.4f} ms" for what, t in times.items())
                ratio = times["exact"] / times["march"]
                print(f"  {view:8} {shown}, exact ÷ march {ratio:.2f}, {clock}")
                for other in [each for each in times if each != "exact"]:
                    compared = ratios.setdefault(f"exact ÷ {other}, {clock}", [])
                    compared.append(times["exact"] / times[other])
    for name, values in ratios.items():
        print(f"{name}: geometric mean {mean(values):.2f}, worst {max(values):.2f}")
        case = f"{engine.name}, {size[0]} × {size[1]}, {texels}², {name}"
        figures |= {f"{case}, geometric mean": mean(values), f"{case}, worst": max(values)}
    return figures


def grow(engine: Any, size: tuple[int, int], sides: tuple[int, ...], runs: int) -> dict[str, float]:
    """Times for maps of growing size, with the same scale."""
    print(f"{engine.adapter}, {size[0]} × {size[1]}, exact alone")
    first = 0.0
    figures = {}
    for texels in sides:
        times = []
        for heights in maps(texels).values():
            baked, _ = bounds_of(engine, heights)
            field = HeightField([heights])
            for scale, towards in VIEWS.values():
                values = {
                    "plane": PlaneView(Vec2(*size), towards, scale), "field": field, "baked": baked,
                }  # fmt: skip
                warm(engine, values, size, runs * WARM_UP)
                taken = timed(engine, programs(64), values, size, runs)
                times.append(taken["timestamps"]["exact"])
        first = first or mean(times)
        each = ", ".join(f"{1000 * t:.4f}" for t in times)
        print(
            f"  {texels:5}² mean {mean(times) * 1000:.4f} ms, {mean(times) / first:.2f} × ({each})"
        )
        case = f"exact at {size[0]} × {size[1]}, {texels}²"
        figures |= {
            f"{case}, mean ms": mean(times) * 1000,
            f"{case} ÷ {sides[0]}²": mean(times) / first,
        }
    return figures


def warm(engine: Any, values: dict[str, Any], size: tuple[int, int], seconds: float) -> None:
    """Keep a GPU busy until its clocks are at full speed."""
    program, settings = programs(64)["march"]
    with engine.prepare(program, {**values, "settings": settings}, size) as job:
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            engine.seconds(job, size[1], 64)


def mean(values: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, values)) / len(values))


def bounds_of(engine: Any, heights: np.ndarray) -> tuple[Texture, dict[str, float]]:
    """Bounds of a map, and the seconds to bake them: by timestamps, or by each clock of the CPU."""
    timed_engine = TimedEngine(engine)
    start = time.perf_counter(), time.process_time()
    baked = Texture([baking.bounds(heights, "wrap", timed_engine)])  # type: ignore[arg-type]
    spent = Seconds(time.perf_counter() - start[0], time.process_time() - start[1])
    return baked, {"timestamps": timed_engine.seconds} if engine.name == "gpu" else spent._asdict()


class TimedEngine:
    """Engine that adds up the GPU time of its programs."""

    def __init__(self, engine: Any) -> None:
        self.engine, self.name, self.seconds = engine, engine.name, 0.0

    def run(
        self,
        program: Program,
        values: dict[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Any:
        if self.name == "gpu":
            first, last = rows or (0, size[1])
            rows_per_dispatch = self.engine.max_rows(len(program.planes), size[0], last - first)
            with self.engine.prepare(program, values, (size[0], rows_per_dispatch)) as job:
                self.seconds += (
                    self.engine.seconds(job, rows_per_dispatch) * (last - first) / rows_per_dispatch
                )
        return self.engine.run(program, values, size, rows)


def timed(
    engine: Any,
    techniques: dict[str, tuple[Program, Any]],
    values: dict[str, Any],
    size: tuple[int, int],
    runs: int,
) -> dict[str, dict[str, float]]:
    """Seconds of each technique, alternating: by timestamps, or by each clock of the CPU."""
    inputs = {name: {**values, "settings": settings} for name, (_, settings) in techniques.items()}
    if engine.name == "cpu":
        tasks = {n: lambda n=n: engine.run(techniques[n][0], inputs[n], size) for n in techniques}
        taken = alternate(tasks, runs)
        return {c: {n: getattr(taken[n], c) for n in techniques} for c in Seconds._fields}
    from gpu_kernel import milliseconds

    jobs = {n: engine.prepare(techniques[n][0], inputs[n], size) for n in techniques}
    times = milliseconds(engine, jobs, size[1], runs)
    for job in jobs.values():
        job.__exit__()
    return {"timestamps": {n: t / 1000.0 for n, t in times.items()}}


if __name__ == "__main__":
    main()
