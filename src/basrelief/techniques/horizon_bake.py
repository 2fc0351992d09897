"""How high the relief stands around each texel: the horizon, and the sky that it leaves.

From a texel's centre a line runs over the bilinear surface, one cell after another, and keeps the
steepest sight so far. Blocks of cells whose highest point cannot come above that are passed over
whole, and the line ends where even the highest point of the map could not.
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
from basrelief.techniques.height import within
from basrelief.techniques.normal_bake import normal_at, texel_height

NEAR = 8
FAR = 64
"""Cells along each side of the two sizes of blocks that are passed over whole."""
MOST = 1048576
"""More steps than any line takes; a line that would is cut short, and stays on the safe side."""
BEYOND = 16777216
"""Texels further off than any map reaches."""
BLUR = 2.5e-7
"""Heights that float32 cannot tell apart on the way, by texel of distance."""
FLATTEST = 1e-20
"""The least share of a direction that is divided by."""


@struct
class Way:
    """A direction over the map: a unit vector in texels, v down.

    After `repeats` texels the heights come again, or change no more; a line longer than `longest`
    is cut short.
    """

    along: Vec2
    repeats: float
    longest: float


@struct
class Sights:
    """What all lines go by.

    `top` is the highest point of the map, `per_texel` what the whole height range rises in widths
    of a texel; sights no steeper than `least`, in heights a texel, count as level.
    """

    top: float
    per_texel: float
    least: float


@struct
class Elevation:
    """The sine of the elevation of the horizon, 0 (level) to 1."""

    sine: float


@struct
class Openness:
    """The share of a uniform sky's light that arrives, 0 to 1."""

    open: float


@shader
def horizon(
    at: IVec2,
    field: HeightField,
    near: HeightField,
    far: HeightField,
    sights: Sights,
    ways: Buffer[Way],
) -> Elevation:
    """The elevation of the horizon in the first of the ways, never too low."""
    return Elevation(elevation(field, near, far, at, ways[0], sights))


@shader
def openness(
    at: IVec2,
    field: HeightField,
    near: HeightField,
    far: HeightField,
    sights: Sights,
    ways: Buffer[Way],
) -> Openness:
    """How much of the sky is seen, by the cosine to the normal: the mean over all ways of what is
    left of the slice above the horizon, integrated in closed form."""
    normal = normal_at(field, at, sights.per_texel)
    total = 0.0
    for k in range(len(ways)):
        way = ways[k]
        sine = elevation(field, near, far, at, way, sights)
        square = saturate(1.0 - sine * sine)
        leaning = normal.x * way.along.x - normal.y * way.along.y
        sideways = acos(sine) - sqrt(square) * sine
        total = total + max(normal.z * square + leaning * sideways, 0.0)
    return Openness(saturate(total / float(len(ways))))


@shader
def elevation(
    field: HeightField, near: HeightField, far: HeightField, at: IVec2, way: Way, sights: Sights
) -> float:
    """The sine of the elevation of the horizon from a texel."""
    slope = steepest(field, near, far, at, way, sights)
    # what is counted may have lost some height in rounding
    tangent = (slope + BLUR) * sights.per_texel if slope > sights.least else 0.0
    return min(tangent / sqrt(1.0 + tangent * tangent), 1.0)


