"""Scenes of the benchmarks, and timing by medians of alternating runs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import basrelief
from basrelief.engine import Engine
from basrelief.rendering.programs import program_of, values_of


def plane_scene(maps: int = 1024) -> basrelief.Scene:
    """A plane of bricks that fills a picture of 16 : 9, by parallax occlusion, 8 to 32 steps."""
    obj = basrelief.Object(
        basrelief.sample("bricks", maps),
        technique="parallax_occlusion",
        scale=0.06,
        tiling=(3.0, 3.0),
        transform=basrelief.rotated("x", -90.0) @ basrelief.placed(scale=(6.0, 6.0, 6.0)),
    )
    lights = (
        basrelief.directional(-50.0, 35.0),
        basrelief.point((0.5, 1.0, 0.5)),
        basrelief.spot((-1.0, 2.0, 0.0), intensity=3.0),
    )
    camera = basrelief.Orbit(azimuth=20.0, elevation=40.0, distance=2.0)
    return basrelief.Scene((obj,), camera=camera, lights=lights)


def work(scene: basrelief.Scene, size: tuple[int, int], engine: Engine):  # type: ignore[no-untyped-def]
    """Program of the first object of a scene, and its values, baked by an engine."""
    obj = scene.objects[0]
    return program_of(obj.resolved, scene), values_of(obj.resolved, scene, size, engine)


class Seconds(NamedTuple):
    """Duration of a task by the wall clock, and the processor time of all its threads.

    Other programs on the machine affect the first, and hardly the second.
    """

    wall: float
    processor: float


def seconds_of(task: Callable[[], object]) -> Seconds:
    """Time of one run of a task."""
    wall, processor = time.perf_counter(), time.process_time()
    task()
    return Seconds(time.perf_counter() - wall, time.process_time() - processor)


def median(taken: Sequence[Seconds]) -> Seconds:
    """Median of each of the two times."""
    return Seconds(*map(statistics.median, zip(*taken, strict=True)))


def alternate(tasks: Mapping[str, Callable[[], object]], runs: int = 7) -> dict[str, Seconds]:
    """Median time of each task, run in turn after one warm-up each."""
    for task in tasks.values():
        task()
    times: dict[str, list[Seconds]] = {name: [] for name in tasks}
    for _ in range(runs):
        for name, task in tasks.items():
            times[name].append(seconds_of(task))
    return {name: median(taken) for name, taken in times.items()}
