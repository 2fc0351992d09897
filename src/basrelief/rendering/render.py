"""Scene → programs and their values → engine → Frame."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError, new_name
from basrelief.lang import Vec2
from basrelief.material import Material, load
from basrelief.rendering.frame import Frame, composite
from basrelief.rendering.programs import program_of, values_of
from basrelief.rendering.shadow_maps import shadow_map_values
from basrelief.scene import Object, Scene
from basrelief.scene.presets import NOTHING, Preset
from basrelief.scene.presets import preset as preset_named
from basrelief.shading.intersection import CameraSample

Progress = Callable[[float], None]
_LARGEST = 1 << 15
_MOST_PIXELS = 1 << 27
"""A frame of so many takes 4.4 GB."""
_BAND = 1 << 20
"""Pixels that are drawn at once: all samples of a band are done before the next, so that a large
picture needs little memory beside its own."""


def render(
    what: Scene | Object | Material | str | Path,
    *,
    size: tuple[int, int] = (1280, 720),
    samples: int = 4,
    device: str | Engine = "auto",
    progress: Progress | None = None,
    preset: str | Path | Preset | None = None,
    **options: Any,
) -> Frame:
    """Draw a scene, an object, a material, or what is in a folder.

    `size` is (width, height) in pixels; `samples` how many places of each pixel are averaged;
    `device` is "auto", "cpu", "gpu" or an engine of `choose_device`. Further options are those of
    `Object` (`technique`, `shape`, `scale`, …) and `Scene` (`camera`, `lights`, …) where `what`
    does not fix them.
    `preset`, a name, a TOML file or a `Preset`, says what is left open of how a folder is read and
    a material drawn.
    Raises InputError for values that make no picture, DeviceError for a device that cannot be used.
    """
    scene = scene_of(what, {**options, "preset": preset})
    width, height = check_picture(size, samples)
    scene.check_camera()
    engine = engine_of(device)
    return _Drawing(scene, (width, height), samples, engine, progress).frame()


def check_picture(size: Any, samples: int = 1) -> tuple[int, int]:
    """Width and height of a picture; raises InputError for sizes and samples that make none."""
    width, height = _checked_size(size)
    if width * height > _MOST_PIXELS:
        raise InputError(
            f"a picture of {width} × {height} is over {_MOST_PIXELS // 10**6} million pixels; "
            "draw it smaller, or in parts"
        )
    if not (0 < width <= _LARGEST and 0 < height <= _LARGEST):
        raise InputError(f"a picture of {width} × {height}: give 1 to {_LARGEST} pixels a side")
    if not 1 <= samples <= 1024:
        raise InputError(f"{samples} samples a pixel: give 1 to 1024")
    return width, height


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = (operator.index(side) for side in size)
    except (TypeError, ValueError):
        raise InputError(f"size is {size!r}: give (width, height) in whole pixels") from None
    return width, height


def scene_of(what: Any, options: dict[str, Any]) -> Scene:
    """The scene that `render` draws for what it is given; uses the options up.

    Raises InputError for an option that there is not, or that `what` already says.
    """
    preset = options.pop("preset", None)
    chosen = preset_named(preset) if isinstance(preset, str | Path) else preset or NOTHING
    if isinstance(what, str | Path):
        what = load(what, **chosen.maps)
    if isinstance(what, Material):
        return chosen.scene(what, **options)
    of_scene = {k: options.pop(k) for k in list(options) if k in Scene.__dataclass_fields__}
    if isinstance(what, Object):
        what = Scene((what,), **of_scene)
        of_scene = {}
    if not isinstance(what, Scene):
        raise InputError(f"cannot draw a {type(what).__name__}: give a folder, material or scene")
    left = [*options, *of_scene, *([] if preset is None else ["preset"])]
    if left:
        hint = new_name(left[0], ("device",))
        raise InputError(hint or f"{', '.join(left)}: already said by the {type(what).__name__}")
    return what


# --- drawing -------------------------------------------------------------------------------------


def sample_places(count: int) -> list[tuple[float, float]]:
    """Places within a pixel, 0 to 1, evenly spread for any count; the first is the middle.

    M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
    """
    return [
        ((0.5 + k * 0.7548776662466927) % 1.0, (0.5 + k * 0.5698402909980532) % 1.0)
        for k in range(count)
    ]


class _Drawing:
    """One picture under way: band by band, every sample of every object laid over one another."""

    def __init__(
        self,
        scene: Scene,
        size: tuple[int, int],
        samples: int,
        engine: Engine,
        progress: Progress | None,
    ) -> None:
        self.scene, self.size, self.engine, self.progress = scene, size, engine, progress
        self.places = sample_places(samples)
        order = scene.back_to_front(size)
        cast = (
            shadow_map_values(replace(scene, objects=tuple(order)), engine)
            if scene.casts
            else [{}] * len(order)
        )
        self.objects = [
            (program_of(obj, scene), {**values_of(obj, scene, size, engine), **others})
            for obj, others in zip(order, cast, strict=True)
        ]
        width, height = size
        self.band = max(1, min(height, _BAND // width))
        self.runs = -(-height // self.band) * samples * len(self.objects)
        self.done = 0

    def frame(self) -> Frame:
        """All samples averaged; everything but the colour from the first."""
        whole = self.empty(self.size[1])
        for top in range(0, self.size[1], self.band):
            rows = (top, min(top + self.band, self.size[1]))
            self.draw(whole.rows(*rows), rows)
        return whole

    def draw(self, band: Frame, rows: tuple[int, int]) -> None:
        """Draw some rows into their part of the frame."""
        for number, place in enumerate(self.places):
            one = self.sample(place, rows)
            if number == 0:
                band.take(one)
            else:
                np.add(band.color, one.color, out=band.color)
        np.multiply(band.color, np.float32(1.0 / len(self.places)), out=band.color)
        if self.scene.background is None:
            # colour divided by coverage again, where the background is transparent
            coverage = np.maximum(band.color[:, :, 3:], np.float32(1e-6))
            np.divide(band.color[:, :, :3], coverage, out=band.color[:, :, :3])

    def sample(self, place: tuple[float, float], rows: tuple[int, int]) -> Frame:
        """One sample of some rows: the nearest object at each pixel, over the background.

        Colour is multiplied by coverage, so that samples can be added up.
        """
        frame = self.empty(rows[1] - rows[0])
        if self.scene.background is not None:
            frame.color[:] = (*self.scene.background, 1.0)
        for program, values in self.objects:
            view = CameraSample(values["sample"].camera, Vec2(*place))
            planes = self.engine.run(program, {**values, "sample": view}, self.size, rows)
            composite(frame, planes)
            self.done += 1
            if self.progress is not None:
                self.progress(self.done / self.runs)
        return frame

    def empty(self, height: int) -> Frame:
        """A frame of the picture's width in which there is nothing yet."""
        width = self.size[0]
        return Frame(
            np.zeros((height, width, 4), np.float32),
            np.full((height, width), np.inf, np.float32),
            np.zeros((height, width, 2), np.float32),
            np.zeros((height, width), np.bool_),
            np.zeros((height, width), np.int32),
            f"{self.engine.name}: {self.engine.adapter}",
        )
