"""Ray-object intersection: in world space, in object space and on the texture."""

from __future__ import annotations

from basrelief.lang import Mat3, Vec2, Vec3, length, shader, struct
from basrelief.shading.camera import Camera, CameraRay
from basrelief.shading.ray_differentials import Footprint, transferred
from basrelief.shading.shapes import ShapeRay, chart, intersect_shape, is_on_shape
from basrelief.shading.tangent_frame import TangentFrame, tangent_frame, to_tangent, to_texture
from basrelief.shading.variant import Variant


@struct
class CameraSample:
    """The camera, and the offset of this sample within each pixel; (½, ½) is the centre."""

    camera: Camera
    offset: Vec2


@struct
class Placement:
    """The transform of an object and of the texture on it.

    A world point p is `to_object @ (p − origin)` in object space. The shape's own texture
    coordinates are multiplied by `tiling`, then `shift` is added. `proportion` is the width of the
    maps ÷ their height in texels, for which their normals are valid.
    """

    origin: Vec3
    to_object: Mat3
    tiling: Vec2
    shift: Vec2
    proportion: float


@struct
class Intersection:
    """The intersection of a camera ray with an object's shape.

    `distance` is along the ray, in world units, `t_exit` that at which the ray leaves the shape.
    `uv` are texture coordinates, `view` is the unit vector to the viewer in the tangent `frame`.
    `object_ray` is the ray in object space, `object_units_per_world` the length of a world unit
    along the ray in object units.
    """

    found: bool
    distance: float
    t_exit: float
    uv: Vec2
    frame: TangentFrame
    view: Vec3
    object_ray: ShapeRay
    object_units_per_world: float


@shader
def intersect(ray: CameraRay, placement: Placement, variant: Variant) -> Intersection:
    """Intersect a ray with an object, in object space: the relief is scaled with the object."""
    origin = placement.to_object @ (ray.origin - placement.origin)
    direction = placement.to_object @ ray.direction
    object_units_per_world = length(direction)
    object_ray = ShapeRay(origin, direction)
    point = intersect_shape(object_ray, variant)
    texture = chart(point.position, point.normal, variant)
    frame = tangent_frame(
        point.normal, texture.along_u / placement.tiling.x, texture.along_v / placement.tiling.y
    )
    return Intersection(
        found=point.found,
        distance=point.distance,
        t_exit=point.t_exit,
        uv=texture.uv * placement.tiling + placement.shift,
        frame=frame,
        view=to_tangent(frame, direction / -object_units_per_world),
        object_ray=object_ray,
        object_units_per_world=object_units_per_world,
    )


@shader
def footprint_at(
    ray: CameraRay, placement: Placement, intersection: Intersection, distance: float
) -> Footprint:
    """The pixel footprint on the texture at a distance along the ray."""
    # with a unit direction, so that results do not depend on the object's size
    unit = intersection.object_ray.direction / intersection.object_units_per_world
    away = distance * intersection.object_units_per_world
    right = transferred(
        away,
        unit,
        intersection.frame.normal,
        placement.to_object @ ray.origin_dx,
        placement.to_object @ ray.direction_dx / intersection.object_units_per_world,
    )
    down = transferred(
        away,
        unit,
        intersection.frame.normal,
        placement.to_object @ ray.origin_dy,
        placement.to_object @ ray.direction_dy / intersection.object_units_per_world,
    )
    return Footprint(
        to_texture(intersection.frame, to_tangent(intersection.frame, right).xy),
        to_texture(intersection.frame, to_tangent(intersection.frame, down).xy),
    )


@shader
def is_clipped(uv: Vec2, placement: Placement, variant: Variant) -> bool:
    """Whether displaced coordinates lie outside the shape where the edge is "clip"."""
    if variant.edge != "clip":
        return False
    return not is_on_shape((uv - placement.shift) / placement.tiling, variant)
