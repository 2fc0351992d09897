"""Height polarity and green direction, from the correlation of height and normal slopes.

Where heights rise to the right, normals lean to the left. Where heights rise towards the top of the
picture, normals lean down, if green is up. A negative correlation along x therefore shows that
the heights are depths; opposite signs along x and y show that green is down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGEST = 512
"""Largest side, in texels, at which maps are compared: slopes between single texels are noise."""

SIGNIFICANT = 0.25
"""Correlations beyond this are significant; those of unrelated maps are a few hundredths."""


@dataclass(frozen=True)
class SlopeCorrelation:
    """Correlations, −1 to 1, of height and normal slopes along x and along y.

    Both are positive where white is high and green is up.
    """

    x: float
    y: float

    @property
    def is_significant(self) -> bool:
        """Whether both maps describe the same relief, in whatever convention."""
        return abs(self.x) > SIGNIFICANT and abs(self.y) > SIGNIFICANT

    @property
    def heights_are_depths(self) -> bool:
        """Whether the slopes along x, which do not depend on green, are opposite."""
        return self.is_significant and self.x < 0

    @property
    def green_is_down(self) -> bool:
        """Whether the correlation along y has the opposite sign of that along x."""
        return self.is_significant and self.x * self.y < 0

    def __str__(self) -> str:
        return f"slopes correlate by {self.x:+.2f} along x and {self.y:+.2f} along y"


def slope_correlation(height: NDArray[Any], normal: NDArray[Any]) -> SlopeCorrelation | None:
    """Correlation of heights (h, w, 1) with normals (h, w, 3), stored 0 to 1.

    Sizes, types and units may differ. None where a map is flat or smaller than 4 texels.
    """
    rows = min(height.shape[0], normal.shape[0], LARGEST)
    columns = min(height.shape[1], normal.shape[1], LARGEST)
    if min(rows, columns) < 4:
        return None
    heights = _block_means(height[:, :, 0], rows, columns)
    most = {"uint8": 255, "uint16": 65535}.get(str(normal.dtype), 1)
    slopes_of_normals = [
        _block_means(normal[:, :, axis], rows, columns) / most * 2 - 1 for axis in (0, 1)
    ]
    rise_right = (np.roll(heights, -1, 1) - np.roll(heights, 1, 1))[1:-1, 1:-1]
    rise_up = (np.roll(heights, 1, 0) - np.roll(heights, -1, 0))[1:-1, 1:-1]
    x = _correlation(slopes_of_normals[0][1:-1, 1:-1], -rise_right)
    y = _correlation(slopes_of_normals[1][1:-1, 1:-1], -rise_up)
    return None if x is None or y is None else SlopeCorrelation(x, y)


def _block_means(values: NDArray[Any], rows: int, columns: int) -> NDArray[np.float64]:
    """Means over nearly equal blocks of texels, (rows, columns)."""
    return _row_means(_row_means(values, rows).T, columns).T


def _row_means(values: NDArray[Any], count: int) -> NDArray[np.float64]:
    """Means over `count` nearly equal blocks of rows."""
    height = len(values)
    if height % count:
        starts = np.arange(count) * height // count
        sums = np.add.reduceat(values, starts, axis=0, dtype=np.float64)
        sizes = np.diff(np.append(starts, height))
        return sums / sizes[:, None]
    size = height // count
    # ten times as fast as reduceat
    total = values[::size].astype(np.float64)
    for row in range(1, size):
        total += values[row::size]
    return total / size


def _correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float | None:
    a, b = a - a.mean(), b - b.mean()
    spread = float(np.sqrt((a * a).sum() * (b * b).sum()))
    return None if spread < 1e-12 else float((a * b).sum()) / spread
