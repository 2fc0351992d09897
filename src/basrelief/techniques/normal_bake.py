"""The bake of normals: central differences of the heights."""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, Vec3, corners, shader, size, sqrt, struct
from basrelief.techniques.edge import cell_in_map


@struct
class HeightRange:
    """The height range in texel widths, `per_texel`."""

    per_texel: float


@struct
class Normal:
    """A unit normal: x right, y up in the picture, z outwards."""

    normal: Vec3


@shader
def normals(at: IVec2, field: HeightField, relief: HeightRange) -> Normal:
    """The normal at a texel."""
    return Normal(normal_at(field, at, relief.per_texel))


@shader
def normal_at(field: HeightField, at: IVec2, per_texel: float) -> Vec3:
    """normalize(−∂h/∂x, ∂h/∂y, 1) by central differences, v down and y up, of square texels."""
    half = per_texel * 0.5
    slope = Vec2(
        (texel_height(field, at.x + 1, at.y) - texel_height(field, at.x - 1, at.y)) * half,
        (texel_height(field, at.x, at.y + 1) - texel_height(field, at.x, at.y - 1)) * half,
    )
    norm = sqrt(slope.x * slope.x + slope.y * slope.y + 1.0)
    return Vec3(-slope.x / norm, slope.y / norm, 1.0 / norm)


@shader
def texel_height(field: HeightField, x: int, y: int) -> float:
    """The height at a texel's centre, inside the map or beyond its edge."""
    extent = size(field, 0)
    return corners(
        field, IVec2(cell_in_map(field, x, extent.x), cell_in_map(field, y, extent.y)), 0
    ).x
