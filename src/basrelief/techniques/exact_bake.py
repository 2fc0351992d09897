"""The records that the technique `exact` goes by, each worked out by one invocation.

First the highest point of each block of cells, a margin around the map included, so that no later
step has to know what lies beyond an edge; then windows of blocks, each from smaller ones that
overlap; then the records, for each of the four quadrants that a ray can run towards. Everything is
rounded to the safe side: up, and so room down.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Vec2,
    Vec4,
    clamp,
    corners,
    floor,
    shader,
    size,
    struct,
)
from basrelief.techniques.bake import Bake
from basrelief.techniques.edge import cells_in_map
from basrelief.techniques.exact_records import (
    BLOCK,
    FAR,
    FAR_2,
    FAR_3,
    FAR_4,
    FAR_BLOCK,
    HIGHEST,
    LOWEST,
    PLANE,
    STEEPEST,
    WINDOW,
    far_blocks,
    near_blocks,
)
from basrelief.techniques.height import extent_of

MOST = 65535.0
HEIGHT_SLACK = 1e-6
"""Heights that float32 may lose on the way."""
PLACE_SLACK = 0.002
"""Texels by which float32 may misplace a ray, and so what a slope makes of them."""
REACH = WINDOW // BLOCK
"""Blocks along each side of the window of a near record, and the margin that takes."""
FAR_REACH = FAR_4
"""The same for the widest window of a far record."""


@struct
class Blocks:
    """How blocks of a map are taken: so many cells a side, so many blocks of margin around."""

    side: int
    margin: int


@struct
class Overlap:
    """Windows that begin so many blocks apart."""

    apart: int


@struct
class Top:
    """The highest point of something."""

    height: float


@struct
class Packed:
    """Four 16-bit numbers, the first in the lower half."""

    low: int
    high: int


@shader
def block_top(at: IVec2, blocks: Blocks, field: HeightField) -> Top:
    """The highest point of one block of cells."""
    first = (at - blocks.margin) * blocks.side
    top = 0.0
    for j in range(blocks.side):
        for i in range(blocks.side):
            top = max(top, highest(patch(field, first + IVec2(i, j))))
    return Top(top)


@shader
def window_top(at: IVec2, overlap: Overlap, field: HeightField) -> Top:
    """The highest point of four windows that overlap, those beside a window's own and itself."""
    k = overlap.apart
    last = size(field, 0) - 1
    beside = IVec2(min(at.x + k, last.x), min(at.y + k, last.y))
    upper = max(one(field, at), one(field, IVec2(beside.x, at.y)))
    lower = max(one(field, IVec2(at.x, beside.y)), one(field, beside))
    return Top(max(upper, lower))


@shader
def far_record(
    at: IVec2,
    field: HeightField,
    least: HeightField,
    second: HeightField,
    third: HeightField,
    most: HeightField,
) -> Packed:
    """The room above the highest points of four ever larger windows ahead of a block."""
    blocks = far_blocks(extent_of(field, 0))
    return packed(
        Vec4(
            room_code(least, ahead_of(at, blocks, FAR_BLOCK, FAR, FAR_REACH).window),
            room_code(second, ahead_of(at, blocks, FAR_BLOCK, FAR_2, FAR_REACH).window),
            room_code(third, ahead_of(at, blocks, FAR_BLOCK, FAR_3, FAR_REACH).window),
            room_code(most, ahead_of(at, blocks, FAR_BLOCK, FAR_4, FAR_REACH).window),
        )
    )


@shader
def near_record(at: IVec2, field: HeightField, windows: HeightField) -> Packed:
    """The room above a plane over the cells ahead of a block, its slopes, and the room above the
    highest point of a larger window ahead."""
    ahead = ahead_of(at, near_blocks(extent_of(field, 0)), BLOCK, REACH, REACH)
    codes = slope_codes(field, ahead)
    slope = codes * (2.0 * STEEPEST / MOST) - STEEPEST
    top = -1.0e9
    # patches two apart, and the last, have all points among their corners
    for j in range(0, PLANE, 2):
        for i in range(0, PLANE, 2):
            top = max(top, above_plane(field, ahead, slope, IVec2(i, j)))
        top = max(top, above_plane(field, ahead, slope, IVec2(PLANE - 1, j)))
        top = max(top, above_plane(field, ahead, slope, IVec2(j, PLANE - 1)))
    top = max(top, above_plane(field, ahead, slope, IVec2(PLANE - 1, PLANE - 1)))
    top = top + HEIGHT_SLACK + PLACE_SLACK * (abs(slope.x) + abs(slope.y))
    room = floor((1.0 - top - LOWEST) * (MOST / (HIGHEST - LOWEST)))
    return packed(Vec4(clamp(room, 0.0, MOST), codes.x, codes.y, room_code(windows, ahead.window)))


