"""Where a ray meets a shape, in the shape's own space: plane, box, sphere, cylinder.

Each shape fits the cube from −½ to ½. uv (0, 0) is the top left corner of the picture, u to the
right, v down, as seen from outside; cross(normal, ∂P/∂u) points along −∂P/∂v on each of them, so
nothing is mirrored. Only the outside is seen: a ray that starts inside, or meets the plane from
behind, finds nothing.

A ray is a world ray taken to object space, its direction not normalised, so that the distance
along it, in multiples of `direction`, is the same in both spaces.
"""

from __future__ import annotations

from basrelief.lang import (
    Vec2,
    Vec3,
    atan2,
    clamp,
    copysign,
    cross,
    dot,
    length,
    normalize,
    shader,
    sqrt,
    struct,
)
from basrelief.shading.variant import Variant

PI = 3.14159265358979
TWO_PI = 6.28318530717959
SLOWEST = 1e-18
"""Directions' components are held to at least this: far below any that matters (a component of 1
has 1e-7 of itself as its last place), and the quotients by it far from overflow."""
SLOWEST_SQUARED = 1e-24
"""The same for the squared length of a direction seen along an axis."""
FAR = 1e9
"""Further than anything is."""
NARROWEST = 1e-4
"""The sine of the angle from the pole below which the sphere's circle of latitude is held."""


@struct
class ShapeRay:
    """A ray in object space; `direction` is of any length but 0."""

    origin: Vec3
    direction: Vec3


@struct
class SurfacePoint:
    """Where a ray meets a shape, in object space.

    `distance` is the ray's parameter there, above 0, `t_exit` that where it leaves the shape again,
    FAR for the plane, which has no inside; `normal` the outward unit normal. Where nothing is
    `found` position and normal are sound all the same, those of the front.
    """

    found: bool
    distance: float
    t_exit: float
    position: Vec3
    normal: Vec3


@struct
class Chart:
    """How the shape's own texture lies at a point: coordinates, and ∂P/∂u and ∂P/∂v there, never of
    length 0."""

    uv: Vec2
    along_u: Vec3
    along_v: Vec3


@struct
class Interval:
    """The part of a ray within something, as parameters; empty where `enter` > `leave`."""

    enter: float
    leave: float


@shader
def shape(ray: ShapeRay, variant: Variant) -> SurfacePoint:
    """The nearest point of the chosen shape's outside that the ray meets."""
    if variant.shape == "box":
        return box(ray)
    if variant.shape == "sphere":
        return sphere(ray)
    if variant.shape == "cylinder":
        return cylinder(ray)
    return plane(ray)


@shader
def chart(position: Vec3, normal: Vec3, variant: Variant) -> Chart:
    """How the texture lies on the chosen shape, at a point of it."""
    if variant.shape == "sphere":
        return globe(normal)
    if variant.shape == "cylinder":
        return barrel(position, normal)
    return square(position, normal)


@shader
def shell_depth(raised: float, variant: Variant) -> float:
    """The longest way of a ray through a shell around the chosen shape, `raised` thick, before it
    meets the shape: all but along it. The flat faces of a box end like a curve of twice the radius;
    the caps of a cylinder like its side.
    """
    if variant.shape == "plane":
        return FAR
    return sqrt(raised * ((2.0 if variant.shape == "box" else 1.0) + raised))


@shader
def widest(variant: Variant) -> float:
    """The length of u from 0 to 1 where it is longest: a side, or the circumference."""
    return PI if variant.shape in ("sphere", "cylinder") else 1.0


@shader
def on_shape(uv: Vec2, variant: Variant) -> bool:
    """Whether there is anything of the shape at its own texture coordinates."""
    if variant.shape in ("sphere", "cylinder"):
        # it goes round: it has rims above and below, and none along u
        return uv.y >= 0.0 and uv.y <= 1.0
    return min(uv.x, uv.y) >= 0.0 and max(uv.x, uv.y) <= 1.0


