"""Colour encoding: the sRGB curve, and light as integer codes."""

from __future__ import annotations

import functools
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)


def srgb_encode(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """sRGB code values, 0 to 1, of linear light, 0 to 1, by the exact piecewise curve.

    Source: IEC 61966-2-1:1999, *Default RGB colour space, sRGB*, with its four printed constants.
    Values below 0 follow the linear segment, values above 1 the power.
    """
    power = 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, power)


def srgb_decode(encoded: NDArray[np.floating]) -> NDArray[np.floating]:
    """Linear light, 0 to 1, of sRGB code values, 0 to 1; the inverse of `srgb_encode`."""
    power = ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, power)


@functools.cache
def srgb_thresholds(bits: int = 8) -> NDArray[np.float32]:
    """The least linear light of each sRGB code of 8 or 16 bits, (2^bits + 1,): below all light for
    0, and beyond all light for the last, which no light has."""
    exact = srgb_decode((np.arange(1, 2**bits) - 0.5) / (2**bits - 1))
    rounded = exact.astype(np.float32)
    least = np.where(rounded < exact, np.nextafter(rounded, np.float32(2)), rounded)
    return np.concatenate([[-1.0], least, [2.0]]).astype(np.float32)


def look_up(table: NDArray[_Number], codes: NDArray[Any]) -> NDArray[_Number]:
    """`table[codes]` of codes (h, …), some rows at a time: NumPy makes indices of 64 bits."""
    values = np.empty(codes.shape, table.dtype)
    for first in range(0, len(codes), _ROWS):
        values[first : first + _ROWS] = table[codes[first : first + _ROWS]]
    return values


_ROWS = 64
"""Rows that are looked up at once."""


def encode_light(linear: NDArray[np.floating], bits: int = 8) -> NDArray[Any]:
    """Integer codes of light (h, w, 3 or 4): colours sRGB-encoded, alpha linear; NaN is black."""
    largest = 2**bits - 1
    light = np.clip(np.nan_to_num(linear, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    encoded = light.copy()
    encoded[:, :, :3] = srgb_encode(light[:, :, :3])
    codes: NDArray[Any] = np.floor(encoded * largest + 0.5).astype(np.int32)
    # the power is rounded: the thresholds are exact
    colors, thresholds = codes[:, :, :3], srgb_thresholds(bits)
    colors -= light[:, :, :3] < thresholds[colors]
    colors += light[:, :, :3] >= thresholds[colors + 1]
    return codes.astype(np.uint8 if bits == 8 else np.uint16)
