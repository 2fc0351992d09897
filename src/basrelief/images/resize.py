"""Resizing of single channels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.uint16]


def resized(codes: Codes, shape: tuple[int, int]) -> Codes:
    """One channel (h, w) at another size: enlarged bilinearly, reduced to area averages.

    It wraps, so that it tiles seamlessly. Rows are resized before columns, and rounded in between.
    """
    values = codes
    for axis, target in enumerate(shape):
        count = values.shape[axis]
        if target > count:
            values = _enlarged(values, target, axis)
        elif target < count:
            values = _averaged(values, target, axis)
    return values


def _enlarged(values: Codes, target: int, axis: int) -> Codes:
    count = values.shape[axis]
    position = (np.arange(target) + 0.5) * count / target - 0.5
    first = np.floor(position).astype(int)
    weight = (position - first).reshape((-1, 1) if axis == 0 else (1, -1))
    a, b = (np.take(values, (first + k) % count, axis) for k in (0, 1))
    return _rounded(a * (1.0 - weight) + b * weight)


def _averaged(values: Codes, target: int, axis: int) -> Codes:
    """Means over an axis: texel i covers i · count ÷ target to (i + 1) · count ÷ target."""
    count = values.shape[axis]
    ends = np.arange(target + 1) * count / target
    first = np.floor(ends).astype(int)
    rest = (ends - first).reshape((-1, 1) if axis == 0 else (1, -1))
    sums = np.zeros([n + (k == axis) for k, n in enumerate(values.shape)])
    np.cumsum(values, axis, out=sums[1:] if axis == 0 else sums[:, 1:])
    partial = rest * np.take(values, np.minimum(first, count - 1), axis)
    below = np.take(sums, first, axis) + partial
    return _rounded(np.diff(below, axis=axis) * target / count)


def _rounded(values: NDArray[np.float64]) -> Codes:
    codes: Codes = np.rint(values).astype(np.uint16)
    return codes
