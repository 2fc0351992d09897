"""Single texels of a height map, and the slope of the heights around one."""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, Vec3, corners, shader, size, sqrt, struct
from basrelief.techniques.edge import cell_in_map


@struct
class Relief:
    """`per_texel` is what the whole height range rises, in widths of a texel."""

    per_texel: float


@struct
class Normal:
    """A unit normal, x right, y up in the picture."""

    normal: Vec3


@shader
def normals(at: IVec2, field: HeightField, relief: Relief) -> Normal:
    """The normal at each texel."""
    return Normal(normal_at(field, at, relief.per_texel))


@shader
def normal_at(field: HeightField, at: IVec2, per_texel: float) -> Vec3:
    """By central differences, of square texels."""
    half = per_texel * 0.5
    slope = Vec2(
        (texel_height(field, at.x + 1, at.y) - texel_height(field, at.x - 1, at.y)) * half,
        (texel_height(field, at.x, at.y + 1) - texel_height(field, at.x, at.y - 1)) * half,
    )
    long = sqrt(slope.x * slope.x + slope.y * slope.y + 1.0)
    return Vec3(-slope.x / long, slope.y / long, 1.0 / long)


@shader
def texel_height(field: HeightField, x: int, y: int) -> float:
    """The height at a texel's centre; beyond the map as its edge says."""
    extent = size(field, 0)
    return corners(
        field, IVec2(cell_in_map(field, x, extent.x), cell_in_map(field, y, extent.y)), 0
    ).x
