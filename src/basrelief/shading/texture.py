"""Sampling colour and data maps: bilinear within a mip level, linear between levels."""

from __future__ import annotations

from basrelief.lang import IVec2, Texture, Vec2, Vec4, floor, mix, shader, size, texel
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.techniques.edge import in_tile

UNIT = 1.0 / 65535.0
"""The unit of a 16-bit channel: texels store fractions of 65535."""


@shader
def bilinear(map: Texture, uv: Vec2, mip: int) -> Vec4:
    """The four channels at texture coordinates, bilinear in one mip level."""
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
    """The nearest texel where a pixel covers no more than one, else `trilinear`: magnified texels
    stay sharp squares."""
    extent = size(map, 0)
    texels = Vec2(float(extent.x), float(extent.y))
    position = uv * texels
    center = Vec2(floor(position.x) + 0.5, floor(position.y) + 0.5) / texels
    minified = level_of_detail(footprint, extent) > 0.0
    return trilinear(map, uv if minified else center, footprint)


@shader
def trilinear(map: Texture, uv: Vec2, footprint: Footprint) -> Vec4:
    """The four channels at texture coordinates, filtered to the pixel footprint."""
    lod = level_of_detail(footprint, size(map, 0))
    finer = floor(lod)
    value = bilinear(map, uv, int(finer))
    fraction = lod - finer
    if fraction > 0.0:
        value = mix(value, bilinear(map, uv, int(finer) + 1), fraction)
    return value