@shader
def steepest(
    field: HeightField, near: HeightField, far: HeightField, at: IVec2, way: Way, sights: Sights
) -> float:
    """The steepest sight from a texel along a way, in heights a texel; `least` or more."""
    extent = size(field, 0)
    own = texel_height(field, at.x, at.y)
    along = Vec2(
        copysign(max(abs(way.along.x), FLATTEST), way.along.x),
        copysign(max(abs(way.along.y), FLATTEST), way.along.y),
    )
    forth = IVec2(1 if along.x > 0.0 else 0, 1 if along.y > 0.0 else 0)
    pace = 1.0 / along
    end = min(way.repeats, way.longest)
    # the cell that the line is in, counted from the texel, and as the map has it
    cell = IVec2(forth.x - 1, forth.y - 1)
    mapped = IVec2(
        cell_in_map(field, at.x + cell.x, extent.x), cell_in_map(field, at.y + cell.y, extent.y)
    )
    top = sights.top
    best = sights.least
    s = 0.0
    blocks = 2
    k = 0
    # from here on, no point of the map can be seen under more than (top − own) ÷ s
    while k < MOST and s < end and top - own > best * s:
        held = IVec2(max(mapped.x, 0), max(mapped.y, 0))
        first = held
        side = 1
        highest = 2.0
        if blocks == 2:
            first = IVec2(held.x & -FAR, held.y & -FAR)
            side = FAR
            highest = corners(far, IVec2(held.x >> 6, held.y >> 6), 0).x
        elif blocks == 1:
            first = IVec2(held.x & -NEAR, held.y & -NEAR)
            side = NEAR
            highest = corners(near, IVec2(held.x >> 3, held.y >> 3), 0).x
        last = IVec2(min(first.x + side, extent.x) - 1, min(first.y + side, extent.y) - 1)
        if field.edge == "clamp":
            # beyond the border nothing changes along that axis
            first = IVec2(
                -BEYOND if forth.x == 0 and mapped.x < 0 else first.x,
                -BEYOND if forth.y == 0 and mapped.y < 0 else first.y,
            )
            last = IVec2(
                BEYOND if forth.x > 0 and mapped.x >= extent.x - 1 else last.x,
                BEYOND if forth.y > 0 and mapped.y >= extent.y - 1 else last.y,
            )
        # the block's first and last cells, and the walls that the line leaves through
        low = IVec2(cell.x + first.x - held.x, cell.y + first.y - held.y)
        high = IVec2(cell.x + last.x - held.x, cell.y + last.y - held.y)
        leave = Vec2(
            float(high.x + 1 if forth.x > 0 else low.x) * pace.x,
            float(high.y + 1 if forth.y > 0 else low.y) * pace.y,
        )
        out = max(min(leave.x, leave.y), s)
        if blocks == 0:
            best = over_a_cell(field, mapped, cell, way.along, s, out, own, best)
        if blocks == 0 or highest - own <= best * s:
            behind = IVec2(
                high.x + 1 if forth.x > 0 else low.x - 1, high.y + 1 if forth.y > 0 else low.y - 1
            )
            there = way.along * out
            nearer = IVec2(cell.x if forth.x > 0 else low.x, cell.y if forth.y > 0 else low.y)
            further = IVec2(high.x if forth.x > 0 else cell.x, high.y if forth.y > 0 else cell.y)
            beside = IVec2(
                min(max(int(floor(there.x)), nearer.x), further.x),
                min(max(int(floor(there.y)), nearer.y), further.y),
            )
            onward = IVec2(
                behind.x if leave.x <= leave.y else beside.x,
                behind.y if leave.y <= leave.x else beside.y,
            )
            before = held
            mapped = IVec2(
                cell_in_map(field, mapped.x + onward.x - cell.x, extent.x),
                cell_in_map(field, mapped.y + onward.y - cell.y, extent.y),
            )
            cell = onward
            s = out
            # where the line comes into a larger block, that may be clear as a whole
            crossed = (before.x ^ mapped.x) | (before.y ^ mapped.y)
            if (crossed & -FAR) != 0:
                blocks = 2
            elif (crossed & -NEAR) != 0:
                blocks = max(blocks, 1)
        else:
            blocks = blocks - 1
        k = k + 1
    cut = s < way.repeats and (s >= end or k >= MOST)
    return max(best, (top - own) / max(s, 1.0)) if cut else best


@shader
def over_a_cell(
    field: HeightField,
    mapped: IVec2,
    cell: IVec2,
    along: Vec2,
    enter: float,
    out: float,
    own: float,
    best: float,
) -> float:
    """The steepest sight of a line over one cell, from `enter` to `out`; at least `best`.

    The bilinear patch along a line is the parabola f + (g − f) t + bend (t − t²), t from 0 to 1.
    """
    four = corners(field, mapped, 0)
    offset = Vec2(float(cell.x), float(cell.y))
    middle = (enter + out) * 0.5
    f = rise(four, offset, along, enter) - own
    m = rise(four, offset, along, middle) - own
    g = rise(four, offset, along, out) - own
    bend = 4.0 * m - 2.0 * (f + g)
    found = max(best, g / max(out, 0.5))
    # the parabola lies below its ends and the point where its end tangents meet
    peak = (f + g + bend) * 0.5
    if bend > 0.0 and peak > found * middle:
        if enter <= 0.0:
            found = peak / max(middle, 0.25)
        else:
            way = out - enter
            gain = (g - f + bend) * enter - f * way
            root = sqrt(max(bend * bend * enter * enter + bend * way * gain, 0.0))
            t = saturate(gain / max(bend * enter + root, FLATTEST))
            found = max(found, (f + (g - f) * t + bend * (t - t * t)) / (enter + way * t))
    return found


@shader
def rise(four: Vec4, offset: Vec2, along: Vec2, s: float) -> float:
    """The height of a patch under a line, so many texels from the line's start."""
    return within(four, saturate(along.x * s - offset.x), saturate(along.y * s - offset.y))
