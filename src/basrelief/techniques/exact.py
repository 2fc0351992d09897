"""The exact technique: the first hit on the bilinear surface, guaranteed.

No step is a guess. At each cell that the ray comes to, records that are baked beside the heights
prove how far the ray may go on unhindered; a cell that they do not clear is solved, as the
quadratic that a bilinear patch is along a line. `basrelief.baking.exact` makes the records.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Map,
    Texture,
    Vec2,
    clamp,
    dot,
    floor,
    maximum,
    shader,
    sqrt,
    stored,
    struct,
)
from basrelief.techniques.edge import cell_is_baked, cells_in_map
from basrelief.techniques.exact_bake import BOUNDS
from basrelief.techniques.exact_records import (
    BLOCK,
    FAR,
    FAR_2,
    FAR_3,
    FAR_4,
    FAR_BLOCK,
    FAR_SHIFT,
    HIGHEST,
    LOWEST,
    PLANE,
    SHIFT,
    STEEPEST,
    WINDOW,
    far_blocks,
    first_row,
    near_blocks,
)
from basrelief.techniques.height import extent_of, level_under, patch_of
from basrelief.techniques.ray import (
    SLOWEST,
    Hit,
    Ray,
    fall_at,
    fastest_fall,
    height_at,
    hit_at,
    lost_at,
)
from basrelief.techniques.technique import Nothing, technique

MOST_STEPS = 16384
"""A ray that takes more, at a grazing angle over many tiles, stays where it is."""
FLATTEST = 1e-20
"""The least way, in texels, that is divided by."""
BLUR = 2.5e-7
"""How far float32 may misplace a ray, as a share of its way."""
UNIT = 1.0 / 65535.0


@struct
class Line:
    """A ray in texels, mirrored so that it never runs back, from the corner of its first cell.

    The `ray` begins at `start` and ends at `start + way`; `pace` is the share of it that one texel
    along each axis takes, `brisk` the less of both. Of the map's level `level` its first cell is
    `first`, and the next along each axis lies `sign` away. `near` and `far` are where the records
    for the way it goes begin, `doubt` the height that its plane may be off by.
    """

    ray: Ray
    start: Vec2
    way: Vec2
    pace: Vec2
    brisk: float
    doubt: float
    first: Vec2
    sign: Vec2
    level: int
    near: IVec2
    far: IVec2


@struct
class Clearance:
    """The height of a line above a patch: c + b s + a s², s after where it comes in, to `span`."""

    a: float
    b: float
    c: float
    span: float


@struct
class Walk:
    """How far a ray has come: the cell, the share of its way, what it met there, what it read."""

    cell: Vec2
    t: float
    found: bool
    above: Clearance
    reads: int


@technique(bake=BOUNDS, most_reads=24)
def exact(field: HeightField, baked: Texture, ray: Ray, settings: Nothing) -> Hit:
    """Go on as far as bounds prove that nothing is in the way, and solve the cells that are left.

    No feature is missed, whatever the angle, on a way of up to 16,384 steps; with heights "mip"
    none of the level that the pixel sees. Cost: two records for each step, and a read for each cell
    that is solved. After P. Tevs, I. Ihrke and H.-P. Seidel, Maximum Mipmaps for Fast, Accurate,
    and Scalable Dynamic Height Field Rendering, 2008, with overlapping windows and planes in place
    of their pyramid.
    """
    level = level_under(field, ray)
    extent = extent_of(field, level)
    line = line_of(ray, extent, level, first_row(field, level))
    walk = Walk(Vec2(0.0, 0.0), 0.0, False, Clearance(0.0, 0.0, 0.0, 0.0), 0)
    k = 0
    while k < MOST_STEPS // 2 and goes_on(walk):
        walk = step(field, baked, line, extent, walk)
        # two steps a turn: a loop costs a GPU more than what is in it
        if goes_on(walk):
            walk = step(field, baked, line, extent, walk)
        k = k + 1
    t = walk.t + first_root(walk.above) if walk.found else min(walk.t, 1.0)
    return hit_at(ray, t, walk.found, walk.reads)


@shader
def goes_on(walk: Walk) -> bool:
    """Whether the ray has neither met anything nor come to its end."""
    return not walk.found and walk.t < 1.0


@shader
def step(field: HeightField, baked: Texture, line: Line, extent: Vec2, walk: Walk) -> Walk:
    """From a cell as far as nothing is in the way, or to what is."""
    walls = walls_of(line, walk.cell)
    out = min(max(min(walls.x, walls.y), walk.t), 1.0)
    t = free_until(baked, line, walk.cell, extent, walk.t, out)
    reads = walk.reads + 2
    above = walk.above
    found = False
    if t < out:
        above = clearance(field, line, walk.cell, extent, walk.t, out)
        found = is_met(above)
        reads = reads + 1
        t = walk.t if found else out
    return Walk(cell_after(line, walk.cell, walls, t), t, found, above, reads)


# --- the ray among the cells ----------------------------------------------------------------------


@shader
def line_of(ray: Ray, extent: Vec2, level: int, row: int) -> Line:
    """The ray in texels of a level whose records begin at a row of the table."""
    start = ray.uv * extent - 0.5
    signed = ray.travel * extent
    back_u = signed.x < 0.0
    back_v = signed.y < 0.0
    sign = Vec2(-1.0 if back_u else 1.0, -1.0 if back_v else 1.0)
    first = floor(start)
    way = signed * sign
    pace = 1.0 / maximum(way, FLATTEST)
    near = near_blocks(extent)
    far = far_blocks(extent)
    return Line(
        ray=ray,
        start=0.5 + (start - first - 0.5) * sign,
        way=way,
        pace=pace,
        brisk=min(pace.x, pace.y),
        doubt=max(way.x, way.y) * (BLUR * STEEPEST),
        first=first,
        sign=sign,
        level=level,
        near=IVec2(near.x if back_u else 0, row + (near.y if back_v else 0)),
        far=IVec2(far.x if back_u else 0, row + near.y * 2 + (far.y if back_v else 0)),
    )


@shader
def cell_of_map(map: Map, line: Line, cell: Vec2, extent: Vec2) -> Vec2:
    """A cell of the line's as the map has it."""
    return cells_in_map(map, line.first + line.sign * cell, extent)


