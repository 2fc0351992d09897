r"""The exact technique: the first hit on the bilinear surface, guaranteed.

At each cell the ray either leaps over empty space that baked records prove, or its cell is solved.
`basrelief.baking.exact` makes the records.

**A cell, solved.** With (x, y) the position in the cell and h the heights of its corners, the
surface is the bilinear patch

    f(x, y) = h₀₀ + right · x + down · y + twist · x · y
    right = h₁₀ − h₀₀,  down = h₀₁ − h₀₀,  twist = h₁₁ − h₁₀ − h₀₁ + h₀₀

A ray enters the cell at t₀, at (x₀, y₀) and height r₀, and moves by (vx, vy) cells per t. With
s = t − t₀ its height is r₀ − descent · s + bend · s². Height − f is the clearance, a quadratic

    c + b s + a s²,   a = bend − twist · vx · vy
                      b = −descent − vx (right + twist · y₀) − vy (down + twist · x₀)
                      c = r₀ − f(x₀, y₀)

and the hit is its first root from 0 to span, the s at which the ray leaves the cell.

**Empty space ahead.** All rays are mirrored to run towards +u and +v, so that the cells ahead of a
block form a square at its corner; a block has a record for each of the four quadrants. *Headroom*
is the distance below height 1: of a ray 1 − its height, of a record 1 − the height that it bounds.

    height 1 --------------------------------   A window record: no point of the W × W cells ahead
       ray *                   ^                has less headroom than w. The ray is free until
             `.                | w              its own headroom is w, or until it may leave the
                `.             v                window, whichever comes first:
         . . . . . `. . . . . . . . . . . . .
                ___           /\                    Δt = min((w − headroom) ÷ descent, window's end)
          _____/   \_________/  \____
         |block|  W × W cells ahead  |

A plane record bounds the 4 × 4 cells ahead more tightly: their surface lies below a plane with the
headroom p at the block's corner and the slopes g along u and v. At a position q from that corner,
moving by v per t, the ray is free until

    headroom + descent · Δt = p − g · (q + v · Δt)
    Δt = (p − headroom − g · q) ÷ (descent + g · v)

The longest leap of all records counts. If it does not reach the cell's end, the cell is solved.
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
    MAX_HEADROOM,
    MAX_SLOPE,
    MIN_HEADROOM,
    PLANE,
    SHIFT,
    WINDOW,
    far_blocks,
    first_row,
    near_blocks,
)
from basrelief.techniques.height import extent_of, patch_heights, ray_level
from basrelief.techniques.ray import (
    MIN_DROP,
    Hit,
    Ray,
    descent_at,
    drop_at,
    height_at,
    hit_at,
    max_descent,
)
from basrelief.techniques.technique import Nothing, technique

MAX_STEPS = 16384
"""Upper limit of a ray's steps; a ray that needs more, at a grazing angle over many tiles, stops
there."""
MIN_TRAVEL = 1e-20
"""Lower limit of a ray's travel along an axis in divisions, in texels."""
POSITION_ERROR = 2.5e-7
"""The error of a ray's position in float32, as a fraction of its travel."""
UNIT = 1.0 / 65535.0
"""The unit of the table's 16-bit numbers."""


@struct
class MirroredRay:
    """A ray in texels from the corner of its first cell, mirrored to run towards +u and +v.

    The `ray` runs from `start` to `start + travel`. `pace` is the t that one texel along each axis
    takes, `min_pace` the smaller of both. `first` is its first cell in mip level
    `level` of the map, and the next along each axis lies `sign` away. `near` and `far` are the
    positions in the table of its quadrant's first records; `plane_error` is the height by which
    rounding may misplace a record's plane.
    """

    ray: Ray
    start: Vec2
    travel: Vec2
    pace: Vec2
    min_pace: float
    plane_error: float
    first: Vec2
    sign: Vec2
    level: int
    near: IVec2
    far: IVec2


@struct
class Clearance:
    """The height of a ray above a patch, c + b s + a s², for s from its entry (0) to `span`."""

    a: float
    b: float
    c: float
    span: float


@struct
class Traversal:
    """The state of a traversal: the cell, t, whether the surface is hit in it, the clearance there,
    and the number of reads."""

    cell: Vec2
    t: float
    found: bool
    patch: Clearance
    reads: int


