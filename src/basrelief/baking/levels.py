"""Mip levels of a height map: each half the size of the one before, texels are area averages."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_ROWS = 16
"""Rows that are averaged at once."""


def levels_of(heights: NDArray[Any]) -> list[NDArray[np.float32]]:
    """All mip levels of a height map (h, w), from the map itself down to 1 × 1."""
    levels = [np.ascontiguousarray(heights, np.float32)]
    while max(levels[-1].shape) > 1:
        levels.append(halved(levels[-1]))
    return levels


def halved(level: NDArray[Any]) -> NDArray[np.float32]:
    """The next mip level: sides ⌊n ÷ 2⌋, at least 1, each texel an area average."""
    height, width = level.shape[:2]
    if height % 2:
        return _halved_along(_halved_along(level, 0), 1)
    # a few rows at a time: they stay in the processor's cache, and take no memory to speak of
    next_level = np.empty((height // 2, max(width // 2, 1), *level.shape[2:]), np.float32)
    for first in range(0, height // 2, _ROWS):
        rows = _halved_along(level[2 * first : 2 * (first + _ROWS)], 0)
        next_level[first : first + _ROWS] = _halved_along(rows, 1)
    return next_level


def _halved_along(level: NDArray[Any], axis: int) -> NDArray[np.float32]:
    n = level.shape[axis]
    if n == 1:
        return np.asarray(level, np.float32)
    m = n // 2
    parts = [
        level[tuple(slice(k, k + 2 * m - 1, 2) if a == axis else slice(None) for a in (0, 1))]
        for k in range(2 if n % 2 == 0 else 3)
    ]
    if n % 2 == 0:
        mean: NDArray[np.float32] = (parts[0].astype(np.float32) + parts[1]) * np.float32(0.5)
        return mean
    # an odd side: each new texel covers two old ones and a fraction of a third
    step = np.arange(m, dtype=np.float32)
    shape = [1] * level.ndim
    shape[axis] = m
    weights = [(m - step) / n, np.full(m, m / n, np.float32), (step + 1) / n]
    total = np.zeros(parts[0].shape, np.float32)
    for part, weight in zip(parts, weights, strict=True):
        total += part * weight.reshape(shape).astype(np.float32)
    return total
