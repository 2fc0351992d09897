"""One ray explained: every height that a technique read for a pixel, in order, and the true hit.

The technique itself runs, as the plain Python function that it is, on the ray of that pixel; its
reads are noted as they happen. `measure.section` draws them.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.lang import HeightField, IVec2, Shader, Texture, Vec2, bound, watched
from basrelief.measure.columns import first_column_hits
from basrelief.measure.oracle import first_hits
from basrelief.measure.section import write_section
from basrelief.measure.traced import Floats, Kind, Sample, TracedRay, surface_heights
from basrelief.rendering.programs import map_edge, values_of, variant_of
from basrelief.rendering.render import scene_of
from basrelief.scene import Object, Scene
from basrelief.shading.camera import CameraRay, primary_ray
from basrelief.shading.intersection import Intersection, footprint_at, intersect
from basrelief.shading.relief import faded_relief, height_lod, object_height_range, relief_ray
from basrelief.techniques import displace
from basrelief.techniques.edge import cell_in_map, cells_in_map, in_tile
from basrelief.techniques.height import surface_height
from basrelief.techniques.ray import Ray, at, height_at

__all__ = ["Explanation", "Sample", "explain"]


@dataclass(frozen=True, eq=False)
class Explanation(TracedRay):
    """A traced ray that draws itself."""

    def save(self, path: str | Path) -> Path:
        """Draw the cross-section as SVG, PNG or PDF, whole or not at all; needs matplotlib.

        Raises InputError for another suffix, a place that cannot be written, or no matplotlib.
        """
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
    met = [each for obj in scene.objects if (each := _met(obj, scene, pixel, size)) is not None]
    if not met:
        raise InputError(f"pixel {x},{y} meets nothing; choose one on the object")
    obj, meeting = min(met, key=lambda pair: float(pair[1].distance))
    if not obj.has_relief:
        raise InputError(
            f"pixel {x},{y} meets a {obj.shape} without relief, where nothing is read; "
            "give it heights and a technique other than flat"
        )
    return _explained(obj, scene, meeting, pixel, size)


def _met(
    obj: Object, scene: Scene, pixel: tuple[int, int], size: tuple[int, int]
) -> tuple[Object, Intersection] | None:
    """An object with where the ray through the middle of a pixel meets its shape."""
    ray = _camera_ray(scene, pixel, size)
    meeting = intersect(ray, obj.placement(), variant_of(obj, scene))
    return (obj, meeting) if meeting.found else None


def _camera_ray(scene: Scene, pixel: tuple[int, int], size: tuple[int, int]) -> CameraRay:
    return primary_ray(scene.shader_camera(size), Vec2(pixel[0] + 0.5, pixel[1] + 0.5))


def _explained(
    obj: Object, scene: Scene, met: Intersection, pixel: tuple[int, int], size: tuple[int, int]
) -> Explanation:
    # the shaders run in Python, which rounds as the CPU does
    values = values_of(obj, scene, size, choose_device("cpu"))
    field, technique = values["field"], obj.drawn_with
    variant = variant_of(obj, scene)
    seen = faded_relief(values["relief"], met.distance, variant)
    if seen.scale <= 0.0:
        raise InputError(f"pixel {pixel[0]},{pixel[1]}: the relief has no depth here")
    camera, placement = _camera_ray(scene, pixel, size), obj.placement()
    footprint = footprint_at(camera, placement, met, met.distance)
    lod = height_lod(field, footprint, values["smoothing"])
    deep = object_height_range(seen, placement, variant)
    ray = relief_ray(met, seen, deep, lod, values["smoothing"].mip_fade, variant)
    notes = _Notes(ray, field, technique.columns)
    baked = values.get("baked") or _UNBAKED
    with bound({displace: technique}), watched(notes.watch):
        hit = displace(notes.noting(field), notes.noting(baked), ray, values["settings"])
    travel = _numbers(ray.travel)
    first = first_column_hits if technique.columns else first_hits
    true = first(notes.heights, _numbers(ray.uv), travel, map_edge(obj))
    return Explanation(
        material=obj.material.name,
        technique=technique.name,
        settings={f.name: getattr(obj.settings, f.name) for f in fields(obj.settings)},
        pixel=pixel,
        uv=_pair(_numbers(met.uv)),
        travel=_pair(travel),
        reference_height=float(ray.reference_height),
        samples=tuple(notes.samples),
        hit=hit,
        true_uv=_pair(true.uv[0]),
        true_height=float(1.0 - true.t[0]),
        heights=notes.heights,
        edge=map_edge(obj),
        columns=technique.columns,
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

    def __init__(self, ray: Ray, field: HeightField, columns: bool) -> None:
        self.ray, self.columns, self.edge = ray, columns, field.edge
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
            self.known[_key(result)] = float(height_at(self.ray, given["t"]))
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
            whole: Kind = "height" if self.columns else "cell"
            self._add_cell(whole if of == "height" else of, IVec2(*self.cell))
        else:
            # read by its texel alone, whose middle stands for it
            rows, columns = self.heights.shape
            self._add(of, Vec2((x + 0.5) / columns, (y + 0.5) / rows), None)

    def _add(self, kind: Kind, uv: Vec2, surface: float | None) -> None:
        place = _numbers(uv)
        if surface is None:
            surface = float(surface_heights(self.heights, place[None], self.edge, self.columns)[0])
        ray = self.known.get(_key(uv))
        self.samples.append(
            Sample(kind, _pair(place), self._height_at(place) if ray is None else ray, surface)
        )

    def _height_at(self, place: Floats) -> float:
        """The ray's height over a place, by how far along its way it is."""
        travel = _numbers(self.ray.travel)
        moved = place - _numbers(self.ray.uv)
        return float(1.0 - moved @ travel / max(float(travel @ travel), 1e-30))

    def _add_cell(self, kind: Kind, cell: IVec2) -> None:
        """A read of a whole cell, or box: noted where the ray comes to it."""
        texels = np.array(self.heights.shape[::-1], np.float64)
        half = 0.0 if self.columns else 0.5
        start, way = _numbers(self.ray.uv) * texels - half, _numbers(self.ray.travel) * texels
        low = np.array([int(cell.x), int(cell.y)], np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            walls = np.divide(low + (way <= 0) - start, way)
        enter = float(np.clip(np.nanmax(np.where(way == 0, -np.inf, walls)), 0.0, 1.0))
        place = (start + way * enter + half) / texels
        # a little further on, so that the box is the one behind the wall
        inner = (np.clip(start + way * enter, low + 1e-6, low + 1 - 1e-6) + half) / texels
        surface = float(surface_heights(self.heights, inner[None], self.edge, self.columns)[0])
        self.samples.append(Sample(kind, _pair(place), 1.0 - enter, surface))


def _numbers(v: Vec2) -> Floats:
    return np.array([float(c) for c in v], np.float64)


def _pair(values: Any) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _key(uv: Vec2) -> bytes:
    return np.array([*uv], np.float32).tobytes()
