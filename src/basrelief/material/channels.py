"""Extraction of map channels from image files; integer pixels stay integers."""

from __future__ import annotations

from typing import Any, Literal, assert_never, get_args

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import Picture

Channel = Literal["r", "g", "b", "a", "luminance"]
NormalPacking = Literal["rgb", "ag", "rg"]

Pixels = NDArray[Any]


def max_code(pixels: Pixels) -> int:
    """The stored value that represents 1."""
    return {"uint8": 255, "uint16": 65535}.get(str(pixels.dtype), 1)


def extract_channel(picture: Picture, channel: str) -> Pixels:
    """One channel of a picture, (height, width, 1): "r", "g", "b", "a", or "luminance" (Rec. 709).

    A grey picture gives its one channel for every name but "a". Raises InputError for a channel
    that the picture lacks.
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
        luminance = color[:, :, :3].astype(np.float32) @ weights[: color.shape[2]]
        linear: Pixels = luminance[:, :, None] / np.float32(max_code(color))
        return linear
    index = "rgb".index(channel)
    if index >= color.shape[2]:
        raise InputError(f"{picture.path}: has no channel {channel}; choose another channel")
    return np.ascontiguousarray(color[:, :, index : index + 1])


def extract_rgb(picture: Picture) -> Pixels:
    """Colours, (height, width, 3), without alpha; grey is repeated in all three channels."""
    color = _divided_by_alpha(picture) if picture.path.suffix.lower() == ".exr" else picture.opaque
    if color.shape[2] < 3:
        return np.repeat(color[:, :, :1], 3, axis=2)
    return np.ascontiguousarray(color[:, :, :3])


def _divided_by_alpha(picture: Picture) -> Pixels:
    """Colours with OpenEXR's premultiplied alpha divided out; unchanged where alpha is 0."""
    if picture.alpha is None:
        return picture.opaque
    divided: Pixels = picture.opaque / np.where(picture.alpha > 0, picture.alpha, np.float32(1))
    return divided


def extract_normals(picture: Picture, packing: NormalPacking) -> Pixels:
    """Normals, (height, width, 3), each component of −1 to 1 stored as 0 to 1.

    `packing` is "rgb", x, y and z as stored; "rg", x in the first channel and y in the second; or
    "ag", x in alpha and y in green (DXT5nm). The last two reconstruct z from the unit length.
    Floats with values below 0 are read as −1 to 1. Raises InputError for missing channels.
    """
    match packing:
        case "ag":
            x, y = extract_channel(picture, "a"), extract_channel(picture, "g")
        case "rg":
            _check_count(picture, picture.pixels.shape[2], 2)
            x, y = picture.pixels[:, :, 0:1], picture.pixels[:, :, 1:2]
        case "rgb":
            _check_count(picture, picture.opaque.shape[2], 3)
            return _to_unit_range(np.ascontiguousarray(picture.opaque[:, :, :3]))
        case _:
            assert_never(packing)
    return _with_z(_to_unit_range(np.concatenate([x, y], axis=2)))


def _check_count(picture: Picture, count: int, needed: int) -> None:
    if count < needed:
        raise InputError(
            f"{picture.path}: {picture.pixels.shape[2]} channels make no normal map;"
            " if it holds heights, name it with --height FILE"
        )


def _to_unit_range(pixels: Pixels) -> Pixels:
    if pixels.dtype == np.float32 and float(pixels.min()) < -0.01:
        return pixels * np.float32(0.5) + np.float32(0.5)
    return pixels


def _with_z(xy: Pixels) -> Pixels:
    scale = max_code(xy)
    signed_xy = xy.astype(np.float32) / np.float32(scale) * 2 - 1
    z = np.sqrt(np.maximum(1 - (signed_xy * signed_xy).sum(axis=2, keepdims=True), 0)) * 0.5 + 0.5
    z = z if scale == 1 else np.rint(z * scale)
    return np.concatenate([xy, z.astype(xy.dtype)], axis=2)


def inverted(pixels: Pixels) -> Pixels:
    """1 − value, exact for integers."""
    result: Pixels = (np.asarray(max_code(pixels), pixels.dtype) - pixels).astype(pixels.dtype)
    return result


def with_green_flipped(pixels: Pixels) -> Pixels:
    """Normals with green inverted, from up to down or back."""
    flipped = pixels.copy()
    flipped[:, :, 1] = inverted(pixels[:, :, 1])
    return flipped


def stretched(pixels: Pixels) -> Pixels:
    """Values stretched to fill 0 to 1, float32; a constant map is only clipped to 0 to 1."""
    values = pixels.astype(np.float64) / max_code(pixels)
    low, high = values.min(), values.max()
    if high <= low:
        low, high = 0.0, 1.0
    unit: Pixels = np.clip((values - low) / (high - low), 0, 1).astype(np.float32)
    return unit


def is_constant(pixels: Pixels) -> bool:
    """Whether all values are equal."""
    return bool((pixels == pixels.flat[0]).all())
