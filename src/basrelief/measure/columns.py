"""The first hits of rays on a height map whose texels are columns, in float64.

It is the reference of the technique `texel` alone, whose field is not that of `measure.oracle`. It
shares no code with the shaders and does not traverse cell by cell: it lists and sorts all walls
that a ray crosses, then tests the segments between them in order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, assert_never, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Edge = Literal["wrap", "clamp"]
"""Continuation beyond the map: repeat it, or extend its border."""


@dataclass(frozen=True, eq=False)
class ColumnHits:
    """First hits of rays on columns: `t` (n,) from 0 to 1, texture coordinates `uv` (n, 2), and
    `side` (n, 2), the direction that the hit side faces: −1 or 1 along one axis of texture
    coordinates, 0 and 0 on top.
    """

    t: Floats
    uv: Floats
    side: NDArray[np.int64]


def intersect_columns(
    heights: ArrayLike, uv: ArrayLike, travel: ArrayLike, edge: Edge = "wrap"
) -> ColumnHits:
    """First points at which rays are not above the column of the texel below them.

    `heights` (h, w) are 0 to 1. Rays start at `uv` (n, 2) at height 1 and move by `travel` (n, 2)
    while they fall to 0, both in texture coordinates. `edge` says how the map continues.
    Raises ValueError for another edge.
    """
    if edge not in get_args(Edge):
        raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
    field = np.asarray(heights, np.float64)
    start, moved = (np.atleast_2d(np.asarray(v, np.float64)) for v in (uv, travel))
    hits = [_first_hit(field, s, w, edge) for s, w in zip(start, moved, strict=True)]
    t = np.array([hit[0] for hit in hits])
    return ColumnHits(t, start + moved * t[:, None], np.array([hit[1] for hit in hits]))


def _first_hit(
    field: Floats, uv: Floats, travel: Floats, edge: Edge
) -> tuple[float, tuple[int, int]]:
    """The t of one ray's first hit, and the direction that the hit side faces."""
    texels = np.array(field.shape[::-1], np.float64)
    start, moved = uv * texels, travel * texels
    times, axes = _wall_crossings(start, moved)
    t_enter, t_exit = np.concatenate([[0.0], times]), np.concatenate([times, [1.0]])
    middles = start + moved * ((t_enter + t_exit) / 2)[:, None]
    heights = _column_heights(field, np.floor(middles).astype(np.int64), edge)
    through_side, from_above = 1.0 - t_enter <= heights, 1.0 - heights <= t_exit
    first = int(np.argmax(through_side | from_above))
    if through_side[first] and first > 0:
        faces = [0, 0]
        faces[axes[first - 1]] = -int(np.sign(moved[axes[first - 1]]))
        return float(t_enter[first]), (faces[0], faces[1])
    return float(max(1.0 - heights[first], 0.0)), (0, 0)


def _wall_crossings(start: Floats, moved: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """The t at which a ray crosses walls between texels, in order, and the axis of each wall."""
    times, axes = [], []
    for axis in (0, 1):
        if moved[axis] != 0.0:
            ends = sorted((start[axis], start[axis] + moved[axis]))
            walls = np.arange(np.floor(ends[0]) + 1, np.ceil(ends[1]))
            times.append((walls - start[axis]) / moved[axis])
            axes.append(np.full(len(walls), axis))
    if not times:
        return np.zeros(0), np.zeros(0, np.int64)
    all_times, all_axes = np.concatenate(times), np.concatenate(axes)
    order = np.argsort(all_times, kind="stable")
    return all_times[order], all_axes[order]


def _column_heights(field: Floats, texels: NDArray[np.int64], edge: Edge) -> Floats:
    height, width = field.shape
    x, y = texels.T
    match edge:
        case "wrap":
            x, y = x % width, y % height
        case "clamp":
            x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
        case _:
            assert_never(edge)
    heights: Floats = field[y, x]
    return heights
