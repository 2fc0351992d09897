"""One ray explained: every height that a technique read for a pixel, in order, and the true hit.

The technique itself runs, as the plain Python function that it is, on the ray of that pixel; its
reads are noted as they happen. `measure.section` draws them.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.lang import HeightField, IVec2, Shader, Texture, Vec2, bound, watched
from basrelief.lang.resources import Edge
from basrelief.measure.boxes import first_box_hits
from basrelief.measure.oracle import first_hits
from basrelief.rendering.programs import map_edge, program_of, values_of
from basrelief.rendering.render import scene_of
from basrelief.scene import Object, Scene
from basrelief.shading.camera import primary_ray
from basrelief.shading.intersection import Meeting, meet
from basrelief.shading.relief import depth_seen, lod_seen, relief_ray
from basrelief.techniques import displace
from basrelief.techniques.edge import cell_in_map, cells_in_map, in_tile
from basrelief.techniques.height import surface_height
from basrelief.techniques.ray import Hit, Ray, at

__all__ = ["Explanation", "Sample", "explain"]

Floats = NDArray[np.float64]
Kind = Literal["height", "cell", "record"]


@dataclass(frozen=True)
class Sample:
    """One read. `kind` says of what: a "height" of the surface, a "cell" between four texels that
    was solved as a whole, or a "record" of what is baked.

    `uv` is where, `ray` the ray's height there, `surface` the surface's, both 0 to 1.
    """

    kind: Kind
    uv: tuple[float, float]
    ray: float
    surface: float

    @property
    def above(self) -> bool:
        """Whether the ray is above the surface here."""
        return self.ray > self.surface


@dataclass(frozen=True, eq=False)
class Explanation:
    """The ray of one pixel, what a technique read along it, and where it should have ended.

    `uv` is where the ray meets the polygon, at height `level`; while it falls from height 1 to 0 it
    moves by `fall`, in texture coordinates. `hit` is the technique's own; `true_uv` and
    `true_height` those of the first hit in float64, on the bilinear surface, or on boxes where the
    technique takes texels for boxes. `heights` are the map, (height, width) float64.
    """

    material: str
    technique: str
    settings: Mapping[str, float]
    pixel: tuple[int, int]
    uv: tuple[float, float]
    fall: tuple[float, float]
    level: float
    samples: tuple[Sample, ...]
    hit: Hit
    true_uv: tuple[float, float]
    true_height: float
    heights: Floats = field(repr=False)
    edge: Edge
    boxes: bool

    @property
    def texels(self) -> Floats:
        """The width and the height of the map in texels."""
        return np.array(self.heights.shape[::-1], np.float64)

    @property
    def travel(self) -> float:
        """How far the ray moves over the map while it falls from height 1 to 0, in texels."""
        return float(np.linalg.norm(np.array(self.fall) * self.texels))

    @property
    def error(self) -> float:
        """How far from the true hit the technique ended, over the map, in texels."""
        apart = np.array([*self.hit.uv], np.float64) - self.true_uv
        return float(np.linalg.norm(apart * self.texels))

    def along(self, uv: Any) -> Floats:
        """How far texture coordinates, (…, 2), lie along the ray's way over the map, in texels from
        where it meets the polygon."""
        moved: Floats = (np.asarray(uv, np.float64) - self.uv) * self.texels
        return moved @ self.direction

    @property
    def direction(self) -> Floats:
        """The ray's way over the map in texels, of length 1; along u where there is none."""
        way: Floats = np.array(self.fall) * self.texels
        length = float(np.linalg.norm(way))
        return way / length if length > 1e-9 else np.array([1.0, 0.0])

    def surface(self, uv: Any) -> Floats:
        """The surface's heights at texture coordinates, (n, 2)."""
        return _surface(self.heights, np.asarray(uv, np.float64), self.edge, self.boxes)

    @property
    def told(self) -> str:
        """The technique with its settings."""
        return ", ".join(
            [self.technique, *(f"{name} {value:g}" for name, value in self.settings.items())]
        )

    @property
    def verdict(self) -> str:
        """How it went, in a few words."""
        reads = int(self.hit.reads)
        often = "1 read" if reads == 1 else f"{reads or 'no'} reads"
        met = "" if self.hit.found else ", nothing found"
        return f"{self.technique}: {often}{met}, {self.error:.2f} texels from the true hit"

    @property
    def summary(self) -> str:
        """The same with what was explained, in one line."""
        x, y = self.pixel
        return f"{self.material}, pixel {x},{y}: {self.verdict} ({self.told})"

    def table(self) -> str:
        """All reads as a table: number, of what, u, v, the ray's and the surface's height."""
        lines = [f"{'':>4}  {'read':<6} {'u':>9} {'v':>9} {'ray':>8} {'surface':>8}  the ray is"]
        for n, one in enumerate(self.samples, 1):
            where = "above" if one.above else "below" if one.ray < one.surface else "on it"
            lines.append(
                f"{n:>4}  {one.kind:<6} {one.uv[0]:>9.5f} {one.uv[1]:>9.5f} "
                f"{one.ray:>8.5f} {one.surface:>8.5f}  {where}"
            )
        for name, uv, height in (
            ("ends", [float(c) for c in self.hit.uv], float(self.hit.height)),
            ("true", self.true_uv, self.true_height),
        ):
            lines.append(f"{'':>4}  {name:<6} {uv[0]:>9.5f} {uv[1]:>9.5f} {height:>8.5f}")
        return "\n".join(lines)

    def save(self, path: str | Path) -> Path:
        """Draw the cross-section as SVG, PNG or PDF, whole or not at all; needs matplotlib.

        Raises InputError for another suffix, a place that cannot be written, or no matplotlib.
        """
        from basrelief.measure.section import write_section

        return write_section(self, Path(path))


