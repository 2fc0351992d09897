"""Colour encoding: the sRGB curve, and light as integer codes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


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


def encode_light(linear: NDArray[np.floating], bits: int = 8) -> NDArray[Any]:
    """Integer codes of light (h, w, 3 or 4): colours sRGB-encoded, alpha linear; NaN is black."""
    largest = 2**bits - 1
    light = np.clip(np.nan_to_num(linear, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    light[:, :, :3] = srgb_encode(light[:, :, :3])
    codes: NDArray[Any] = np.rint(light * largest).astype(np.uint8 if bits == 8 else np.uint16)
    return codes
