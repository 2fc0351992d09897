"""Ray-shape intersection in object space: plane, box, sphere, cylinder.

Each shape fits the cube from −½ to ½. uv (0, 0) is the top left corner of the picture, u to the
right, v down, seen from outside. cross(normal, ∂P/∂u) points along −∂P/∂v on all of them, so
nothing is mirrored. Shapes are visible from outside only: a ray that starts inside, or meets the
plane from behind, has no intersection.

A ray is a world ray transformed to object space. Its direction is not normalised, so that the
distance along it, in multiples of `direction`, is the same in both spaces.
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
MIN_COMPONENT = 1e-18
"""Lower limit of a direction's components in divisions: far below any that matters (the last place
of a component of 1 is 1e-7), and quotients by it stay far from overflow."""
MIN_SQUARED_LENGTH = 1e-24
"""Lower limit of the squared length of a direction projected along an axis."""
FAR = 1e9
"""A distance beyond everything."""
MIN_RING = 1e-4
"""Lower limit of the radius of a circle of latitude on the unit sphere: at the poles ∂P/∂u would
vanish."""


@struct
class ShapeRay:
    """A ray in object space; `direction` has any length but 0."""

    origin: Vec3
    direction: Vec3


@struct
class ShapeIntersection:
    """The intersection of a ray with a shape, in object space.

    `distance` is the ray's parameter at the entry, above 0; `t_exit` that at the exit, FAR for the
    plane, which has no inside. `normal` is the outward unit normal. Where nothing is `found`,
    position and normal are still valid: those of the front.
    """

    found: bool
    distance: float
    t_exit: float
    position: Vec3
    normal: Vec3


@struct
class Chart:
    """The texture parameterisation at a point of the shape: coordinates and the derivatives
    `along_u` = ∂P/∂u and `along_v` = ∂P/∂v, which are never of length 0."""

    uv: Vec2
    along_u: Vec3
    along_v: Vec3


@struct
class Interval:
    """An interval of ray parameters; empty where `t_enter` > `t_exit`."""

    t_enter: float
    t_exit: float


@shader
def intersect_shape(ray: ShapeRay, variant: Variant) -> ShapeIntersection:
    """The first intersection of a ray with the outside of the variant's shape."""
    if variant.shape == "box":
        return intersect_box(ray)
    if variant.shape == "sphere":
        return intersect_sphere(ray)
    if variant.shape == "cylinder":
        return intersect_cylinder(ray)
    return intersect_plane(ray)


@shader
def chart(position: Vec3, normal: Vec3, variant: Variant) -> Chart:
    """The texture parameterisation at a point of the variant's shape."""
    if variant.shape == "sphere":
        return sphere_chart(normal)
    if variant.shape == "cylinder":
        return cylinder_chart(position, normal)
    return plane_chart(position, normal)


@shader
def max_shell_distance(raised: float, variant: Variant) -> float:
    """The longest distance of a ray within a shell around the shape, `raised` thick, before it
    meets the shape; the grazing ray has it.

    On a sphere of radius ½ it is √((½ + raised)² − ½²). The flat faces of a box end like a curve of
    twice the radius, the caps of a cylinder like its side.
    """
    if variant.shape == "plane":
        return FAR
    return sqrt(raised * ((2.0 if variant.shape == "box" else 1.0) + raised))


@shader
def max_tile_width(variant: Variant) -> float:
    """The length of u from 0 to 1 where it is longest: a side, or the circumference."""
    return PI if variant.shape in ("sphere", "cylinder") else 1.0


@shader
def is_on_shape(uv: Vec2, variant: Variant) -> bool:
    """Whether the shape's own texture coordinates lie on the shape."""
    if variant.shape in ("sphere", "cylinder"):
        # closed along u; the rims are above and below
        return uv.y >= 0.0 and uv.y <= 1.0
    return min(uv.x, uv.y) >= 0.0 and max(uv.x, uv.y) <= 1.0


# --- intersections ---------------------------------------------------------------------------