@technique(bake=BOUNDS, most_reads=24, exact=True)
def exact(field: HeightField, baked: Texture, ray: Ray, settings: Nothing) -> Hit:
    """The exact first hit: leap as far as the bounds prove empty space, solve the other cells.

        t ← t + Δt, the longest leap that a record proves, or the first root of the cell's clearance

    No feature is missed at any angle, within 16,384 steps. With heights "mip" this holds for the
    surface of the ray's mip level.
    Cost: two records a step, and a read for each cell that is solved.

    References
    ----------
    P. Tevs, I. Ihrke and H.-P. Seidel, Maximum Mipmaps for Fast, Accurate, and Scalable Dynamic
    Height Field Rendering, 2008; here with overlapping windows and planes in place of the pyramid.
    """
    level = ray_level(field, ray)
    extent = extent_of(field, level)
    line = mirrored_ray(ray, extent, level, first_row(field, level))
    state = Traversal(Vec2(0.0, 0.0), 0.0, False, Clearance(0.0, 0.0, 0.0, 0.0), 0)
    k = 0
    while k < MAX_STEPS // 2 and is_active(state):
        state = step(field, baked, line, extent, state)
        # two steps per iteration: on a GPU the loop costs more than its body
        if is_active(state):
            state = step(field, baked, line, extent, state)
        k = k + 1
    t = state.t + first_root(state.patch) if state.found else min(state.t, 1.0)
    return hit_at(ray, t, state.found, state.reads)


@shader
def is_active(state: Traversal) -> bool:
    """Whether the ray has neither hit the surface nor reached its end."""
    return not state.found and state.t < 1.0


@shader
def step(
    field: HeightField, baked: Texture, line: MirroredRay, extent: Vec2, state: Traversal
) -> Traversal:
    """Advance from a cell over proven empty space, or solve the cell."""
    exits = cell_exits(line, state.cell)
    t_exit = min(max(min(exits.x, exits.y), state.t), 1.0)
    t = clear_until(baked, line, state.cell, extent, state.t, t_exit)
    reads = state.reads + 2
    patch = state.patch
    found = False
    if t < t_exit:
        patch = clearance(field, line, state.cell, extent, state.t, t_exit)
        found = hits_patch(patch)
        reads = reads + 1
        t = state.t if found else t_exit
    return Traversal(next_cell(line, state.cell, exits, t), t, found, patch, reads)


# --- the ray among the cells ----------------------------------------------------------------------


@shader
def mirrored_ray(ray: Ray, extent: Vec2, level: int, row: int) -> MirroredRay:
    """The ray in texels of a mip level, whose records begin at a `row` of the table."""
    start = ray.uv * extent - 0.5
    signed = ray.travel * extent
    back_u = signed.x < 0.0
    back_v = signed.y < 0.0
    sign = Vec2(-1.0 if back_u else 1.0, -1.0 if back_v else 1.0)
    first = floor(start)
    travel = signed * sign
    pace = 1.0 / maximum(travel, MIN_TRAVEL)
    near = near_blocks(extent)
    far = far_blocks(extent)
    return MirroredRay(
        ray=ray,
        start=0.5 + (start - first - 0.5) * sign,
        travel=travel,
        pace=pace,
        min_pace=min(pace.x, pace.y),
        plane_error=max(travel.x, travel.y) * (POSITION_ERROR * MAX_SLOPE),
        first=first,
        sign=sign,
        level=level,
        near=IVec2(near.x if back_u else 0, row + (near.y if back_v else 0)),
        far=IVec2(far.x if back_u else 0, row + near.y * 2 + (far.y if back_v else 0)),
    )


@shader
def cell_of_map(map: Map, line: MirroredRay, cell: Vec2, extent: Vec2) -> Vec2:
    """The map's cell for a cell of the mirrored ray."""
    return cells_in_map(map, line.first + line.sign * cell, extent)


@shader
def cell_exits(line: MirroredRay, cell: Vec2) -> Vec2:
    """The t at which the ray crosses the far sides of a cell, along u and along v."""
    return (cell + 1.0 - line.start) * line.pace


@shader
def next_cell(line: MirroredRay, cell: Vec2, exits: Vec2, t: float) -> Vec2:
    """The cell of the ray at t, after it has left a cell."""
    # at least the neighbour: rounding never moves the ray back
    neighbour = cell + (Vec2(1.0, 0.0) if exits.x <= exits.y else Vec2(0.0, 1.0))
    return maximum(neighbour, floor(line.start + line.travel * t))


# --- empty space ahead ----------------------------------------------------------------------------


