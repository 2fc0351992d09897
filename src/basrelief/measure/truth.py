"""Where the view rays of a picture truly end: the first hits of the oracle, pixel by pixel.

Only the rays come from the shaders: where each meets the polygon, and how its texture coordinates
move while it falls. The heights that the oracle sees are those of the very field that techniques
read, in 32 bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.lang.resources import Edge
from basrelief.measure.oracle import first_hits
from basrelief.rendering import textures
from basrelief.rendering.programs import map_edge, values_of, view_ray_program_of
from basrelief.rendering.render import check_picture
from basrelief.scene import Object, Scene

__all__ = ["Truth", "truth"]

Floats = NDArray[np.float64]
_AT_ONCE = 1 << 15
"""Rays that are walked side by side: what they hold stays near the processor."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The true first hit of every pixel's ray; arrays are (height, width, …), row 0 at the top.

    `uv` (…, 2) are the texture coordinates of the hit, not taken into one tile; `height` (0 to 1)
    is that of the surface there, `distance` that along the ray in world units. `there` says
    which pixels show the object at all; where it is False the others are 0. `travel` (…, 2) is how
    far the ray's coordinates move while it falls from height 1 to 0. `texels` is the size of the
    height map, (along u, along v), and `wraps` whether it repeats.
    """

    uv: Floats
    height: Floats
    distance: Floats
    there: NDArray[np.bool_]
    travel: Floats
    texels: tuple[int, int]
    wraps: bool


def truth(what: Scene | Object, size: tuple[int, int], *, device: str | Engine = "auto") -> Truth:
    """The true first hits of a scene of one plane with a relief, as `render` would draw it.

    `size` is (width, height). The relief lies where the object's `level` says, and fades where it
    fades; whatever its `projection` and `heights`, the true ray is straight and the true surface
    is the finest level's. Raises InputError for a scene of anything but one plane with heights.
    """
    size = check_picture(size)
    scene = what if isinstance(what, Scene) else Scene((what,))
    obj = measurable(scene)
    engine = engine_of(device)
    values = values_of(obj, scene, size, engine)
    rays = engine.run(view_ray_program_of(obj), values, size)
    found = rays["found"] != 0
    start, travel = (
        np.stack([rays[f"{name}.x"], rays[f"{name}.y"]], -1).astype(np.float64)
        for name in ("uv", "travel")
    )
    heights = _heights(obj)
    uv, height = np.zeros_like(start), np.zeros(found.shape)
    uv[found], height[found] = _met(heights, start[found], travel[found], map_edge(obj))
    depth = rays["distance"] + (1.0 - height) * rays["length"].astype(float)
    there = found & (depth > 0.0)
    if obj.edge == "clip":
        place = (uv - obj.shift) / obj.tiles
        there &= ((place >= 0.0) & (place <= 1.0)).all(-1)
    return Truth(
        uv, height, np.where(there, depth, 0.0), there, travel, heights.shape[::-1],
        map_edge(obj) == "wrap",
    )  # fmt: skip


def measurable(scene: Scene) -> Object:
    """The one object of a scene whose truth is known; raises InputError where there is none."""
    if len(scene.objects) != 1 or scene.objects[0].shape != "plane":
        raise InputError("errors are measured on one plane; give a scene of one object, a plane")
    obj = scene.objects[0]
    if obj.material.height is None:
        raise InputError(
            f"{obj.material.name} has no height map, so there is nothing to measure; add one"
        )
    return obj


def _heights(obj: Object) -> NDArray[np.float32]:
    """The finest level of the field that programs read."""
    field = textures.height_field(obj.material, map_edge(obj))
    assert field is not None
    heights: NDArray[np.float32] = field.levels[0]
    return heights


def _met(
    heights: NDArray[np.float32], start: Floats, travel: Floats, edge: Edge
) -> tuple[Floats, Floats]:
    uv, height = np.empty_like(start), np.empty(len(start))
    for first in range(0, len(start), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        hits = first_hits(heights, start[some], travel[some], edge)
        uv[some], height[some] = hits.uv, hits.height
    return uv, height
