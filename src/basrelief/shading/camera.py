"""Primary rays: from a position in the picture to a ray in the world, with its derivatives.

The world is right-handed with y up. Positions in the picture are in pixels: x to the right, y down,
(0, 0) the top left corner, pixel centres at + ½. `basrelief.scene.cameras` makes cameras from a
position and a target.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, copysign, dot, shader, sqrt, struct

MIN_DEPTH = 1e-6
"""World units: smaller depths are replaced by this before dividing."""


@struct
class Camera:
    """A camera as the shaders need it; lengths in world units.

    `corner + right · x + down · y` is the point (x, y) of the picture. In perspective
    (`perspective` 1) it is the direction of the ray from `position`, one unit deep along `forward`.
    In orthographic projection (0) it is the ray's origin relative to `position`, perpendicular to
    `forward`.
    """

    position: Vec3
    corner: Vec3
    right: Vec3
    down: Vec3
    forward: Vec3
    perspective: float


@struct
class CameraRay:
    """A ray and its derivatives per pixel: `_dx` to the right, `_dy` downwards.

    `direction` has unit length; its derivatives are those of the unit vector.
    """

    origin: Vec3
    direction: Vec3
    origin_dx: Vec3
    origin_dy: Vec3
    direction_dx: Vec3
    direction_dy: Vec3


@shader
def primary_ray(camera: Camera, position: Vec2) -> CameraRay:
    """The ray through a position in the picture, in pixels, and its analytic derivatives.

    H. Igehy, Tracing Ray Differentials, 1999.
    """
    parallel = 1.0 - camera.perspective
    plane_point = camera.corner + camera.right * position.x + camera.down * position.y
    towards = plane_point * camera.perspective + camera.forward * parallel
    scale = 1.0 / sqrt(dot(towards, towards))
    direction = towards * scale
    return CameraRay(
        origin=camera.position + plane_point * parallel,
        direction=direction,
        origin_dx=camera.right * parallel,
        origin_dy=camera.down * parallel,
        direction_dx=unit_vector_derivative(direction, camera.right * (camera.perspective * scale)),
        direction_dy=unit_vector_derivative(direction, camera.down * (camera.perspective * scale)),
    )


@shader
def unit_vector_derivative(unit: Vec3, change: Vec3) -> Vec3:
    """The derivative of d ÷ |d|, from `unit` = d ÷ |d| and `change` = d′ ÷ |d|.

    Igehy's equation 8 with |d| factored out: (d ÷ |d|)′ = (d′ − û (û · d′)) ÷ |d|.
    """
    return change - unit * dot(unit, change)


@shader
def projected(camera: Camera, position: Vec3) -> Vec3:
    """The inverse of `primary_ray`: a world position in the picture (x, y), in pixels, and its
    distance along the ray (z), negative behind a perspective camera."""
    offset = position - camera.position
    depth = dot(offset, camera.forward)
    # the plane that `primary_ray` spans: one unit deep, or through the camera
    across = offset - camera.forward * depth
    distance = depth
    if camera.perspective > 0.5:
        across = offset / max(abs(depth), MIN_DEPTH)
        distance = copysign(sqrt(dot(offset, offset)), depth)
    plane_point = across - camera.corner
    return Vec3(
        dot(plane_point, camera.right) / dot(camera.right, camera.right),
        dot(plane_point, camera.down) / dot(camera.down, camera.down),
        distance,
    )
