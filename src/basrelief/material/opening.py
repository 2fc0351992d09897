"""A hole that opens in a surface: a crack map and a dust map merged into a height map.

After E. Nordeus (habrador, *Parallax mapping*, Unity tutorial), who merges two textures and varies
the strength of the dust. Here a threshold merges them: the ground sinks where crack and dust
together exceed a limit. Cracks therefore open first, along their centre lines and from the middle
of the dust outwards; the ground between them sinks later.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.material.material import Map, Material, Note

DEPTH = 0.3
"""Depth of the hole as a fraction of the tile's width: about half its own width."""

STRENGTH = 2.8
"""Strength of the dust in an open hole; from 1 on, full dust sinks ground without a crack too."""

SOFTNESS = 0.45
"""Excess over the limit at which heights have fallen to 1/e; less makes steeper walls."""


def hole(cracks: Material, dust: Material, opening: float) -> Material:
    """The surface of `cracks` with a hole where `dust` lies; `opening` is 0 (whole) to 1 (open).

    With the crack heights h and the dust heights d, the heights are
    exp(−max(STRENGTH · opening · d − h, 0) ÷ SOFTNESS). At 0 they are all 1, and the cracks show in
    the colour alone. Heights never rise as the opening grows.

    The base colour is darkened inside. Normals and occlusion are omitted, since those of the cracks
    would be wrong; the renderer derives normals from the heights. Raises InputError for an opening
    outside 0 to 1, and for height maps that are missing or differ in size.
    """
    if not 0 <= opening <= 1:
        raise InputError(f"a hole's opening is 0 (whole) to 1 (open), not {opening}")
    crack_heights, dust_heights = _heights(cracks), _heights(dust)
    if crack_heights.shape != dust_heights.shape:
        first, second = (
            " × ".join(map(str, m.shape[1::-1])) for m in (crack_heights, dust_heights)
        )
        raise InputError(
            f"a hole needs cracks and dust of one size, not {first} and {second} texels"
        )
    excess = dust_heights * np.float32(STRENGTH * opening) - crack_heights
    np.maximum(excess, 0, out=excess)
    excess *= np.float32(-1 / SOFTNESS)
    height = np.exp(excess, out=excess)
    codes = np.rint(height * np.float32(65535)).astype(np.uint16)
    return replace(
        cracks,
        name=f"hole in {cracks.name}",
        base_color=None if cracks.base_color is None else _darkened(cracks.base_color, height),
        normal=None,
        height=Map(codes[:, :, None], False, f"hole in {cracks.name}, height"),
        occlusion=None,
        depth=None if cracks.tile is None else DEPTH * cracks.tile,
        notes=(*cracks.notes, Note(f"opened by {opening:g}", f"dust from {dust.name}")),
    )


def _heights(material: Material) -> NDArray[np.float32]:
    if material.height is None:
        raise InputError(f"{material.name} has no height map, which a hole is made from")
    return material.height.linear()[:, :, 0]


def _darkened(color: Map, height: NDArray[np.float32]) -> Map:
    """A colour map times powers of the height: 1½ for red, 2 for green, 2½ for blue.

    The rim turns brown, and the bottom black.
    """
    root = np.sqrt(height)
    square = height * height
    pixels = np.empty(color.pixels.shape, np.float32)
    for channel, factor in enumerate((height * root, square, square * root)):
        np.multiply(color.pixels[:, :, channel], factor, out=pixels[:, :, channel])
    if color.pixels.dtype != np.float32:
        pixels = np.rint(pixels, out=pixels).astype(color.pixels.dtype)
    return Map(pixels, color.srgb, f"{color.source}, darkened")
