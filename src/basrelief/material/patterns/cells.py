"""Periodic Voronoi cells around the points of a jittered grid, with distances to their borders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.material.patterns.canvas import Canvas, Plane


@dataclass(frozen=True, eq=False)
class Cells:
    """The cell of each texel. Lengths are in widths of a grid square.

    `row` and `column` identify the cell, (`x`, `y`) is the offset from the cell's point to the
    texel, and `border` the distance to the nearest border, with rounded corners.
    """

    row: NDArray[np.int32]
    column: NDArray[np.int32]
    x: Plane
    y: Plane
    border: Plane
    count: tuple[int, int]
    random: np.random.Generator

    def per_cell(self, values: NDArray[Any]) -> NDArray[np.float32]:
        """Values by (row, column) of a cell, at each texel."""
        spread: NDArray[np.float32] = values.astype(np.float32)[self.row, self.column]
        return spread

    def draw(self, low: float, high: float) -> Plane:
        """A random number per cell, at each texel."""
        return self.per_cell(self.random.uniform(low, high, self.count))


def cells(
    canvas: Canvas, name: str, across: int, *, jitter: float = 0.35, roundness: float = 0.03
) -> Cells:
    """Cells around points up to `jitter` from the centres of a grid of `across` squares per row.

    `roundness` is the radius of the rounded corners. Every second row is shifted by half a square,
    as in laid stones.
    """
    down = canvas.rows(across, even=True)
    random = canvas.random(name)
    grid = _Grid(random.uniform(-jitter, jitter, (2, down, across)))
    gx = canvas.x * across + _RIPPLE * canvas.noise(f"{name} x", across * 2, octaves=3)
    gy = canvas.y * np.float32(down * canvas.width / canvas.height)
    gy = gy + _RIPPLE * canvas.noise(f"{name} y", across * 2, octaves=3)
    bands = [
        grid.locate(gx[top : top + _BAND], gy[top : top + _BAND], roundness)
        for top in range(0, canvas.height, _BAND)
    ]
    row, column, x, y, border = (np.concatenate(planes) for planes in zip(*bands, strict=True))
    return Cells(row % down, column % across, x, y, border, (down, across), random)


_RIPPLE = np.float32(0.05)
"""Amplitude of the distortion of borders, in grid squares."""

_BAND = 32
"""Rows processed at once, so that the working set stays in the processor's cache."""

_MARGIN = 4
"""Cells repeated around the grid, so that neighbours need no wrapping."""


class _Grid:
    """Points of a jittered grid with a margin of repeated points, numbered row by row."""

    def __init__(self, jitter_offsets: NDArray[np.float64]) -> None:
        down, across = jitter_offsets.shape[1:]
        rows = np.arange(-_MARGIN, down + _MARGIN)[:, None]
        columns = np.arange(-_MARGIN, across + _MARGIN)[None, :]
        offset_x, offset_y = jitter_offsets[:, rows % down, columns % across]
        self.shift = ((rows[:, 0] % 2) * 0.5).astype(np.float32)
        self.stride = columns.size
        self.x = (columns + self.shift[:, None] + 0.5 + offset_x).astype(np.float32).ravel()
        self.y = (rows + 0.5 + offset_y).astype(np.float32).ravel()

    def locate(self, gx: Plane, gy: Plane, roundness: float) -> tuple[NDArray[Any], ...]:
        """Row and column of the nearest point, the offset from it, the distance to the border."""
        point = self.nearest(gx, gy)
        x, y = gx - self.x[point], gy - self.y[point]
        row, column = point // self.stride - _MARGIN, point % self.stride - _MARGIN
        return row, column, x, y, self.border(gx, gy, point, x, y, roundness)

    def nearest(self, gx: Plane, gy: Plane) -> NDArray[np.int32]:
        """The number of the nearest point among the nine squares around."""
        least = np.full(gx.shape, np.inf, np.float32)
        best = np.zeros(gx.shape, np.int32)
        for row_step in (-1, 0, 1):
            row = np.floor(gy).astype(np.int32) + (_MARGIN + row_step)
            column = np.floor(gx - self.shift[row]).astype(np.int32) + _MARGIN
            middle = row * self.stride + column
            for column_step in (-1, 0, 1):
                point = middle + column_step
                x, y = gx - self.x[point], gy - self.y[point]
                square = x * x + y * y
                closer = square < least
                least = np.where(closer, square, least)
                best = np.where(closer, point, best)
        return best

    def border(
        self, gx: Plane, gy: Plane, point: NDArray[np.int32], x: Plane, y: Plane, roundness: float
    ) -> Plane:
        """Smooth minimum of the distances to the borders with the neighbouring cells.

        −roundness · log Σ exp(−distance/roundness), which rounds the corners between two borders
        (I. Quilez, *Smooth Voronoi*, 2014; here over the distances to the bisectors).
        """
        total = np.zeros(gx.shape, np.float32)
        for row_step in (-2, -1, 0, 1, 2):
            reach = 1 if abs(row_step) == 2 else 2
            for column_step in range(-reach, reach + 1):
                if row_step == column_step == 0:
                    continue
                other = point + (row_step * self.stride + column_step)
                x2, y2 = gx - self.x[other], gy - self.y[other]
                dx, dy = x2 - x, y2 - y
                away = (dx * (x + x2) + dy * (y + y2)) / (2 * np.sqrt(dx * dx + dy * dy))
                total += np.exp(np.maximum(away, -1) * np.float32(-1 / roundness))
        return np.float32(-roundness) * np.log(np.maximum(total, np.float32(1e-30)))
