"""Reading the height field: the bilinear surface through its texel centres, sharp or smooth.

A technique asks what lies under its ray with `height_under`. How that is read is the field's own
`filter`: from the finest level, exactly; or from lower levels of the map, which lets small features
go that a few steps would miss here and hit there.
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
    saturate,
    setting,
    shader,
    size,
    struct,
)
from basrelief.techniques.columns import top_at
from basrelief.techniques.edge import in_tile
from basrelief.techniques.ray import Ray, at

STILL_LOWER = 2.0
"""How many levels lower the second reading of a smooth height is."""


@struct
class Smoothing:
    """The numbers of smooth heights."""

    mip_bias: float = setting(
        default=1.0,
        doc="levels that smooth heights lie below what a pixel covers",
        low=0.0,
        high=16.0,
    )
    mip_fade: float = setting(
        default=4.0,
        doc="how readily a smooth height gives way to a still lower level's",
        low=0.0,
        high=64.0,
    )


@shader
def height_under(field: HeightField, ray: Ray, t: float) -> float:
    """The surface's height, 0 to 1, below or above the ray at t."""
    return surface_height(field, at(ray, t), ray.lod, ray.fade)


@shader
def surface_height(field: HeightField, uv: Vec2, lod: float, fade: float) -> float:
    """The height, 0 to 1, at texture coordinates: the finest level's, that of the one level which
    the ray reads, or a smooth one's; of boxes that of the box's top."""
    if field.filter == "columns":
        return top_at(field, uv)
    if field.filter == "smooth":
        return smooth(field, uv, lod, fade)
    if field.filter == "mip":
        return height_in(field, uv, int(lod))
    return sharp(field, uv)


@shader
def smooth(field: HeightField, uv: Vec2, lod: float, fade: float) -> float:
    """A lower level's; where that differs much from a still lower one's, the latter.

    S. Halliwell, Parallax Offset, 2014. Counts as one read, though it takes four bilinear ones.
    """
    seen = height_between(field, uv, lod)
    lower = height_between(field, uv, lod + STILL_LOWER)
    return mix(seen, lower, saturate(abs(seen - lower) * fade))


@shader
def height_between(field: HeightField, uv: Vec2, lod: float) -> float:
    """The height from the two levels that `lod` lies between."""
    finer = floor(lod)
    near = height_in(field, uv, int(finer))
    return mix(near, height_in(field, uv, int(finer) + 1), lod - finer)


@shader
def sharp(field: HeightField, uv: Vec2) -> float:
    """The height, 0 to 1, at texture coordinates; texel centres lie at (i + ½) ÷ N.

    From the finest level, written out as 0: on a GPU that reads all four texels at once.
    """
    cell = cell_at(field, uv, size(field, 0))
    return within(corners(field, cell.corner, 0), cell.x, cell.y)


@shader
def height_in(field: HeightField, uv: Vec2, level: int) -> float:
    """The same from any level."""
    cell = cell_at(field, uv, size(field, level))
    return within(corners(field, cell.corner, level), cell.x, cell.y)


@shader
def slope_at(field: HeightField, uv: Vec2) -> Vec2:
    """How the height changes over a tile, along u and along v: the bilinear surface's own slope."""
    extent = size(field, 0)
    cell = cell_at(field, uv, extent)
    four = corners(field, cell.corner, 0)
    along_u = mix(four.y - four.x, four.w - four.z, cell.y)
    along_v = mix(four.z - four.x, four.w - four.y, cell.x)
    return Vec2(along_u * float(extent.x), along_v * float(extent.y))


@struct
class Cell:
    """The four texels around a place: the upper left one, and how far from it the place is."""

    corner: IVec2
    x: float
    y: float


@shader
def cell_at(field: HeightField, uv: Vec2, extent: IVec2) -> Cell:
    """The cell of a level of some size that texture coordinates lie in."""
    tile = in_tile(field, uv)
    x = tile.x * float(extent.x) - 0.5
    y = tile.y * float(extent.y) - 0.5
    left = floor(x)
    top = floor(y)
    return Cell(IVec2(int(left), int(top)), x - left, y - top)


@shader
def within(four: Vec4, x: float, y: float) -> float:
    """Bilinear interpolation between upper left, upper right, lower left and lower right."""
    return mix(mix(four.x, four.y, x), mix(four.z, four.w, x), y)


# --- whole cells, for techniques that solve them --------------------------------------------------


@shader
def extent_of(field: HeightField, level: int) -> Vec2:
    """The size of a level in texels."""
    count = size(field, level)
    return Vec2(float(count.x), float(count.y))


@shader
def level_under(field: HeightField, ray: Ray) -> int:
    """The level whose bilinear surface a ray meets."""
    return int(ray.lod) if field.filter == "mip" else 0


@shader
def patch_of(field: HeightField, cell: IVec2, level: int) -> Vec4:
    """The four heights around a cell of a level, as `corners` has them."""
    if field.filter == "mip":
        return corners(field, cell, level)
    # written out as 0: on a GPU that reads all four texels at once
    return corners(field, cell, 0)
