"""Reading the height field: the bilinear surface through the texel centres, sharp or smooth.

A technique reads the surface below its ray with `height_under`. The field's `filter` decides how:
"sharp" reads the finest level, exactly; "smooth" and "mip" read lower mip levels, which removes
small features that a few steps would hit at one pixel and miss at the next; "columns" is one flat
column per texel. The field's `sampling` says whether the shaders read four texels and interpolate
them ("texel"), or the filter of the GPU does ("hardware"); whole cells are always read as texels.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Vec2,
    Vec4,
    corners,
    floor,
    mix,
    sampled,
    saturate,
    setting,
    shader,
    size,
    struct,
)
from basrelief.techniques.columns import column_top_at
from basrelief.techniques.edge import in_tile
from basrelief.techniques.ray import Ray, at

LOWER_LEVELS = 2.0
"""The second reading of a smooth height is from this many levels lower."""


@struct
class Smoothing:
    """Settings of smooth heights."""

    mip_bias: float = setting(
        default=1.0,
        doc="mip levels below that of the pixel's footprint",
        low=0.0,
        high=16.0,
    )
    mip_fade: float = setting(
        default=4.0,
        doc="fading to a lower mip level where heights differ much",
        low=0.0,
        high=64.0,
    )


@shader
def height_under(field: HeightField, ray: Ray, t: float) -> float:
    """The height of the surface below or above the ray at t.

    Parameters
    ----------
    field : HeightField
        The heights.
    ray : Ray
        The ray.
    t : float
        The position along the ray, 0 to 1.

    Returns
    -------
    float
        The surface's height, 0 to 1; one read.
    """
    return surface_height(field, at(ray, t), ray.lod, ray.fade)


@shader
def surface_height(field: HeightField, uv: Vec2, lod: float, fade: float) -> float:
    """The surface's height at texture coordinates, 0 to 1, by the field's filter."""
    if field.filter == "columns":
        return column_top_at(field, uv)
    if field.filter == "smooth":
        return smooth(field, uv, lod, fade)
    if field.filter == "mip":
        return level_height(field, uv, int(lod))
    return sharp(field, uv)


@shader
def smooth(field: HeightField, uv: Vec2, lod: float, fade: float) -> float:
    """The height h₁ of mip level `lod`, or h₂ of a still lower one where the two differ much:
    mix(h₁, h₂, |h₁ − h₂| · fade).

    Counts as one read, of four bilinear samples. S. Halliwell, Parallax Offset, 2014.
    """
    finer = lod_height(field, uv, lod)
    lower = lod_height(field, uv, lod + LOWER_LEVELS)
    return mix(finer, lower, saturate(abs(finer - lower) * fade))


@shader
def lod_height(field: HeightField, uv: Vec2, lod: float) -> float:
    """The height interpolated between the two mip levels around `lod`."""
    if field.sampling == "hardware":
        return sampled(field, uv, lod)
    finer = floor(lod)
    height = level_height(field, uv, int(finer))
    return mix(height, level_height(field, uv, int(finer) + 1), lod - finer)


@shader
def sharp(field: HeightField, uv: Vec2) -> float:
    """The bilinear surface of the finest level; texel centres lie at (i + ½) ÷ N."""
    if field.sampling == "hardware":
        return sampled(field, uv, 0.0)
    # level 0 as a literal: a GPU then reads all four texels at once
    cell = cell_at(field, uv, size(field, 0))
    return interpolated(corners(field, cell.corner, 0), cell.x, cell.y)


@shader
def level_height(field: HeightField, uv: Vec2, level: int) -> float:
    """The bilinear surface of any mip level."""
    if field.sampling == "hardware":
        return sampled(field, uv, float(level))
    cell = cell_at(field, uv, size(field, level))
    return interpolated(corners(field, cell.corner, level), cell.x, cell.y)


@shader
def gradient_at(field: HeightField, uv: Vec2) -> Vec2:
    """The gradient of the bilinear surface: height per tile along u and along v."""
    extent = size(field, 0)
    cell = cell_at(field, uv, extent)
    four = corners(field, cell.corner, 0)
    along_u = mix(four.y - four.x, four.w - four.z, cell.y)
    along_v = mix(four.z - four.x, four.w - four.y, cell.x)
    return Vec2(along_u * float(extent.x), along_v * float(extent.y))


@struct
class Cell:
    """A point among its four surrounding texels: the upper left texel `corner`, and the offset from
    its centre, 0 to 1 along each axis."""

    corner: IVec2
    x: float
    y: float


@shader
def cell_at(field: HeightField, uv: Vec2, extent: IVec2) -> Cell:
    """The cell at texture coordinates, in a level of `extent` texels."""
    tile = in_tile(field, uv)
    x = tile.x * float(extent.x) - 0.5
    y = tile.y * float(extent.y) - 0.5
    left = floor(x)
    top = floor(y)
    return Cell(IVec2(int(left), int(top)), x - left, y - top)


@shader
def interpolated(four: Vec4, x: float, y: float) -> float:
    """Bilinear interpolation of upper left, upper right, lower left and lower right."""
    return mix(mix(four.x, four.y, x), mix(four.z, four.w, x), y)


# --- whole cells, for techniques that solve them --------------------------------------------------


@shader
def extent_of(field: HeightField, level: int) -> Vec2:
    """The size of a mip level in texels."""
    count = size(field, level)
    return Vec2(float(count.x), float(count.y))


@shader
def ray_level(field: HeightField, ray: Ray) -> int:
    """The mip level whose bilinear surface the ray is intersected with."""
    return int(ray.lod) if field.filter == "mip" else 0


@shader
def patch_heights(field: HeightField, cell: IVec2, level: int) -> Vec4:
    """The four corner heights of a cell in a level, in the order of `corners`."""
    if field.filter == "mip":
        return corners(field, cell, level)
    # level 0 as a literal: a GPU then reads all four texels at once
    return corners(field, cell, 0)
