"""The first hit of rays on a height map whose texels are boxes, in float64.

Another field than `measure.oracle`'s, for the technique `texel` alone. It shares no code with the
shaders, and is no walk: all walls that a ray crosses are listed and sorted, and the pieces between
them tried in their order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, assert_never, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Edge = Literal["wrap", "clamp"]
"""What lies beyond the map: the same again, or its border going on."""


@dataclass(frozen=True, eq=False)
class ColumnHits:
    """Where rays meet boxes first: `t` (n,) from 0 to 1, texture coordinates (n, 2), and `side`
    (n, 2), −1 or 1 along the axis of texture coordinates that the met side faces, 0 and 0 on top.
    """

    t: Floats
    uv: Floats
    side: NDArray[np.int64]


def intersect_columns(
    heights: ArrayLike, uv: ArrayLike, travel: ArrayLike, edge: Edge = "wrap"
) -> ColumnHits:
    """The first place at which each ray is not above the box of the texel that it is over.

    `heights` (h, w) within 0 to 1; `uv` (n, 2) where the rays are at height 1; `travel` (n, 2) how
    far they move while they fall to 0; `edge` what lies beyond the map.
    Raises ValueError for another edge.
    """
    if edge not in get_args(Edge):
        raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
    field = np.asarray(heights, np.float64)
    start, way = (np.atleast_2d(np.asarray(v, np.float64)) for v in (uv, travel))
    met = [_first(field, s, w, edge) for s, w in zip(start, way, strict=True)]
    t = np.array([each[0] for each in met])
    return ColumnHits(t, start + way * t[:, None], np.array([each[1] for each in met]))


def _first(field: Floats, uv: Floats, travel: Floats, edge: Edge) -> tuple[float, tuple[int, int]]:
    """When one ray meets a box, and which way the side faces."""
    texels = np.array(field.shape[::-1], np.float64)
    start, way = uv * texels, travel * texels
    times, axes = _walls(start, way)
    begins, ends = np.concatenate([[0.0], times]), np.concatenate([times, [1.0]])
    middles = start + way * ((begins + ends) / 2)[:, None]
    tops = _tops(field, np.floor(middles).astype(np.int64), edge)
    through_side, from_above = 1.0 - begins <= tops, 1.0 - tops <= ends
    first = int(np.argmax(through_side | from_above))
    if through_side[first] and first > 0:
        faces = [0, 0]
        faces[axes[first - 1]] = -int(np.sign(way[axes[first - 1]]))
        return float(begins[first]), (faces[0], faces[1])
    return float(max(1.0 - tops[first], 0.0)), (0, 0)


def _walls(start: Floats, way: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """When a ray crosses walls between texels, in order, and along which axis each."""
    times, axes = [], []
    for axis in (0, 1):
        if way[axis] != 0.0:
            ends = sorted((start[axis], start[axis] + way[axis]))
            walls = np.arange(np.floor(ends[0]) + 1, np.ceil(ends[1]))
            times.append((walls - start[axis]) / way[axis])
            axes.append(np.full(len(walls), axis))
    if not times:
        return np.zeros(0), np.zeros(0, np.int64)
    all_times, all_axes = np.concatenate(times), np.concatenate(axes)
    order = np.argsort(all_times, kind="stable")
    return all_times[order], all_axes[order]


def _tops(field: Floats, texels: NDArray[np.int64], edge: Edge) -> Floats:
    height, width = field.shape
    x, y = texels.T
    match edge:
        case "wrap":
            x, y = x % width, y % height
        case "clamp":
            x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
        case _:
            assert_never(edge)
    tops: Floats = field[y, x]
    return tops
