"""Scene → programs and their values → engine → Frame."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.casting import cast_values
from basrelief.engine import Engine, Planes, choose_engine
from basrelief.errors import InputError
from basrelief.lang import Vec2
from basrelief.material import Material, load
from basrelief.picture import encode_png, write_picture
from basrelief.presets import NOTHING, Preset
from basrelief.presets import preset as preset_named
from basrelief.programs import program_of, values_of
from basrelief.scene import Object, Scene
from basrelief.shaders.meeting import View
from basrelief.shaders.pixel import SOLID

__all__ = ["Frame", "Image", "render"]

Progress = Callable[[float], None]
_LARGEST = 1 << 15
_MOST_PIXELS = 1 << 27
"""A frame of so many takes 4.4 GB."""
_BAND = 1 << 20
"""Pixels that are drawn at once: all samples of a band are done before the next, so that a large
picture needs little memory beside its own."""


@dataclass(frozen=True, eq=False)
class Image:
    """A picture: `pixels` (height, width, 4) float32, linear Rec. 709, alpha last."""

    pixels: NDArray[np.float32]

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the picture, whole or not at all; the suffix says the format.

        PNG (8 bits a channel, or 16), JPEG and WebP in sRGB; EXR and HDR linear. Raises InputError
        for another suffix or a folder that cannot be written. Returns the path.
        """
        write_picture(path, self._for_file(Path(path)), bits=bits, quality=quality)
        return Path(path)

    def _for_file(self, path: Path) -> NDArray[np.float32]:
        opaque = bool((self.pixels[:, :, 3] >= 1.0).all())
        return self.pixels[:, :, :3] if opaque else self.pixels

    def _repr_png_(self) -> bytes:
        return encode_png(self._for_file(Path()))


@dataclass(frozen=True, eq=False, repr=False)
class Frame:
    """What was drawn, pixel by pixel; arrays are (height, width, …), row 0 at the top.

    `color` (…, 4) float32 linear with coverage, over the background; `depth` float32, the distance
    from the camera along the ray in world units, infinite where nothing is; `uv` (…, 2) float32,
    the displaced texture coordinates; `hit` bool; `reads` int32, how many heights were read. All
    but the colour are those of the first sample, in the middle of the pixel. `engine` says on what.
    """

    color: NDArray[np.float32]
    depth: NDArray[np.float32]
    uv: NDArray[np.float32]
    hit: NDArray[np.bool_]
    reads: NDArray[np.int32]
    engine: str

    def rows(self, first: int, last: int) -> Frame:
        """The same frame's rows first … last − 1, as views."""
        some = slice(first, last)
        return Frame(
            self.color[some],
            self.depth[some],
            self.uv[some],
            self.hit[some],
            self.reads[some],
            self.engine,
        )

    def take(self, other: Frame) -> None:
        """Copy what another frame of the same size holds into this one."""
        for name in ("color", "depth", "uv", "hit", "reads"):
            np.copyto(getattr(self, name), getattr(other, name))

    @property
    def mean_reads(self) -> float:
        """The mean number of heights read at the pixels that are covered."""
        return float(self.reads[self.hit].mean()) if self.hit.any() else 0.0

    @property
    def image(self) -> Image:
        """The picture."""
        return Image(self.color)

    def __repr__(self) -> str:
        height, width = self.depth.shape
        return f"<Frame {width} × {height}, {self.engine}>"

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the picture; see `Image.save`."""
        return self.image.save(path, bits=bits, quality=quality)

    def _repr_png_(self) -> bytes:
        return self.image._repr_png_()


def render(
    what: Scene | Object | Material | str | Path,
    *,
    size: tuple[int, int] = (1280, 720),
    samples: int = 4,
    engine: str | Engine = "auto",
    progress: Progress | None = None,
    preset: str | Path | Preset | None = None,
    **options: Any,
) -> Frame:
    """Draw a scene, an object, a material, or what is in a folder.

    `size` is (width, height) in pixels; `samples` how many places of each pixel are averaged;
    `engine` "auto", "cpu", "gpu" or an engine. Further options are those of `Object` (`technique`,
    `shape`, `scale`, …) and `Scene` (`camera`, `lights`, …) where `what` does not fix them.
    `preset`, a name, a TOML file or a `Preset`, says what is left open of how a folder is read and
    a material drawn.
    Raises InputError for values that make no picture, EngineError for an engine that cannot run.
    """
    scene = scene_of(what, {**options, "preset": preset})
    width, height = check_picture(size, samples)
    scene.check_camera()
    runner = choose_engine(engine) if isinstance(engine, str) else engine
    return _Drawing(scene, (width, height), samples, runner, progress).frame()


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
        raise InputError(f"{', '.join(left)}: already said by the {type(what).__name__}")
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
        order = scene.from_far_to_near(size)
        cast = (
            cast_values(replace(scene, objects=tuple(order)), engine)
            if scene.casts
            else [{}] * len(order)
        )
        self.things = [
            (program_of(thing, scene), {**values_of(thing, scene, size), **others})
            for thing, others in zip(order, cast, strict=True)
        ]
        width, height = size
        self.band = max(1, min(height, _BAND // width))
        self.runs = -(-height // self.band) * samples * len(self.things)
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
        for program, values in self.things:
            view = View(values["view"].camera, Vec2(*place))
            planes = self.engine.run(program, {**values, "view": view}, self.size, rows)
            _lay_over(frame, planes)
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
            f"{self.engine.name}: {self.engine.device}",
        )


def _lay_over(frame: Frame, planes: Planes) -> None:
    """Put an object's planes where they are nearer than what is there.

    What is mostly see-through leaves the depth as it is, and so hides nothing that comes later.
    """
    np.add(frame.reads, planes["reads"], out=frame.reads)
    nearer = (planes["hit"] != 0) & (planes["depth"] < frame.depth)
    coverage = np.where(nearer, planes["color.w"], np.float32(0.0))
    rest = np.float32(1.0) - coverage
    for channel, name in enumerate(("color.x", "color.y", "color.z")):
        plane = frame.color[:, :, channel]
        np.multiply(plane, rest, out=plane)
        plane += planes[name] * coverage
    alpha = frame.color[:, :, 3]
    np.multiply(alpha, rest, out=alpha)
    alpha += coverage
    solid = coverage >= SOLID
    np.copyto(frame.depth, planes["depth"], where=solid)
    np.copyto(frame.uv[:, :, 0], planes["uv.x"], where=solid)
    np.copyto(frame.uv[:, :, 1], planes["uv.y"], where=solid)
    np.logical_or(frame.hit, solid, out=frame.hit)
