"""The exact first hits of rays on the bilinear surface of a height map, in float64.

It shares no code with the shaders. Rays traverse the grid cell by cell (J. Amanatides and A. Woo,
A Fast Voxel Traversal Algorithm for Ray Tracing, 1987), thousands of them at once in NumPy. Along a
ray a bilinear patch is a quadratic, which is solved in each cell unless the ray stays above the
highest of the cell's corners.

A ray is a segment with t from 0 to 1. Its texture coordinates are `uv + travel · t`, its height is
the parabola `height − drop · t − bend · t (1 − t)`. By default it falls straight from height 1 to
0, as over a flat surface; such a ray always hits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, assert_never, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from basrelief.threads import map_on_threads

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Edge = Literal["wrap", "clamp"]
"""Continuation beyond the map: repeat it, or extend its border."""
_CHUNK = 1 << 15
"""Rays that a thread traces at once. With fewer, operations of NumPy are so short that threads wait
for Python's lock; with more, they wait for memory."""
_MARGIN = 1e-9
"""Clearance above a cell, as a share of the largest coordinate or height, from which on rounding
can hide no hit in it: a million times the rounding of 64 bits."""
_TEXELS_A_RAY = 1 << 11
"""Texels whose cells are compared with their neighbours in the time that this saves a ray."""


@dataclass(frozen=True, eq=False)
class Hits:
    """First hits of n rays on a height field.

    Attributes
    ----------
    t : ndarray of float64, shape (n,)
        Position along the ray, 0 to 1; 1 for a ray without a hit.
    uv : ndarray of float64, shape (n, 2)
        Texture coordinates at `t`, not wrapped into one tile.
    height : ndarray of float64, shape (n,)
        Height of the ray at `t`.
    found : ndarray of bool, shape (n,)
        Whether the ray hits.
    """

    t: Floats
    uv: Floats
    height: Floats
    found: NDArray[np.bool_]


def intersect_height_field(
    heights: ArrayLike,
    uv: ArrayLike,
    travel: ArrayLike,
    edge: Edge = "wrap",
    *,
    height: ArrayLike = 1.0,
    drop: ArrayLike = 1.0,
    bend: ArrayLike = 0.0,
) -> Hits:
    """First points at which rays are not above the bilinear surface of a height map.

    Parameters
    ----------
    heights : array_like, shape (h, w)
        Heights, 0 to 1; texel i of N has its centre at (i + ½) ÷ N.
    uv : array_like, shape (n, 2)
        Texture coordinates at which the rays start.
    travel : array_like, shape (n, 2)
        Change of the texture coordinates from t = 0 to 1.
    edge : {"wrap", "clamp"}
        Continuation beyond the map.
    height, drop, bend : array_like, shape () or (n,)
        Coefficients of the rays' heights, `height − drop · t − bend · t (1 − t)`.

    Returns
    -------
    Hits

    Raises
    ------
    ValueError
        For heights outside 0 to 1, values that are not finite, and another edge.

    References
    ----------
    J. Amanatides and A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987.
    """
    field = np.asarray(heights)
    # 32 bits store the heights of pictures exactly, in half the memory
    field = field if field.dtype == np.float32 else field.astype(np.float64, copy=False)
    start, moved = (np.atleast_2d(np.asarray(v, np.float64)) for v in (uv, travel))
    coefficients = [
        np.broadcast_to(np.asarray(v, np.float64), len(start)) for v in (height, drop, bend)
    ]
    if not all(np.isfinite(v).all() for v in (field, start, moved, *coefficients)):
        raise ValueError("heights and rays must be finite")
    if field.min() < 0.0 or field.max() > 1.0:
        raise ValueError(f"heights from {field.min():g} to {field.max():g}: give 0 to 1")
    if edge not in get_args(Edge):
        raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
    texels = np.array(field.shape[::-1], np.float64)
    surface = _Surface(field, edge, len(start))

    def chunk_hits(first: int) -> Floats:
        chunk = slice(first, first + _CHUNK)
        rays = _Rays.at_start(
            start[chunk] * texels - 0.5, moved[chunk] * texels, *(v[chunk] for v in coefficients)
        )
        return _first_hits(rays, surface)

    chunks = map_on_threads(chunk_hits, range(0, len(start), _CHUNK))
    t_hit = np.concatenate([np.empty(0), *chunks])
    t = np.where(np.isnan(t_hit), 1.0, t_hit)
    return Hits(t, start + moved * t[:, None], _ray_height(t, *coefficients), ~np.isnan(t_hit))


