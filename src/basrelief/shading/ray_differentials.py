"""Ray differentials: the change of texture coordinates from one pixel to the next."""

from __future__ import annotations

from basrelief.lang import IVec2, Vec2, Vec3, copysign, dot, log2, shader, sqrt, struct

MIN_COSINE = 1e-6
"""Lower limit of |N · D| in the division."""


@struct
class Footprint:
    """The change of texture coordinates per pixel to the right (`dx`) and down (`dy`)."""

    dx: Vec2
    dy: Vec2


@shader
def transferred(
    distance: float, direction: Vec3, normal: Vec3, origin_change: Vec3, direction_change: Vec3
) -> Vec3:
    """The derivative of the point where a ray meets a plane: the ray transferred to the plane.

    `origin_change` and `direction_change` are the ray's derivatives.
    H. Igehy, Tracing Ray Differentials, 1999, equations 10 and 12.
    """
    offset = origin_change + direction_change * distance
    cosine = dot(direction, normal)
    clamped = copysign(max(abs(cosine), MIN_COSINE), cosine)
    return offset - direction * (dot(offset, normal) / clamped)


@shader
def level_of_detail(footprint: Footprint, extent: IVec2) -> float:
    """The mip level, at least 0, whose texel is as long as the pixel footprint's longer side.

    log2 of that side in texels. L. Williams, Pyramidal Parametrics, 1983.
    """
    texels = Vec2(float(extent.x), float(extent.y))
    dx = footprint.dx * texels
    dy = footprint.dy * texels
    longer = sqrt(max(dot(dx, dx), dot(dy, dy)))
    return max(log2(max(longer, 1e-6)), 0.0)
