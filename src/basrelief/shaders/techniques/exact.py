"""The exact technique: the first hit on the bilinear surface, guaranteed.

No step is a guess. At each cell that the ray comes to, a record that is baked beside the heights
proves how far the ray may go on unhindered; a cell that the record does not clear is solved, as the
quadratic that a bilinear patch is along a line. `basrelief.bake.bounds` makes the records.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec2,
    clamp,
    copysign,
    corners,
    floor,
    shader,
    size,
    sqrt,
    struct,
    texel,
)
from basrelief.shaders.edge import cell_in_map, cell_is_baked
from basrelief.shaders.ray import Hit, Ray, at
from basrelief.shaders.techniques.technique import Nothing, technique

MOST_CELLS = 16384
"""A ray that comes to more cells, at a grazing angle over many tiles, stays where it is."""
BLOCK = 2
"""Cells along each side that share a record."""
WINDOW = 10
"""Cells along each side of the window ahead whose highest point a record holds."""
PLANE = 4
"""Cells along each side of the window ahead that a record's plane lies above."""
STEEPEST = 0.5
"""The steepest slope that a record can hold, in heights a texel."""
LOWEST = -4.0
HIGHEST = 4.0
"""The least and the most that a record can hold of 1 − a plane's height at its block's corner."""
FLATTEST = 1e-20
"""The least way, in texels, that is divided by."""
UNIT = 1.0 / 65535.0


@struct
class Line:
    """A ray in texels from the corner of its first cell, `cell`.

    It is at `start` at height 1 and at `start + way` at height 0. `sign` is its way in whole cells,
    `pace` the share of it that one texel along each axis takes.
    """

    cell: IVec2
    start: Vec2
    way: Vec2
    sign: IVec2
    pace: Vec2


@struct
class Record:
    """What a block of cells knows of those ahead: the room above their highest point, and a plane
    that nothing in the nearer ones rises above, as the room above it at the block's corner and its
    slopes."""

    room: float
    slope: Vec2
    window_room: float


@technique(bake="bounds", most_reads=16)
def exact(field: HeightField, baked: Texture, ray: Ray, settings: Nothing) -> Hit:
    """Go on as far as bounds prove that nothing is in the way, and solve the cells that are left.

    No feature is missed, whatever the angle, on a way of up to 16,384 records. Cost: a record for
    each step, and a read for each cell that is solved. After P. Tevs, I. Ihrke and H.-P. Seidel,
    Maximum Mipmaps for Fast, Accurate, and Scalable Dynamic Height Field Rendering, 2008, with
    overlapping windows and planes in place of their pyramid.
    """
    extent = size(field, 0)
    line = line_of(ray, extent)
    cell = line.cell
    t = 0.0
    reads = 0
    found = False
    k = 0
    while k < MOST_CELLS and not found and t < 1.0:
        leave = walls_ahead(line, cell, 1, 0)
        out = clamp(min(leave.x, leave.y), t, 1.0)
        free = free_until(baked, line, cell, extent, t)
        reads = reads + 1
        met = 2.0
        if free < out:
            met = meeting(field, line, cell, extent, t, out)
            reads = reads + 1
        found = met <= out
        t = met if found else max(free, out)
        if t > out:
            cell = furthest(cell, line.cell + cell_of(line.start + line.way * t), line.sign)
        elif leave.x <= leave.y:
            cell = IVec2(cell.x + line.sign.x, cell.y)
        else:
            cell = IVec2(cell.x, cell.y + line.sign.y)
        k = k + 1
    height = 1.0 - min(t, 1.0)
    return Hit(at(ray, height), height, found or t >= 1.0, reads)


# --- the ray among the cells ----------------------------------------------------------------------


@shader
def line_of(ray: Ray, extent: IVec2) -> Line:
    """The ray from the top of the heights to their bottom, in texels."""
    texels = Vec2(float(extent.x), float(extent.y))
    start = at(ray, 1.0) * texels - 0.5
    way = ray.fall * texels
    cell = cell_of(start)
    held = Vec2(
        copysign(max(abs(way.x), FLATTEST), way.x), copysign(max(abs(way.y), FLATTEST), way.y)
    )
    return Line(
        cell=cell,
        start=start - Vec2(float(cell.x), float(cell.y)),
        way=way,
        # of the held way: a way of −0 has a pace below 0
        sign=IVec2(-1 if held.x < 0.0 else 1, -1 if held.y < 0.0 else 1),
        pace=1.0 / held,
    )


@shader
def cell_of(place: Vec2) -> IVec2:
    """The cell that a place in texels lies in."""
    return IVec2(int(floor(place.x)), int(floor(place.y)))