def explain(
    what: Any, *, pixel: tuple[int, int], size: tuple[int, int] = (1280, 720), **options: Any
) -> Explanation:
    """Run the technique of what a pixel shows in Python, and note each of its reads.

    `what` and `options` are those of `render`; `pixel` is (x, y), from the top left, of a picture
    of `size` (width, height). Raises InputError where that pixel shows no relief.
    """
    scene = scene_of(what, {"preset": None, **options})
    x, y = pixel
    if not (0 <= x < size[0] and 0 <= y < size[1]):
        raise InputError(
            f"pixel {x},{y}: outside a picture of {size[0]} × {size[1]}; count from the top left"
        )
    scene.check_camera()
    met = [each for thing in scene.objects if (each := _met(thing, scene, pixel, size)) is not None]
    if not met:
        raise InputError(f"pixel {x},{y} meets nothing; choose one on the object")
    thing, meeting = min(met, key=lambda pair: float(pair[1].point.distance))
    if not thing.has_relief:
        raise InputError(
            f"pixel {x},{y} meets a {thing.shape} without relief, where nothing is read; "
            "give it heights and a technique other than flat"
        )
    return _explained(thing, scene, meeting, pixel, size)


def _met(
    thing: Object, scene: Scene, pixel: tuple[int, int], size: tuple[int, int]
) -> tuple[Object, Meeting] | None:
    """An object with where the ray through the middle of a pixel meets its shape."""
    values = values_of(thing, scene, size)
    with bound(program_of(thing, scene).bindings):
        place = Vec2(pixel[0] + 0.5, pixel[1] + 0.5)
        meeting = meet(primary_ray(values["view"].camera, place), values["placement"])
    return (thing, meeting) if meeting.point.found else None


def _explained(
    thing: Object, scene: Scene, met: Meeting, pixel: tuple[int, int], size: tuple[int, int]
) -> Explanation:
    values = values_of(thing, scene, size)
    field, technique = values["field"], thing.drawn_with
    with bound(program_of(thing, scene).bindings):
        deep = depth_seen(values["depth"], met.point.distance)
        if deep.scale <= 0.0:
            raise InputError(f"pixel {pixel[0]},{pixel[1]}: the relief has no depth here")
        lod = lod_seen(field, met.footprint, values["smoothing"])
        ray = relief_ray(met, deep, lod, values["smoothing"].mip_fade)
        notes = _Notes(ray, field, technique.boxes)
        baked = values.get("baked") or _UNBAKED
        with watched(notes.watch):
            hit = displace(notes.noting(field), notes.noting(baked), ray, values["settings"])
    top, fall = _at(ray, 1.0), _numbers(ray.fall)
    first = first_box_hits if technique.boxes else first_hits
    true = first(notes.heights, top, fall, map_edge(thing))
    return Explanation(
        material=thing.material.name,
        technique=technique.name,
        settings={f.name: getattr(thing.settings, f.name) for f in fields(thing.settings)},
        pixel=pixel,
        uv=_pair(_numbers(ray.uv)),
        fall=_pair(fall),
        level=float(ray.level),
        samples=tuple(notes.samples),
        hit=hit,
        true_uv=_pair(true.uv[0]),
        true_height=float(1.0 - true.t[0]),
        heights=notes.heights,
        edge=map_edge(thing),
        boxes=technique.boxes,
    )


_UNBAKED = Texture([np.zeros((1, 1, 4), np.uint16)])


# --- taking notes ---------------------------------------------------------------------------------


