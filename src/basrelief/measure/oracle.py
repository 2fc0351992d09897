"""The exact first hit of rays on the bilinear surface of a height map, in float64.

It shares no code with the shaders: cells are walked one by one along each ray (J. Amanatides and
A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987), and in each the bilinear patch is
solved as the quadratic that it is along a line. Rays are walked side by side in NumPy.

A ray falls from height 1 at t = 0 to height 0 at t = 1; its texture coordinates are
`uv + fall · t`. Heights lie within 0 to 1, so every ray ends on the surface or above it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, assert_never, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Edge = Literal["wrap", "clamp"]
"""What lies beyond the map: the same again, or its border going on."""


@dataclass(frozen=True, eq=False)
class Hits:
    """Where rays meet the surface first: `t` (n,) from 0 to 1, and texture coordinates (n, 2)."""

    t: Floats
    uv: Floats

    @property
    def height(self) -> Floats:
        """The ray's height there, (n,): 1 − t."""
        return 1.0 - self.t


def first_hits(heights: ArrayLike, uv: ArrayLike, fall: ArrayLike, edge: Edge = "wrap") -> Hits:
    """The first place at which each ray is not above the surface.

    `heights` (h, w) within 0 to 1, texel centres at (i + ½) ÷ N; `uv` (n, 2) where the rays are at
    height 1; `fall` (n, 2) how far they move while they fall to 0; `edge` what lies beyond the map.
    Raises ValueError for heights outside 0 to 1, for what is not finite, and for another edge.
    """
    field = np.asarray(heights, np.float64)
    start, way = (np.atleast_2d(np.asarray(v, np.float64)) for v in (uv, fall))
    if not (np.isfinite(field).all() and np.isfinite(start).all() and np.isfinite(way).all()):
        raise ValueError("heights and rays must be finite")
    if field.min() < 0.0 or field.max() > 1.0:
        raise ValueError(f"heights from {field.min():g} to {field.max():g}: give 0 to 1")
    if edge not in get_args(Edge):
        raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
    texels = np.array(field.shape[::-1], np.float64)
    walk = _Walk(field, start * texels - 0.5, way * texels, edge)
    t = walk.to_the_end()
    return Hits(t, start + way * t[:, None])


class _Walk:
    """Rays on their way, in texels: cell (i, j) lies between texel centres i and i + 1."""

    def __init__(self, field: Floats, start: Floats, way: Floats, edge: Edge) -> None:
        self.field = field
        self.edge: Edge = edge
        self.start, self.way = start, way
        count = len(start)
        self.cell: Ints = np.floor(start).astype(np.int64)
        self.t = np.zeros(count)
        # towards which side of a cell each ray leaves it
        self.sign: Ints = np.sign(way).astype(np.int64)
        self.found = np.full(count, np.nan)

    def to_the_end(self) -> Floats:
        """Walk until every ray has met the surface."""
        under_way = np.arange(len(self.t))
        while len(under_way):
            self._cross_one_cell(under_way)
            under_way = under_way[np.isnan(self.found[under_way])]
        return self.found

    def _cross_one_cell(self, rays: Ints) -> None:
        enter = self.t[rays]
        leave, axis = self._exits(rays)
        met = self._meeting(rays, enter, leave)
        hit = ~np.isnan(met)
        # at t = 1 the ray is at height 0, which nothing lies below
        ended = ~hit & (leave >= 1.0)
        self.found[rays[hit]] = met[hit]
        self.found[rays[ended]] = 1.0
        on = rays[~hit & ~ended]
        along = axis[~hit & ~ended]
        self.t[on] = leave[~hit & ~ended]
        self.cell[on, along] += self.sign[on, along]

    def _exits(self, rays: Ints) -> tuple[Floats, Ints]:
        """Where each ray leaves its cell, at most 1, and across which axis."""
        way, sign = self.way[rays], self.sign[rays]
        wall = self.cell[rays] + (sign > 0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            times = np.where(sign == 0, np.inf, (wall - self.start[rays]) / way)
        axis = np.argmin(times, axis=1)
        leave = np.take_along_axis(times, axis[:, None], 1)[:, 0]
        return np.maximum(np.minimum(leave, 1.0), self.t[rays]), axis

    def _meeting(self, rays: Ints, enter: Floats, leave: Floats) -> Floats:
        """The first t within a cell at which the ray is not above the patch, NaN where it is."""
        h00, h10, h01, h11 = self._corners(rays)
        x, y = (self.start[rays] + self.way[rays] * enter[:, None] - self.cell[rays]).T
        dx, dy = self.way[rays].T
        right, down, twist = h10 - h00, h01 - h00, h11 - h10 - h01 + h00
        # clearance(s) = a s² + b s + c for s = t − enter: the ray's height less the patch's
        a = -twist * dx * dy
        b = -1.0 - (right * dx + down * dy + twist * (x * dy + y * dx))
        c = (1.0 - enter) - (h00 + right * x + down * y + twist * x * y)
        s = _first_root(a, b, c)
        span = leave - enter
        past = c + span * (b + span * a) <= 0.0
        within = s <= span
        # where rounding hides the root of a ray that ends below, the far wall is the place
        met = np.where(within, enter + s, np.where(past, leave, np.nan))
        return np.where(c <= 0.0, enter, met)

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
    """The least s ≥ 0 with a s² + b s + c = 0, for c > 0; infinite where there is none."""
    inside = b * b - 4.0 * a * c
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        half = -0.5 * (b + np.copysign(np.sqrt(np.maximum(inside, 0.0)), b))
        roots = np.stack([half / a, c / half])
    roots = np.where((roots >= 0.0) & (inside >= 0.0), roots, np.inf)
    least: Floats = roots.min(axis=0)
    return least
