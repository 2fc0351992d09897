r"""The horizon bake: the elevation of the horizon around each texel, and the visible sky above it.

From a texel at height h a line runs in a direction d over the bilinear surface f. The tangent of
the horizon's elevation is the steepest slope to any point of the surface:

    slope(s) = (f(s · d) − h) ÷ s,   horizon = max over s > 0 of slope(s)

    height                  ____
                    __..--'/    \          The horizon is the steepest line of sight from the texel
             __..--'      /      \    _    to the surface; what is below it is hidden.
    h  *-''`    ____     /        \__/ \
       |_______/    \___/               \
       +------------------> s, in texels

**Over one cell** the surface along the line is a parabola. With t from 0 to 1 between the entry s₀
and the exit s₁, f and g the heights there and m that in the middle, all relative to h,

    rise(t) = f + (g − f) t + bend (t − t²),   bend = 4 m − 2 (f + g)
    slope(t) = rise(t) ÷ (s₀ + w t),           w = s₁ − s₀

Its derivative is 0 where bend w t² + 2 bend s₀ t = gain, with gain = (g − f + bend) s₀ − f w, so
the maximum is at

    t = gain ÷ (bend s₀ + √(bend² s₀² + bend w gain))

**Empty space.** The line skips blocks of 8 × 8 and 64 × 64 cells whose highest point cannot raise
the horizon, and ends where even the highest point of the map could not.

**The visible sky** is the cosine-weighted share of a uniform sky above the horizon. In the slice
of direction d, with e the horizon's elevation, n the normal and n_d its part along d,

    2 ∫ from e to π/2 of (n_z sin φ + n_d cos φ) cos φ dφ
        = n_z cos² e + n_d (π/2 − e − cos e sin e)

and the visibility is the mean of this over all directions, slices below 0 counting as 0.

N. L. Max, Horizon Mapping: Shadows for Bump-Mapped Surfaces, 1988. L. Bavoil, M. Sainz and
R. Dimitrov, Image-Space Horizon-Based Ambient Occlusion, 2008.
"""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    Vec2,
    Vec4,
    acos,
    copysign,
    corners,
    floor,
    saturate,
    shader,
    size,
    sqrt,
    struct,
)
from basrelief.techniques.edge import cell_in_map
from basrelief.techniques.height import interpolated
from basrelief.techniques.normal_bake import normal_at, texel_height

NEAR = 8
FAR = 64
"""Cells along each side of the two sizes of blocks that are skipped."""
MAX_STEPS = 1048576
"""Upper limit of a line's steps, more than any takes; a line cut short gets a horizon that is too
high rather than too low."""
OUTSIDE = 16777216
"""Texels: further away than any map reaches."""
SLOPE_ERROR = 2.5e-7
"""The error of a slope in float32, in heights per texel."""
MIN_COMPONENT = 1e-20
"""Lower limit of a direction's components in divisions."""


@struct
class MapDirection:
    """A direction over the map.

    `along` is the unit vector in texels, v down. After `period` texels the heights repeat or no
    longer change; a line is cut short after `max_length` texels.
    """

    along: Vec2
    period: float
    max_length: float


@struct
class HorizonSearch:
    """Parameters that all lines share.

    `top` is the highest point of the map, `per_texel` the height range in texel widths. Slopes up
    to `min_slope`, in heights per texel, count as level.
    """

    top: float
    per_texel: float
    min_slope: float


@struct
class Elevation:
    """The sine of the elevation of the horizon, 0 (level) to 1."""

    sine: float


@struct
class SkyVisibility:
    """The visible share of a uniform sky's light, 0 to 1."""

    visibility: float


@shader
def horizon(
    at: IVec2,
    field: HeightField,
    near: HeightField,
    far: HeightField,
    search: HorizonSearch,
    directions: Buffer[MapDirection],
) -> Elevation:
    """The elevation of the horizon in the first direction, never too low."""
    return Elevation(horizon_sine(field, near, far, at, directions[0], search))


