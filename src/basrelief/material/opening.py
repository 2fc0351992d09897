"""A hole that opens in a surface: a crack map and a dust map merged into a height map.

After E. Nordeus (habrador, *Parallax mapping*, Unity tutorial), who merges two textures and varies
the strength of the dust. Here the ground sinks where the dust, times its strength, exceeds the
height of the cracks. Cracks therefore open first, along their centre lines and from the middle
of the dust outwards; the ground between them sinks later.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_decode, srgb_encode
from basrelief.images.resize import resized
from basrelief.material.material import Map, Material, Note

DEPTH = 0.3
"""Depth of the hole as a fraction of the tile's width: about half its own width."""

STRENGTH = 2.8
"""Strength of the dust in an open hole; from 1 on, full dust sinks ground without a crack too."""

SOFTNESS = 0.45
"""Excess of dust over cracks at which heights have fallen to 1/e; less makes steeper walls."""

_UNIT = 65535
"""The 16-bit code of 1."""


def hole(cracks: Material, dust: Material, opening: float) -> Material:
    """The surface of `cracks` with a hole where the heights of `dust` lie.

    As `opened`, for two materials. Raises InputError for height maps that are missing, too.
    """
    for material in (cracks, dust):
        if material.height is None:
            raise InputError(f"{material.name} has no height map, which a hole is made from")
    return opened(replace(cracks, dust=dust.height), opening)


def opened(material: Material, opening: float) -> Material:
    """A material with a hole where its dust lies; `opening` is 0 (whole) to 1 (open).

    With the material's own heights h, those of cracks, and the dust d, the heights are
    exp(−max(STRENGTH · opening · d − h, 0) ÷ SOFTNESS). At 0 they are all 1, and the cracks show in
    the colour alone. Heights never rise as the opening grows. The hole has the material's
    proportions, and as many texels as the larger of h and d.

    The base colour is darkened inside; one with fewer texels than the hole is enlarged. Normals and
    occlusion are omitted, since those of the cracks would be wrong; the renderer derives normals
    from the heights. Raises InputError for an opening outside 0 to 1, and without heights or dust.
    """
    if not 0 <= opening <= 1:
        raise InputError(f"a hole's opening is 0 (whole) to 1 (open), not {opening}")
    if material.height is None or material.dust is None:
        missing = "height" if material.height is None else "dust"
        raise InputError(f"{material.name} has no {missing} map, which a hole is made from")
    shape = _shape(material.height, material.dust, material.proportion)
    cracks = _resized(material.height.linear()[:, :, 0], shape)
    dust = _resized(material.dust.linear()[:, :, 0], shape)
    excess = dust * np.float32(STRENGTH * opening) - cracks
    np.maximum(excess, 0, out=excess)
    excess *= np.float32(-1 / SOFTNESS)
    height = np.exp(excess, out=excess)
    codes = np.rint(height * np.float32(_UNIT)).astype(np.uint16)
    color, name = material.base_color, f"hole in {material.name}"
    return replace(
        material,
        name=name,
        base_color=None if color is None else _darkened(color, height),
        normal=None,
        height=Map(codes[:, :, None], False, f"{name}, height"),
        occlusion=None,
        dust=None,
        depth=None if material.tile is None else DEPTH * material.tile,
        notes=(*material.notes, Note(f"opened by {opening:g}", f"by {material.dust.source}")),
    )


def _shape(cracks: Map, dust: Map, proportion: float) -> tuple[int, int]:
    """Height and width of a hole, at a proportion of width to height."""
    texels = dust.width * dust.height
    if texels <= cracks.width * cracks.height:
        return cracks.height, cracks.width
    height = max(1, round(math.sqrt(texels / proportion)))
    return height, max(1, round(height * proportion))


def _resized(values: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Numbers (h, w) from 0 to 1 at another size, as 16-bit fractions where they are resized."""
    if values.shape == shape:
        return values
    codes = np.rint(np.clip(values, 0, 1) * np.float32(_UNIT)).astype(np.uint16)
    return resized(codes, shape).astype(np.float32) / np.float32(_UNIT)


def _darkened(color: Map, height: NDArray[np.float32]) -> Map:
    """A colour map times powers of the height in sRGB: 1½ for red, 2 for green, 2½ for blue.

    The rim turns brown, and the bottom black. The smaller of colour and heights is resized to the
    larger.
    """
    shape = (max(color.height, height.shape[0]), max(color.width, height.shape[1]))
    height = _resized(height, shape)
    if color.pixels.shape[:2] != shape:
        channels = np.moveaxis(color.linear(), 2, 0)
        light = np.stack([_resized(channel, shape) for channel in channels], 2)
        color = Map(light, False, color.source)
    root = np.sqrt(height)
    square = height * height
    encoded = color.pixels if color.srgb else srgb_encode(color.linear())
    pixels = np.empty(color.pixels.shape, np.float32)
    for channel, factor in enumerate((height * root, square, square * root)):
        np.multiply(encoded[:, :, channel], factor, out=pixels[:, :, channel])
    if not color.srgb:
        pixels = srgb_decode(pixels).astype(np.float32)
    elif color.pixels.dtype != np.float32:
        pixels = np.rint(pixels, out=pixels).astype(color.pixels.dtype)
    return Map(pixels, color.srgb, f"{color.source}, darkened")
