"""One pixel, whole: from the primary ray to the colour that it brings back."""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    Mat3,
    Texture,
    Vec2,
    Vec3,
    Vec4,
    clamp,
    normalize,
    shader,
    slot,
    sqrt,
    struct,
    transpose,
)
from basrelief.lang import length as length_of
from basrelief.shaders.camera import Camera, CameraRay, primary_ray
from basrelief.shaders.gradients import Footprint, along, transferred
from basrelief.shaders.height import height_at
from basrelief.shaders.lighting import (
    Light,
    Shading,
    ShadingPoint,
    ambient_light,
    arriving,
    reflectance,
)
from basrelief.shaders.projection import SHALLOWEST, projection
from basrelief.shaders.ray import Hit, Ray
from basrelief.shaders.shadow import Reaching, Shadowing, ShadowRay, shadow
from basrelief.shaders.shapes import ShapeRay, SurfacePoint, shape
from basrelief.shaders.surfaces.standard import Finish, Spot, Surface, standard_surface
from basrelief.shaders.tangent import Frame, frame_of, from_tangent, to_tangent, to_texture
from basrelief.shaders.techniques.technique import Settings, displace


@struct
class View:
    """The camera, and where within each pixel this picture samples: (½, ½) is the middle."""

    camera: Camera
    sample: Vec2


@struct
class Placement:
    """Where the object is, and how its texture lies on it.

    A world point p is `to_object @ (p − origin)` in object space; `to_world` is the inverse. The
    shape's own texture coordinates are multiplied by `tiling`, then `shift` is added. `proportion`
    is the width of the maps ÷ their height in texels, for which their normals were made.
    """

    origin: Vec3
    to_object: Mat3
    to_world: Mat3
    tiling: Vec2
    shift: Vec2
    proportion: float


@struct
class Depth:
    """How deep the relief is: `scale` is the whole range as a fraction of a tile's width.

    `level` is the height that lies on the polygon; `bias` is what the projection `biased` adds.
    """

    scale: float
    level: float
    bias: float


@struct
class Pixel:
    """What a pixel knows: linear colour with coverage, distance along the ray in world units
    (0 where nothing is hit), displaced texture coordinates, whether anything is hit, reads."""

    color: Vec4
    depth: float
    uv: Vec2
    hit: bool
    reads: int


@struct
class Meeting:
    """Where the view ray meets the object: the polygon's point, its frame, the view, the pixel."""

    point: SurfacePoint
    frame: Frame
    view: Vec3
    falling: float
    footprint: Footprint


@struct
class Displaced:
    """Where the ray ends: texture coordinates, how far beyond the polygon, heights read."""

    uv: Vec2
    further: float
    reads: int


