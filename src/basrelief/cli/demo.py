"""Pictures of `basrelief demo`: every technique on bricks, every shape with another sample."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.material import Material, sample
from basrelief.rendering.programs import frame_program_of
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene
from basrelief.scene.recipe import Recipe
from basrelief.settings.kinds import ShapeKind
from basrelief.techniques import TECHNIQUES

_SIZE = (640, 360)
_SAMPLES = 3
_SHAPES: tuple[tuple[str, ShapeKind], ...] = (
    ("cobbles", "sphere"),
    ("tiles", "box"),
    ("gravel", "cylinder"),
    ("terrain", "plane"),
)
_SHOWN = [name for name, technique in TECHNIQUES.items() if technique.most_reads < 100]
"""Techniques of the demo: all but the slowest."""
COUNT = len(_SHOWN) + len(_SHAPES)
"""Number of pictures."""


def pictures(folder: Path, device: str) -> Iterator[tuple[Path, str]]:
    """Draw the pictures into a folder; yields the path of each when it is written, and the command
    that draws it."""
    # choosing a device and making the samples are independent: run both at once
    with ThreadPoolExecutor() as pool:
        device_choice = pool.submit(choose_device, device)
        names = ["bricks", *(name for name, _ in _SHAPES)]
        materials = dict(zip(names, pool.map(sample, names), strict=True))
        scenes = dict(_scenes(materials))
        engine = device_choice.result()
        programs = [frame_program_of(scene.resolved[0], scene) for scene in scenes.values()]
        list(pool.map(engine.compile, programs))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror}); choose another") from None
    # one picture is written while the next is drawn
    with ThreadPoolExecutor(1) as writer:
        writing: Future[Path] | None = None
        command = ""
        for name, scene in scenes.items():
            frame = render(scene, size=_SIZE, samples=_SAMPLES, device=engine)
            if writing is not None:
                yield writing.result(), command
            writing = writer.submit(frame.save, folder / f"{name}.png")
            command = Recipe(scene, {"size": _SIZE, "samples": _SAMPLES}).command
        if writing is not None:
            yield writing.result(), command


def _scenes(materials: dict[str, Material]) -> Iterator[tuple[str, Scene]]:
    for name in _SHOWN:
        obj = Object(materials["bricks"], technique=name, scale=0.08)
        yield f"bricks-{name}", Scene((obj,), camera=Orbit(30.0, 28.0))
    for sample_name, shape in _SHAPES:
        yield f"{sample_name}-{shape}", Scene((Object(materials[sample_name], shape=shape),))