class _Surface:
    """The bilinear surface; cell (i, j) lies between texel centres i and i + 1, j and j + 1."""

    def __init__(self, field: NDArray[np.floating], edge: Edge, ray_count: int) -> None:
        self.field, self.edge = field, edge
        # of each cell, row by row; for a few rays they would cost more than they save
        self.highest = self._highest_corners() if ray_count * _TEXELS_A_RAY > field.size else None

    def _highest_corners(self) -> NDArray[np.floating]:
        match self.edge:
            case "wrap":
                padded = np.pad(self.field, (0, 1), "wrap")
            case "clamp":
                padded = np.pad(self.field, 1, "edge")
            case _:
                assert_never(self.edge)
        highest = np.maximum(padded[:, :-1], padded[:, 1:])
        return np.maximum(highest[:-1], highest[1:])

    def are_below(self, cell: Floats, height: Floats) -> NDArray[np.bool_]:
        """Whether cells, (2, n), are sure to be below heights, (n,)."""
        if self.highest is None:
            return np.zeros(height.shape, np.bool_)
        # border texels continue beyond the map: there is one more row and one more column of cells
        first = 1 if self.edge == "clamp" else 0
        (i, j), (rows, columns) = cell.astype(np.int64) + first, self.highest.shape
        index = self._inside(j, rows) * columns + self._inside(i, columns)
        below: NDArray[np.bool_] = self.highest.ravel()[index] < height
        return below

    def corner_heights(self, cell: Floats) -> list[Floats]:
        """Heights at (i, j), (i + 1, j), (i, j + 1) and (i + 1, j + 1) of cells, (2, n)."""
        (i, j), (height, width) = cell.astype(np.int64), self.field.shape
        columns = self._inside(i, width), self._inside(i + 1, width)
        rows = self._inside(j, height), self._inside(j + 1, height)
        return [self.field[row, column].astype(np.float64) for row in rows for column in columns]

    def _inside(self, index: Ints, count: int) -> Ints:
        """Indices along an axis within the map."""
        match self.edge:
            case "wrap":
                # the remainder, by a division that NumPy vectorizes
                return index - index // count * count
            case "clamp":
                return np.clip(index, 0, count - 1)
            case _:
                assert_never(self.edge)


@dataclass(eq=False)
class _Rays:
    """Rays on their way from cell to cell; coordinates, (2, n), are in texels, x before y.

    `ahead` leads from a cell to the wall through which its ray leaves it: 0 or 1, infinite for a
    ray that does not move along that axis. `t` is the point of entry, `level` the height there.
    """

    number: Ints
    start: Floats
    travel: Floats
    height: Floats
    drop: Floats
    bend: Floats
    cell: Floats
    step: Floats
    ahead: Floats
    t: Floats
    level: Floats

    @classmethod
    def at_start(
        cls, start: Floats, travel: Floats, height: Floats, drop: Floats, bend: Floats
    ) -> _Rays:
        """Rays in their first cells; `start` and `travel` are (n, 2)."""
        start, travel = np.ascontiguousarray(start.T), np.ascontiguousarray(travel.T)
        ahead = np.where(travel == 0.0, np.copysign(np.inf, travel), travel > 0.0)
        t = np.zeros(len(height))
        return cls(
            np.arange(len(t)), start, travel, height, drop, bend,
            np.floor(start), np.sign(travel), ahead, t, _ray_height(t, height, drop, bend),
        )  # fmt: skip

    def take(self, which: Ints) -> _Rays:
        """Some of the rays."""
        return _Rays(*(value.take(which, axis=-1) for value in vars(self).values()))

    def cell_exits(self) -> tuple[Floats, NDArray[np.bool_]]:
        """The t at which rays leave their cells, at most 1, and whether through a wall of x."""
        with np.errstate(over="ignore"):
            x, y = (self.cell + self.ahead - self.start) / self.travel
        return np.maximum(np.minimum(np.minimum(x, y), 1.0), self.t), x <= y

    def cross(self, t: Floats, level: Floats, through_x: NDArray[np.bool_]) -> None:
        """Move the rays into their next cells."""
        self.cell[0] += self.step[0] * through_x
        self.cell[1] += self.step[1] * ~through_x
        self.t, self.level = t, level