@shader
def pixel(
    at: IVec2,
    view: View,
    placement: Placement,
    depth: Depth,
    settings: Settings,
    finish: Finish,
    shading: Shading,
    shadowing: Shadowing,
    field: HeightField,
    base_color: Texture,
    normal: Texture,
    response: Texture,
    emission: Texture,
    lights: Buffer[Light],
) -> Pixel:
    """Find the object, displace the texture, read its maps there, and light it."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement)
    if not met.point.found:
        return Pixel(Vec4(0.0), 0.0, Vec2(0.0), False, 0)
    moved = displaced(field, met, depth, settings)
    distance = met.point.distance + moved.further
    if distance <= 0.0 or not inside((moved.uv - placement.shift) / placement.tiling):
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    spot = Spot(moved.uv, met.footprint)
    surface = standard_surface(spot, finish, base_color, normal, response, emission)
    if surface.opacity <= 0.0:
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    point = shading_point(ray, placement, met, surface, distance)
    color = ambient_light(point, shading) + point.emission
    reads = moved.reads
    for k in range(len(lights)):
        # every light falls on the displaced point, read from the displaced maps
        incoming = arriving(lights[k], point.position)
        towards = placement.to_object @ incoming.direction
        reaching = unhidden(field, met, moved, depth, towards, shadowing)
        color = color + reflectance(point, shading, incoming) * reaching.share
        reads = reads + reaching.reads
    return Pixel(Vec4(color, surface.opacity), distance, moved.uv, True, reads)


# --- the steps -----------------------------------------------------------------------------------


@shader
def meet(ray: CameraRay, placement: Placement) -> Meeting:
    """Meet the object in its own space, where the relief is set: it scales with the object."""
    origin = placement.to_object @ (ray.origin - placement.origin)
    direction = placement.to_object @ ray.direction
    met = shape(ShapeRay(origin, direction))
    along_u = met.along_u / placement.tiling.x
    along_v = met.along_v / placement.tiling.y
    frame = frame_of(met.normal, along_u, along_v)
    # with a unit direction, so that a large object is no different from a small one
    falling = length_of(direction)
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
    tiled = met.uv * placement.tiling + placement.shift
    point = SurfacePoint(
        found=met.found,
        distance=met.distance,
        position=met.position,
        normal=met.normal,
        along_u=along_u,
        along_v=along_v,
        uv=tiled,
        leave=met.leave,
        radius=met.radius,
    )
    return Meeting(
        point=point,
        frame=frame,
        view=to_tangent(frame, -unit),
        falling=falling,
        footprint=Footprint(along(right, along_u, along_v), along(down, along_u, along_v)),
    )


@slot
def displaced(field: HeightField, met: Meeting, depth: Depth, settings: Settings) -> Displaced:
    """Where the ray ends: on the relief, or on the polygon itself."""


@shader
def with_relief(field: HeightField, met: Meeting, depth: Depth, settings: Settings) -> Displaced:
    """As the technique says; with no depth not one height is read."""
    if depth.scale <= 0.0:
        return Displaced(met.point.uv, 0.0, 0)
    hit = displace(field, relief_ray(met, depth), settings)
    return Displaced(hit.uv, beyond(met, depth, hit), hit.reads)


@shader
def without_relief(field: HeightField, met: Meeting, depth: Depth, settings: Settings) -> Displaced:
    """On the polygon: a material without heights, or the technique `flat`."""
    return Displaced(met.point.uv, 0.0, 0)


@slot
def unhidden(
    field: HeightField,
    met: Meeting,
    moved: Displaced,
    depth: Depth,
    towards: Vec3,
    shadowing: Shadowing,
) -> Reaching:
    """How much of a light, in a direction of object space, reaches the displaced point."""


@shader
def everything(
    field: HeightField,
    met: Meeting,
    moved: Displaced,
    depth: Depth,
    towards: Vec3,
    shadowing: Shadowing,
) -> Reaching:
    """All of it: no self-shadow."""
    return Reaching(1.0, 0)


@shader
def self_shadowed(
    field: HeightField,
    met: Meeting,
    moved: Displaced,
    depth: Depth,
    towards: Vec3,
    shadowing: Shadowing,
) -> Reaching:
    """What the relief leaves of it; nothing of a light behind the polygon."""
    light = to_tangent(met.frame, normalize(towards))
    if depth.scale <= 0.0:
        return Reaching(1.0, 0)
    if light.z <= SHALLOWEST:
        return Reaching(0.0, 0)
    rise = to_texture(light.xy * (depth.scale / light.z), met.frame.aspect)
    # from the surface itself: a technique may end the view ray below it
    surface = height_at(field, moved.uv)
    reaching = shadow(field, ShadowRay(moved.uv, surface, rise), shadowing)
    return Reaching(reaching.share, reaching.reads + 1)


@shader
def relief_ray(met: Meeting, depth: Depth) -> Ray:
    """The ray that a technique follows: the chosen projection, in texture coordinates."""
    move = projection(met.view, depth.bias) * -depth.scale
    fall = to_texture(move, met.frame.aspect)
    return Ray(met.point.uv, fall, depth.level, met.view.z)


@shader
def beyond(met: Meeting, depth: Depth, hit: Hit) -> float:
    """How much further than the polygon the true ray goes to reach the hit's height.

    A bent ray's depth too is that of its height, so that other objects meet the relief rightly.
    The relief of a curved surface is that of its tangent plane, which near the outline runs far
    from the shape: what is pushed in stays within it, what is raised within a shell around it.
    """
    width = depth.scale * met.frame.width
    further = (depth.level - hit.height) * width / (max(met.view.z, SHALLOWEST) * met.falling)
    shell = (1.0 - depth.level) * width
    before = sqrt(shell * (2.0 * met.point.radius + shell)) / met.falling
    return clamp(further, -before, met.point.leave - met.point.distance)


@shader
def shading_point(
    ray: CameraRay, placement: Placement, met: Meeting, surface: Surface, distance: float
) -> ShadingPoint:
    """The displaced point in world space, its normal bent by the normal map."""
    # a tile of other proportions than its maps is as steep as they are stretched
    stretch = met.frame.aspect / placement.proportion
    slanted = Vec3(surface.normal.x, surface.normal.y * stretch, surface.normal.z)
    bent = from_tangent(met.frame, slanted)
    return ShadingPoint(
        position=ray.origin + ray.direction * distance,
        normal=normalize(transpose(placement.to_object) @ bent),
        view=-ray.direction,
        base_color=surface.base_color,
        roughness=surface.roughness,
        metallic=surface.metallic,
        occlusion=surface.occlusion,
        emission=surface.emission,
    )


# --- the edge of the object ----------------------------------------------------------------------


@slot
def inside(place: Vec2) -> bool:
    """Whether there is anything at displaced coordinates, 0 to 1 over all of the shape."""


@shader
def anywhere(place: Vec2) -> bool:
    """The texture goes on for ever."""
    return True


@shader
def within(place: Vec2) -> bool:
    """What is displaced beyond the shape's own edge is not drawn."""
    return min(place.x, place.y) >= 0.0 and max(place.x, place.y) <= 1.0
