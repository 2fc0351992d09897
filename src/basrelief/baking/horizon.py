"""Bakes: heights → horizon maps, and heights → ambient occlusion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.texels import Heights, checked_heights, checked_scale, run
from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.lang import Buffer, HeightField, Vec2
from basrelief.lang.resources import Edge
from basrelief.techniques import horizon_bake as shaders

_MAX_CODE = 65535
_MAX_TILES = 8
"""Tiles after which a line that does not repeat is truncated."""
_OCCLUSION_TILES = 1.0
"""Tiles beyond which nothing occludes the sky."""
_MIN_TANGENT = 0.004
"""Smallest tangent of a horizon that counts; lower ones hide less than 0.1 % of the sky."""


def horizon_map(
    heights: Heights,
    edge: Edge,
    scale: float,
    directions: int = 8,
    device: str | Engine = "cpu",
) -> NDArray[np.uint16]:
    """Bake the horizon map of a height map: the elevation of the horizon around each texel.

    Light from direction k, with the unit vector L in tangent space, arrives where L.z is above the
    stored sine. The map is conservative: no point of the bilinear surface along a direction lies
    above its horizon, up to 2.5e-7 of the height range per texel. The horizon is too high by that
    and one code at most; a line in an oblique direction that does not repeat within 8 tiles is
    truncated there, and its horizon is too high by what could rise beyond. Nothing is guaranteed
    between the directions.

    Parameters
    ----------
    heights
        (h, w), 0 to 1, with square texels.
    edge
        "wrap" or "clamp".
    scale
        The whole height range as a fraction of the map's width, at least 0.
    directions
        Number of directions n. Direction k points 360° · k ÷ n from +u towards the top of the
        picture: for 8 right, up right, up and so on.
    device
        As in `render`.

    Returns
    -------
    array
        (h, w, directions) uint16: the sine of the elevation, 0 to 1 as 0 to 65535, rounded up.

    Raises
    ------
    InputError
        For other heights, edges and scales, and without a direction.

    References
    ----------
    N. Max, Horizon Mapping: Shadows for Bump-Mapped Surfaces, 1988.
    """
    heights = checked_heights(heights, edge)
    horizons = np.empty((*heights.shape, _count(directions)), np.uint16)
    engine, values = engine_of(device), _values(heights, edge, scale, shaders.SLOPE_ERROR)
    for k, direction in enumerate(_directions(heights.shape, edge, directions)):
        buffer = Buffer([direction])
        planes = run(shaders.horizon, heights, edge, engine, directions=buffer, **values)
        horizons[:, :, k] = np.ceil(planes["sine"].astype(np.float64) * _MAX_CODE)
    return horizons


def ambient_occlusion(
    heights: Heights,
    edge: Edge,
    scale: float,
    directions: int = 16,
    device: str | Engine = "cpu",
) -> NDArray[np.float32]:
    """Bake the ambient occlusion of a height map: the fraction of a uniform sky that it receives.

    Directions are weighted by the cosine to the normal of `normal_map`; the relief is black and
    opaque. The result is the mean over directions of the visible slice between horizon and zenith,
    which is integrated in closed form: with horizon elevation e, normal n and its part n_d along
    the direction, max(n.z cos² e + n_d (π/2 − e − cos e sin e), 0). Horizons lower than a slope of
    0.004 count as flat, and nothing further away than a tile counts.

    Parameters
    ----------
    heights, edge, scale, directions, device
        As in `horizon_map`.

    Returns
    -------
    array
        (h, w) float32, 0 (no light) to 1.

    Raises
    ------
    InputError
        As in `horizon_map`.

    References
    ----------
    L. Bavoil, M. Sainz and R. Dimitrov, Image-Space Horizon-Based Ambient Occlusion, 2008.
    """
    heights = checked_heights(heights, edge)
    _count(directions)
    buffer = Buffer(_directions(heights.shape, edge, directions, _OCCLUSION_TILES))
    min_slope = _MIN_TANGENT / max(checked_scale(scale) * heights.shape[1], _MIN_TANGENT)
    values = _values(heights, edge, scale, max(min_slope, shaders.SLOPE_ERROR))
    engine = engine_of(device)
    planes = run(
        shaders.sky_visibility, heights, edge, engine, cost=directions, directions=buffer, **values
    )
    return planes["visibility"]


def _count(directions: int) -> int:
    if directions < 1:
        raise InputError(f"a horizon needs at least one direction, not {directions}")
    return directions


def _values(heights: Heights, edge: Edge, scale: float, min_slope: float) -> dict[str, Any]:
    rise = checked_scale(scale) * heights.shape[1]
    cells = _cell_maxima(heights, edge)
    return {
        "search": shaders.HorizonSearch(float(heights.max()), rise, min_slope),
        "near": HeightField([_block_maxima(cells, shaders.NEAR)], edge),
        "far": HeightField([_block_maxima(cells, shaders.FAR)], edge),
    }


def _cell_maxima(heights: Heights, edge: Edge) -> Heights:
    """Maximum of each cell: of a texel and those right, below, and below right of it."""
    for axis in (0, 1):
        neighbours = np.roll(heights, -1, axis)
        if edge == "clamp":
            neighbours[(slice(None),) * axis + (-1,)] = heights[(slice(None),) * axis + (-1,)]
        heights = np.maximum(heights, neighbours)
    return heights


def _block_maxima(cells: Heights, side: int) -> Heights:
    for axis in (0, 1):
        cells = np.maximum.reduceat(cells, range(0, cells.shape[axis], side), axis)
    return cells


def _directions(
    shape: tuple[int, ...], edge: Edge, directions: int, max_tiles: float = math.inf
) -> list[shaders.MapDirection]:
    return [
        _direction(shape, edge, 2.0 * math.pi * k / directions, max_tiles)
        for k in range(directions)
    ]


def _direction(
    shape: tuple[int, ...], edge: Edge, angle: float, max_tiles: float
) -> shaders.MapDirection:
    """Direction at an angle from +u towards the top; heights beyond `max_tiles` are ignored."""
    rows, columns = shape
    larger = max(rows, columns)
    max_length, longest = max_tiles * larger, float(_MAX_TILES * larger)
    # rounding makes axes and diagonals exact
    x, y = (round(part, 12) + 0.0 for part in (math.cos(angle), -math.sin(angle)))
    if edge == "clamp":
        # beyond the map along both axes, heights are constant
        exits = [side / abs(part) for side, part in ((columns, x), (rows, y)) if part]
        return shaders.MapDirection(Vec2(x, y), min(max(exits) + 1.0, max_length), longest)
    repeats = math.inf
    if y == 0.0:
        repeats = float(columns)
    elif x == 0.0:
        repeats = float(rows)
    elif abs(x) == abs(y):
        repeats = math.lcm(rows, columns) / abs(x)
    return shaders.MapDirection(Vec2(x, y), min(repeats, max_length), longest)