@shader
def sky_visibility(
    at: IVec2,
    field: HeightField,
    near: HeightField,
    far: HeightField,
    search: HorizonSearch,
    directions: Buffer[MapDirection],
) -> SkyVisibility:
    """The cosine-weighted visible sky: the mean over all directions of the slice above the horizon,
    integrated in closed form."""
    normal = normal_at(field, at, search.per_texel)
    total = 0.0
    for k in range(len(directions)):
        direction = directions[k]
        sine = horizon_sine(field, near, far, at, direction, search)
        cosine_squared = saturate(1.0 - sine * sine)
        tilt = normal.x * direction.along.x - normal.y * direction.along.y
        tilt_weight = acos(sine) - sqrt(cosine_squared) * sine
        total = total + max(normal.z * cosine_squared + tilt * tilt_weight, 0.0)
    return SkyVisibility(saturate(total / float(len(directions))))


@shader
def horizon_sine(
    field: HeightField,
    near: HeightField,
    far: HeightField,
    at: IVec2,
    direction: MapDirection,
    search: HorizonSearch,
) -> float:
    """The sine of the elevation of the horizon from a texel."""
    slope = max_slope(field, near, far, at, direction, search)
    # rounding may have lowered the slope
    tangent = (slope + SLOPE_ERROR) * search.per_texel if slope > search.min_slope else 0.0
    return min(tangent / sqrt(1.0 + tangent * tangent), 1.0)


@shader
def max_slope(
    field: HeightField,
    near: HeightField,
    far: HeightField,
    at: IVec2,
    direction: MapDirection,
    search: HorizonSearch,
) -> float:
    """The steepest slope from a texel along a direction, in heights per texel; at least
    `min_slope`."""
    extent = size(field, 0)
    own = texel_height(field, at.x, at.y)
    along = Vec2(
        copysign(max(abs(direction.along.x), MIN_COMPONENT), direction.along.x),
        copysign(max(abs(direction.along.y), MIN_COMPONENT), direction.along.y),
    )
    forward = IVec2(1 if along.x > 0.0 else 0, 1 if along.y > 0.0 else 0)
    pace = 1.0 / along
    end = min(direction.period, direction.max_length)
    # the line's cell, relative to the texel, and the map's cell for it
    cell = IVec2(forward.x - 1, forward.y - 1)
    in_map = IVec2(
        cell_in_map(field, at.x + cell.x, extent.x), cell_in_map(field, at.y + cell.y, extent.y)
    )
    top = search.top
    best = search.min_slope
    s = 0.0
    # the size of the block to test: 2 far, 1 near, 0 a single cell
    size_class = 2
    k = 0
    # beyond s no point of the map has a slope above (top − own) ÷ s
    while k < MAX_STEPS and s < end and top - own > best * s:
        inside = IVec2(max(in_map.x, 0), max(in_map.y, 0))
        first = inside
        side = 1
        highest = 2.0
        if size_class == 2:
            first = IVec2(inside.x & -FAR, inside.y & -FAR)
            side = FAR
            highest = corners(far, IVec2(inside.x >> 6, inside.y >> 6), 0).x
        elif size_class == 1:
            first = IVec2(inside.x & -NEAR, inside.y & -NEAR)
            side = NEAR
            highest = corners(near, IVec2(inside.x >> 3, inside.y >> 3), 0).x
        last = IVec2(min(first.x + side, extent.x) - 1, min(first.y + side, extent.y) - 1)
        if field.edge == "clamp":
            # beyond the border nothing changes along that axis
            first = IVec2(
                -OUTSIDE if forward.x == 0 and in_map.x < 0 else first.x,
                -OUTSIDE if forward.y == 0 and in_map.y < 0 else first.y,
            )
            last = IVec2(
                OUTSIDE if forward.x > 0 and in_map.x >= extent.x - 1 else last.x,
                OUTSIDE if forward.y > 0 and in_map.y >= extent.y - 1 else last.y,
            )
        # the block's first and last cells, and the s at which the line crosses its far sides
        low = IVec2(cell.x + first.x - inside.x, cell.y + first.y - inside.y)
        high = IVec2(cell.x + last.x - inside.x, cell.y + last.y - inside.y)
        exits = Vec2(
            float(high.x + 1 if forward.x > 0 else low.x) * pace.x,
            float(high.y + 1 if forward.y > 0 else low.y) * pace.y,
        )
        s_exit = max(min(exits.x, exits.y), s)
        if size_class == 0:
            best = max_slope_in_cell(field, in_map, cell, direction.along, s, s_exit, own, best)
        if size_class == 0 or highest - own <= best * s:
            behind = IVec2(
                high.x + 1 if forward.x > 0 else low.x - 1,
                high.y + 1 if forward.y > 0 else low.y - 1,
            )
            position = direction.along * s_exit
            nearer = IVec2(cell.x if forward.x > 0 else low.x, cell.y if forward.y > 0 else low.y)
            farther = IVec2(
                high.x if forward.x > 0 else cell.x, high.y if forward.y > 0 else cell.y
            )
            across = IVec2(
                min(max(int(floor(position.x)), nearer.x), farther.x),
                min(max(int(floor(position.y)), nearer.y), farther.y),
            )
            next_cell = IVec2(
                behind.x if exits.x <= exits.y else across.x,
                behind.y if exits.y <= exits.x else across.y,
            )
            before = inside
            in_map = IVec2(
                cell_in_map(field, in_map.x + next_cell.x - cell.x, extent.x),
                cell_in_map(field, in_map.y + next_cell.y - cell.y, extent.y),
            )
            cell = next_cell
            s = s_exit
            # where the line enters a larger block, test that block as a whole
            crossed = (before.x ^ in_map.x) | (before.y ^ in_map.y)
            if (crossed & -FAR) != 0:
                size_class = 2
            elif (crossed & -NEAR) != 0:
                size_class = max(size_class, 1)
        else:
            size_class = size_class - 1
        k = k + 1
    is_cut = s < direction.period and (s >= end or k >= MAX_STEPS)
    return max(best, (top - own) / max(s, 1.0)) if is_cut else best


