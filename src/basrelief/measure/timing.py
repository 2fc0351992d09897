"""Times of drawing programs, measured in turn so that a busy machine slows all of them alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Literal, assert_never

from basrelief.engine import Canvas, Engine
from basrelief.lang.program import Program
from basrelief.rendering.programs import frame_program_of, frame_values, values_of
from basrelief.scene import Scene

RUNS = 5
"""Number of runs of which a time is the median."""
CENTRE = (0.5, 0.5)
"""The only sample of a pixel."""
_DISPATCHES = 8
"""Dispatches in one timestamped run on a GPU."""
GPU_SIZE = (1920, 1080)
"""Picture size on a GPU, which draws small pictures too fast to be timed."""


@dataclass(frozen=True)
class Timing:
    """The way times are measured: size, the picture's (width, height), by clock or timestamps."""

    size: tuple[int, int]
    by: Literal["clock", "timestamps"]


def timing_on(engine: Engine, size: tuple[int, int]) -> Timing:
    """The best way to measure times of pictures of a size on an engine."""
    is_hardware = getattr(engine, "adapter_info", {}).get("adapter_type", "CPU") != "CPU"
    if is_hardware and getattr(engine, "has_timestamps", False):
        return Timing(GPU_SIZE, "timestamps")
    return Timing(size, "clock")


def seconds_of(
    scenes: Mapping[str, Scene], timing: Timing, engine: Engine, runs: int = RUNS
) -> dict[str, float]:
    """Median seconds of each scene's drawing program alone, with one sample a pixel.

    Scenes have one object each. They run in turn, so that none finds warmer caches.
    """
    times_of: dict[str, list[float]] = {name: [] for name in scenes}
    with ExitStack() as stack:
        canvas = _canvas_for(scenes, timing, engine)
        draws = {
            name: _timed_draw(scene, timing, engine, canvas, stack)
            for name, scene in scenes.items()
        }
        for _ in range(runs):
            for name, draw in draws.items():
                times_of[name].append(draw())
    return {name: statistics.median(times) for name, times in times_of.items()}


def _canvas_for(scenes: Mapping[str, Scene], timing: Timing, engine: Engine) -> Canvas | None:
    """The canvas on which all programs are timed by the clock, since their planes are the same."""
    if timing.by != "clock":
        return None
    scene = next(iter(scenes.values()))
    return engine.canvas(frame_program_of(scene.resolved[0], scene), timing.size)


def _timed_draw(
    scene: Scene, timing: Timing, engine: Any, canvas: Canvas | None, stack: ExitStack
) -> Any:
    """A function that draws a scene once and returns the seconds it took."""
    obj, size = scene.resolved[0], timing.size
    # the program that pictures are drawn with, so that there is one to compile
    program = frame_program_of(obj, scene)
    values = {**values_of(obj, scene, size, engine), **frame_values(scene, [CENTRE])}
    match timing.by:
        case "timestamps":
            job = stack.enter_context(engine.prepare(program, values, size))
            return lambda: engine.seconds(job, size[1], _DISPATCHES)
        case "clock":
            assert canvas is not None
            # a row, to compile and to upload maps
            engine.draw(program, values, canvas, (0, 1))
            return lambda: _clocked(engine, program, values, canvas)
        case _:
            assert_never(timing.by)


def _clocked(engine: Engine, program: Program, values: Mapping[str, Any], canvas: Canvas) -> float:
    before = time.perf_counter()
    engine.draw(program, values, canvas)
    canvas.read("reads")  # waits until it is drawn
    return time.perf_counter() - before
