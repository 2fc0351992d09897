"""Where the view ray meets the object, in object space: point, frame, view, the pixel."""

from __future__ import annotations

from basrelief.lang import Mat3, Vec2, Vec3, length, shader, struct
from basrelief.shading.camera import Camera, CameraRay
from basrelief.shading.ray_differentials import Footprint, along, transferred
from basrelief.shading.shapes import ShapeRay, SurfacePoint, on_shape, shape
from basrelief.shading.tangent_frame import Frame, frame_of, to_tangent
from basrelief.shading.variant import Variant


@struct
class View:
    """The camera, and where within each pixel this picture samples: (½, ½) is the middle."""

    camera: Camera
    sample: Vec2


@struct
class Placement:
    """Where the object is, and how its texture lies on it.

    A world point p is `to_object @ (p − origin)` in object space. The shape's own texture
    coordinates are multiplied by `tiling`, then `shift` is added. `proportion` is the width of the
    maps ÷ their height in texels, for which their normals were made.
    """

    origin: Vec3
    to_object: Mat3
    tiling: Vec2
    shift: Vec2
    proportion: float


@struct
class Meeting:
    """Where the view ray meets the object: the polygon's point, texture coordinates there, frame,
    view, the pixel."""

    point: SurfacePoint
    uv: Vec2
    frame: Frame
    view: Vec3
    falling: float
    footprint: Footprint


@shader
def meet(ray: CameraRay, placement: Placement, variant: Variant) -> Meeting:
    """Meet the object in its own space, where the relief is set: it scales with the object."""
    origin = placement.to_object @ (ray.origin - placement.origin)
    direction = placement.to_object @ ray.direction
    met = shape(ShapeRay(origin, direction), variant)
    along_u = met.along_u / placement.tiling.x
    along_v = met.along_v / placement.tiling.y
    frame = frame_of(met.normal, along_u, along_v)
    # with a unit direction, so that a large object is no different from a small one
    falling = length(direction)
    unit = direction / falling
    away = met.distance * falling
    right = transferred(
        away,
        unit,
        met.normal,
        placement.to_object @ ray.origin_dx,
        placement.to_object @ ray.direction_dx / falling,
    )
    down = transferred(
        away,
        unit,
        met.normal,
        placement.to_object @ ray.origin_dy,
        placement.to_object @ ray.direction_dy / falling,
    )
    return Meeting(
        point=met,
        uv=met.uv * placement.tiling + placement.shift,
        frame=frame,
        view=to_tangent(frame, -unit),
        falling=falling,
        footprint=Footprint(along(right, along_u, along_v), along(down, along_u, along_v)),
    )


@shader
def clipped(uv: Vec2, placement: Placement, variant: Variant) -> bool:
    """Whether displaced coordinates have left the shape, where the relief ends at its edge."""
    if variant.edge != "clip":
        return False
    return not on_shape((uv - placement.shift) / placement.tiling, variant)