# --- where a ray meets them ------------------------------------------------------------------


@shader
def plane(ray: ShapeRay) -> SurfacePoint:
    """The square from −½ to ½ in x and y at z = 0, facing +z."""
    height = ray.origin.z
    falling = -ray.direction.z
    if height <= 0.0 or falling < SLOWEST:
        return nothing()
    distance = height / falling
    met = ray.origin + ray.direction * distance
    if max(abs(met.x), abs(met.y)) > 0.5:
        return nothing()
    return SurfacePoint(True, distance, FAR, Vec3(met.xy, 0.0), Vec3(0.0, 0.0, 1.0))


@shader
def box(ray: ShapeRay) -> SurfacePoint:
    """The cube from −½ to ½."""
    x = slab(ray.origin.x, ray.direction.x)
    y = slab(ray.origin.y, ray.direction.y)
    z = slab(ray.origin.z, ray.direction.z)
    span = both(both(x, y), z)
    if span.enter <= 0.0 or span.enter > span.leave:
        return nothing()
    met = clamp(ray.origin + ray.direction * span.enter, -0.5, 0.5)
    normal = Vec3(0.0, 0.0, -copysign(1.0, ray.direction.z))
    position = Vec3(met.xy, 0.5 * normal.z)
    if x.enter >= max(y.enter, z.enter):
        normal = Vec3(-copysign(1.0, ray.direction.x), 0.0, 0.0)
        position = Vec3(0.5 * normal.x, met.yz)
    elif y.enter >= z.enter:
        normal = Vec3(0.0, -copysign(1.0, ray.direction.y), 0.0)
        position = Vec3(met.x, 0.5 * normal.y, met.z)
    return SurfacePoint(True, span.enter, span.leave, position, normal)


@shader
def sphere(ray: ShapeRay) -> SurfacePoint:
    """The sphere of radius ½."""
    span = ball(ray.origin, ray.direction)
    if span.enter <= 0.0 or span.enter > span.leave:
        return nothing()
    normal = normalize(ray.origin + ray.direction * span.enter)
    return SurfacePoint(True, span.enter, span.leave, normal * 0.5, normal)


@shader
def cylinder(ray: ShapeRay) -> SurfacePoint:
    """The cylinder of radius ½ around the y axis from y = −½ to ½, closed by flat caps."""
    side = ball(Vec3(ray.origin.x, 0.0, ray.origin.z), Vec3(ray.direction.x, 0.0, ray.direction.z))
    caps = slab(ray.origin.y, ray.direction.y)
    span = both(side, caps)
    if span.enter <= 0.0 or span.enter > span.leave:
        return nothing()
    met = clamp(ray.origin + ray.direction * span.enter, -0.5, 0.5)
    if caps.enter >= side.enter:
        cap = Vec3(0.0, -copysign(1.0, ray.direction.y), 0.0)
        return SurfacePoint(True, span.enter, span.leave, Vec3(met.x, 0.5 * cap.y, met.z), cap)
    normal = normalize(Vec3(met.x, 0.0, met.z))
    position = Vec3(0.5 * normal.x, met.y, 0.5 * normal.z)
    return SurfacePoint(True, span.enter, span.leave, position, normal)


@shader
def nothing() -> SurfacePoint:
    """No point."""
    return SurfacePoint(False, 0.0, FAR, Vec3(0.0, 0.0, 0.5), Vec3(0.0, 0.0, 1.0))


# --- how the texture lies on them ------------------------------------------------------------


@shader
def square(position: Vec3, normal: Vec3) -> Chart:
    """The whole texture on a flat face of a plane or box, u to the right.

    Seen from outside, the plane and the four sides have the picture's top towards +y. Top and
    bottom go on from the front (+z) where they meet it: the top's picture has its top towards −z,
    the bottom's towards +z, and u runs along +x on both.
    """
    up = Vec3(0.0, 1.0 - abs(normal.y), -normal.y)
    right = cross(up, normal)
    return Chart(Vec2(0.5 + dot(position, right), 0.5 - dot(position, up)), right, -up)


