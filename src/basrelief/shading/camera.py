"""Primary rays: from a place in the picture to a ray in the world, with its derivatives.

The world is right-handed with y up. Places in the picture are in pixels, x to the right, y down,
(0, 0) the top left corner of the picture, pixel centres at + ½. `basrelief.scene.cameras` makes
cameras from a position and a target.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, copysign, dot, shader, sqrt, struct

NEAREST = 1e-6
"""The least depth that a position is divided by, in world units."""


@struct
class Camera:
    """A camera as the shaders need it; lengths in world units.

    `corner + right · x + down · y` leads to the place (x, y) of the picture: in perspective
    (1) it is the direction of the ray from `position`, one unit deep along `forward`; in
    orthographic projection (0) it is where the ray starts, from `position`, and lies across
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
    """A ray and how it changes from one pixel to the next: `_dx` to the right, `_dy` downwards.

    `direction` is of unit length; its derivatives are those of the unit vector, per pixel.
    """

    origin: Vec3
    direction: Vec3
    origin_dx: Vec3
    origin_dy: Vec3
    direction_dx: Vec3
    direction_dy: Vec3


@shader
def primary_ray(camera: Camera, sample: Vec2) -> CameraRay:
    """The ray through a place of the picture, in pixels, and its analytic derivatives.

    After H. Igehy, Tracing Ray Differentials, 1999.
    """
    parallel = 1.0 - camera.perspective
    spanned = camera.corner + camera.right * sample.x + camera.down * sample.y
    towards = spanned * camera.perspective + camera.forward * parallel
    scale = 1.0 / sqrt(dot(towards, towards))
    direction = towards * scale
    return CameraRay(
        origin=camera.position + spanned * parallel,
        direction=direction,
        origin_dx=camera.right * parallel,
        origin_dy=camera.down * parallel,
        direction_dx=change_of_unit(direction, camera.right * (camera.perspective * scale)),
        direction_dy=change_of_unit(direction, camera.down * (camera.perspective * scale)),
    )


@shader
def change_of_unit(unit: Vec3, change: Vec3) -> Vec3:
    """The change of a normalised vector, given the vector's own ÷ its length: the part across it.

    Igehy's equation 8 after taking |d| out: d/dx (d ÷ |d|) = (d′ − û (û · d′)) ÷ |d|.
    """
    return change - unit * dot(unit, change)


@shader
def seen_from(camera: Camera, position: Vec3) -> Vec3:
    """The other way round: the place in the picture where a position is seen, and how far along
    that place's ray it is; the distance is below 0 behind a camera in perspective."""
    offset = position - camera.position
    deep = dot(offset, camera.forward)
    # the same plane that `primary_ray` spans: one unit deep, or through the camera
    across = offset - camera.forward * deep
    distance = deep
    if camera.perspective > 0.5:
        across = offset / max(abs(deep), NEAREST)
        distance = copysign(sqrt(dot(offset, offset)), deep)
    spanned = across - camera.corner
    return Vec3(
        dot(spanned, camera.right) / dot(camera.right, camera.right),
        dot(spanned, camera.down) / dot(camera.down, camera.down),
        distance,
    )