def _first_hits(rays: _Rays, surface: _Surface) -> Floats:
    """The t of each ray's first hit, NaN where there is none."""
    t_hit = np.full(len(rays.number), np.nan)
    sizes = [np.abs(v).max() for v in (rays.start, rays.travel, rays.height, rays.drop, rays.bend)]
    margin, is_bent = _MARGIN * max(1.0, *sizes), rays.bend.any()
    while len(rays.number):
        finished = np.zeros(len(rays.number), np.bool_)
        # dropping rays costs as much as several cells
        while 8 * np.count_nonzero(finished) <= len(finished):
            t_exit, through_x = rays.cell_exits()
            level = _ray_height(t_exit, rays.height, rays.drop, rays.bend)
            lowest = np.minimum(rays.level, level)
            if is_bent:
                # a parabola is below its chord by at most bend ÷ 4 · (length of the chord)²
                lowest -= 0.25 * np.abs(rays.bend) * (t_exit - rays.t) ** 2
            near = np.flatnonzero(~(surface.are_below(rays.cell, lowest - margin) | finished))
            hits = _patch_hits(rays.take(near), t_exit[near], surface)
            t_hit[rays.number[near]] = hits
            finished[near] = ~np.isnan(hits)
            finished |= t_exit >= 1.0
            rays.cross(t_exit, level, through_x)
        rays = rays.take(np.flatnonzero(~finished))
    return t_hit


def _ray_height(t: Floats, height: Floats, drop: Floats, bend: Floats) -> Floats:
    """Heights of rays at t."""
    level: Floats = height - t * (drop + bend * (1.0 - t))
    return level


def _patch_hits(rays: _Rays, t_exit: Floats, surface: _Surface) -> Floats:
    """The first t in a cell at which a ray is not above the patch, NaN without one."""
    h00, h10, h01, h11 = surface.corner_heights(rays.cell)
    x, y = rays.start + rays.travel * rays.t - rays.cell
    dx, dy = rays.travel
    right, down, twist = h10 - h00, h01 - h00, h11 - h10 - h01 + h00
    # clearance(s) = a s² + b s + c for s = t − t_enter: the ray's height less the patch's
    a = rays.bend - twist * dx * dy
    slope = rays.drop + rays.bend * (1.0 - 2.0 * rays.t)
    b = -slope - (right * dx + down * dy + twist * (x * dy + y * dx))
    c = rays.level - (h00 + right * x + down * y + twist * x * y)
    s = _first_root(a, b, c)
    span = t_exit - rays.t
    ends_below = c + span * (b + span * a) <= 0.0
    within = s <= span
    # where rounding hides the root of a ray that ends below the patch, take the exit
    t_hit = np.where(within, rays.t + s, np.where(ends_below, t_exit, np.nan))
    return np.where(c <= 0.0, rays.t, t_hit)


def _first_root(a: Floats, b: Floats, c: Floats) -> Floats:
    """The smallest s ≥ 0 with a s² + b s + c = 0, for c > 0; infinite where there is none."""
    discriminant = b * b - 4.0 * a * c
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        half = -0.5 * (b + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), b))
        roots = np.stack([half / a, c / half])
    roots = np.where((roots >= 0.0) & (discriminant >= 0.0), roots, np.inf)
    smallest: Floats = roots.min(axis=0)
    return smallest
