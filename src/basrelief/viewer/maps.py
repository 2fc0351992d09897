"""Maps as a page holds them: the finest level, channel by channel, packed; the page halves it."""

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
    """A picture of 16-bit channels: size, channels, and the packed numbers as text.

    A channel of one value is that value, one that is like another before it is that one's number.
    One of at most 256 values is a list of them and an index for each texel, in differences from the
    texel before; any other is in differences too, the low bytes of all texels first.
    """
    height, width, count = pixels.shape
    channels, parts = [], []
    for number in range(count):
        values = pixels[:, :, number]
        like = next((k for k in range(number) if np.array_equal(values, pixels[:, :, k])), None)
        told, part = _packed_channel(values.ravel()) if like is None else ({"same": like}, b"")
        channels.append(told)
        parts.append(part)
    content = base64.b64encode(zlib.compress(b"".join(parts), 6)).decode()
    return {"width": width, "height": height, "channels": channels, "content": content}


def _packed_channel(values: NDArray[np.uint16]) -> tuple[dict[str, Any], bytes]:
    known, places = np.unique(values, return_inverse=True)
    if len(known) == 1:
        return {"constant": int(known[0])}, b""
    if len(known) <= 256:
        index = places.astype(np.uint8)
        return {"palette": known.tolist()}, np.diff(index, prepend=np.uint8(0)).tobytes()
    steps = np.diff(values, prepend=np.uint16(0))
    low, high = (steps & 0xFF).astype(np.uint8), (steps >> 8).astype(np.uint8)
    return {}, low.tobytes() + high.tobytes()


def as_fractions(heights: NDArray[np.float32]) -> Channels:
    """Heights, (h, w), as 16-bit fractions, (h, w, 1): exact for maps of 8 and of 16 bits."""
    return np.rint(heights.astype(np.float64) * _UNIT).astype(np.uint16)[:, :, None]
