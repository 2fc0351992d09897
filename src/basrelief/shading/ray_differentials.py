"""Ray differentials: how far texture coordinates move from one pixel to the next."""

from __future__ import annotations

from basrelief.lang import IVec2, Vec2, Vec3, copysign, dot, log2, shader, sqrt, struct

GRAZING = 1e-6
"""The least |N · D| that is divided by."""


@struct
class Footprint:
    """The change of texture coordinates for one pixel to the right and one down."""

    dx: Vec2
    dy: Vec2


@shader
def transferred(
    distance: float, direction: Vec3, normal: Vec3, origin_change: Vec3, direction_change: Vec3
) -> Vec3:
    """How the point where a ray meets a plane moves with the ray.

    H. Igehy, Tracing Ray Differentials, 1999, equations 10 and 12.
    """
    moved = origin_change + direction_change * distance
    facing = dot(direction, normal)
    slope = copysign(max(abs(facing), GRAZING), facing)
    return moved - direction * (dot(moved, normal) / slope)


@shader
def level_of_detail(footprint: Footprint, extent: IVec2) -> float:
    """The mip level at which a pixel's longer side covers one texel; 0 or more.

    log2 of that side in texels (L. Williams, Pyramidal Parametrics, 1983).
    """
    texels = Vec2(float(extent.x), float(extent.y))
    dx = footprint.dx * texels
    dy = footprint.dy * texels
    longer = sqrt(max(dot(dx, dx), dot(dy, dy)))
    return max(log2(max(longer, 1e-6)), 0.0)