# --- what lies ahead of a block -------------------------------------------------------------------


@struct
class Ahead:
    """A block seen by rays of one quadrant: the texel at its back corner, the way on from there,
    and which window begins at it, among those with a margin."""

    corner: IVec2
    sign: IVec2
    window: IVec2


@shader
def ahead_of(at: IVec2, blocks: IVec2, side: int, reach: int, margin: int) -> Ahead:
    """The block of a record; the records of the four quadrants lie beside and below one another."""
    back = IVec2(1 if at.x >= blocks.x else 0, 1 if at.y >= blocks.y else 0)
    block = at - back * blocks
    return Ahead((block + back) * side, 1 - back * 2, block + margin - back * (reach - 1))


@shader
def slope_codes(field: HeightField, ahead: Ahead) -> Vec2:
    """The slopes of the plane that fits the heights ahead best, as they are stored.

    By least squares from the four patches at the corners; its middle column and row would add
    nothing to the slope across them.
    """
    total = Vec2(0.0, 0.0)
    squares = 0.0
    middle = float(PLANE) * 0.5
    for j in range(0, PLANE, PLANE - 1):
        for i in range(0, PLANE, PLANE - 1):
            four = patch_ahead(field, ahead, IVec2(i, j))
            x = float(i) - middle
            y = float(j) - middle
            total = total + Vec2(
                x * (four.x + four.z) + (x + 1.0) * (four.y + four.w),
                y * (four.x + four.y) + (y + 1.0) * (four.z + four.w),
            )
            squares = squares + 2.0 * (x * x + (x + 1.0) * (x + 1.0))
    slope = total / squares
    return clamp(floor((slope * (0.5 / STEEPEST) + 0.5) * MOST + 0.5), 0.0, MOST)


@shader
def above_plane(field: HeightField, ahead: Ahead, slope: Vec2, cell: IVec2) -> float:
    """How far a patch ahead rises above the plane of these slopes through the block's corner."""
    four = patch_ahead(field, ahead, cell)
    start = float(cell.x) * slope.x + float(cell.y) * slope.y
    upper = max(four.x, four.y - slope.x)
    lower = max(four.z - slope.y, four.w - slope.x - slope.y)
    return max(upper, lower) - start


@shader
def patch_ahead(field: HeightField, ahead: Ahead, cell: IVec2) -> Vec4:
    """The corners of a patch ahead, the nearest first, then along u, along v, along both."""
    first = ahead.corner + ahead.sign * cell
    back_u = ahead.sign.x < 0
    back_v = ahead.sign.y < 0
    four = patch(field, IVec2(first.x - (1 if back_u else 0), first.y - (1 if back_v else 0)))
    four = four.yxwz if back_u else four
    return four.zwxy if back_v else four


# --- single reads ---------------------------------------------------------------------------------


@shader
def patch(field: HeightField, cell: IVec2) -> Vec4:
    """The four heights around any cell, beyond the edges too."""
    held = cells_in_map(field, Vec2(float(cell.x), float(cell.y)), extent_of(field, 0))
    return corners(field, IVec2(int(held.x), int(held.y)), 0)


@shader
def one(field: HeightField, cell: IVec2) -> float:
    """The height of a texel of the map."""
    return corners(field, cell, 0).x


@shader
def highest(four: Vec4) -> float:
    """The largest of four."""
    return max(max(four.x, four.y), max(four.z, four.w))


@shader
def room_code(windows: HeightField, window: IVec2) -> float:
    """The room above a window as it is stored, a little less for what float32 may lose."""
    return clamp(floor((1.0 - one(windows, window)) * MOST - 0.02), 0.0, MOST)


@shader
def packed(codes: Vec4) -> Packed:
    """Four whole numbers up to 65535 in two words."""
    return Packed(
        int(codes.x) | (int(codes.y) << 16),
        int(codes.z) | (int(codes.w) << 16),
    )


# --- the bake -------------------------------------------------------------------------------------

BOUNDS = Bake(
    "bounds",
    (block_top, window_top, near_record, far_record),
    all_levels=True,
)
