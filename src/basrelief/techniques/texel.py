"""The technique of pixel art: the exact hit on columns, one per texel, sides included."""

from __future__ import annotations

from basrelief.lang import HeightField, Vec2, clamp, size
from basrelief.techniques.columns import (
    MAX_COLUMNS,
    column_top,
    grid_line,
    next_column,
    position_in_column,
    t_exits,
)
from basrelief.techniques.exact import Clearance, first_root
from basrelief.techniques.ray import MIN_DROP, Hit, Ray, at, descent_at, height_at
from basrelief.techniques.technique import Nothing, technique


@technique(columns=True, most_reads=64)
def texel(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """The first column whose side or top the ray hits, by grid traversal.

    Within a column the ray is lowest at its ends or where its descent is 0:

        side: height_at(t_enter) ≤ top         top: min over the column of height_at(t) ≤ top

    Exact on the field of columns, which is not the bilinear surface: steps stay steps, and their
    sides are lit as walls.
    Cost: one read for each texel passed over, at most 16,384.

    References
    ----------
    J. Amanatides and A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
    """
    extent = size(field, 0)
    line = grid_line(extent, ray.uv, ray.travel)
    column = line.first
    # where a bent ray is lowest
    t_lowest = 0.5 + 0.5 * ray.drop / max(ray.bend, MIN_DROP)
    height = ray.height
    top = 0.0
    t = 0.0
    t_exit = 0.0
    found = False
    k = 0
    while k < MAX_COLUMNS and not found and t < 1.0:
        top = column_top(field, extent, column)
        exits = t_exits(line, column)
        t_exit = min(min(exits.x, exits.y), 1.0)
        # kept for the next column: to compute it again there costs a GPU 10 %
        exit_height = height_at(ray, t_exit)
        lowest = min(height, exit_height)
        if ray.bend > 0.0:
            lowest = min(lowest, height_at(ray, clamp(t_lowest, t, t_exit)))
        # through a side, or from above
        found = lowest <= top
        t = t if found else t_exit
        height = height if found else exit_height
        column = column if found else next_column(line, column, exits)
        k = k + 1
    above = height - top
    on_top = found and above > 0.0
    t = t + first_root(Clearance(ray.bend, -descent_at(ray, t), above, t_exit - t)) if on_top else t
    position = position_in_column(line, column, t)
    texels = Vec2(float(extent.x), float(extent.y))
    uv = (Vec2(float(column.x), float(column.y)) + position) / texels
    # the loop is past the last column of a ray that hits none
    uv = uv if found else at(ray, t)
    return Hit(uv, top if on_top else height, t, found, k)
