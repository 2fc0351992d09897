"""How long programs take, in turn with one another, so that a busy machine is unfair to none."""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Literal, assert_never

from basrelief.engine import Engine
from basrelief.lang.program import Program
from basrelief.rendering.programs import program_of, values_of
from basrelief.scene import Scene

RUNS = 5
"""How many runs a time is the median of."""
_DISPATCHES = 8
"""How often a GPU draws in one timestamped run."""
GPU_SIZE = (1920, 1080)
"""On a GPU a small picture is drawn too fast to be timed."""


@dataclass(frozen=True)
class Timing:
    """How times are taken: the picture's (width, height), and by "clock" or "timestamps"."""

    size: tuple[int, int]
    by: Literal["clock", "timestamps"]


def timing_on(engine: Engine, size: tuple[int, int]) -> Timing:
    """How times of pictures of a size are best taken on an engine."""
    real = getattr(engine, "adapter_info", {}).get("adapter_type", "CPU") != "CPU"
    if real and getattr(engine, "has_timestamps", False):
        return Timing(GPU_SIZE, "timestamps")
    return Timing(size, "clock")


def seconds_of(
    scenes: Mapping[str, Scene], timing: Timing, engine: Engine, runs: int = RUNS
) -> dict[str, float]:
    """The median time in seconds of each scene's drawing program alone, one sample a pixel.

    Each is of one object. They take turns, after one run each to warm up.
    """
    found: dict[str, list[float]] = {name: [] for name in scenes}
    with ExitStack() as stack:
        ready = {name: _ready(scene, timing, engine, stack) for name, scene in scenes.items()}
        for run in range(runs + 1):
            for name, once in ready.items():
                seconds = once()
                if run > 0:
                    found[name].append(seconds)
    return {name: statistics.median(times) for name, times in found.items()}


def _ready(scene: Scene, timing: Timing, engine: Any, stack: ExitStack) -> Any:
    """What draws a scene once and says how long it took."""
    obj, size = scene.objects[0], timing.size
    program, values = program_of(obj, scene), values_of(obj, scene, size, engine)
    match timing.by:
        case "timestamps":
            job = stack.enter_context(engine.prepare(program, values, size))
            return lambda: engine.seconds(job, size[1], _DISPATCHES)
        case "clock":
            return lambda: _clocked(engine, program, values, size)
        case _:
            assert_never(timing.by)


def _clocked(
    engine: Engine, program: Program, values: Mapping[str, Any], size: tuple[int, int]
) -> float:
    before = time.perf_counter()
    engine.run(program, values, size)
    return time.perf_counter() - before
