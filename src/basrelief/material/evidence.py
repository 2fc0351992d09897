"""Do a normal map and a height map tell of the same relief, and which way round?

Where heights rise to the right, the normals of a surface lean to the left; where heights rise
towards the top of the picture, they lean down, if green is up. So the slopes of both maps,
compared over the picture, show a green that points down, and heights that are depths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGEST = 512
"""Both maps are shrunk to this many texels a side at most: slopes of single texels are noise."""

CLEAR = 0.25
"""A correlation beyond this is taken for a fact; unrelated maps stay within a few hundredths."""


@dataclass(frozen=True)
class Agreement:
    """Correlations, −1 to 1, of the slopes along x and along y, if heights and green are up."""

    x: float
    y: float

    @property
    def clear(self) -> bool:
        """Do both maps tell of the same relief at all, whichever way round?"""
        return abs(self.x) > CLEAR and abs(self.y) > CLEAR

    @property
    def heights_are_depths(self) -> bool:
        """The slopes along x, which no convention of green touches, run against each other."""
        return self.clear and self.x < 0

    @property
    def green_is_down(self) -> bool:
        """The slopes along y disagree with those along x."""
        return self.clear and self.x * self.y < 0

    def __str__(self) -> str:
        return f"slopes correlate by {self.x:+.2f} along x and {self.y:+.2f} along y"


def agreement(height: NDArray[Any], normal: NDArray[Any]) -> Agreement | None:
    """Compare heights (h, w, 1) with normals (h, w, 3), stored 0 to 1; sizes may differ.

    Any unit of the heights and any integer or float scale of both will do. None where either is
    flat or too small to judge.
    """
    rows = min(height.shape[0], normal.shape[0], LARGEST)
    columns = min(height.shape[1], normal.shape[1], LARGEST)
    if min(rows, columns) < 4:
        return None
    heights = _shrink(height[:, :, 0], rows, columns)
    most = {"uint8": 255, "uint16": 65535}.get(str(normal.dtype), 1)
    lean = [_shrink(normal[:, :, axis], rows, columns) / most * 2 - 1 for axis in (0, 1)]
    rise_right = (np.roll(heights, -1, 1) - np.roll(heights, 1, 1))[1:-1, 1:-1]
    rise_up = (np.roll(heights, 1, 0) - np.roll(heights, -1, 0))[1:-1, 1:-1]
    x = _correlation(lean[0][1:-1, 1:-1], -rise_right)
    y = _correlation(lean[1][1:-1, 1:-1], -rise_up)
    return None if x is None or y is None else Agreement(x, y)


def _shrink(values: NDArray[Any], rows: int, columns: int) -> NDArray[np.float64]:
    """Means over blocks of texels, (rows, columns), blocks as even as can be."""
    row_starts = np.arange(rows) * values.shape[0] // rows
    column_starts = np.arange(columns) * values.shape[1] // columns
    sums = np.add.reduceat(values, row_starts, axis=0, dtype=np.float64)
    sums = np.add.reduceat(sums, column_starts, axis=1)
    row_counts = np.diff(np.append(row_starts, values.shape[0]))
    column_counts = np.diff(np.append(column_starts, values.shape[1]))
    means: NDArray[np.float64] = sums / (row_counts[:, None] * column_counts)
    return means


def _correlation(one: NDArray[np.float64], other: NDArray[np.float64]) -> float | None:
    one, other = one - one.mean(), other - other.mean()
    spread = float(np.sqrt((one * one).sum() * (other * other).sum()))
    return None if spread < 1e-12 else float((one * other).sum()) / spread
