"""The true view ray of a pixel in the height map's texture space, without any technique.

What the ruler goes by (`basrelief.measure.truth`): the same camera, shape, frame and depth as those
of `shading.pixel`, up to where a technique would take over.
"""

from __future__ import annotations

from basrelief.lang import IVec2, Vec2, shader, struct
from basrelief.shading.camera import primary_ray
from basrelief.shading.intersection import Placement, View, meet
from basrelief.shading.relief import Depth, beyond, depth_seen
from basrelief.shading.tangent_frame import to_texture
from basrelief.shading.variant import Variant
from basrelief.techniques.projection import full
from basrelief.techniques.ray import Hit


@struct
class ViewRay:
    """Where a pixel's ray meets the polygon, and how it goes on.

    `uv` and `fall` are those of `techniques.Ray`; `distance` is the polygon's along the ray, in
    world units, and `per_height` how much further the ray goes while it falls through all heights.
    """

    found: bool
    uv: Vec2
    fall: Vec2
    distance: float
    per_height: float


@shader
def view_ray(
    at: IVec2, view: View, placement: Placement, depth: Depth, variant: Variant
) -> ViewRay:
    """The ray of one pixel."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement, variant)
    if not met.point.found:
        return ViewRay(False, Vec2(0.0), Vec2(0.0), 0.0, 0.0)
    deep = depth_seen(depth, met.point.distance, variant)
    fall = to_texture(full(met.view, 0.0) * -deep.scale, met.frame.aspect)
    lowest = beyond(met, deep, Hit(met.uv, 0.0, True, 0))
    highest = beyond(met, deep, Hit(met.uv, 1.0, True, 0))
    return ViewRay(True, met.uv, fall, met.point.distance, lowest - highest)