@shader
def max_slope_in_cell(
    field: HeightField,
    in_map: IVec2,
    cell: IVec2,
    along: Vec2,
    s_enter: float,
    s_exit: float,
    own: float,
    best: float,
) -> float:
    """The steepest slope to the surface of one cell, from `s_enter` to `s_exit`; at least
    `best`."""
    four = corners(field, in_map, 0)
    offset = Vec2(float(cell.x), float(cell.y))
    s_middle = (s_enter + s_exit) * 0.5
    f = patch_height(four, offset, along, s_enter) - own
    m = patch_height(four, offset, along, s_middle) - own
    g = patch_height(four, offset, along, s_exit) - own
    bend = 4.0 * m - 2.0 * (f + g)
    slope = max(best, g / max(s_exit, 0.5))
    # the parabola lies below its ends and the point where its end tangents meet
    peak = (f + g + bend) * 0.5
    if bend > 0.0 and peak > slope * s_middle:
        if s_enter <= 0.0:
            slope = peak / max(s_middle, 0.25)
        else:
            width = s_exit - s_enter
            gain = (g - f + bend) * s_enter - f * width
            root = sqrt(max(bend * bend * s_enter * s_enter + bend * width * gain, 0.0))
            t = saturate(gain / max(bend * s_enter + root, MIN_COMPONENT))
            slope = max(slope, (f + (g - f) * t + bend * (t - t * t)) / (s_enter + width * t))
    return slope


@shader
def patch_height(four: Vec4, offset: Vec2, along: Vec2, s: float) -> float:
    """The height of a cell's patch under a line, s texels from the line's start."""
    return interpolated(four, saturate(along.x * s - offset.x), saturate(along.y * s - offset.y))
