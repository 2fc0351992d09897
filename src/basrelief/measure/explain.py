"""Explanation of one ray: the reads of a technique in a pixel, in order, and the true hit.

The technique itself runs as plain Python on the pixel's ray while its reads are recorded;
`measure.section` draws them.
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
from basrelief.measure.columns import intersect_columns
from basrelief.measure.oracle import intersect_height_field
from basrelief.measure.section import write_section
from basrelief.measure.traced import Floats, Kind, Read, TracedRay, surface_heights
from basrelief.rendering.programs import map_edge, values_of, variant_of
from basrelief.rendering.render import scene_of
from basrelief.scene import ResolvedObject, Scene
from basrelief.shading.camera import CameraRay, primary_ray
from basrelief.shading.intersection import Intersection, footprint_at, intersect
from basrelief.shading.relief import faded_relief, height_lod, object_height_range, relief_ray
from basrelief.techniques import displace
from basrelief.techniques.edge import cell_in_map, cells_in_map, in_tile
from basrelief.techniques.height import surface_height
from basrelief.techniques.ray import Ray, at, height_at

__all__ = ["Explanation", "Read", "explain"]


@dataclass(frozen=True, eq=False)
class Explanation(TracedRay):
    """The ray of one pixel, the reads of a technique along it, and the true hit.

    Attributes
    ----------
    material, technique : str
        Names of the material and the technique.
    settings : mapping of str to float
        Settings of the technique.
    pixel : (int, int)
        The pixel (x, y), from the top left.
    uv : (float, float)
        Texture coordinates at which the ray meets the polygon.
    travel : (float, float)
        Change of the texture coordinates while the ray falls from height 1 to 0.
    reference_height : float
        Height of the polygon, 0 to 1.
    reads : tuple of Read
        Reads of the technique, in order.
    hit : Hit
        Hit of the technique.
    true_uv : (float, float)
        Texture coordinates of the true first hit.
    true_height : float
        Height of the true first hit, 0 to 1.
    heights : ndarray of float64, shape (h, w)
        The height map, 0 to 1.
    edge : {"wrap", "clamp"}
        Continuation beyond the map.
    columns : bool
        Whether the technique draws columns, not the bilinear surface.
    """

    def save(self, path: str | Path) -> Path:
        """Draw the cross-section along the ray; needs matplotlib.

        Parameters
        ----------
        path : path
            An SVG, PNG or PDF file; it is written atomically.

        Returns
        -------
        Path
            The path of the file.

        Raises
        ------
        InputError
            For another suffix, a file that cannot be written, or without matplotlib.
        """
        return write_section(self, Path(path))


def explain(
    what: Any, *, pixel: tuple[int, int], size: tuple[int, int] = (1280, 720), **options: Any
) -> Explanation:
    """Trace the view ray of one pixel in Python and record each read of the technique.

    Heights are read as texels, also for the filter "hardware".

    Parameters
    ----------
    what : Scene, Object, Material or path
        The scene, or what to make it of, as in `render`.
    pixel : (int, int)
        The pixel (x, y), from the top left.
    size : (int, int)
        Width and height of the picture, in pixels.
    **options
        Options of `render` that describe the scene.

    Returns
    -------
    Explanation

    Raises
    ------
    InputError
        For a pixel outside the picture, and for one that shows no relief.
    """
    scene = scene_of(what, {"preset": None, **options})
    x, y = pixel
    if not (0 <= x < size[0] and 0 <= y < size[1]):
        raise InputError(
            f"pixel {x},{y}: outside a picture of {size[0]} × {size[1]}; count from the top left"
        )
    scene.check_camera()
    intersections = [
        pair
        for obj in scene.resolved
        if (pair := _intersection_with(obj, scene, pixel, size)) is not None
    ]
    if not intersections:
        raise InputError(f"pixel {x},{y} shows no object; choose another")
    obj, intersection = min(intersections, key=lambda pair: float(pair[1].distance))
    if not obj.has_relief:
        raise InputError(
            f"pixel {x},{y} shows a {obj.shape} without relief, where nothing is read; "
            "give it heights and a technique other than flat"
        )
    return _explanation(obj, scene, intersection, pixel, size)


def _intersection_with(
    obj: ResolvedObject, scene: Scene, pixel: tuple[int, int], size: tuple[int, int]
) -> tuple[ResolvedObject, Intersection] | None:
    """The object, with the intersection of its shape and a pixel's ray; None for a miss."""
    ray = _camera_ray(scene, pixel, size)
    intersection = intersect(ray, obj.placement(), variant_of(obj, scene))
    return (obj, intersection) if intersection.found else None


