"""The technique of pixel art: heights are boxes, one for each texel, and their sides are seen."""

from __future__ import annotations

from basrelief.lang import HeightField, Vec2, clamp, size
from basrelief.techniques.columns import (
    MAX_COLUMNS,
    leaving,
    line_over,
    next_column,
    top_of,
    within_box,
)
from basrelief.techniques.exact import Clearance, first_root
from basrelief.techniques.ray import SLOWEST, Hit, Ray, fall_at, height_at
from basrelief.techniques.technique import Nothing, technique


@technique(columns=True, most_reads=64)
def texel(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """Go from box to box, each texel being one, to the first whose side or top is met.

    Exact on that field, which is not the bilinear surface: steps stay steps, and their sides are
    lit as walls. Cost: a read for each texel passed over, up to 16,384. J. Amanatides and A. Woo,
    A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
    """
    extent = size(field, 0)
    line = line_over(extent, ray.uv, ray.travel)
    cell = line.cell
    # where a ray that hangs through is lowest
    lowest = 0.5 + 0.5 * ray.drop / max(ray.bend, SLOWEST)
    height = ray.height
    top = 0.0
    t = 0.0
    out = 0.0
    found = False
    k = 0
    while k < MAX_COLUMNS and not found and t < 1.0:
        top = top_of(field, extent, cell)
        leave = leaving(line, cell)
        out = min(max(min(leave.x, leave.y), t), 1.0)
        # kept for the next box: to compute it there anew costs a GPU a tenth
        after = height_at(ray, out)
        # through a side, or from above
        found = min(height, after) <= top
        if ray.bend > 0.0:
            found = found or height_at(ray, clamp(lowest, t, out)) <= top
        t = t if found else out
        height = height if found else after
        cell = cell if found or out >= 1.0 else next_column(line, cell, leave)
        k = k + 1
    over = height - top
    on_top = found and over > 0.0
    t = t + first_root(Clearance(ray.bend, -fall_at(ray, t), over, out - t)) if on_top else t
    place = within_box(line, cell, t)
    texels = Vec2(float(extent.x), float(extent.y))
    uv = (Vec2(float(cell.x), float(cell.y)) + place) / texels
    return Hit(uv, top if on_top else height, t, found, k)
