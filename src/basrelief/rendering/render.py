"""Rendering of a scene to a frame, by an engine."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import Any

from basrelief.engine import Engine, check_sampling, engine_of
from basrelief.errors import InputError, new_name
from basrelief.lang import Vec2
from basrelief.lang.program import Program
from basrelief.material import Material, load
from basrelief.rendering.frame import Frame, empty_frame
from basrelief.rendering.programs import (
    backdrop_of,
    frame_program_of,
    frame_values,
    values_of,
)
from basrelief.rendering.shadow_maps import shadow_map_values
from basrelief.scene import Object, Scene
from basrelief.scene.presets import EMPTY_PRESET, Preset
from basrelief.scene.presets import preset as preset_named
from basrelief.settings import settings_of
from basrelief.shading.intersection import CameraSample
from basrelief.shading.picture import Step
from basrelief.timings import step

Progress = Callable[[float], None]
_MAX_SIDE = 1 << 15
_MAX_PIXELS = 1 << 27
"""Largest number of pixels; such a frame takes 4.4 GB."""
_BAND = 1 << 24
"""Samples that are drawn at once, between two reports of the progress."""


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
        For a device that cannot be used, and for the CPU with the filter "hardware".
    """
    scene = scene_of(what, {**options, "preset": preset})
    width, height = check_picture(size, samples)
    scene.check_camera()
    engine = engine_of(device)
    check_device(scene, engine)
    with step("draw"):
        return _Drawing(scene, (width, height), samples, engine, progress).frame()


def check_device(scene: Scene, engine: Engine) -> None:
    """Raise DeviceError for a scene that an engine cannot draw."""
    for obj in scene.objects:
        check_sampling(obj.filter, engine)


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
    """State of drawing one picture: the programs of its objects, and the planes on the device."""

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
        shared = frame_values(scene, self.positions)
        self.objects = [
            (
                frame_program_of(obj, scene),
                {**values_of(obj, scene, size, engine), **shared, **shadow_map},
            )
            for obj, shadow_map in zip(ordered.resolved, shadow_maps, strict=True)
        ]

    def frame(self) -> Frame:
        """The whole frame: colours averaged over all samples, other planes of the first."""
        if not self.objects:
            device = f"{self.engine.name}: {self.engine.adapter}"
            return empty_frame(self.size, backdrop_of(self.scene), device)
        canvas = self.engine.canvas(self.objects[0][0], self.size)
        steps = [*self._steps()]
        for number, (program, values, rows) in enumerate(steps):
            self.engine.draw(program, values, canvas, rows)
            if self.progress is not None:
                self.progress((number + 1) / len(steps))
        prefix = "" if len(self.objects) == 1 else "drawn."
        return Frame.drawn(self.engine, canvas, prefix, opaque=self.scene.background is not None)

    def _steps(self) -> Iterator[tuple[Program, dict[str, Any], tuple[int, int]]]:
        """Programs to run in turn, with their values and rows."""
        width, height = self.size
        samples, layers = len(self.positions), len(self.objects)
        # one object takes all samples at once
        band = max(1, _BAND // (width * (samples if layers == 1 else 1)))
        for top in range(0, height, band):
            rows = (top, min(top + band, height))
            if layers == 1:
                yield (*self.objects[0], rows)
                continue
            for sample, position in enumerate(self.positions):
                for number, (program, values) in enumerate(self.objects):
                    view = CameraSample(values["sample"].camera, Vec2(*position))
                    position_of_run = Step(number, layers, sample, samples)
                    yield program, {**values, "sample": view, "step": position_of_run}, rows
