"""The true view ray of a pixel in the height map's texture space, without any technique.

What the ruler goes by (`basrelief.measure.truth`): the same camera, shape, frame and depth as those
of `shading.pixel`, up to where a technique would take over.
"""

from __future__ import annotations

from basrelief.lang import IVec2, Vec2, shader, struct
from basrelief.shading.camera import primary_ray
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import Placement, View, meet
from basrelief.shading.relief import (
    ReliefParameters,
    faded_relief,
    height_range,
    relief_ray,
    span_of,
)
from basrelief.shading.variant import Variant


@struct
class ViewRay:
    """A pixel's ray through the relief.

    It comes in at texture coordinates `uv`, at height 1, and moves by `travel` until height 0, as
    those of `techniques.Ray`; `distance` is how far along the ray it comes in, and `length` how far
    it goes from there to height 0, in world units.
    """

    found: bool
    uv: Vec2
    travel: Vec2
    distance: float
    length: float


@shader
def view_ray(
    at: IVec2,
    view: View,
    placement: Placement,
    relief: ReliefParameters,
    geometry: Geometry,
    variant: Variant,
) -> ViewRay:
    """The ray of one pixel."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement, variant)
    if not met.found:
        return ViewRay(False, Vec2(0.0), Vec2(0.0), 0.0, 0.0)
    seen = faded_relief(relief, met.distance, variant)
    deep = height_range(seen, placement, variant)
    straight = relief_ray(met, seen, deep, 0.0, 0.0, variant)
    span = span_of(met, seen.reference_height, deep)
    return ViewRay(
        True, straight.uv, straight.travel, met.distance + span.enter, span.leave - span.enter
    )
