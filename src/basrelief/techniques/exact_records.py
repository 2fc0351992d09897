"""The records of the technique `exact`: their contents and their positions in the table.

A near record belongs to a block of 2 × 2 cells, a far record to one of 8 × 8; each exists once for
every quadrant that a ray can run towards. `exact_bake` has the shaders that compute them,
`docs/bake.md` the layout in words.
"""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, shader
from basrelief.techniques.height import extent_of

SHIFT = 1
BLOCK = 1 << SHIFT
"""Cells along each side of the block of a near record."""
PLANE = 4
"""Cells along each side of the window below a near record's plane."""
WINDOW = 10
"""Cells along each side of the window of a near record's highest point."""
FAR_SHIFT = 3
FAR_BLOCK = 1 << FAR_SHIFT
"""Cells along each side of the block of a far record."""
FAR = 3
FAR_2 = 6
FAR_3 = 12
FAR_4 = 24
"""Blocks along each side of the four windows of a far record's highest points."""
MAX_SLOPE = 0.5
"""The steepest slope of a record's plane, in heights per texel."""
MIN_HEADROOM = -4.0
MAX_HEADROOM = 4.0
"""The range of a plane's headroom in a record: 1 − the plane's height at the block's corner."""


@shader
def first_row(field: HeightField, level: int) -> int:
    """The first row of a mip level's records in the table, below those of all finer levels."""
    rows = 0
    for k in range(level):
        rows = rows + rows_of(extent_of(field, k))
    return rows


@shader
def rows_of(extent: Vec2) -> int:
    """The number of rows of the records of a map of `extent` texels."""
    return 2 * (near_blocks(extent).y + far_blocks(extent).y)


@shader
def near_blocks(extent: Vec2) -> IVec2:
    """The number of near records' blocks along each axis of a map."""
    more = BLOCK - 1
    return IVec2((int(extent.x) + more) >> SHIFT, (int(extent.y) + more) >> SHIFT)


@shader
def far_blocks(extent: Vec2) -> IVec2:
    """The number of far records' blocks along each axis of a map."""
    more = FAR_BLOCK - 1
    return IVec2((int(extent.x) + more) >> FAR_SHIFT, (int(extent.y) + more) >> FAR_SHIFT)
