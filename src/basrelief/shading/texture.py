"""Reading colour and data maps: bilinear within a level, linear between levels."""

from __future__ import annotations

from basrelief.lang import IVec2, Texture, Vec2, Vec4, floor, mix, shader, size, texel
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.techniques.edge import in_tile

UNIT = 1.0 / 65535.0
"""Channels are stored as 16-bit fractions of one."""


@shader
def bilinear(map: Texture, uv: Vec2, mip: int) -> Vec4:
    """The four channels at texture coordinates, from one level."""
    extent = size(map, mip)
    tile = in_tile(map, uv)
    x = tile.x * float(extent.x) - 0.5
    y = tile.y * float(extent.y) - 0.5
    left = floor(x)
    top = floor(y)
    column = int(left)
    row = int(top)
    upper = mix(
        texel(map, IVec2(column, row), mip), texel(map, IVec2(column + 1, row), mip), x - left
    )
    lower = mix(
        texel(map, IVec2(column, row + 1), mip),
        texel(map, IVec2(column + 1, row + 1), mip),
        x - left,
    )
    return mix(upper, lower, y - top) * UNIT


@shader
def pixelated(map: Texture, uv: Vec2, footprint: Footprint) -> Vec4:
    """One texel's channels wherever a pixel sees no more than that, else as wide as it sees."""
    extent = size(map, 0)
    texels = Vec2(float(extent.x), float(extent.y))
    place = uv * texels
    centre = Vec2(floor(place.x) + 0.5, floor(place.y) + 0.5) / texels
    seen = level_of_detail(footprint, extent) > 0.0
    return trilinear(map, uv if seen else centre, footprint)


@shader
def trilinear(map: Texture, uv: Vec2, footprint: Footprint) -> Vec4:
    """The four channels at texture coordinates, as wide as the pixel sees them."""
    lod = level_of_detail(footprint, size(map, 0))
    finer = floor(lod)
    value = bilinear(map, uv, int(finer))
    between = lod - finer
    if between > 0.0:
        value = mix(value, bilinear(map, uv, int(finer) + 1), between)
    return value