@shader
def intersect_plane(ray: ShapeRay) -> ShapeIntersection:
    """The square from −½ to ½ in x and y at z = 0, facing +z."""
    height = ray.origin.z
    descent = -ray.direction.z
    if height <= 0.0 or descent < MIN_COMPONENT:
        return no_intersection()
    distance = height / descent
    point = ray.origin + ray.direction * distance
    if max(abs(point.x), abs(point.y)) > 0.5:
        return no_intersection()
    return ShapeIntersection(True, distance, FAR, Vec3(point.xy, 0.0), Vec3(0.0, 0.0, 1.0))


@shader
def intersect_box(ray: ShapeRay) -> ShapeIntersection:
    """The cube from −½ to ½."""
    x = slab_interval(ray.origin.x, ray.direction.x)
    y = slab_interval(ray.origin.y, ray.direction.y)
    z = slab_interval(ray.origin.z, ray.direction.z)
    inside = overlap(overlap(x, y), z)
    if inside.t_enter <= 0.0 or inside.t_enter > inside.t_exit:
        return no_intersection()
    point = clamp(ray.origin + ray.direction * inside.t_enter, -0.5, 0.5)
    normal = Vec3(0.0, 0.0, -copysign(1.0, ray.direction.z))
    position = Vec3(point.xy, 0.5 * normal.z)
    if x.t_enter >= max(y.t_enter, z.t_enter):
        normal = Vec3(-copysign(1.0, ray.direction.x), 0.0, 0.0)
        position = Vec3(0.5 * normal.x, point.yz)
    elif y.t_enter >= z.t_enter:
        normal = Vec3(0.0, -copysign(1.0, ray.direction.y), 0.0)
        position = Vec3(point.x, 0.5 * normal.y, point.z)
    return ShapeIntersection(True, inside.t_enter, inside.t_exit, position, normal)


@shader
def intersect_sphere(ray: ShapeRay) -> ShapeIntersection:
    """The sphere of radius ½."""
    inside = sphere_interval(ray.origin, ray.direction)
    if inside.t_enter <= 0.0 or inside.t_enter > inside.t_exit:
        return no_intersection()
    normal = normalize(ray.origin + ray.direction * inside.t_enter)
    return ShapeIntersection(True, inside.t_enter, inside.t_exit, normal * 0.5, normal)


@shader
def intersect_cylinder(ray: ShapeRay) -> ShapeIntersection:
    """The cylinder of radius ½ around the y axis from y = −½ to ½, closed by flat caps."""
    side = sphere_interval(
        Vec3(ray.origin.x, 0.0, ray.origin.z), Vec3(ray.direction.x, 0.0, ray.direction.z)
    )
    caps = slab_interval(ray.origin.y, ray.direction.y)
    inside = overlap(side, caps)
    if inside.t_enter <= 0.0 or inside.t_enter > inside.t_exit:
        return no_intersection()
    point = clamp(ray.origin + ray.direction * inside.t_enter, -0.5, 0.5)
    if caps.t_enter >= side.t_enter:
        cap = Vec3(0.0, -copysign(1.0, ray.direction.y), 0.0)
        return ShapeIntersection(
            True, inside.t_enter, inside.t_exit, Vec3(point.x, 0.5 * cap.y, point.z), cap
        )
    normal = normalize(Vec3(point.x, 0.0, point.z))
    position = Vec3(0.5 * normal.x, point.y, 0.5 * normal.z)
    return ShapeIntersection(True, inside.t_enter, inside.t_exit, position, normal)


@shader
def no_intersection() -> ShapeIntersection:
    """The result for a ray that misses the shape."""
    return ShapeIntersection(False, 0.0, FAR, Vec3(0.0, 0.0, 0.5), Vec3(0.0, 0.0, 1.0))


# --- texture parameterisations ---------------------------------------------------------------


@shader
def plane_chart(position: Vec3, normal: Vec3) -> Chart:
    """The whole texture on a plane or a face of the box, u to the right.

    Seen from outside, the plane and the four sides have the picture's top towards +y. Top and
    bottom continue the front (+z) across their common edge: the top's picture has its top towards
    −z, the bottom's towards +z, and u runs along +x on both.
    """
    up = Vec3(0.0, 1.0 - abs(normal.y), -normal.y)
    right = cross(up, normal)
    return Chart(Vec2(0.5 + dot(position, right), 0.5 - dot(position, up)), right, -up)


