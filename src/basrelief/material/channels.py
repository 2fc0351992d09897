"""From the pixels of a file to the channels of a map; whole numbers stay whole numbers."""

from __future__ import annotations

from typing import Any, Literal, assert_never, get_args

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import Picture

Channel = Literal["r", "g", "b", "a", "luminance"]
NormalPacking = Literal["rgb", "ag", "rg"]

Pixels = NDArray[Any]


def most(pixels: Pixels) -> int:
    """The stored value that stands for 1."""
    return {"uint8": 255, "uint16": 65535}.get(str(pixels.dtype), 1)


def one_channel(picture: Picture, channel: str) -> Pixels:
    """One channel of a picture, (height, width, 1): "r", "g", "b", "a", or "luminance" (Rec. 709).

    A grey picture answers with its one channel to all but "a". Raises InputError when there is no
    such channel.
    """
    if channel not in get_args(Channel):
        raise InputError(f"channel is one of {', '.join(get_args(Channel))}, not {channel!r}")
    if channel == "a":
        if picture.alpha is None:
            raise InputError(f"{picture.path}: has no alpha channel; choose another channel")
        return np.ascontiguousarray(picture.alpha)
    color = picture.opaque
    if color.shape[2] == 1:
        return np.ascontiguousarray(color)
    if channel == "luminance":
        weights = np.array([0.2126, 0.7152, 0.0722], np.float32)  # ITU-R BT.709-6 (2015), 3.2
        bright = color[:, :, :3].astype(np.float32) @ weights[: color.shape[2]]
        linear: Pixels = bright[:, :, None] / np.float32(most(color))
        return linear
    at = "rgb".index(channel)
    if at >= color.shape[2]:
        raise InputError(f"{picture.path}: has no channel {channel}; choose another channel")
    return np.ascontiguousarray(color[:, :, at : at + 1])


def three_channels(picture: Picture) -> Pixels:
    """Colours, (height, width, 3); grey is repeated, the alpha left out."""
    color = _divided_by_alpha(picture) if picture.path.suffix.lower() == ".exr" else picture.opaque
    if color.shape[2] < 3:
        return np.repeat(color[:, :, :1], 3, axis=2)
    return np.ascontiguousarray(color[:, :, :3])


def _divided_by_alpha(picture: Picture) -> Pixels:
    """OpenEXR stores colours multiplied by their alpha; where that is 0 they stay as they are."""
    if picture.alpha is None:
        return picture.opaque
    divided: Pixels = picture.opaque / np.where(picture.alpha > 0, picture.alpha, np.float32(1))
    return divided


def normals(picture: Picture, packing: NormalPacking) -> Pixels:
    """Normals, (height, width, 3), stored 0 to 1 for −1 to 1.

    `packing` "rgb": as stored; "rg": x in the first channel, y in the second; "ag": x in the
    alpha, y in green (DXT5nm). The last two rebuild z from the unit length. Floats that reach
    below 0 are taken for −1 to 1. Raises InputError when the channels are not there.
    """
    match packing:
        case "ag":
            x, y = one_channel(picture, "a"), one_channel(picture, "g")
        case "rg":
            _check_count(picture, picture.pixels.shape[2], 2)
            x, y = picture.pixels[:, :, 0:1], picture.pixels[:, :, 1:2]
        case "rgb":
            _check_count(picture, picture.opaque.shape[2], 3)
            return _unsigned(np.ascontiguousarray(picture.opaque[:, :, :3]))
        case _:
            assert_never(packing)
    return _with_z(_unsigned(np.concatenate([x, y], axis=2)))


def _check_count(picture: Picture, count: int, needed: int) -> None:
    if count < needed:
        raise InputError(
            f"{picture.path}: {picture.pixels.shape[2]} channels make no normal map;"
            " if it holds heights, name it with --height FILE"
        )


def _unsigned(pixels: Pixels) -> Pixels:
    if pixels.dtype == np.float32 and float(pixels.min()) < -0.01:
        return pixels * np.float32(0.5) + np.float32(0.5)
    return pixels


def _with_z(xy: Pixels) -> Pixels:
    scale = most(xy)
    leaning = xy.astype(np.float32) / np.float32(scale) * 2 - 1
    z = np.sqrt(np.maximum(1 - (leaning * leaning).sum(axis=2, keepdims=True), 0)) * 0.5 + 0.5
    z = z if scale == 1 else np.rint(z * scale)
    return np.concatenate([xy, z.astype(xy.dtype)], axis=2)


def inverted(pixels: Pixels) -> Pixels:
    """1 − value, exact for integers."""
    turned: Pixels = (np.asarray(most(pixels), pixels.dtype) - pixels).astype(pixels.dtype)
    return turned


def with_green_turned(pixels: Pixels) -> Pixels:
    """Normals with the other direction of green."""
    turned = pixels.copy()
    turned[:, :, 1] = inverted(pixels[:, :, 1])
    return turned


def stretched(pixels: Pixels) -> Pixels:
    """Values stretched to fill 0 to 1, float32; a constant becomes itself, clipped to 0 to 1."""
    values = pixels.astype(np.float64) / most(pixels)
    low, high = values.min(), values.max()
    if high <= low:
        low, high = 0.0, 1.0
    filled: Pixels = np.clip((values - low) / (high - low), 0, 1).astype(np.float32)
    return filled


def constant(pixels: Pixels) -> bool:
    """Is every value the same?"""
    return bool((pixels == pixels.flat[0]).all())
