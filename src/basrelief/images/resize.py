"""Resizing of single channels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.uint16]


def resized(codes: Codes, shape: tuple[int, int]) -> Codes:
    """One channel (h, w), resized bilinearly to `shape`; it wraps, so that it tiles seamlessly.

    Rows are resized before columns, and rounded in between.
    """
    values = codes
    for axis, target in enumerate(shape):
        count = values.shape[axis]
        if count == target:
            continue
        position = (np.arange(target) + 0.5) * count / target - 0.5
        first = np.floor(position).astype(int)
        weight = (position - first).reshape((-1, 1) if axis == 0 else (1, -1))
        a, b = (np.take(values, (first + k) % count, axis) for k in (0, 1))
        values = np.rint(a * (1.0 - weight) + b * weight).astype(np.uint16)
    return values