def _camera_ray(scene: Scene, pixel: tuple[int, int], size: tuple[int, int]) -> CameraRay:
    return primary_ray(scene.shader_camera(size), Vec2(pixel[0] + 0.5, pixel[1] + 0.5))


def _explanation(
    obj: ResolvedObject,
    scene: Scene,
    intersection: Intersection,
    pixel: tuple[int, int],
    size: tuple[int, int],
) -> Explanation:
    # the shaders run in Python, which rounds as the CPU does
    values = values_of(obj, scene, size, choose_device("cpu"))
    field, technique = values["field"], obj.technique
    variant = variant_of(obj, scene)
    faded = faded_relief(values["relief"], intersection.distance, variant)
    if faded.scale <= 0.0:
        raise InputError(
            f"pixel {pixel[0]},{pixel[1]}: the relief has no depth here; choose another"
        )
    camera, placement = _camera_ray(scene, pixel, size), obj.placement()
    footprint = footprint_at(camera, placement, intersection, intersection.distance)
    lod = height_lod(field, footprint, values["smoothing"])
    depth = object_height_range(faded, placement, variant)
    ray = relief_ray(intersection, faded, depth, lod, values["smoothing"].mip_fade, variant)
    recorder = _ReadRecorder(ray, field, technique.columns)
    baked = values.get("baked") or _NO_BAKE
    with bound({displace: technique}), watched(recorder.watch):
        hit = displace(
            recorder.recording(field), recorder.recording(baked), ray, values["settings"]
        )
    travel = _array(ray.travel)
    first_hits = intersect_columns if technique.columns else intersect_height_field
    true = first_hits(recorder.heights, _array(ray.uv), travel, map_edge(obj))
    return Explanation(
        material=obj.material.name,
        technique=technique.name,
        settings={f.name: getattr(obj.settings, f.name) for f in fields(obj.settings)},
        pixel=pixel,
        uv=_pair(_array(intersection.uv)),
        travel=_pair(travel),
        reference_height=float(ray.reference_height),
        reads=tuple(recorder.reads),
        hit=hit,
        true_uv=_pair(true.uv[0]),
        true_height=float(1.0 - true.t[0]),
        heights=recorder.heights,
        edge=map_edge(obj),
        columns=technique.columns,
    )


_NO_BAKE = Texture([np.zeros((1, 1, 4), np.uint16)])
"""Argument of techniques that read no baked table."""


# --- recording reads ------------------------------------------------------------------------------


