"""Heights → horizons, and the light of the sky that comes over them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.texels import Heights, checked, checked_scale, run
from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.lang import Buffer, HeightField, Vec2
from basrelief.lang.resources import Edge
from basrelief.techniques import horizon_bake as shaders

_MOST = 65535
_TILES = 8
"""Tiles after which a line that never comes to the same heights again is cut short."""
_SEEN = 1.0
"""Tiles beyond which nothing takes from the light of the sky."""
_LOWEST = 0.004
"""Tangents of horizons that take too little of the sky to be looked for: less than 0.1 %."""


def horizon_map(
    heights: Heights,
    edge: Edge,
    scale: float,
    directions: int = 8,
    device: str | Engine = "cpu",
) -> NDArray[np.uint16]:
    """How high the relief stands around each texel: (h, w, directions) uint16.

    Of heights (h, w), 0 to 1, with square texels, whose whole range is `scale` widths of the map;
    `edge` ("wrap" or "clamp") says what lies beyond it. Direction k of n points 360° · k ÷ n from
    +u (right) towards the top of the picture: of 8 they are right, right and up, up, and so on.
    Stored is the sine of the horizon's elevation above the level, 0 to 1 as 0 to 65535, rounded up:
    light that comes from direction k, with L its unit vector, arrives where L.z is above it.

    Conservative: no point of the bilinear surface along that direction stands above the stored
    horizon, but for rises of less than 2.5e-7 of the height range in a texel. It is too high by as
    much and one code at most, or, where a line in a slanted direction never comes to the same
    heights again, by what could stand more than 8 tiles away. Between the directions nothing is
    promised. After N. Max, Horizon Mapping: Shadows for Bump-Mapped Surfaces, 1988.
    Raises InputError for other heights, edges and scales, and without a direction.
    """
    heights = checked(heights, edge)
    made = np.empty((*heights.shape, _count(directions)), np.uint16)
    engine, values = engine_of(device), _values(heights, edge, scale, shaders.SLOPE_ERROR)
    for k, way in enumerate(_ways(heights.shape, edge, directions)):
        ways = Buffer([way])
        planes = run(shaders.horizon, heights, edge, engine, directions=ways, **values)
        made[:, :, k] = np.ceil(planes["sine"].astype(np.float64) * _MOST)
    return made


def ambient_occlusion(
    heights: Heights,
    edge: Edge,
    scale: float,
    directions: int = 16,
    device: str | Engine = "cpu",
) -> NDArray[np.float32]:
    """The share of a uniform sky's light that each texel gets, 0 (none) to 1: (h, w) float32.

    `heights`, `edge`, `scale` and the order of directions as in `horizon_map`. Each way out
    weighs as its cosine to the normal of `normal_map`; the relief is black and lets no light
    through. The estimator is the mean over evenly spread directions of the slice between horizon
    and zenith, which is integrated in closed form: with horizon elevation e, normal n and n_d
    its part along the direction, max(n.z cos² e + n_d (π/2 − e − cos e sin e), 0). Horizons lower
    than a slope of 0.004 count as level, and nothing further off than a tile counts.
    After L. Bavoil, M. Sainz and R. Dimitrov, Image-Space Horizon-Based Ambient Occlusion, 2008.
    Raises InputError as `horizon_map`.
    """
    heights = checked(heights, edge)
    _count(directions)
    ways = Buffer(_ways(heights.shape, edge, directions, _SEEN))
    least = _LOWEST / max(checked_scale(scale) * heights.shape[1], _LOWEST)
    values = _values(heights, edge, scale, max(least, shaders.SLOPE_ERROR))
    engine = engine_of(device)
    planes = run(
        shaders.sky_visibility, heights, edge, engine, effort=directions, directions=ways, **values
    )
    return planes["visibility"]


def _count(directions: int) -> int:
    if directions < 1:
        raise InputError(f"a horizon needs at least one direction, not {directions}")
    return directions


def _values(heights: Heights, edge: Edge, scale: float, least: float) -> dict[str, Any]:
    rise = checked_scale(scale) * heights.shape[1]
    cells = _highest_of_cells(heights, edge)
    return {
        "search": shaders.HorizonSearch(float(heights.max()), rise, least),
        "near": HeightField([_highest_of_blocks(cells, shaders.NEAR)], edge),
        "far": HeightField([_highest_of_blocks(cells, shaders.FAR)], edge),
    }


def _highest_of_cells(heights: Heights, edge: Edge) -> Heights:
    """The highest point between each texel's centre and those to the right, below, and both."""
    for axis in (0, 1):
        beside = np.roll(heights, -1, axis)
        if edge == "clamp":
            beside[(slice(None),) * axis + (-1,)] = heights[(slice(None),) * axis + (-1,)]
        heights = np.maximum(heights, beside)
    return heights


def _highest_of_blocks(cells: Heights, side: int) -> Heights:
    for axis in (0, 1):
        cells = np.maximum.reduceat(cells, range(0, cells.shape[axis], side), axis)
    return cells


def _ways(
    shape: tuple[int, ...], edge: Edge, directions: int, seen: float = math.inf
) -> list[shaders.MapDirection]:
    return [_way(shape, edge, 2.0 * math.pi * k / directions, seen) for k in range(directions)]


def _way(shape: tuple[int, ...], edge: Edge, angle: float, seen: float) -> shaders.MapDirection:
    """The way at an angle from +u towards the top; what lies beyond so many tiles is not there."""
    rows, columns = shape
    larger = max(rows, columns)
    seen, longest = seen * larger, float(_TILES * larger)
    # the axes and the diagonals exactly
    x, y = (round(part, 12) + 0.0 for part in (math.cos(angle), -math.sin(angle)))
    if edge == "clamp":
        # outside along both axes the heights no longer change
        out = [side / abs(part) for side, part in ((columns, x), (rows, y)) if part]
        return shaders.MapDirection(Vec2(x, y), min(max(out) + 1.0, seen), longest)
    repeats = math.inf
    if y == 0.0:
        repeats = float(columns)
    elif x == 0.0:
        repeats = float(rows)
    elif abs(x) == abs(y):
        repeats = math.lcm(rows, columns) / abs(x)
    return shaders.MapDirection(Vec2(x, y), min(repeats, seen), longest)
