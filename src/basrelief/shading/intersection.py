"""Where a ray meets the object: in world and object space, and on the texture."""

from __future__ import annotations

from basrelief.lang import Mat3, Vec2, Vec3, length, shader, struct
from basrelief.shading.camera import Camera, CameraRay
from basrelief.shading.ray_differentials import Footprint, transferred
from basrelief.shading.shapes import ShapeRay, chart, on_shape, shape
from basrelief.shading.tangent_frame import Frame, tangent_frame, to_tangent, to_texture
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
    """Where a ray meets an object's shape: how far along it, in world units, and where it leaves
    the shape again; texture coordinates, tangent frame, unit vector to the viewer in that frame.

    `inside` is the ray in object space, `stretch` how many of its units are one of the world.
    """

    found: bool
    distance: float
    t_exit: float
    uv: Vec2
    frame: Frame
    view: Vec3
    inside: ShapeRay
    stretch: float


@shader
def meet(ray: CameraRay, placement: Placement, variant: Variant) -> Meeting:
    """Meet the object in its own space, where the relief is set: it scales with the object."""
    origin = placement.to_object @ (ray.origin - placement.origin)
    direction = placement.to_object @ ray.direction
    # with a unit direction, so that a large object is no different from a small one
    stretch = length(direction)
    inside = ShapeRay(origin, direction)
    met = shape(inside, variant)
    lies = chart(met.position, met.normal, variant)
    frame = tangent_frame(
        met.normal, lies.along_u / placement.tiling.x, lies.along_v / placement.tiling.y
    )
    return Meeting(
        found=met.found,
        distance=met.distance,
        t_exit=met.t_exit,
        uv=lies.uv * placement.tiling + placement.shift,
        frame=frame,
        view=to_tangent(frame, direction / -stretch),
        inside=inside,
        stretch=stretch,
    )


@shader
def footprint_at(ray: CameraRay, placement: Placement, met: Meeting, distance: float) -> Footprint:
    """How far a pixel reaches over the texture, at a distance along the ray."""
    unit = met.inside.direction / met.stretch
    away = distance * met.stretch
    right = transferred(
        away,
        unit,
        met.frame.normal,
        placement.to_object @ ray.origin_dx,
        placement.to_object @ ray.direction_dx / met.stretch,
    )
    down = transferred(
        away,
        unit,
        met.frame.normal,
        placement.to_object @ ray.origin_dy,
        placement.to_object @ ray.direction_dy / met.stretch,
    )
    return Footprint(
        to_texture(met.frame, to_tangent(met.frame, right).xy),
        to_texture(met.frame, to_tangent(met.frame, down).xy),
    )


@shader
def clipped(uv: Vec2, placement: Placement, variant: Variant) -> bool:
    """Whether displaced coordinates have left the shape, where the relief ends at its edge."""
    if variant.edge != "clip":
        return False
    return not on_shape((uv - placement.shift) / placement.tiling, variant)