@shader
def sphere_chart(normal: Vec3) -> Chart:
    """The sphere: u around the y axis, ½ at +z; v from the north pole (+y) down.

    ∂P/∂u vanishes at the poles; its length is kept above 0 by MIN_RING.
    """
    ring = sqrt(normal.x * normal.x + normal.z * normal.z)
    east = east_of(normal, ring)
    return Chart(
        uv=Vec2(azimuth_u(normal), atan2(ring, normal.y) / PI),
        along_u=east * (PI * max(ring, MIN_RING)),
        along_v=Vec3(normal.y * -east.z, -ring, normal.y * east.x) * (0.5 * PI),
    )


@shader
def cylinder_chart(position: Vec3, normal: Vec3) -> Chart:
    """The cylinder: on its side u runs around the y axis, ½ at +z, and v from the top down. The
    caps are parameterised as top and bottom of a box, with tiles as wide as on the side: a cap is
    1/π of u wide.
    """
    if normal.y != 0.0:
        cap = plane_chart(position, normal)
        return Chart(Vec2(0.5 + position.x / PI, cap.uv.y), cap.along_u * PI, cap.along_v)
    east = east_of(normal, 1.0)
    return Chart(Vec2(azimuth_u(normal), 0.5 - position.y), east * PI, Vec3(0.0, -1.0, 0.0))


# --- parts of the above ----------------------------------------------------------------------


@shader
def slab_interval(origin: float, direction: float) -> Interval:
    """The interval in which one coordinate of a ray is within −½ to ½.

    T. L. Kay and J. T. Kajiya, Ray Tracing Complex Scenes, 1986. A ray perpendicular to the axis
    gets a large finite interval: around 0 if it starts inside the slab, far from 0 if not.
    """
    step = copysign(max(abs(direction), MIN_COMPONENT), direction)
    half = copysign(0.5, direction)
    return Interval((-half - origin) / step, (half - origin) / step)


@shader
def overlap(a: Interval, b: Interval) -> Interval:
    """The intersection of two intervals."""
    return Interval(max(a.t_enter, b.t_enter), min(a.t_exit, b.t_exit))


@shader
def sphere_interval(origin: Vec3, direction: Vec3) -> Interval:
    """The interval of a ray within the sphere of radius ½; with y = 0 in both arguments, within the
    infinite cylinder.

    The discriminant is computed from the point closest to the centre, and the root that would
    cancel from the product of the two. E. Haines, J. Günther and T. Akenine-Möller, Precision
    Improvements for Ray/Sphere Intersection, 2019.
    """
    squared = max(dot(direction, direction), MIN_SQUARED_LENGTH)
    towards = -dot(origin, direction)
    closest = origin + direction * (towards / squared)
    half_chord_squared = 0.25 - dot(closest, closest)
    if half_chord_squared < 0.0:
        return Interval(1.0, 0.0)
    far = length(origin)
    outside = (far - 0.5) * (far + 0.5)
    root = sqrt(squared * half_chord_squared)
    # the root whose terms have the same sign; it is 0 only where the ray starts on the sphere and
    # leaves at once
    if towards >= 0.0:
        last = towards + root
        return Interval(outside / max(last, MIN_COMPONENT), last / squared)
    first = towards - root
    return Interval(first / squared, outside / min(first, -MIN_COMPONENT))


@shader
def east_of(normal: Vec3, ring: float) -> Vec3:
    """The unit vector around the y axis in the direction of u; `ring` is the length of normal.xz.

    On the axis itself it is +x, as at +z.
    """
    if ring > 0.0:
        return Vec3(normal.z / ring, 0.0, -normal.x / ring)
    return Vec3(1.0, 0.0, 0.0)


@shader
def azimuth_u(normal: Vec3) -> float:
    """u around the y axis, 0 to 1: ½ at +z, ¾ at +x, 0 and 1 at −z."""
    return 0.5 + atan2(normal.x, normal.z) / TWO_PI