@shader
def furthest(a: IVec2, b: IVec2, sign: IVec2) -> IVec2:
    """Of two cells the one further along the way: rounding never takes a ray back."""
    return IVec2(
        min(a.x, b.x) if sign.x < 0 else max(a.x, b.x),
        min(a.y, b.y) if sign.y < 0 else max(a.y, b.y),
    )


@shader
def walls_ahead(line: Line, first: IVec2, ahead: int, behind: int) -> Vec2:
    """When the line crosses the far walls of a window: `ahead` cells from a first one along u and v
    where they grow, and as many, from the `behind`th beyond it, where they shrink."""
    x = first.x - line.cell.x + (ahead if line.sign.x > 0 else behind)
    y = first.y - line.cell.y + (ahead if line.sign.y > 0 else behind)
    return (Vec2(float(x), float(y)) - line.start) * line.pace


# --- how far nothing is in the way ----------------------------------------------------------------


@shader
def free_until(baked: Texture, line: Line, cell: IVec2, extent: IVec2, t: float) -> float:
    """How far along the line is proven free, seen from a cell that it comes to at t."""
    held = IVec2(max(cell_in_map(cell.x, extent.x), 0), max(cell_in_map(cell.y, extent.y), 0))
    record = record_at(baked, held, line.sign)
    # beyond the border a window may begin at the cell itself: the heights there are the border's
    baked_u = cell_is_baked(cell.x, extent.x)
    baked_v = cell_is_baked(cell.y, extent.y)
    first = IVec2(
        cell.x - ((held.x % BLOCK) if baked_u else 0), cell.y - ((held.y % BLOCK) if baked_v else 0)
    )
    window = walls_ahead(line, first, WINDOW, BLOCK - WINDOW)
    free = min(record.window_room, min(window.x, window.y))
    if baked_u and baked_v:
        near = walls_ahead(line, first, PLANE, BLOCK - PLANE)
        corner = Vec2(float(first.x - line.cell.x), float(first.y - line.cell.y))
        place = line.start + line.way * t - corner
        room = record.room - t - record.slope.x * place.x - record.slope.y * place.y
        loss = 1.0 + record.slope.x * line.way.x + record.slope.y * line.way.y
        free = max(free, min(t + room / max(loss, 1e-9), min(near.x, near.y)))
    return min(max(free, t), 1.0)


@shader
def record_at(baked: Texture, held: IVec2, sign: IVec2) -> Record:
    """The record of the block of a cell of the map, for one of the four ways that a ray can go."""
    rows = size(baked, 0).y // 4
    quadrant = (1 if sign.x < 0 else 0) + (2 if sign.y < 0 else 0)
    place = IVec2(held.x // BLOCK, quadrant * rows + held.y // BLOCK)
    stored = texel(baked, place, 0)
    return Record(
        room=LOWEST + stored.x * ((HIGHEST - LOWEST) * UNIT),
        slope=(stored.yz * (2.0 * UNIT) - 1.0) * STEEPEST,
        window_room=stored.w * UNIT,
    )


# --- one cell, solved -----------------------------------------------------------------------------


@shader
def meeting(
    field: HeightField, line: Line, cell: IVec2, extent: IVec2, t: float, out: float
) -> float:
    """The first place from t to `out` where the line is not above the cell's patch; 2 if none."""
    held = IVec2(cell_in_map(cell.x, extent.x), cell_in_map(cell.y, extent.y))
    four = corners(field, held, 0)
    place = line.start + line.way * t
    x = place.x - float(cell.x - line.cell.x)
    y = place.y - float(cell.y - line.cell.y)
    right = four.y - four.x
    down = four.z - four.x
    twist = four.w - four.y - down
    # the clearance after s more is c + b s + a s²
    a = -twist * line.way.x * line.way.y
    b = -1.0 - line.way.x * (right + twist * y) - line.way.y * (down + twist * x)
    c = (1.0 - t) - four.x - right * x - y * (down + twist * x)
    span = out - t
    root = first_root(a, b, c, span)
    return t + root if root <= span else 2.0


@shader
def first_root(a: float, b: float, c: float, span: float) -> float:
    """The least s from 0 to `span` at which c + b s + a s² is not above 0; twice the span and 1
    where there is none."""
    if c <= 0.0:
        return 0.0
    below = c + span * (b + span * a) <= 0.0
    # or it dips below in between, and is above again at the end
    inside = b * b - 4.0 * a * c
    dips = a > 0.0 and b < 0.0 and -b < 2.0 * a * span and inside >= 0.0
    if not below and not dips:
        return 2.0 * span + 1.0
    half = 0.5 * (abs(b) + sqrt(max(inside, 0.0)))
    # where the clearance grows at first, the root is that of the falling branch
    root = c / max(half, 1e-30) if b < 0.0 else half / max(-a, 1e-30)
    return clamp(root, 0.0, span)
