"""The height field of columns: one flat-topped column per texel, without interpolation (pixel art).

It is another field than the bilinear surface (CONVENTIONS.md), with vertical walls between texels.
A line is followed from column to column, one grid line at a time; the t of each grid line is
computed from its number, so that rounding errors do not add up. J. Amanatides and A. Woo, A Fast
Voxel Traversal Algorithm for Ray Tracing, 1987.
"""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, clamp, corners, floor, shader, size, struct
from basrelief.techniques.edge import cell_in_map

MAX_COLUMNS = 16384
"""Upper limit of the columns that a ray passes over; a ray beyond it, at a grazing angle over many
tiles, stops there."""
MIN_TRAVEL = 1e-20
"""Lower limit of a line's travel along an axis in divisions, in texels."""
INSET = 1.0 / 64.0
"""Texels: a hit on a side is moved this far into its column, so that rounding never assigns it to
the neighbour, and it has the column's colour."""


@struct
class GridLine:
    """A line over the texel grid, in texels from the corner of its `first` column.

    It runs from `start` at t = 0 to `start + travel` at t = 1. `step` is its direction along each
    axis, −1 or 1, `pace` the signed t that one texel along each axis takes.
    """

    first: IVec2
    start: Vec2
    travel: Vec2
    step: IVec2
    pace: Vec2


@shader
def grid_line(extent: IVec2, uv: Vec2, travel: Vec2) -> GridLine:
    """The line from texture coordinates over a map of `extent` texels."""
    texels = Vec2(float(extent.x), float(extent.y))
    start = uv * texels
    texel_travel = travel * texels
    left = floor(start.x)
    top = floor(start.y)
    divisor = Vec2(
        texel_travel.x if abs(texel_travel.x) > MIN_TRAVEL else MIN_TRAVEL,
        texel_travel.y if abs(texel_travel.y) > MIN_TRAVEL else MIN_TRAVEL,
    )
    return GridLine(
        first=IVec2(int(left), int(top)),
        start=Vec2(start.x - left, start.y - top),
        travel=texel_travel,
        step=IVec2(-1 if divisor.x < 0.0 else 1, -1 if divisor.y < 0.0 else 1),
        pace=1.0 / divisor,
    )


@shader
def t_exits(line: GridLine, column: IVec2) -> Vec2:
    """The t at which the line crosses the far sides of a column, along u and along v."""
    x = column.x - line.first.x + (1 if line.step.x > 0 else 0)
    y = column.y - line.first.y + (1 if line.step.y > 0 else 0)
    return (Vec2(float(x), float(y)) - line.start) * line.pace


@shader
def next_column(line: GridLine, column: IVec2, exits: Vec2) -> IVec2:
    """The column behind the side that is crossed first."""
    along_u = exits.x <= exits.y
    return IVec2(
        column.x + (line.step.x if along_u else 0), column.y + (0 if along_u else line.step.y)
    )


@shader
def position_in_column(line: GridLine, column: IVec2, t: float) -> Vec2:
    """The line's position in a column at t, 0 to 1 from corner to corner, at least INSET within."""
    corner = Vec2(float(column.x - line.first.x), float(column.y - line.first.y))
    return clamp(line.start + line.travel * t - corner, INSET, 1.0 - INSET)


@shader
def column_top(field: HeightField, extent: IVec2, column: IVec2) -> float:
    """The height of a column: that of its texel, as stored."""
    texel = IVec2(cell_in_map(field, column.x, extent.x), cell_in_map(field, column.y, extent.y))
    return corners(field, texel, 0).x


@shader
def column_top_at(field: HeightField, uv: Vec2) -> float:
    """The height of the column at texture coordinates."""
    extent = size(field, 0)
    x = int(floor(uv.x * float(extent.x)))
    y = int(floor(uv.y * float(extent.y)))
    return column_top(field, extent, IVec2(x, y))


@shader
def side_normal(field: HeightField, uv: Vec2, height: float, travel: Vec2) -> Vec2:
    """The outward normal along u and v of the side that a ray hits: ±1 along one axis, or (0, 0) on
    a column's top.

    The ray hits at texture coordinates `uv` at a height, and moves along `travel`.
    """
    extent = size(field, 0)
    texels = Vec2(float(extent.x), float(extent.y))
    position = uv * texels
    texel_travel = travel * texels
    left = floor(position.x)
    top = floor(position.y)
    column = IVec2(int(left), int(top))
    if height >= column_top(field, extent, column):
        return Vec2(0.0)
    step = IVec2(-1 if texel_travel.x < 0.0 else 1, -1 if texel_travel.y < 0.0 else 1)
    x = position.x - left if step.x > 0 else 1.0 - position.x + left
    y = position.y - top if step.y > 0 else 1.0 - position.y + top
    # of the two sides through which the ray may have entered, the nearer
    along_u = max(x - INSET, 0.0) * abs(texel_travel.y) < max(y - INSET, 0.0) * abs(texel_travel.x)
    before = IVec2(column.x - (step.x if along_u else 0), column.y - (0 if along_u else step.y))
    # at a vertical edge both are near: a side behind a column as high is not visible
    if column_top(field, extent, before) > height:
        along_u = not along_u
    return Vec2(float(-step.x) if along_u else 0.0, 0.0 if along_u else float(-step.y))
