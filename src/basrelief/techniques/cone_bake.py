"""The bake of cone stepping: for each cell, the cone that the surface does not rise into.

Slopes are in heights per texel and distances in texels, the same along u and v. A *point* is any
point of the bilinear surface, a *vertex* one at a texel's centre.

The cone of a cell has the slope s = max of (f(y) − f(x)) ÷ |y − x|, over all points x over the cell
and all points y. Vertices suffice to bound it:

- *Cells that do not touch.* For a slope s and a unit direction d, let g = f(y) − f(x) − s d·(y − x)
  for x in one cell and y in the other. Along each axis of either cell g is linear, so it is largest
  between two vertices. With d along the line between the cells' middles, d·(y − x) ≤ |y − x|, and
  between two vertices it is at least √(`min_distance_squared`). So if s is the largest rise between
  vertices ÷ that distance, g ≤ 0 everywhere and no point is above the cone.
- *Cells that touch.* A line between two points is no steeper than the steepest point it leads over.

Vertices are searched in windows of doubling width around each vertex, one width a pass: within each
window only its highest vertex counts, at the distance of the window's nearest texel. That
overestimates slopes, which keeps the cone conservative.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec2,
    Vec4,
    corners,
    floor,
    shader,
    size,
    sqrt,
    static,
    struct,
)
from basrelief.techniques.bake import Bake
from basrelief.techniques.cone_bake_windows import (
    UNIT,
    WindowLayout,
    first_windows,
    next_windows,
    windows_at,
)
from basrelief.techniques.edge import cell_in_map

BLOCKS = 8
"""Blocks along each side of the area that one pass searches; a block is four windows."""
SLOPE_ROUNDING = 1e-5
MIN_SLOPE = 4e-7
"""The relative and absolute margins of a slope for float32 rounding: a division as inexact as WGSL
allows, 2.5 units in the last place, and 1e-7 for the rise."""
LEVEL_SLOPE = 1e-6
"""Heights per texel: a smaller descent counts as level, since engines round differently."""


@struct
class SearchBounds:
    """The bounds of a pass: vertices from `nearest` texels away, up to the map's `highest` height.

    In a search by sector, only windows between the directions `first` and `last` count.
    """

    nearest: float
    highest: float
    first: Vec2
    last: Vec2


@static
class Search:
    """Whether windows are searched in one sector only or in all directions."""

    by_sector: bool


@struct
class SquaredSlope:
    """A squared slope."""

    squared: float


@struct
class StoredCone:
    """A cone as stored: 65535 · c, an integer."""

    cone: float


# --- the steepest rise from each vertex ----------------------------------------------------------


@shader
def steepest(
    at: IVec2,
    bounds: SearchBounds,
    layout: WindowLayout,
    field: HeightField,
    windows: Texture,
    previous: HeightField,
    search: Search,
) -> SquaredSlope:
    """The steepest rise from a vertex, squared: the larger of that of the `previous` passes and
    that of this pass's windows."""
    own = corners(field, at, 0).x
    squared = corners(previous, at, 0).x
    rise_limit = max(bounds.highest - own, 0.0)
    # nothing further away can be steeper
    if rise_limit * rise_limit <= squared * min_distance_squared(bounds.nearest, 0.0):
        return SquaredSlope(squared)
    half = BLOCKS // 2
    for j in range(BLOCKS):
        for i in range(BLOCKS):
            # covered by narrower windows
            inner = min(i, j) >= half // 2 and max(i, j) < half + half // 2
            x = (i - half) * 2 * layout.width
            y = (j - half) * 2 * layout.width
            if (layout.width == 1 or not inner) and any_in_search(
                bounds, x, y, layout.width, search
            ):
                four = windows_at(windows, layout, at.x + x, at.y + y)
                squared = max(squared, steepest_of(four, own, bounds, layout.width, x, y, search))
    return SquaredSlope(squared)


@shader
def steepest_of(
    four: Vec4, own: float, bounds: SearchBounds, width: int, x: int, y: int, search: Search
) -> float:
    """The steepest rise, squared, to the four windows of a block that begins at an offset."""
    most = squared_slope(four.x, own, bounds, width, x, y, search)
    most = max(most, squared_slope(four.y, own, bounds, width, x + width, y, search))
    most = max(most, squared_slope(four.z, own, bounds, width, x, y + width, search))
    return max(most, squared_slope(four.w, own, bounds, width, x + width, y + width, search))


@shader
def squared_slope(
    code: float, own: float, bounds: SearchBounds, width: int, x: int, y: int, search: Search
) -> float:
    """The squared slope to a window's highest height; 0 if it is lower or not in the search."""
    rise = max(min(code * UNIT, bounds.highest) - own, 0.0)
    squared = rise * rise / min_distance_squared(min_offset(x, width), min_offset(y, width))
    return squared if in_search(bounds, x, y, width, search) else 0.0


@shader
def any_in_search(bounds: SearchBounds, x: int, y: int, width: int, search: Search) -> bool:
    """Whether any of the four windows of a block is in the search."""
    return (
        in_search(bounds, x, y, width, search)
        or in_search(bounds, x + width, y, width, search)
        or in_search(bounds, x, y + width, width, search)
        or in_search(bounds, x + width, y + width, width, search)
    )


