"""Noise over the texels that steep slopes stretch: grain across the streaks of planar colours."""

from __future__ import annotations

from basrelief.lang import IVec2, Texture, Vec2, Vec3, exp, floor, mix, saturate, shader, size
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.techniques.edge import cell_in_map, in_tile

COARSEST = 32.0
"""Width of the largest grains, in texels."""
OCTAVES = 6
"""Number of sizes of grains, each half as wide as the one before; the smallest are texels."""
STRENGTH = 0.6
"""The greatest change of the brightness's logarithm by one size of grains, on a vertical slope."""


@shader
def stretch_noise(
    map: Texture, uv: Vec2, height_in_tiles: float, normal: Vec3, footprint: Footprint
) -> float:
    """The factor of a map's colour on a slope with a unit normal: noise around 1, and 1 on level
    ground.

    A slope shows a texel 1 ÷ n.z times as long as it is. The noise varies along the slope, where
    the colours do not, with a strength of 1 − n.z². Grains smaller than a pixel are left out.
    S. Halliwell, Parallax Offset, 2014 (suggests noise, without a formula).
    """
    steepness = 1.0 - saturate(normal.z * normal.z)
    total = 0.0
    if steepness > 0.0:
        texels = size(map, 0)
        tile = in_tile(map, uv)
        width = COARSEST
        for _ in range(OCTAVES):
            # at least two grains, so that a tile is no even grey
            grains = IVec2(
                max(int(float(texels.x) / width), 2), max(int(float(texels.y) / width), 2)
            )
            # full where a grain is two pixels wide, none where it is one
            share = saturate(1.0 - level_of_detail(footprint, IVec2(grains.x * 2, grains.y * 2)))
            if share > 0.0:
                x = tile.x * float(grains.x)
                y = tile.y * float(grains.y)
                z = height_in_tiles * float(grains.x)
                total = total + share * value_noise(map, x, y, z, grains)
            width = width * 0.5
    return exp(STRENGTH * steepness * total)


@shader
def value_noise(map: Texture, x: float, y: float, z: float, period: IVec2) -> float:
    """Smooth noise from −1 to 1 that repeats with the map: random values at the points of a
    lattice, blended between them."""
    column = floor(x)
    row = floor(y)
    layer = floor(z)
    along = Vec3(eased(x - column), eased(y - row), eased(z - layer))
    left = cell_in_map(map, int(column), period.x)
    right = cell_in_map(map, int(column) + 1, period.x)
    upper = cell_in_map(map, int(row), period.y)
    lower = cell_in_map(map, int(row) + 1, period.y)
    below = layer_noise(left, right, upper, lower, int(layer), along)
    above = layer_noise(left, right, upper, lower, int(layer) + 1, along)
    return mix(below, above, along.z)


@shader
def layer_noise(left: int, right: int, upper: int, lower: int, layer: int, along: Vec3) -> float:
    """The noise in one layer of the lattice."""
    top = mix(random_value(left, upper, layer), random_value(right, upper, layer), along.x)
    bottom = mix(random_value(left, lower, layer), random_value(right, lower, layer), along.x)
    return mix(top, bottom, along.y)


@shader
def eased(t: float) -> float:
    """3t² − 2t³: no creases at the points of the lattice."""
    return t * t * (3.0 - 2.0 * t)


@shader
def random_value(x: int, y: int, z: int) -> float:
    """A number from −1 to 1 for three integers.

    M. Jarzynski and M. Olano, Hash Functions for GPU Rendering, 2020 (pcg3d).
    """
    a = x * 1664525 + 1013904223
    b = y * 1664525 + 1013904223
    c = z * 1664525 + 1013904223
    a = a + b * c
    b = b + c * a
    c = c + a * b
    # the shift keeps the sign
    a = a ^ ((a >> 16) & 65535)
    b = b ^ ((b >> 16) & 65535)
    c = c ^ ((c >> 16) & 65535)
    a = a + b * c
    return float((a >> 16) & 65535) * (2.0 / 65535.0) - 1.0