class _Notes:
    """What is read while a technique runs.

    A shader says where it reads before it does: by `in_tile`, which takes texture coordinates, or
    by `cells_in_map`, or once for each axis by `cell_in_map`. The heights read after that are one
    read, however many texels it takes, and all that `surface_height` does is one; each record of
    what is baked is one.
    """

    def __init__(self, ray: Ray, field: HeightField, boxes: bool) -> None:
        self.ray, self.boxes, self.edge = ray, boxes, field.edge
        self.heights: Floats = field.levels[0].astype(np.float64)
        self.samples: list[Sample] = []
        self.known: dict[bytes, float] = {}
        self.place: Vec2 | None = None
        self.cell: list[int] = []
        self.noted: set[type] = set()
        self.within = 0

    def watch(
        self, shader: Shader[..., Any], given: Mapping[str, Any], run: Callable[[], Any]
    ) -> Any:
        """Stand around the call of a shader."""
        if shader is surface_height:
            self.within += 1
            result = run()
            self.within -= 1
            if not self.within:
                self._add("height", given["uv"], float(result))
            return result
        if shader is cell_in_map:
            before = self.cell
            result = run()
            self._reads_at(None, [*before[-1:], int(given["cell"])])
            return result
        result = run()
        if shader is at:
            self.known[_key(result)] = float(given["height"])
        elif shader is in_tile:
            self._reads_at(given["uv"], [])
        elif shader is cells_in_map:
            self._reads_at(None, [int(each) for each in given["cell"]])
        return result

    def _reads_at(self, place: Vec2 | None, cell: list[int]) -> None:
        self.place, self.cell, self.noted = place, cell, set()

    def noting(self, map: Any) -> Any:
        """The same map, which tells when it is read."""
        kind = type(map)
        made = copy.copy(map)
        notes = self

        class Noting(kind):  # type: ignore[misc, valid-type]
            def texel_index(self, x: int, y: int, level: int) -> tuple[int, int, int]:
                notes.read(kind, x, y)
                found: tuple[int, int, int] = super().texel_index(x, y, level)
                return found

        made.__class__ = Noting
        return made

    def read(self, kind: type, x: int, y: int) -> None:
        """A texel of a map is read, the first of those that make one read."""
        if self.within or kind in self.noted:
            return
        if kind is not Texture:
            self.noted.add(kind)
        of: Kind = "record" if kind is Texture else "height"
        if self.place is not None:
            self._add(of, self.place, None)
        elif len(self.cell) == 2:
            whole: Kind = "height" if self.boxes else "cell"
            self._add_cell(whole if of == "height" else of, IVec2(*self.cell))
        else:
            # read by its texel alone, whose middle stands for it
            rows, columns = self.heights.shape
            self._add(of, Vec2((x + 0.5) / columns, (y + 0.5) / rows), None)

    def _add(self, kind: Kind, uv: Vec2, surface: float | None) -> None:
        place = _numbers(uv)
        if surface is None:
            surface = float(_surface(self.heights, place[None], self.edge, self.boxes)[0])
        ray = self.known.get(_key(uv))
        self.samples.append(
            Sample(kind, _pair(place), self._height_at(place) if ray is None else ray, surface)
        )

    def _height_at(self, place: Floats) -> float:
        """The ray's height over a place, by how far along its way it is."""
        fall = _numbers(self.ray.fall)
        moved = place - _numbers(self.ray.uv)
        return float(self.ray.level - moved @ fall / max(float(fall @ fall), 1e-30))

    def _add_cell(self, kind: Kind, cell: IVec2) -> None:
        """A read of a whole cell, or box: noted where the ray comes to it."""
        texels = np.array(self.heights.shape[::-1], np.float64)
        half = 0.0 if self.boxes else 0.5
        start, way = _at(self.ray, 1.0) * texels - half, _numbers(self.ray.fall) * texels
        low = np.array([int(cell.x), int(cell.y)], np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            walls = np.divide(low + (way <= 0) - start, way)
        enter = float(np.clip(np.nanmax(np.where(way == 0, -np.inf, walls)), 0.0, 1.0))
        place = (start + way * enter + half) / texels
        # a little further on, so that the box is the one behind the wall
        inner = (np.clip(start + way * enter, low + 1e-6, low + 1 - 1e-6) + half) / texels
        surface = float(_surface(self.heights, inner[None], self.edge, self.boxes)[0])
        self.samples.append(Sample(kind, _pair(place), 1.0 - enter, surface))


def _surface(heights: Floats, uv: Floats, edge: Edge, boxes: bool) -> Floats:
    """Heights at texture coordinates (n, 2): bilinear, or the texels' own."""
    size = np.array(heights.shape[::-1])
    place = uv * size - (0.0 if boxes else 0.5)
    first = np.floor(place).astype(np.int64)

    def read(right: int, down: int) -> Floats:
        x, y = (first + np.array([right, down])).T
        if edge == "wrap":
            x, y = x % size[0], y % size[1]
        found: Floats = heights[np.clip(y, 0, size[1] - 1), np.clip(x, 0, size[0] - 1)]
        return found

    if boxes:
        return read(0, 0)
    x, y = (place - first).T
    upper = read(0, 0) * (1 - x) + read(1, 0) * x
    lower = read(0, 1) * (1 - x) + read(1, 1) * x
    mixed: Floats = upper * (1 - y) + lower * y
    return mixed


def _at(ray: Ray, height: float) -> Floats:
    """The ray's texture coordinates at a height, in float64."""
    return _numbers(ray.uv) + _numbers(ray.fall) * (float(ray.level) - height)


def _numbers(v: Vec2) -> Floats:
    return np.array([float(c) for c in v], np.float64)


def _pair(values: Any) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _key(uv: Vec2) -> bytes:
    return np.array([*uv], np.float32).tobytes()
