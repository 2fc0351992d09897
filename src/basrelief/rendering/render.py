"""Rendering of a scene to a frame, by an engine."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import replace
from numbers import Integral
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
from basrelief.scene.presets import EMPTY_PRESET, Preset
from basrelief.scene.presets import preset as preset_named
from basrelief.settings import settings_of
from basrelief.shading.intersection import CameraSample

Progress = Callable[[float], None]
_MAX_SIDE = 1 << 15
_MAX_PIXELS = 1 << 27
"""Largest number of pixels; such a frame takes 4.4 GB."""
_BAND = 1 << 20
"""Pixels drawn at once. All samples of a band are finished before the next band, so that a large
picture needs little extra memory."""


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
    """Draw a scene, an object, a material, or the material in a folder.

    Parameters
    ----------
    what : Scene, Object, Material, path or str
        Scene to draw, or a part of one. Paths and "sample:NAME" are passed to `load`.
    size : (int, int), default (1280, 720)
        Width and height in pixels, up to 32768 a side and 134 million pixels.
    samples : int, default 4
        Samples per pixel, 1 to 1024, whose colours are averaged.
    device : {"auto", "cpu", "gpu"} or Engine, default "auto"
        Device that draws, or an engine of `choose_device`.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    preset : str, path or Preset, optional
        Preset by its name or TOML file, for a material or a folder. `options` override it.
    **options
        Options of `Object` (`technique`, `shape`, `scale`, …) and `Scene` (`camera`, `lights`, …)
        that `what` does not fix.

    Returns
    -------
    Frame

    Raises
    ------
    InputError
        For unknown options, values out of range, and a camera inside an object.
    DeviceError
        For a device that cannot be used.
    """
    scene = scene_of(what, {**options, "preset": preset})
    width, height = check_picture(size, samples)
    scene.check_camera()
    engine = engine_of(device)
    return _Drawing(scene, (width, height), samples, engine, progress).frame()


def check_picture(size: Any, samples: int = 1) -> tuple[int, int]:
    """Width and height of a picture; raises InputError for a size or samples out of range."""
    width, height = _checked_size(size)
    if width * height > _MAX_PIXELS:
        raise InputError(
            f"a picture of {width} × {height} is over {_MAX_PIXELS // 10**6} million pixels; "
            "draw it smaller, or in parts"
        )
    if not (0 < width <= _MAX_SIDE and 0 < height <= _MAX_SIDE):
        raise InputError(f"a picture of {width} × {height}: give 1 to {_MAX_SIDE} pixels a side")
    if not isinstance(samples, Integral) or not 1 <= samples <= 1024:
        raise InputError(f"{samples} samples a pixel: give 1 to 1024")
    return width, height


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = (operator.index(side) for side in size)
    except (TypeError, ValueError):
        raise InputError(f"size is {size!r}: give (width, height) in whole pixels") from None
    return width, height


def scene_of(what: Any, options: dict[str, Any]) -> Scene:
    """The scene that `render` draws for its arguments; removes used options from `options`.

    Raises InputError for unknown options, and for those that `what` fixes.
    """
    preset = options.pop("preset", None)
    preset_record = (
        preset_named(preset) if isinstance(preset, str | Path) else preset or EMPTY_PRESET
    )
    if isinstance(what, str | Path):
        what = load(what, **preset_record.maps)
    if isinstance(what, Material):
        return preset_record.scene(what, **options)
    scene_options = {k: options.pop(k) for k in list(options) if k in settings_of(Scene)}
    if isinstance(what, Object):
        what = Scene((what,), **scene_options)
        scene_options = {}
    if not isinstance(what, Scene):
        raise InputError(f"cannot draw a {type(what).__name__}: give a folder, material or scene")
    unused = [*options, *scene_options, *([] if preset is None else ["preset"])]
    if unused:
        hint = new_name(unused[0], ("device",))
        raise InputError(
            hint
            or f"{', '.join(unused)}: already set by the {type(what).__name__}; change it there"
        )
    return what


# --- drawing -------------------------------------------------------------------------------------


def sample_positions(count: int) -> list[tuple[float, float]]:
    """Sample positions within a pixel, 0 to 1, the first at its centre.

    The R2 sequence, evenly spread for any count (M. Roberts, The Unreasonable Effectiveness of
    Quasirandom Sequences, 2018).
    """
    return [
        ((0.5 + k * 0.7548776662466927) % 1.0, (0.5 + k * 0.5698402909980532) % 1.0)
        for k in range(count)
    ]


class _Drawing:
    """State of drawing one picture: band by band, samples of all objects are composited."""

    def __init__(
        self,
        scene: Scene,
        size: tuple[int, int],
        samples: int,
        engine: Engine,
        progress: Progress | None,
    ) -> None:
        self.scene, self.size, self.engine, self.progress = scene, size, engine, progress
        self.positions = sample_positions(samples)
        ordered = replace(scene, objects=tuple(scene.back_to_front(size)))
        shadow_maps = (
            shadow_map_values(ordered, engine) if scene.casts else [{}] * len(scene.objects)
        )
        self.objects = [
            (program_of(obj, scene), {**values_of(obj, scene, size, engine), **shadow_map})
            for obj, shadow_map in zip(ordered.resolved, shadow_maps, strict=True)
        ]
        width, height = size
        self.band = max(1, min(height, _BAND // width))
        self.runs = -(-height // self.band) * samples * len(self.objects)
        self.done = 0

    def frame(self) -> Frame:
        """The whole frame: colours averaged over all samples, other planes of the first."""
        frame = self.empty(self.size[1])
        for top in range(0, self.size[1], self.band):
            rows = (top, min(top + self.band, self.size[1]))
            self.draw(frame.rows(*rows), rows)
        return frame

    def draw(self, band: Frame, rows: tuple[int, int]) -> None:
        """Draw a range of rows into their part of the frame."""
        for number, position in enumerate(self.positions):
            sample = self.sample(position, rows)
            if number == 0:
                band.take(sample)
            else:
                np.add(band.color, sample.color, out=band.color)
        np.multiply(band.color, np.float32(1.0 / len(self.positions)), out=band.color)
        if self.scene.background is None:
            # back to straight alpha, where the background is transparent
            coverage = np.maximum(band.color[:, :, 3:], np.float32(1e-6))
            np.divide(band.color[:, :, :3], coverage, out=band.color[:, :, :3])

    def sample(self, position: tuple[float, float], rows: tuple[int, int]) -> Frame:
        """One sample of a range of rows, composited over the background.

        Colour is premultiplied by coverage, so that samples can be added.
        """
        frame = self.empty(rows[1] - rows[0])
        if self.scene.background is not None:
            frame.color[:] = (*self.scene.background, 1.0)
        for program, values in self.objects:
            view = CameraSample(values["sample"].camera, Vec2(*position))
            planes = self.engine.run(program, {**values, "sample": view}, self.size, rows)
            composite(frame, planes)
            self.done += 1
            if self.progress is not None:
                self.progress(self.done / self.runs)
        return frame

    def empty(self, height: int) -> Frame:
        """An empty frame of the picture's width."""
        width = self.size[0]
        return Frame(
            np.zeros((height, width, 4), np.float32),
            np.full((height, width), np.inf, np.float32),
            np.zeros((height, width, 2), np.float32),
            np.zeros((height, width), np.bool_),
            np.zeros((height, width), np.int32),
            f"{self.engine.name}: {self.engine.adapter}",
        )
