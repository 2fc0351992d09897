"""Noise over the texels that steep slopes stretch: grain across the streaks of planar colours."""

from __future__ import annotations

from basrelief.lang import (
    IVec2,
    Texture,
    Vec2,
    Vec3,
    exp,
    floor,
    mix,
    saturate,
    shader,
    size,
    smoothstep,
)
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.techniques.edge import cell_in_map, in_tile

LARGEST_GRAIN = 32.0
"""Width of the largest grains, in texels."""
OCTAVES = 6
"""Number of sizes of grains, each half as wide as the one before; the smallest are texels."""
VARIANCE = 0.137
"""Variance of value noise: 1 ÷ 3 at the points of the lattice, less between them."""
LAYERS = 1 << 16
"""Layers of lattice points between those of one octave and of the next."""
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
    squares = 0.0
    if steepness > 0.0:
        texels = size(map, 0)
        tile = in_tile(map, uv)
        width = LARGEST_GRAIN
        for octave in range(OCTAVES):
            grains = IVec2(int(float(texels.x) / width), int(float(texels.y) / width))
            # full where a grain is two pixels wide, none where it is one
            share = saturate(1.0 - level_of_detail(footprint, IVec2(grains.x * 2, grains.y * 2)))
            # one grain a tile would be an even grey
            if share > 0.0 and grains.x > 1 and grains.y > 1:
                x = tile.x * float(grains.x)
                y = tile.y * float(grains.y)
                z = height_in_tiles * float(grains.x)
                total = total + share * value_noise(map, x, y, z, grains, octave)
                squares = squares + share * share
            width = width * 0.5
    strength = STRENGTH * steepness
    # half the variance less, so that the mean stays 1
    return exp(strength * total - 0.5 * VARIANCE * strength * strength * squares)


@shader
def value_noise(map: Texture, x: float, y: float, z: float, period: IVec2, octave: int) -> float:
    """Smooth noise from −1 to 1 that repeats with the map: random values at the points of a
    lattice, blended between them. Every octave has other values."""
    column = floor(x)
    row = floor(y)
    layer = floor(z)
    weights = Vec3(
        smoothstep(0.0, 1.0, x - column),
        smoothstep(0.0, 1.0, y - row),
        smoothstep(0.0, 1.0, z - layer),
    )
    salt = int(layer) + octave * LAYERS
    left = cell_in_map(map, int(column), period.x)
    right = cell_in_map(map, int(column) + 1, period.x)
    upper = cell_in_map(map, int(row), period.y)
    lower = cell_in_map(map, int(row) + 1, period.y)
    below = layer_noise(left, right, upper, lower, salt, weights)
    above = layer_noise(left, right, upper, lower, salt + 1, weights)
    return mix(below, above, weights.z)


@shader
def layer_noise(left: int, right: int, upper: int, lower: int, layer: int, weights: Vec3) -> float:
    """The noise in one layer of the lattice."""
    top = mix(random_value(left, upper, layer), random_value(right, upper, layer), weights.x)
    bottom = mix(random_value(left, lower, layer), random_value(right, lower, layer), weights.x)
    return mix(top, bottom, weights.y)


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