@shader
def clear_until(
    baked: Texture, line: MirroredRay, cell: Vec2, extent: Vec2, t: float, t_exit: float
) -> float:
    """The t up to which the records of a cell prove empty space, for a ray in the cell from t to
    t_exit."""
    in_map = cell_of_map(baked, line, cell, extent)
    x = max(int(in_map.x), 0)
    y = max(int(in_map.y), 0)
    near = stored(baked, line.near + IVec2(x >> SHIFT, y >> SHIFT))
    far = stored(baked, line.far + IVec2(x >> FAR_SHIFT, y >> FAR_SHIFT)) * UNIT
    # the ray's headroom here, and the least t in which it reaches the headroom of a record
    headroom = 1.0 - line.ray.height + drop_at(line.ray, t)
    descent = max_descent(line.ray, t)
    t_per_height = 1.0 / max(descent, MIN_DROP)
    rest = t_exit - t
    free = min(
        (near.w * UNIT - headroom) * t_per_height, rest + line.min_pace * float(WINDOW - BLOCK)
    )
    free = max(
        free,
        min((far.x - headroom) * t_per_height, rest + line.min_pace * float((FAR - 1) * FAR_BLOCK)),
    )
    free = max(
        free,
        min(
            (far.y - headroom) * t_per_height,
            rest + line.min_pace * float((FAR_2 - 1) * FAR_BLOCK),
        ),
    )
    free = max(
        free,
        min(
            (far.z - headroom) * t_per_height,
            rest + line.min_pace * float((FAR_3 - 1) * FAR_BLOCK),
        ),
    )
    free = max(
        free,
        min(
            (far.w - headroom) * t_per_height,
            rest + line.min_pace * float((FAR_4 - 1) * FAR_BLOCK),
        ),
    )
    if cell_is_baked(baked, in_map, extent):
        slope = near.yz * (2.0 * MAX_SLOPE * UNIT) - MAX_SLOPE
        plane_headroom = (
            MIN_HEADROOM + near.x * ((MAX_HEADROOM - MIN_HEADROOM) * UNIT) - line.plane_error
        )
        # the ray's cell within its block, counted from the block's back corner
        in_block = 0.5 + line.sign * (Vec2(float(x & (BLOCK - 1)), float(y & (BLOCK - 1))) - 0.5)
        position = line.start + line.travel * t - cell + in_block
        to_plane = (plane_headroom - headroom - dot(slope, position)) / max(
            descent + dot(slope, line.travel), MIN_DROP
        )
        free = max(free, min(to_plane, rest + line.min_pace * float(PLANE - BLOCK)))
    return t + free


# --- one cell, solved -----------------------------------------------------------------------------


@shader
def clearance(
    field: HeightField, line: MirroredRay, cell: Vec2, extent: Vec2, t: float, t_exit: float
) -> Clearance:
    """The clearance of the ray above a cell's patch, from t to t_exit."""
    ray = line.ray
    in_map = cell_of_map(field, line, cell, extent)
    four = patch_heights(field, IVec2(int(in_map.x), int(in_map.y)), line.level)
    position = 0.5 + line.sign * (line.start + line.travel * t - cell - 0.5)
    v = line.sign * line.travel
    right = four.y - four.x
    down = four.z - four.x
    twist = four.w - four.y - down
    return Clearance(
        a=ray.bend - twist * v.x * v.y,
        b=-descent_at(ray, t)
        - v.x * (right + twist * position.y)
        - v.y * (down + twist * position.x),
        c=height_at(ray, t)
        - four.x
        - right * position.x
        - position.y * (down + twist * position.x),
        span=t_exit - t,
    )


@shader
def clearance_at(patch: Clearance, s: float) -> float:
    """The clearance at s."""
    return patch.c + s * (patch.b + s * patch.a)


@shader
def hits_patch(patch: Clearance) -> bool:
    """Whether the clearance reaches 0: at either end, or at a minimum in between."""
    below = patch.c <= 0.0 or clearance_at(patch, patch.span) <= 0.0
    turns = patch.a > 0.0 and patch.b < 0.0 and -patch.b < 2.0 * patch.a * patch.span
    return below or (turns and patch.b * patch.b >= 4.0 * patch.a * patch.c)


@shader
def first_root(patch: Clearance) -> float:
    """The first root of a clearance that reaches 0."""
    half = 0.5 * (abs(patch.b) + sqrt(max(patch.b * patch.b - 4.0 * patch.a * patch.c, 0.0)))
    # of the two forms of the root, the one that does not cancel; b ≥ 0 means that it rises first
    root = patch.c / max(half, 1e-30) if patch.b < 0.0 else half / max(-patch.a, 1e-30)
    return 0.0 if patch.c <= 0.0 else clamp(root, 0.0, patch.span)
