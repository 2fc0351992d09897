"""The bake of the technique `exact`: the records of empty space, one per shader invocation.

A patch is the bilinear surface over one cell. Headroom is the space above a height h: 1 − h.

Three passes: the highest point of each block of cells, with a margin around the map, so that later
passes do not depend on the edge; the highest points of windows of blocks, each from smaller windows
that overlap; and the records, for the four quadrants that a ray can run towards. All heights are
rounded up, and so all headroom down.
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
    MAX_HEADROOM,
    MAX_SLOPE,
    MIN_HEADROOM,
    PLANE,
    WINDOW,
    far_blocks,
    near_blocks,
)
from basrelief.techniques.height import extent_of

MAX_CODE = 65535.0
"""The largest 16-bit code."""
HEIGHT_ERROR = 1e-6
"""Bound on the float32 error of a height along a ray."""
POSITION_ERROR_TEXELS = 0.002
"""Bound on the float32 error of a ray's position; times the slope, it is an error of the height."""
REACH = WINDOW // BLOCK
"""Blocks along each side of a near record's window, and the margin that it needs."""
FAR_REACH = FAR_4
"""The same for the widest window of a far record, in blocks of far records."""


@struct
class Blocks:
    """The blocks of a map: `side` cells along each side, and `margin` blocks around the map."""

    side: int
    margin: int


@struct
class Overlap:
    """Overlapping windows that begin `spacing` blocks apart."""

    spacing: int


@struct
class MaxHeight:
    """The highest point of a block or window."""

    height: float


@struct
class PackedRecord:
    """Four 16-bit numbers in two words, the first in the lower half of `low`."""

    low: int
    high: int


@shader
def block_top(at: IVec2, blocks: Blocks, field: HeightField) -> MaxHeight:
    """The highest point of a block of cells."""
    first = (at - blocks.margin) * blocks.side
    top = 0.0
    for j in range(blocks.side):
        for i in range(blocks.side):
            top = max(top, highest(patch(field, first + IVec2(i, j))))
    return MaxHeight(top)


@shader
def window_top(at: IVec2, overlap: Overlap, field: HeightField) -> MaxHeight:
    """The highest point of a window, from four smaller windows that overlap and cover it."""
    k = overlap.spacing
    last = size(field, 0) - 1
    other = IVec2(min(at.x + k, last.x), min(at.y + k, last.y))
    upper = max(texel_height(field, at), texel_height(field, IVec2(other.x, at.y)))
    lower = max(texel_height(field, IVec2(at.x, other.y)), texel_height(field, other))
    return MaxHeight(max(upper, lower))


@shader
def far_record(
    at: IVec2,
    field: HeightField,
    least: HeightField,
    second: HeightField,
    third: HeightField,
    most: HeightField,
) -> PackedRecord:
    """The headroom above the highest points of four windows ahead of a block, smallest first."""
    blocks = far_blocks(extent_of(field, 0))
    return packed(
        Vec4(
            headroom_code(least, quadrant_block(at, blocks, FAR_BLOCK, FAR, FAR_REACH).window),
            headroom_code(second, quadrant_block(at, blocks, FAR_BLOCK, FAR_2, FAR_REACH).window),
            headroom_code(third, quadrant_block(at, blocks, FAR_BLOCK, FAR_3, FAR_REACH).window),
            headroom_code(most, quadrant_block(at, blocks, FAR_BLOCK, FAR_4, FAR_REACH).window),
        )
    )


@shader
def near_record(at: IVec2, field: HeightField, windows: HeightField) -> PackedRecord:
    """The headroom above a plane over the cells ahead of a block, the plane's slopes, and the
    headroom above the highest point of a larger window ahead."""
    block = quadrant_block(at, near_blocks(extent_of(field, 0)), BLOCK, REACH, REACH)
    codes = slope_codes(field, block)
    slope = codes * (2.0 * MAX_SLOPE / MAX_CODE) - MAX_SLOPE
    top = -1.0e9
    # every second patch, and the last ones, have all points among their corners
    for j in range(0, PLANE, 2):
        for i in range(0, PLANE, 2):
            top = max(top, height_above_plane(field, block, slope, IVec2(i, j)))
        top = max(top, height_above_plane(field, block, slope, IVec2(PLANE - 1, j)))
        top = max(top, height_above_plane(field, block, slope, IVec2(j, PLANE - 1)))
    top = max(top, height_above_plane(field, block, slope, IVec2(PLANE - 1, PLANE - 1)))
    top = top + HEIGHT_ERROR + POSITION_ERROR_TEXELS * (abs(slope.x) + abs(slope.y))
    headroom = floor((1.0 - top - MIN_HEADROOM) * (MAX_CODE / (MAX_HEADROOM - MIN_HEADROOM)))
    return packed(
        Vec4(clamp(headroom, 0.0, MAX_CODE), codes.x, codes.y, headroom_code(windows, block.window))
    )


