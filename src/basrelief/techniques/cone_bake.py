"""The cone above each cell that the surface does not rise into.

Slopes are in heights a texel; distances are in texels, the same along u and v. A place is any
point of the bilinear surface, a vertex is one at a texel's centre.

Why vertices are enough: for two cells that do not touch, and any one direction, take from the
rise between a place of the one and a place of the other a slope times how far apart they are along
that direction. The rest is straight along each axis, so it is largest between two vertices.
Measured along the line between the cells' middles, two vertices are at least `apart_squared` apart.
Between cells that touch, no line is steeper than the steepest place that it leads over.
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
    Windows,
    first_windows,
    next_windows,
    windows_at,
)
from basrelief.techniques.edge import cell_in_map

BLOCKS = 8
"""Blocks along each side of what one octave covers; a block is four windows."""
ROUNDING = 1e-5
LEAST = 4e-7
"""The share of a slope, and the slope, that stand for what float32 rounds off: with a division as
inexact as WGSL allows, 2.5 units in the last place, and 1e-7 for the rise."""
LEVEL = 1e-6
"""Heights a texel that a surface may fall by and be level still: engines round differently."""


@struct
class Octave:
    """How far an octave reaches: from the vertices that are `nearest` texels away, or all.

    `highest` is the highest height of the map. Where a sector is asked, it lies between the
    directions `first` and `last`.
    """

    nearest: float
    highest: float
    first: Vec2
    last: Vec2


@static
class Search:
    """Which windows are gone through: all, or those of one sector."""

    by_sector: bool


@struct
class Slope:
    """A slope, squared."""

    squared: float


@struct
class Stored:
    """A cone as it is stored, a whole number of 65535ths."""

    cone: float


# --- the steepest line from each vertex to others -------------------------------------------------


@shader
def steepest(
    at: IVec2,
    octave: Octave,
    held: Windows,
    field: HeightField,
    windows: Texture,
    so_far: HeightField,
    search: Search,
) -> Slope:
    """The steepest line up from a vertex, among those so far and those of one octave."""
    own = corners(field, at, 0).x
    squared = corners(so_far, at, 0).x
    most = max(octave.highest - own, 0.0)
    # nothing further away could be steeper
    if most * most <= squared * apart_squared(octave.nearest, 0.0):
        return Slope(squared)
    half = BLOCKS // 2
    for j in range(BLOCKS):
        for i in range(BLOCKS):
            # what narrower windows have covered already
            inner = min(i, j) >= half // 2 and max(i, j) < half + half // 2
            x = (i - half) * 2 * held.width
            y = (j - half) * 2 * held.width
            if (held.width == 1 or not inner) and some_asked(octave, x, y, held.width, search):
                four = windows_at(windows, held, at.x + x, at.y + y)
                squared = max(squared, steepest_of(four, own, octave, held.width, x, y, search))
    return Slope(squared)


@shader
def steepest_of(
    four: Vec4, own: float, octave: Octave, width: int, x: int, y: int, search: Search
) -> float:
    """The steepest line, squared, up to the four windows of a block that begins so far away."""
    most = squared_slope(four.x, own, octave, width, x, y, search)
    most = max(most, squared_slope(four.y, own, octave, width, x + width, y, search))
    most = max(most, squared_slope(four.z, own, octave, width, x, y + width, search))
    return max(most, squared_slope(four.w, own, octave, width, x + width, y + width, search))


@shader
def squared_slope(
    code: float, own: float, octave: Octave, width: int, x: int, y: int, search: Search
) -> float:
    """The slope, squared, up to a window's highest height; 0 where it is lower, or not asked."""
    rise = max(min(code * UNIT, octave.highest) - own, 0.0)
    squared = rise * rise / apart_squared(away(x, width), away(y, width))
    return squared if is_asked(octave, x, y, width, search) else 0.0


@shader
def some_asked(octave: Octave, x: int, y: int, width: int, search: Search) -> bool:
    """Whether any of the four windows of a block is asked."""
    return (
        is_asked(octave, x, y, width, search)
        or is_asked(octave, x + width, y, width, search)
        or is_asked(octave, x, y + width, width, search)
        or is_asked(octave, x + width, y + width, width, search)
    )


@shader
def is_asked(octave: Octave, x: int, y: int, width: int, search: Search) -> bool:
    """Whether a window that begins so far away is asked."""
    return in_sector(octave, x, y, width) if search.by_sector else True


@shader
def in_sector(octave: Octave, x: int, y: int, width: int) -> bool:
    """Those whose middles lie in the sector."""
    half = 0.5 * float(width - 1)
    across = float(x) + half
    down = float(y) + half
    after_first = octave.first.x * down - octave.first.y * across
    before_last = octave.last.y * across - octave.last.x * down
    return after_first >= 0.0 and before_last >= 0.0