@shader
def globe(normal: Vec3) -> Chart:
    """The sphere: u around the y axis, ½ at +z; v from the north pole (+y) down.

    At the poles ∂P/∂u vanishes; closer to them than an angle of 1e-4 its length is held there.
    """
    ring = sqrt(normal.x * normal.x + normal.z * normal.z)
    east = east_of(normal, ring)
    return Chart(
        uv=Vec2(around(normal), atan2(ring, normal.y) / PI),
        along_u=east * (PI * max(ring, NARROWEST)),
        along_v=Vec3(normal.y * -east.z, -ring, normal.y * east.x) * (0.5 * PI),
    )


@shader
def barrel(position: Vec3, normal: Vec3) -> Chart:
    """The cylinder: on its side u runs around the y axis, ½ at +z, and v from the top down. The
    caps lie as a box's top and bottom do, a tile as wide as on the side: a cap is 1/π of u wide.
    """
    if normal.y != 0.0:
        cap = square(position, normal)
        return Chart(Vec2(0.5 + position.x / PI, cap.uv.y), cap.along_u * PI, cap.along_v)
    east = east_of(normal, 1.0)
    return Chart(Vec2(around(normal), 0.5 - position.y), east * PI, Vec3(0.0, -1.0, 0.0))


# --- what they are made of -------------------------------------------------------------------


@shader
def slab(origin: float, direction: float) -> Interval:
    """Where one coordinate of a ray is within −½ to ½.

    After T. L. Kay and J. T. Kajiya, Ray Tracing Complex Scenes, 1986. A ray across the axis gets
    a large finite interval: around 0 when it starts within, far from it when not.
    """
    step = copysign(max(abs(direction), SLOWEST), direction)
    half = copysign(0.5, direction)
    return Interval((-half - origin) / step, (half - origin) / step)


@shader
def both(a: Interval, b: Interval) -> Interval:
    """What two intervals share."""
    return Interval(max(a.enter, b.enter), min(a.leave, b.leave))


@shader
def ball(origin: Vec3, direction: Vec3) -> Interval:
    """Where a ray is within the sphere of radius ½.

    After E. Haines, J. Günther and T. Akenine-Möller, Precision Improvements for Ray/Sphere
    Intersection, 2019: the discriminant from the point closest to the centre, and the root that
    would cancel from the product of the two. With the y of both at 0 it is the endless cylinder.
    """
    squared = max(dot(direction, direction), SLOWEST_SQUARED)
    towards = -dot(origin, direction)
    closest = origin + direction * (towards / squared)
    room = 0.25 - dot(closest, closest)
    if room < 0.0:
        return Interval(1.0, 0.0)
    far = length(origin)
    outside = (far - 0.5) * (far + 0.5)
    root = sqrt(squared * room)
    # the root whose terms have the same sign; its size is 0 only where the ray starts on the
    # sphere and leaves at once
    if towards >= 0.0:
        last = towards + root
        return Interval(outside / max(last, SLOWEST), last / squared)
    first = towards - root
    return Interval(first / squared, outside / min(first, -SLOWEST))


@shader
def east_of(normal: Vec3, ring: float) -> Vec3:
    """The unit vector around the y axis in the sense of u; `ring` is normal.xz's length.

    On the axis itself, +x, as at +z.
    """
    if ring > 0.0:
        return Vec3(normal.z / ring, 0.0, -normal.x / ring)
    return Vec3(1.0, 0.0, 0.0)


@shader
def around(normal: Vec3) -> float:
    """u around the y axis, 0 to 1: ½ at +z, ¾ at +x, 0 and 1 at −z."""
    return 0.5 + atan2(normal.x, normal.z) / TWO_PI
