"""The records that the technique `exact` reads: what they hold, and where each lies in its table.

`exact_bake` has the shaders that make them, `docs/bake.md` the layout in words.
"""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, shader
from basrelief.techniques.height import extent_of

SHIFT = 1
BLOCK = 1 << SHIFT
"""Cells along each side that share a near record."""
PLANE = 4
"""Cells along each side of the window ahead that a near record's plane lies above."""
WINDOW = 10
"""Cells along each side of the window ahead whose highest point a near record holds."""
FAR_SHIFT = 3
FAR_BLOCK = 1 << FAR_SHIFT
"""Cells along each side that share a far record."""
FAR = 3
FAR_2 = 6
FAR_3 = 12
FAR_4 = 24
"""Blocks along each side of the windows ahead whose highest points a far record holds."""
STEEPEST = 0.5
"""The steepest slope that a record can hold, in heights a texel."""
LOWEST = -4.0
HIGHEST = 4.0
"""The least and the most that a record can hold of 1 − a plane's height at its block's corner."""


@shader
def first_row(field: HeightField, level: int) -> int:
    """Where the records of a level begin in the table: below those of all levels above it."""
    rows = 0
    for k in range(level):
        rows = rows + rows_of(extent_of(field, k))
    return rows


@shader
def rows_of(extent: Vec2) -> int:
    """How many rows the records of a level take."""
    return 2 * (near_blocks(extent).y + far_blocks(extent).y)


@shader
def near_blocks(extent: Vec2) -> IVec2:
    """How many blocks of a near record cover a map."""
    more = BLOCK - 1
    return IVec2((int(extent.x) + more) >> SHIFT, (int(extent.y) + more) >> SHIFT)


@shader
def far_blocks(extent: Vec2) -> IVec2:
    """How many blocks of a far record cover a map."""
    more = FAR_BLOCK - 1
    return IVec2((int(extent.x) + more) >> FAR_SHIFT, (int(extent.y) + more) >> FAR_SHIFT)
