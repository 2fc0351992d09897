"""Whole frames as users draw them, beside the time of their kernels: `render`, and what it is for.

Each line is the median of several calls, with the seconds of each step (`basrelief render
--timings`): by device, size, samples, what is read of the frame, and number of threads.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path

from figures import option_parser, store
from scenes import seconds_of

import basrelief
from basrelief.engine import Engine, choose_device
from basrelief.engine.cpu import CpuEngine
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import frame_program_of, frame_values, values_of
from basrelief.rendering.render import sample_positions
from basrelief.timings import Timings

FRAMES = (((1920, 1080), 1), ((1920, 1080), 4), ((3840, 2160), 4))
PLANES = ("color", "distance", "uv", "hit", "reads")


def scene(maps: int, **options: object) -> basrelief.Scene:
    stones = basrelief.sample("cobbles", maps)
    return basrelief.Scene((basrelief.Object(stones, technique="relief"),), **options)


def whole(
    scene: basrelief.Scene, size: tuple[int, int], samples: int, engine: Engine,
    use: Callable[[Frame], object], runs: int,
) -> tuple[float, dict[str, float]]:  # fmt: skip
    """Median seconds of drawing and using a frame, and of each step of the median call."""
    calls = []
    for run in range(runs + 1):
        with Timings() as timings:
            use(basrelief.render(scene, size=size, samples=samples, device=engine))
        if run > 0:
            calls.append((timings.total, timings.seconds))
    return sorted(calls, key=lambda call: call[0])[runs // 2]


def kernel(
    scene: basrelief.Scene, size: tuple[int, int], samples: int, engine: Engine, runs: int
) -> float:
    """Median seconds of the frame's program alone: by timestamps on a GPU."""
    obj = scene.resolved[0]
    program = frame_program_of(obj, scene)
    shared = frame_values(scene, sample_positions(samples))
    values = {**values_of(obj, scene, size, engine), **shared}
    if getattr(engine, "has_timestamps", False):
        with engine.prepare(program, values, size) as job:
            # many at once, since the clocks of an idle GPU are low
            return statistics.median(engine.seconds(job, size[1], 64) for _ in range(runs))
    canvas = engine.canvas(program, size)
    engine.draw(program, values, canvas)
    return statistics.median(
        seconds_of(lambda: engine.draw(program, values, canvas)).wall for _ in range(runs)
    )


def uses(folder: Path) -> dict[str, Callable[[Frame], object]]:
    """What is read of a frame, by name."""
    return {
        "codes": lambda frame: frame.codes,
        "all planes": lambda frame: [getattr(frame, name) for name in PLANES],
        "png": lambda frame: frame.save(folder / "frame.png"),
    }


def thread_counts(most: int) -> list[int]:
    """Powers of two up to the number of threads, and that number."""
    return sorted({most, *(2**k for k in range(most.bit_length()) if 2**k <= most)})


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("device", nargs="*", default=["cpu"])
    options = parser.parse_args()
    maps, runs, frames = 1024, 9, FRAMES
    if options.quick:
        maps, runs, frames = 64, 1, (((96, 54), 2),)
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        for device in options.device:
            engine = choose_device(device)
            print(f"{device}: {engine.adapter}")
            for size, samples in frames:
                name = f"{device}, {size[0]} × {size[1]}, {samples} samples"
                drawn = scene(maps)
                alone = kernel(drawn, size, samples, engine, runs)
                figures[f"{name}, kernel, ms"] = alone * 1e3
                print(f"  {name}: kernel {alone * 1e3:.2f} ms")
                for what, use in uses(Path(folder)).items():
                    total, steps = whole(drawn, size, samples, engine, use, runs)
                    figures[f"{name}, {what}, ms"] = total * 1e3
                    shown = ", ".join(f"{k} {v * 1e3:.1f}" for k, v in steps.items() if v > 0)
                    print(f"    {what}: {total * 1e3:.1f} ms, {total / alone:.2f} ×  ({shown})")
    if "cpu" in options.device:
        figures |= by_threads(scene(maps, shadows="soft"), frames[0], runs)
    store(options.json, figures)


def by_threads(
    scene: basrelief.Scene, frame: tuple[tuple[int, int], int], runs: int
) -> dict[str, float]:
    """Times of a frame with soft shadows on the CPU, by the number of threads."""
    size, samples = frame
    figures = {}
    for threads in thread_counts(CpuEngine().threads):
        engine = CpuEngine(threads=threads)
        alone = kernel(scene, size, samples, engine, runs)
        total, _ = whole(scene, size, samples, engine, lambda frame: frame.codes, runs)
        figures[f"cpu, soft shadows, {threads} threads, codes, ms"] = total * 1e3
        figures[f"cpu, soft shadows, {threads} threads, kernel, ms"] = alone * 1e3
        print(
            f"  cpu, soft shadows, {threads} threads: {total * 1e3:.1f} ms, "
            f"{total / alone:.2f} × its kernel"
        )
    return figures


if __name__ == "__main__":
    main()
