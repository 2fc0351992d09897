"""A hole that opens in a surface: a map of cracks and one of dust, merged into one of heights.

After E. Nordeus (habrador, *Parallax mapping*, Unity tutorial), who merges two textures and turns
one number, the strength of the dust. Here the merging is a threshold: the ground gives way where
crack and dust together are more than it bears. So cracks open first, along their middles and from
the middle of the dust outwards; what stands between them falls in later.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.material.material import Map, Material, Note

DEPTH = 0.3
"""How deep the hole is, as a fraction of the tile's width: about half as deep as it is wide."""

STRENGTH = 2.8
"""The dust's strength when the hole is open; from 1 on full dust breaks even what has no crack."""

SOFTNESS = 0.45
"""How far beyond its limit the ground is when it has sunk to 1/e: less makes steeper walls."""


def hole(cracks: Material, dust: Material, opening: float) -> Material:
    """The surface of `cracks` with a hole where `dust` lies, from 0, whole, to 1, open.

    At 0 all heights are 1, and the cracks are in the colour alone; as the opening grows heights
    fall and never rise. Where the height map of the cracks is h and that of the dust d, it is
    exp(−max(STRENGTH · opening · d − h, 0) ÷ SOFTNESS).

    Colour is darkened inside. There are no normals and no occlusion: those of the cracks would be
    wrong, and the renderer makes normals from the heights, at the relief's scale. Cheap enough for
    each picture of a film. Raises InputError for an opening beyond 0…1, and for height maps that
    are missing or differ in size.
    """
    if not 0 <= opening <= 1:
        raise InputError(f"a hole's opening is 0 (whole) to 1 (open), not {opening}")
    whole, speckle = _heights(cracks), _heights(dust)
    if whole.shape != speckle.shape:
        one, other = (" × ".join(map(str, m.shape[1::-1])) for m in (whole, speckle))
        raise InputError(f"a hole needs cracks and dust of one size, not {one} and {other} texels")
    sunk = speckle * np.float32(STRENGTH * opening) - whole
    np.maximum(sunk, 0, out=sunk)
    sunk *= np.float32(-1 / SOFTNESS)
    height = np.exp(sunk, out=sunk)
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

    So the ground is brown where it breaks, and black in the depth.
    """
    root = np.sqrt(height)
    square = height * height
    pixels = np.empty(color.pixels.shape, np.float32)
    for channel, factor in enumerate((height * root, square, square * root)):
        np.multiply(color.pixels[:, :, channel], factor, out=pixels[:, :, channel])
    if color.pixels.dtype != np.float32:
        pixels = np.rint(pixels, out=pixels).astype(color.pixels.dtype)
    return Map(pixels, color.srgb, f"{color.source}, darkened")