@shader
def walls_of(line: Line, cell: Vec2) -> Vec2:
    """When the line crosses the two walls that lead out of a cell."""
    return (cell + 1.0 - line.start) * line.pace


@shader
def cell_after(line: Line, cell: Vec2, walls: Vec2, t: float) -> Vec2:
    """The cell that the line is in at t, having left one."""
    # the one beside at least: rounding never takes the ray back
    beside = cell + (Vec2(1.0, 0.0) if walls.x <= walls.y else Vec2(0.0, 1.0))
    return maximum(beside, floor(line.start + line.way * t))


# --- how far nothing is in the way ----------------------------------------------------------------


@shader
def free_until(baked: Texture, line: Line, cell: Vec2, extent: Vec2, t: float, out: float) -> float:
    """How far along the line is proven free, seen from a cell from t until it leaves it."""
    held = cell_of_map(baked, line, cell, extent)
    x = max(int(held.x), 0)
    y = max(int(held.y), 0)
    near = stored(baked, line.near + IVec2(x >> SHIFT, y >> SHIFT))
    far = stored(baked, line.far + IVec2(x >> FAR_SHIFT, y >> FAR_SHIFT)) * UNIT
    # how far below the top the ray is here, and how soon it may be as low as a record
    room = 1.0 - line.ray.height + lost_at(line.ray, t)
    fall = fastest_fall(line.ray, t)
    pace = 1.0 / max(fall, SLOWEST)
    past = out - t
    free = min((near.w * UNIT - room) * pace, past + line.brisk * float(WINDOW - BLOCK))
    free = max(free, min((far.x - room) * pace, past + line.brisk * float((FAR - 1) * FAR_BLOCK)))
    free = max(free, min((far.y - room) * pace, past + line.brisk * float((FAR_2 - 1) * FAR_BLOCK)))
    free = max(free, min((far.z - room) * pace, past + line.brisk * float((FAR_3 - 1) * FAR_BLOCK)))
    free = max(free, min((far.w - room) * pace, past + line.brisk * float((FAR_4 - 1) * FAR_BLOCK)))
    if cell_is_baked(baked, held, extent):
        slope = near.yz * (2.0 * STEEPEST * UNIT) - STEEPEST
        deepest = LOWEST + near.x * ((HIGHEST - LOWEST) * UNIT) - line.doubt
        # which cell of its block the ray is in, from the block's back
        deep = 0.5 + line.sign * (Vec2(float(x & (BLOCK - 1)), float(y & (BLOCK - 1))) - 0.5)
        place = line.start + line.way * t - cell + deep
        gain = (deepest - room - dot(slope, place)) / max(fall + dot(slope, line.way), SLOWEST)
        free = max(free, min(gain, past + line.brisk * float(PLANE - BLOCK)))
    return t + free


# --- one cell, solved -----------------------------------------------------------------------------


@shader
def clearance(
    field: HeightField, line: Line, cell: Vec2, extent: Vec2, t: float, out: float
) -> Clearance:
    """The line above a cell's patch, from t until it leaves the cell."""
    ray = line.ray
    held = cell_of_map(field, line, cell, extent)
    four = patch_of(field, IVec2(int(held.x), int(held.y)), line.level)
    place = 0.5 + line.sign * (line.start + line.way * t - cell - 0.5)
    way = line.sign * line.way
    right = four.y - four.x
    down = four.z - four.x
    twist = four.w - four.y - down
    return Clearance(
        a=ray.bend - twist * way.x * way.y,
        b=-fall_at(ray, t) - way.x * (right + twist * place.y) - way.y * (down + twist * place.x),
        c=height_at(ray, t) - four.x - right * place.x - place.y * (down + twist * place.x),
        span=out - t,
    )


@shader
def clearance_after(line: Clearance, s: float) -> float:
    """How far above the patch the line is after s more."""
    return line.c + s * (line.b + s * line.a)


@shader
def is_met(line: Clearance) -> bool:
    """Whether the line comes down to the patch: at the end, or in between, to rise above again."""
    below = line.c <= 0.0 or clearance_after(line, line.span) <= 0.0
    turns = line.a > 0.0 and line.b < 0.0 and -line.b < 2.0 * line.a * line.span
    return below or (turns and line.b * line.b >= 4.0 * line.a * line.c)


@shader
def first_root(line: Clearance) -> float:
    """Where a line that meets the patch does so first."""
    half = 0.5 * (abs(line.b) + sqrt(max(line.b * line.b - 4.0 * line.a * line.c, 0.0)))
    # where the clearance grows at first, the root is that of the falling branch
    root = line.c / max(half, 1e-30) if line.b < 0.0 else half / max(-line.a, 1e-30)
    return 0.0 if line.c <= 0.0 else clamp(root, 0.0, line.span)
