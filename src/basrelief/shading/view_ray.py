"""The true view ray of a pixel in the texture space of the height map, without a technique.

The reference of `basrelief.measure.truth`: camera, shape, frame and depth are those of
`shading.pixel`, up to where a technique would take over.
"""

from __future__ import annotations

from basrelief.lang import IVec2, Vec2, shader, struct
from basrelief.shading.camera import primary_ray
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import CameraSample, Placement, intersect
from basrelief.shading.relief import (
    ReliefParameters,
    faded_relief,
    object_height_range,
    relief_interval,
    relief_ray,
)
from basrelief.shading.variant import Variant


@struct
class ViewRay:
    """A pixel's ray through the relief.

    It enters at texture coordinates `uv` at height 1 and moves by `travel` until height 0, as in
    `techniques.Ray`. `distance` is that of the entry along the ray, `length` the distance from
    there to height 0, in world units. `scale` is the height range in tile widths.
    """

    found: bool
    uv: Vec2
    travel: Vec2
    distance: float
    length: float
    scale: float


@shader
def view_ray(
    at: IVec2,
    sample: CameraSample,
    placement: Placement,
    relief: ReliefParameters,
    geometry: Geometry,
    variant: Variant,
) -> ViewRay:
    """The view ray of one pixel."""
    ray = primary_ray(sample.camera, Vec2(float(at.x), float(at.y)) + sample.offset)
    intersection = intersect(ray, placement, variant)
    if not intersection.found:
        return ViewRay(False, Vec2(0.0), Vec2(0.0), 0.0, 0.0, 0.0)
    faded = faded_relief(relief, intersection.distance, variant)
    height_range = object_height_range(faded, placement, variant)
    straight = relief_ray(intersection, faded, height_range, 0.0, 0.0, variant)
    interval = relief_interval(intersection, faded.reference_height, height_range)
    return ViewRay(
        True,
        straight.uv,
        straight.travel,
        intersection.distance + interval.t_enter,
        interval.t_exit - interval.t_enter,
        straight.scale,
    )