class _ReadRecorder:
    """Recorder of a technique's reads.

    A shader calls `in_tile` (with texture coordinates), `cells_in_map` or, for each axis,
    `cell_in_map` before it reads there. The heights read after such a call count as one read,
    however many texels they take; so does a call of `surface_height`. Each baked record counts as
    one read.
    """

    def __init__(self, ray: Ray, field: HeightField, columns: bool) -> None:
        self.ray, self.columns, self.edge = ray, columns, field.edge
        self.heights: Floats = field.levels[0].astype(np.float64)
        self.reads: list[Read] = []
        self.ray_heights: dict[bytes, float] = {}
        self.uv: Vec2 | None = None
        self.cell: list[int] = []
        self.recorded_types: set[type] = set()
        self.nesting = 0

    def watch(
        self, shader: Shader[..., Any], arguments: Mapping[str, Any], run: Callable[[], Any]
    ) -> Any:
        """Run the call of a shader; record its read, or the location of the reads that follow."""
        if shader is surface_height:
            self.nesting += 1
            result = run()
            self.nesting -= 1
            if not self.nesting:
                self._add("height", arguments["uv"], float(result))
            return result
        if shader is cell_in_map:
            previous_cell = self.cell
            result = run()
            self._set_location(None, [*previous_cell[-1:], int(arguments["cell"])])
            return result
        result = run()
        if shader is at:
            self.ray_heights[_key(result)] = float(height_at(self.ray, arguments["t"]))
        elif shader is in_tile:
            self._set_location(arguments["uv"], [])
        elif shader is cells_in_map:
            self._set_location(None, [int(index) for index in arguments["cell"]])
        return result

    def _set_location(self, uv: Vec2 | None, cell: list[int]) -> None:
        self.uv, self.cell, self.recorded_types = uv, cell, set()

    def recording(self, map: Any) -> Any:
        """A copy of a map that reports its reads."""
        map_type = type(map)
        copied = copy.copy(map)
        recorder = self

        class RecordingMap(map_type):  # type: ignore[misc, valid-type]
            def texel_index(self, x: int, y: int, level: int) -> tuple[int, int, int]:
                recorder.read(map_type, x, y)
                index: tuple[int, int, int] = super().texel_index(x, y, level)
                return index

        copied.__class__ = RecordingMap
        return copied

    def read(self, map_type: type, x: int, y: int) -> None:
        """Record the read of a texel, if it is the first of those that count as one read."""
        if self.nesting or map_type in self.recorded_types:
            return
        if map_type is not Texture:
            self.recorded_types.add(map_type)
        kind: Kind = "record" if map_type is Texture else "height"
        if self.uv is not None:
            self._add(kind, self.uv, None)
        elif len(self.cell) == 2:
            cell_kind: Kind = "height" if self.columns else "cell"
            self._add_cell(cell_kind if kind == "height" else kind, IVec2(*self.cell))
        else:
            # no location was recorded; take the centre of the texel
            rows, columns = self.heights.shape
            self._add(kind, Vec2((x + 0.5) / columns, (y + 0.5) / rows), None)

    def _add(self, kind: Kind, uv: Vec2, surface: float | None) -> None:
        point = _array(uv)
        if surface is None:
            surface = float(surface_heights(self.heights, point[None], self.edge, self.columns)[0])
        ray_height = self.ray_heights.get(_key(uv))
        self.reads.append(
            Read(
                kind,
                _pair(point),
                self._height_at(point) if ray_height is None else ray_height,
                surface,
            )
        )

    def _height_at(self, point: Floats) -> float:
        """The ray's height over a point of the map, from the point's position along the ray."""
        travel = _array(self.ray.travel)
        offset = point - _array(self.ray.uv)
        return float(1.0 - offset @ travel / max(float(travel @ travel), 1e-30))

    def _add_cell(self, kind: Kind, cell: IVec2) -> None:
        """Record the read of a whole cell or column at the point where the ray enters it."""
        texels = np.array(self.heights.shape[::-1], np.float64)
        half = 0.0 if self.columns else 0.5
        start, travel = _array(self.ray.uv) * texels - half, _array(self.ray.travel) * texels
        low = np.array([int(cell.x), int(cell.y)], np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            walls = np.divide(low + (travel <= 0) - start, travel)
        t_enter = float(np.clip(np.nanmax(np.where(travel == 0, -np.inf, walls)), 0.0, 1.0))
        point = (start + travel * t_enter + half) / texels
        # moved off the wall, so that the height is that of this column, not of its neighbour
        inside = (np.clip(start + travel * t_enter, low + 1e-6, low + 1 - 1e-6) + half) / texels
        surface = float(surface_heights(self.heights, inside[None], self.edge, self.columns)[0])
        self.reads.append(Read(kind, _pair(point), 1.0 - t_enter, surface))


def _array(v: Vec2) -> Floats:
    return np.array([float(c) for c in v], np.float64)


def _pair(values: Any) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def _key(uv: Vec2) -> bytes:
    return np.array([*uv], np.float32).tobytes()
