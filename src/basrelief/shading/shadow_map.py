"""Shadows that objects cast on one another, by shadow maps: depth maps seen from the lights.

A map is drawn like any picture, technique included, so reliefs and cut-outs cast correct shadows.
An object is left out of its own map: its shadow on itself is `shading.self_shadow`.

L. Williams, Casting Curved Shadows on Curved Surfaces, 1978; percentage-closer filtering of the
four nearest texels by W. T. Reeves, D. H. Salesin and R. L. Cook, Rendering Antialiased Shadows
with Depth Maps, 1987.
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
from basrelief.shading.camera import Camera, projected

SHADOW_BIAS_TEXELS = 1.5
"""Texels of shadow map: an occluder this little in front of the surface casts no shadow, so that a
surface does not shadow itself."""


@struct
class ShadowMapView:
    """One shadow map: the index of its `light`, the camera at the light, its `side` in texels, and
    its `first` texel in the sheet that holds all maps."""

    light: int
    camera: Camera
    side: int
    first: IVec2


@shader
def shadow_map_visibility(
    distances: HeightField, views: Buffer[ShadowMapView], light: int, position: Vec3
) -> float:
    """The visibility of a light from a world position past all other objects, 0 to 1."""
    visibility = 1.0
    for k in range(len(views)):
        if views[k].light == light:
            visibility = min(visibility, filtered_visibility(distances, views[k], position))
    return visibility


@shader
def filtered_visibility(distances: HeightField, view: ShadowMapView, position: Vec3) -> float:
    """The visibility in one shadow map, percentage-closer filtered; 1 outside the map."""
    seen = projected(view.camera, position)
    x = seen.x - 0.5
    y = seen.y - 0.5
    last = float(view.side) - 1.0
    if seen.z <= 0.0 or min(x, y) < 0.0 or max(x, y) >= last:
        return 1.0
    left = floor(x)
    top = floor(y)
    four = corners(distances, IVec2(int(left) + view.first.x, int(top) + view.first.y), 0)
    # the width of a texel at the position's distance
    texel = length(view.camera.right) * mix(1.0, seen.z, view.camera.perspective)
    receiver = seen.z - SHADOW_BIAS_TEXELS * texel
    upper = mix(depth_test(four.x, receiver), depth_test(four.y, receiver), x - left)
    lower = mix(depth_test(four.z, receiver), depth_test(four.w, receiver), x - left)
    return mix(upper, lower, y - top)


@shader
def depth_test(occluder: float, receiver: float) -> float:
    """1 where the occluder in the map is no nearer to the light than the receiver, else 0."""
    return 1.0 if occluder >= receiver else 0.0
