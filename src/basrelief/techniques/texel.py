"""The technique of pixel art: heights are boxes, one for each texel, and their sides are seen."""

from __future__ import annotations

from basrelief.lang import HeightField, Vec2, size
from basrelief.techniques.columns import (
    MOST_BOXES,
    leaving,
    line_over,
    next_box,
    top_of,
    within_box,
)
from basrelief.techniques.ray import Hit, Ray, at
from basrelief.techniques.technique import Nothing, technique


@technique(boxes=True, most_reads=64)
def texel(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """Go from box to box, each texel being one, to the first whose side or top is met.

    Exact on that field, which is not the bilinear surface: steps stay steps, and their sides are
    lit as walls. Cost: a read for each texel passed over, up to 16,384. J. Amanatides and A. Woo,
    A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
    """
    extent = size(field, 0)
    line = line_over(extent, at(ray, 1.0), ray.fall)
    cell = line.cell
    t = 0.0
    height = 1.0
    found = False
    k = 0
    while k < MOST_BOXES and not found:
        top = top_of(field, extent, cell)
        leave = leaving(line, cell)
        out = max(min(leave.x, leave.y), t)
        # through a side, at the height that the ray has there, or from above
        found = 1.0 - t <= top or 1.0 - top <= out
        height = min(1.0 - t, top) if found else 1.0 - out
        t = t if found else out
        cell = cell if found else next_box(line, cell, leave)
        k = k + 1
    place = within_box(line, cell, 1.0 - height)
    texels = Vec2(float(extent.x), float(extent.y))
    uv = (Vec2(float(cell.x), float(cell.y)) + place) / texels
    return Hit(uv, height, found, k)
