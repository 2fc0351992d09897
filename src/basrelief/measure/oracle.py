"""The exact first hits of rays on the bilinear surface of a height map, in float64.

It shares no code with the shaders. Rays traverse the grid cell by cell (J. Amanatides and A. Woo,
A Fast Voxel Traversal Algorithm for Ray Tracing, 1987), all of them at once in NumPy. Along a ray a
bilinear patch is a quadratic, which is solved in each cell.

A ray is a segment with t from 0 to 1. Its texture coordinates are `uv + travel · t`, its height is
the parabola `height − drop · t − bend · t (1 − t)`. By default it falls straight from height 1 to
0, as over a flat surface; such a ray always hits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, assert_never, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Edge = Literal["wrap", "clamp"]
"""Continuation beyond the map: repeat it, or extend its border."""


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
    field = np.asarray(heights, np.float64)
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
    traversal = _Traversal(field, start * texels - 0.5, moved * texels, edge, *coefficients)
    t_hit = traversal.first_hits()
    t = np.where(np.isnan(t_hit), 1.0, t_hit)
    return Hits(
        t, start + moved * t[:, None], traversal.height_at(np.arange(len(t)), t), ~np.isnan(t_hit)
    )


class _Traversal:
    """Traversal state of rays, in texels: cell (i, j) lies between texel centres i and i + 1."""

    def __init__(
        self, field: Floats, start: Floats, travel: Floats, edge: Edge,
        height: Floats, drop: Floats, bend: Floats,
    ) -> None:  # fmt: skip
        self.field = field
        self.edge: Edge = edge
        self.start, self.travel = start, travel
        self.height, self.drop, self.bend = height, drop, bend
        count = len(start)
        self.cell: Ints = np.floor(start).astype(np.int64)
        self.t = np.zeros(count)
        # the side of a cell through which each ray leaves it
        self.sign: Ints = np.sign(travel).astype(np.int64)
        self.t_hit = np.full(count, np.nan)

    def first_hits(self) -> Floats:
        """The t of each ray's first hit, NaN where there is none."""
        active = np.arange(len(self.t))
        while len(active):
            active = self._cross_cell(active)
        return self.t_hit

    def height_at(self, rays: Ints, t: Floats) -> Floats:
        """Heights of rays at t."""
        descent: Floats = t * (self.drop[rays] + self.bend[rays] * (1.0 - t))
        height: Floats = self.height[rays] - descent
        return height

    def _cross_cell(self, rays: Ints) -> Ints:
        """Move rays through one cell each; returns the rays that continue."""
        t_enter = self.t[rays]
        t_exit, axis = self._cell_exits(rays)
        t_hit = self._patch_hits(rays, t_enter, t_exit)
        hit = ~np.isnan(t_hit)
        self.t_hit[rays[hit]] = t_hit[hit]
        going = ~hit & (t_exit < 1.0)
        self.t[rays[going]] = t_exit[going]
        self.cell[rays[going], axis[going]] += self.sign[rays[going], axis[going]]
        return rays[going]

    def _cell_exits(self, rays: Ints) -> tuple[Floats, Ints]:
        """The t at which each ray leaves its cell, at most 1, and the axis of that wall."""
        travel, sign = self.travel[rays], self.sign[rays]
        wall = self.cell[rays] + (sign > 0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            times = np.where(sign == 0, np.inf, (wall - self.start[rays]) / travel)
        axis = np.argmin(times, axis=1)
        t_exit = np.take_along_axis(times, axis[:, None], 1)[:, 0]
        return np.maximum(np.minimum(t_exit, 1.0), self.t[rays]), axis

    def _patch_hits(self, rays: Ints, t_enter: Floats, t_exit: Floats) -> Floats:
        """The first t in a cell at which a ray is not above the patch, NaN without one."""
        h00, h10, h01, h11 = self._corners(rays)
        x, y = (self.start[rays] + self.travel[rays] * t_enter[:, None] - self.cell[rays]).T
        dx, dy = self.travel[rays].T
        right, down, twist = h10 - h00, h01 - h00, h11 - h10 - h01 + h00
        # clearance(s) = a s² + b s + c for s = t − t_enter: the ray's height less the patch's
        a = self.bend[rays] - twist * dx * dy
        slope = self.drop[rays] + self.bend[rays] * (1.0 - 2.0 * t_enter)
        b = -slope - (right * dx + down * dy + twist * (x * dy + y * dx))
        c = self.height_at(rays, t_enter) - (h00 + right * x + down * y + twist * x * y)
        s = _first_root(a, b, c)
        span = t_exit - t_enter
        ends_below = c + span * (b + span * a) <= 0.0
        within = s <= span
        # where rounding hides the root of a ray that ends below the patch, take the exit
        t_hit = np.where(within, t_enter + s, np.where(ends_below, t_exit, np.nan))
        return np.where(c <= 0.0, t_enter, t_hit)

    def _corners(self, rays: Ints) -> tuple[Floats, Floats, Floats, Floats]:
        height, width = self.field.shape
        i, j = self.cell[rays].T
        match self.edge:
            case "wrap":
                columns, rows = (i % width, (i + 1) % width), (j % height, (j + 1) % height)
            case "clamp":
                columns = (np.clip(i, 0, width - 1), np.clip(i + 1, 0, width - 1))
                rows = (np.clip(j, 0, height - 1), np.clip(j + 1, 0, height - 1))
            case _:
                assert_never(self.edge)
        upper, lower = rows
        left, right = columns
        field = self.field
        return field[upper, left], field[upper, right], field[lower, left], field[lower, right]


def _first_root(a: Floats, b: Floats, c: Floats) -> Floats:
    """The smallest s ≥ 0 with a s² + b s + c = 0, for c > 0; infinite where there is none."""
    discriminant = b * b - 4.0 * a * c
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        half = -0.5 * (b + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), b))
        roots = np.stack([half / a, c / half])
    roots = np.where((roots >= 0.0) & (discriminant >= 0.0), roots, np.inf)
    smallest: Floats = roots.min(axis=0)
    return smallest