@shader
def away(start: int, width: int) -> float:
    """How far the nearest of a row of so many texels is."""
    return float(max(max(start, 1 - start - width), 0))


@shader
def apart_squared(x: float, y: float) -> float:
    """How far apart two vertices are at least along the line between the middles of two cells that
    have them as corners, and that do not touch each other; squared."""
    far = max(max(x, y), 1.0)
    return max(x * x + y * y - 2.0, 0.8 * far * far)


# --- what a ray from a sector may come out of -----------------------------------------------------


@struct
class Sector:
    """The directions between two, and beyond these as far as windows reach out of the sector. Axes
    are among the four: between two of them the slope from a vertex bends no further."""

    beyond_first: Vec2
    first: Vec2
    last: Vec2
    beyond_last: Vec2


@struct
class Height:
    """A height."""

    height: float


@shader
def far_side(at: IVec2, sector: Sector, field: HeightField) -> Height:
    """A vertex's height where the surface beyond it falls in a direction of the sector, else 0."""
    extent = size(field, 0)
    before = IVec2(cell_in_map(field, at.x - 1, extent.x), cell_in_map(field, at.y - 1, extent.y))
    upper_left = corners(field, before, 0)
    own = corners(field, at, 0)
    along_u = Vec2(upper_left.z, own.y) - own.x
    along_v = Vec2(upper_left.y, own.z) - own.x
    within = min(
        slope_towards(along_u, along_v, sector.first), slope_towards(along_u, along_v, sector.last)
    )
    beyond = min(
        slope_towards(along_u, along_v, sector.beyond_first),
        slope_towards(along_u, along_v, sector.beyond_last),
    )
    falls = min(within, beyond)
    return Height(own.x if falls < -LEVEL else 0.0)


@shader
def slope_towards(along_u: Vec2, along_v: Vec2, direction: Vec2) -> float:
    """The slope from a vertex in a direction; it rises by these to the vertices before and after
    it along each axis."""
    over_u = along_u.y if direction.x > 0.0 else along_u.x
    over_v = along_v.y if direction.y > 0.0 else along_v.x
    return abs(direction.x) * over_u + abs(direction.y) * over_v


# --- each cell's cone -----------------------------------------------------------------------------


@shader
def cone_of(at: IVec2, field: HeightField, slopes: HeightField) -> Stored:
    """The cone of the cell right of and below a texel's centre, rounded to the narrower side."""
    of_corners = corners(slopes, at, 0)
    squared = max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w))
    extent = size(field, 0)
    for j in range(3):
        for i in range(3):
            beside = IVec2(
                cell_in_map(field, at.x + i - 1, extent.x),
                cell_in_map(field, at.y + j - 1, extent.y),
            )
            squared = max(squared, rise_within(corners(field, beside, 0), i - 1, j - 1))
    return as_stored(sqrt(squared))


@shader
def relaxed_cone_of(at: IVec2, slopes: HeightField) -> Stored:
    """The narrowest of the cones of a cell's corners."""
    of_corners = corners(slopes, at, 0)
    return as_stored(sqrt(max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w))))


@shader
def rise_within(four: Vec4, i: int, j: int) -> float:
    """How steeply, squared, a cell rises in the directions that lead from the cell (0, 0) to it."""
    along_u = max(rise_along(four.y - four.x, i), rise_along(four.w - four.z, i))
    along_v = max(rise_along(four.z - four.x, j), rise_along(four.w - four.y, j))
    return along_u * along_u + along_v * along_v


@shader
def rise_along(slope: float, towards: int) -> float:
    """How steeply a slope along an axis rises one way, or either way."""
    if towards == 0:
        return abs(slope)
    return max(slope if towards > 0 else -slope, 0.0)


@shader
def as_stored(slope: float) -> Stored:
    """1 ÷ (1 + slope), rounded down: a steeper slope is a narrower cone."""
    # what is level stays a half space, and no more: beside 1 the slightest slopes are rounded off
    margin = LEAST if slope > 0.0 else 0.0
    return Stored(floor(65535.0 / (1.0 + slope * (1.0 + ROUNDING) + margin)))


# --- the bakes ------------------------------------------------------------------------------------

CONE_MAP = Bake(
    "cone_map",
    (first_windows, next_windows, steepest, cone_of),
)
RELAXED_CONE_MAP = Bake(
    "relaxed_cone_map",
    (far_side, first_windows, next_windows, steepest, relaxed_cone_of),
)