@shader
def in_search(bounds: SearchBounds, x: int, y: int, width: int, search: Search) -> bool:
    """Whether a window that begins at an offset is in the search."""
    return in_sector(bounds, x, y, width) if search.by_sector else True


@shader
def in_sector(bounds: SearchBounds, x: int, y: int, width: int) -> bool:
    """Whether the middle of a window lies in the sector."""
    half = 0.5 * float(width - 1)
    across = float(x) + half
    down = float(y) + half
    after_first = bounds.first.x * down - bounds.first.y * across
    before_last = bounds.last.y * across - bounds.last.x * down
    return after_first >= 0.0 and before_last >= 0.0


@shader
def min_offset(start: int, width: int) -> float:
    """The distance along an axis to the nearest of `width` texels from `start` on."""
    return float(max(max(start, 1 - start - width), 0))


@shader
def min_distance_squared(x: float, y: float) -> float:
    """The least squared distance of two vertices x and y apart, along the line between the middles
    of two cells that have them as corners and do not touch."""
    far = max(max(x, y), 1.0)
    return max(x * x + y * y - 2.0, 0.8 * far * far)


# --- relaxed cones: vertices that a ray may come out behind ---------------------------------------


@struct
class Sector:
    """A sector of directions, from `first` to `last`, and widened by the reach of windows that lie
    partly outside it. Each axis is one of the four directions: between two axes the slope from a
    vertex is linear."""

    beyond_first: Vec2
    first: Vec2
    last: Vec2
    beyond_last: Vec2


@struct
class VertexHeight:
    """The height of a vertex."""

    height: float


@shader
def crest_height(at: IVec2, sector: Sector, field: HeightField) -> VertexHeight:
    """The height of a vertex behind which the surface falls in a direction of the sector, else
    0."""
    extent = size(field, 0)
    before = IVec2(cell_in_map(field, at.x - 1, extent.x), cell_in_map(field, at.y - 1, extent.y))
    upper_left = corners(field, before, 0)
    own = corners(field, at, 0)
    along_u = Vec2(upper_left.z, own.y) - own.x
    along_v = Vec2(upper_left.y, own.z) - own.x
    inside = min(
        slope_towards(along_u, along_v, sector.first), slope_towards(along_u, along_v, sector.last)
    )
    outside = min(
        slope_towards(along_u, along_v, sector.beyond_first),
        slope_towards(along_u, along_v, sector.beyond_last),
    )
    slope = min(inside, outside)
    return VertexHeight(own.x if slope < -LEVEL_SLOPE else 0.0)


@shader
def slope_towards(along_u: Vec2, along_v: Vec2, direction: Vec2) -> float:
    """The slope from a vertex in a direction, from the rises to its neighbours before (x) and after
    (y) it along each axis."""
    over_u = along_u.y if direction.x > 0.0 else along_u.x
    over_v = along_v.y if direction.y > 0.0 else along_v.x
    return abs(direction.x) * over_u + abs(direction.y) * over_v


# --- the cone of each cell ------------------------------------------------------------------------


@shader
def cone_of(at: IVec2, field: HeightField, slopes: HeightField) -> StoredCone:
    """The cone of the cell right of and below a texel's centre, rounded to the narrower side."""
    of_corners = corners(slopes, at, 0)
    squared = max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w))
    extent = size(field, 0)
    for j in range(3):
        for i in range(3):
            neighbour = IVec2(
                cell_in_map(field, at.x + i - 1, extent.x),
                cell_in_map(field, at.y + j - 1, extent.y),
            )
            squared = max(squared, rise_within(corners(field, neighbour, 0), i - 1, j - 1))
    return stored_cone(sqrt(squared))


@shader
def relaxed_cone_of(at: IVec2, slopes: HeightField) -> StoredCone:
    """The narrowest of the cones of a cell's corners."""
    of_corners = corners(slopes, at, 0)
    return stored_cone(sqrt(max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w))))


@shader
def rise_within(four: Vec4, i: int, j: int) -> float:
    """The steepest slope, squared, of the cell (i, j) in the directions from the cell (0, 0) to
    it."""
    along_u = max(rise_along(four.y - four.x, i), rise_along(four.w - four.z, i))
    along_v = max(rise_along(four.z - four.x, j), rise_along(four.w - four.y, j))
    return along_u * along_u + along_v * along_v


@shader
def rise_along(slope: float, towards: int) -> float:
    """The rise of a slope towards one side of an axis, or towards either (0)."""
    if towards == 0:
        return abs(slope)
    return max(slope if towards > 0 else -slope, 0.0)


@shader
def stored_cone(slope: float) -> StoredCone:
    """65535 ÷ (1 + slope), rounded down: to a steeper slope, a narrower cone."""
    # a level surface keeps its half space; next to 1 the smallest slopes would round away
    margin = MIN_SLOPE if slope > 0.0 else 0.0
    return StoredCone(floor(65535.0 / (1.0 + slope * (1.0 + SLOPE_ROUNDING) + margin)))


# --- the bakes ------------------------------------------------------------------------------------

CONE_MAP = Bake(
    "cone_map",
    (first_windows, next_windows, steepest, cone_of),
)
"""The bake of `cone`."""
RELAXED_CONE_MAP = Bake(
    "relaxed_cone_map",
    (crest_height, first_windows, next_windows, steepest, relaxed_cone_of),
)
"""The bake of `relaxed_cone`."""