# --- the cells ahead of a block -------------------------------------------------------------------


@struct
class QuadrantBlock:
    """A block for rays of one quadrant: the texel at the `corner` where rays enter, the `sign` of
    their direction along each axis, and the index of the `window` ahead, margin included."""

    corner: IVec2
    sign: IVec2
    window: IVec2


@shader
def quadrant_block(at: IVec2, blocks: IVec2, side: int, reach: int, margin: int) -> QuadrantBlock:
    """The block and quadrant of a record; the quadrants lie side by side and below each other in
    the table."""
    back = IVec2(1 if at.x >= blocks.x else 0, 1 if at.y >= blocks.y else 0)
    block = at - back * blocks
    return QuadrantBlock((block + back) * side, 1 - back * 2, block + margin - back * (reach - 1))


@shader
def slope_codes(field: HeightField, block: QuadrantBlock) -> Vec2:
    """The slopes of the plane that fits the heights ahead best, as stored codes.

    Least squares over the four corner patches of the window; its middle rows and columns have
    little weight.
    """
    total = Vec2(0.0, 0.0)
    squares = 0.0
    middle = float(PLANE) * 0.5
    for j in range(0, PLANE, PLANE - 1):
        for i in range(0, PLANE, PLANE - 1):
            four = patch_ahead(field, block, IVec2(i, j))
            x = float(i) - middle
            y = float(j) - middle
            total = total + Vec2(
                x * (four.x + four.z) + (x + 1.0) * (four.y + four.w),
                y * (four.x + four.y) + (y + 1.0) * (four.z + four.w),
            )
            squares = squares + 2.0 * (x * x + (x + 1.0) * (x + 1.0))
    slope = total / squares
    return clamp(floor((slope * (0.5 / MAX_SLOPE) + 0.5) * MAX_CODE + 0.5), 0.0, MAX_CODE)


@shader
def height_above_plane(field: HeightField, block: QuadrantBlock, slope: Vec2, cell: IVec2) -> float:
    """The largest height of a patch ahead above the plane with these slopes through height 0 at the
    block's corner."""
    four = patch_ahead(field, block, cell)
    start = float(cell.x) * slope.x + float(cell.y) * slope.y
    upper = max(four.x, four.y - slope.x)
    lower = max(four.z - slope.y, four.w - slope.x - slope.y)
    return max(upper, lower) - start


@shader
def patch_ahead(field: HeightField, block: QuadrantBlock, cell: IVec2) -> Vec4:
    """The corner heights of a patch ahead: the nearest, then along u, along v, along both."""
    first = block.corner + block.sign * cell
    back_u = block.sign.x < 0
    back_v = block.sign.y < 0
    four = patch(field, IVec2(first.x - (1 if back_u else 0), first.y - (1 if back_v else 0)))
    four = four.yxwz if back_u else four
    return four.zwxy if back_v else four


# --- single reads ---------------------------------------------------------------------------------


@shader
def patch(field: HeightField, cell: IVec2) -> Vec4:
    """The corner heights of any cell, inside the map or beyond its edge."""
    in_map = cells_in_map(field, Vec2(float(cell.x), float(cell.y)), extent_of(field, 0))
    return corners(field, IVec2(int(in_map.x), int(in_map.y)), 0)


@shader
def texel_height(field: HeightField, texel: IVec2) -> float:
    """The height of a texel of the map."""
    return corners(field, texel, 0).x


@shader
def highest(four: Vec4) -> float:
    """The largest of four heights."""
    return max(max(four.x, four.y), max(four.z, four.w))


@shader
def headroom_code(windows: HeightField, window: IVec2) -> float:
    """The headroom above a window as a stored code, less a margin for float32 rounding."""
    return clamp(floor((1.0 - texel_height(windows, window)) * MAX_CODE - 0.02), 0.0, MAX_CODE)


@shader
def packed(codes: Vec4) -> PackedRecord:
    """Four integers up to 65535 in two words."""
    return PackedRecord(
        int(codes.x) | (int(codes.y) << 16),
        int(codes.z) | (int(codes.w) << 16),
    )


# --- the bake -------------------------------------------------------------------------------------

BOUNDS = Bake(
    "bounds",
    (block_top, window_top, near_record, far_record),
    all_levels=True,
)
"""The bake of `exact`."""
