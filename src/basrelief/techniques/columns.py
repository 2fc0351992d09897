"""Heights as boxes, one for each texel: the field of pixel art, with no interpolation.

Another field than the bilinear surface (CONVENTIONS.md): walls stand where texels meet. A line is
followed from box to box by whole steps along one axis at a time, each wall's place computed anew
from its count, so that nothing adds up. J. Amanatides and A. Woo, A Fast Voxel Traversal Algorithm
for Ray Tracing, 1987.
"""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, clamp, corners, floor, shader, size, struct
from basrelief.techniques.edge import cell_in_map

MAX_COLUMNS = 16384
"""A ray that passes over more boxes, at a grazing angle over many tiles, stays where it is."""
FLATTEST = 1e-20
"""The least way, in texels, that is divided by."""
INSET = 1.0 / 64.0
"""How far within a box, in texels, a place on its side is put, so that it is known for the box's
own whatever is rounded, and has its colour."""


@struct
class Line:
    """A line over the boxes, in texels from the corner of its first box, `cell`.

    It is at `start` at 0 and at `start + way` at 1. `sign` is its way in whole boxes, `pace` the
    share of it that one texel along each axis takes.
    """

    cell: IVec2
    start: Vec2
    way: Vec2
    sign: IVec2
    pace: Vec2


@shader
def line_over(extent: IVec2, uv: Vec2, move: Vec2) -> Line:
    """The line from texture coordinates by a move, over a map of some size."""
    texels = Vec2(float(extent.x), float(extent.y))
    start = uv * texels
    way = move * texels
    left = floor(start.x)
    top = floor(start.y)
    held = Vec2(
        way.x if abs(way.x) > FLATTEST else FLATTEST, way.y if abs(way.y) > FLATTEST else FLATTEST
    )
    return Line(
        cell=IVec2(int(left), int(top)),
        start=Vec2(start.x - left, start.y - top),
        way=way,
        sign=IVec2(-1 if held.x < 0.0 else 1, -1 if held.y < 0.0 else 1),
        pace=1.0 / held,
    )


@shader
def leaving(line: Line, cell: IVec2) -> Vec2:
    """When the line crosses the far walls of a box, along u and along v."""
    x = cell.x - line.cell.x + (1 if line.sign.x > 0 else 0)
    y = cell.y - line.cell.y + (1 if line.sign.y > 0 else 0)
    return (Vec2(float(x), float(y)) - line.start) * line.pace


@shader
def next_column(line: Line, cell: IVec2, leave: Vec2) -> IVec2:
    """The box behind the wall that is crossed first."""
    along_u = leave.x <= leave.y
    return IVec2(cell.x + (line.sign.x if along_u else 0), cell.y + (0 if along_u else line.sign.y))


@shader
def within_box(line: Line, cell: IVec2, t: float) -> Vec2:
    """Where the line is in a box at t, 0 to 1 from corner to corner, held a little within it."""
    corner = Vec2(float(cell.x - line.cell.x), float(cell.y - line.cell.y))
    return clamp(line.start + line.way * t - corner, INSET, 1.0 - INSET)


@shader
def top_of(field: HeightField, extent: IVec2, cell: IVec2) -> float:
    """The height of a box: its texel's, as it is stored."""
    held = IVec2(cell_in_map(field, cell.x, extent.x), cell_in_map(field, cell.y, extent.y))
    return corners(field, held, 0).x


@shader
def top_at(field: HeightField, uv: Vec2) -> float:
    """The height of the box at texture coordinates."""
    extent = size(field, 0)
    x = int(floor(uv.x * float(extent.x)))
    y = int(floor(uv.y * float(extent.y)))
    return top_of(field, extent, IVec2(x, y))


@shader
def side_at(field: HeightField, uv: Vec2, height: float, way: Vec2) -> Vec2:
    """Which way the side that a ray met faces along u and v: ±1 along one of them, or 0 and 0 on a
    box's top. The ray ended at texture coordinates at a height, and runs `way` there."""
    extent = size(field, 0)
    texels = Vec2(float(extent.x), float(extent.y))
    place = uv * texels
    run = way * texels
    left = floor(place.x)
    up = floor(place.y)
    cell = IVec2(int(left), int(up))
    if height >= top_of(field, extent, cell):
        return Vec2(0.0)
    step = IVec2(-1 if run.x < 0.0 else 1, -1 if run.y < 0.0 else 1)
    x = place.x - left if step.x > 0 else 1.0 - place.x + left
    y = place.y - up if step.y > 0 else 1.0 - place.y + up
    # the nearer of the two walls that it may have come in by
    along_u = max(x - INSET, 0.0) * abs(run.y) < max(y - INSET, 0.0) * abs(run.x)
    before = IVec2(cell.x - (step.x if along_u else 0), cell.y - (0 if along_u else step.y))
    # at an edge both are near: no side is seen where a box as high stands before it
    if top_of(field, extent, before) > height:
        along_u = not along_u
    return Vec2(float(-step.x) if along_u else 0.0, 0.0 if along_u else float(-step.y))
