"""Packing of maps for a page: mip level 0, channel by channel; the page computes the others."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

Channels = NDArray[np.uint16]
"""(h, w, c): fractions of 65535."""
_UNIT = 65535


def packed(pixels: Channels) -> dict[str, Any]:
    """A picture of 16-bit channels, packed: size, channels, and the content as base64.

    A constant channel is stored as its value, a copy of an earlier channel as that one's number. A
    channel of at most 256 values has a palette and an index per texel. Indices and all other values
    are differences from the texel before; of 16-bit differences the low bytes come first.
    """
    height, width, count = pixels.shape
    channels, parts = [], []
    for number in range(count):
        values = pixels[:, :, number]
        original = next((k for k in range(number) if np.array_equal(values, pixels[:, :, k])), None)
        description, part = (
            _packed_channel(values.ravel()) if original is None else ({"same": original}, b"")
        )
        channels.append(description)
        parts.append(part)
    content = base64.b64encode(zlib.compress(b"".join(parts), 6)).decode()
    return {"width": width, "height": height, "channels": channels, "content": content}


def _packed_channel(values: NDArray[np.uint16]) -> tuple[dict[str, Any], bytes]:
    palette, indices = np.unique(values, return_inverse=True)
    if len(palette) == 1:
        return {"constant": int(palette[0])}, b""
    if len(palette) <= 256:
        codes = indices.astype(np.uint8)
        return {"palette": palette.tolist()}, np.diff(codes, prepend=np.uint8(0)).tobytes()
    steps = np.diff(values, prepend=np.uint16(0))
    low, high = (steps & 0xFF).astype(np.uint8), (steps >> 8).astype(np.uint8)
    return {}, low.tobytes() + high.tobytes()


def as_fractions(heights: NDArray[np.float32]) -> Channels:
    """Heights, (h, w), as 16-bit fractions, (h, w, 1); exact for maps of 8 and of 16 bits."""
    return np.rint(heights.astype(np.float64) * _UNIT).astype(np.uint16)[:, :, None]
