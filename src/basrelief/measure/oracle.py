"""The exact first hit of rays on the bilinear surface of a height map, in float64.

It shares no code with the shaders: cells are walked one by one along each ray (J. Amanatides and
A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, 1987), and in each the bilinear patch is
solved as the quadratic that it is along a line. Rays are walked side by side in NumPy.

A ray is a segment with t from 0 to 1: texture coordinates `uv + travel · t`, and the height
`height − drop · t − bend · t (1 − t)`, a parabola. By default it falls straight from height 1
to 0, as over a flat surface, where every ray ends on the surface or above it.
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
    """Where rays meet the surface first: `t` (n,) from 0 to 1, texture coordinates `uv` (n, 2), the
    ray's `height` there (n,), and whether it was `found` (n,): if not, the ray ends at t = 1."""

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
    """The first place at which each ray is not above the surface.

    `heights` (h, w) within 0 to 1, texel centres at (i + ½) ÷ N; `uv` (n, 2) where the rays begin,
    `travel` (n, 2) how far they move; `edge` what lies beyond the map; `height`, `drop` and `bend`,
    one for all rays or (n,), what a ray's height is. Raises ValueError for heights outside 0 to 1,
    for what is not finite, and for another edge.
    """
    field = np.asarray(heights, np.float64)
    start, way = (np.atleast_2d(np.asarray(v, np.float64)) for v in (uv, travel))
    falls = [np.broadcast_to(np.asarray(v, np.float64), len(start)) for v in (height, drop, bend)]
    if not all(np.isfinite(v).all() for v in (field, start, way, *falls)):
        raise ValueError("heights and rays must be finite")
    if field.min() < 0.0 or field.max() > 1.0:
        raise ValueError(f"heights from {field.min():g} to {field.max():g}: give 0 to 1")
    if edge not in get_args(Edge):
        raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
    texels = np.array(field.shape[::-1], np.float64)
    walk = _Walk(field, start * texels - 0.5, way * texels, edge, *falls)
    met = walk.to_the_end()
    t = np.where(np.isnan(met), 1.0, met)
    return Hits(t, start + way * t[:, None], walk.height_at(np.arange(len(t)), t), ~np.isnan(met))


class _Walk:
    """Rays on their way, in texels: cell (i, j) lies between texel centres i and i + 1."""

    def __init__(
        self, field: Floats, start: Floats, way: Floats, edge: Edge,
        height: Floats, drop: Floats, bend: Floats,
    ) -> None:  # fmt: skip
        self.field = field
        self.edge: Edge = edge
        self.start, self.way = start, way
        self.height, self.drop, self.bend = height, drop, bend
        count = len(start)
        self.cell: Ints = np.floor(start).astype(np.int64)
        self.t = np.zeros(count)
        # towards which side of a cell each ray leaves it
        self.sign: Ints = np.sign(way).astype(np.int64)
        self.found = np.full(count, np.nan)

    def to_the_end(self) -> Floats:
        """Walk until each ray has met the surface, at the t that is returned, or ended: NaN."""
        under_way = np.arange(len(self.t))
        while len(under_way):
            under_way = self._cross_one_cell(under_way)
        return self.found

    def height_at(self, rays: Ints, t: Floats) -> Floats:
        """The height of rays at t."""
        lost: Floats = t * (self.drop[rays] + self.bend[rays] * (1.0 - t))
        height: Floats = self.height[rays] - lost
        return height

    def _cross_one_cell(self, rays: Ints) -> Ints:
        """Take rays through their cells; returns those that go on."""
        enter = self.t[rays]
        leave, axis = self._exits(rays)
        met = self._meeting(rays, enter, leave)
        hit = ~np.isnan(met)
        self.found[rays[hit]] = met[hit]
        on = ~hit & (leave < 1.0)
        self.t[rays[on]] = leave[on]
        self.cell[rays[on], axis[on]] += self.sign[rays[on], axis[on]]
        return rays[on]

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
        a = self.bend[rays] - twist * dx * dy
        falling = self.drop[rays] + self.bend[rays] * (1.0 - 2.0 * enter)
        b = -falling - (right * dx + down * dy + twist * (x * dy + y * dx))
        c = self.height_at(rays, enter) - (h00 + right * x + down * y + twist * x * y)
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
