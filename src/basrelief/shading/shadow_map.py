"""Shadows that objects cast on one another, by depth maps seen from the lights.

L. Williams, Casting Curved Shadows on Curved Surfaces, 1978; the four nearest texels are compared
each by itself (W. T. Reeves, D. H. Salesin and R. L. Cook, Rendering Antialiased Shadows with Depth
Maps, 1987). A map is drawn like any picture, technique included, so reliefs and cut-outs cast the
shadows that they should; an object is left out of its own, whose shadow is `shading.self_shadow`.
"""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    Vec3,
    corners,
    floor,
    length,
    mix,
    shader,
    struct,
)
from basrelief.shading.camera import Camera, seen_from

SHADOW_BIAS_TEXELS = 1.5
"""Texels of depth map by which what is met may lie before the surface and cast nothing."""


@struct
class ShadowMapView:
    """One depth map: whose light, from where, of how many texels a side, and its first texel in the
    sheet of all."""

    light: int
    camera: Camera
    side: int
    first: IVec2


@shader
def shadow_map_visibility(
    distances: HeightField, views: Buffer[ShadowMapView], light: int, position: Vec3
) -> float:
    """How much of a light reaches a position past all other objects, as its depth maps have it."""
    share = 1.0
    for k in range(len(views)):
        if views[k].light == light:
            share = min(share, lit(distances, views[k], position))
    return share


@shader
def lit(distances: HeightField, view: ShadowMapView, position: Vec3) -> float:
    """The share of the four texels around a position that see as far as it; 1 out of view."""
    seen = seen_from(view.camera, position)
    x = seen.x - 0.5
    y = seen.y - 0.5
    last = float(view.side) - 1.0
    if seen.z <= 0.0 or min(x, y) < 0.0 or max(x, y) >= last:
        return 1.0
    left = floor(x)
    top = floor(y)
    four = corners(distances, IVec2(int(left) + view.first.x, int(top) + view.first.y), 0)
    # a texel's width where the position is
    texel = length(view.camera.right) * mix(1.0, seen.z, view.camera.perspective)
    needed = seen.z - SHADOW_BIAS_TEXELS * texel
    upper = mix(sees(four.x, needed), sees(four.y, needed), x - left)
    lower = mix(sees(four.z, needed), sees(four.w, needed), x - left)
    return mix(upper, lower, y - top)


@shader
def sees(distance: float, needed: float) -> float:
    """1 where what the map met is as far away as is needed, else 0."""
    return 1.0 if distance >= needed else 0.0
