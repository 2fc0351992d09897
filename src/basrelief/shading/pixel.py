"""One pixel, whole: from the primary ray to the colour that it brings back."""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    Texture,
    Vec2,
    Vec3,
    Vec4,
    dot,
    mix,
    normalize,
    saturate,
    shader,
    slot,
    struct,
    transpose,
)
from basrelief.shading.brdf import Shading, ShadingPoint, ambient_light, reflectance
from basrelief.shading.camera import CameraRay, primary_ray
from basrelief.shading.fog import Fog, fogged
from basrelief.shading.intersection import Meeting, Placement, View, meet
from basrelief.shading.lights import Light, arriving
from basrelief.shading.relief import Depth, Displaced, displaced, self_shadowed, slope_of
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.shadow_map import CastView, reaching_past_others
from basrelief.shading.surfaces.surface import (
    MapPlaces,
    Spot,
    Surface,
    SurfaceSettings,
    surface_at,
)
from basrelief.shading.tangent_frame import from_tangent
from basrelief.shading.variant import Variant
from basrelief.techniques.height import Smoothing
from basrelief.techniques.technique import Settings

SOLID = 0.5
"""The least opacity that has a depth, and casts a shadow."""


@struct
class Pixel:
    """What a pixel knows: linear colour with coverage, distance along the ray in world units
    (0 where nothing is hit), displaced texture coordinates, whether anything is hit, reads."""

    color: Vec4
    depth: float
    uv: Vec2
    hit: bool
    reads: int


@shader
def pixel(
    at: IVec2,
    view: View,
    placement: Placement,
    depth: Depth,
    smoothing: Smoothing,
    settings: Settings,
    finish: SurfaceSettings,
    places: MapPlaces,
    shading: Shading,
    shadowing: Shadowing,
    fog: Fog,
    field: HeightField,
    baked: Texture,
    base_color: Texture,
    normal: Texture,
    response: Texture,
    emission: Texture,
    layer_color: Texture,
    layer_normal: Texture,
    lights: Buffer[Light],
    distances: HeightField,
    views: Buffer[CastView],
    variant: Variant,
) -> Pixel:
    """Find the object, displace the texture, read its maps there, and light it."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement)
    if not met.point.found:
        return Pixel(Vec4(0.0), 0.0, Vec2(0.0), False, 0)
    moved = displaced(field, baked, met, depth, smoothing, settings)
    distance = met.point.distance + moved.further
    if distance <= 0.0 or not inside((moved.uv - placement.shift) / placement.tiling):
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    spot = spot_on(field, met, moved, depth)
    surface = surface_at(
        spot, finish, places, base_color, normal, response, emission,
        layer_color, layer_normal, variant,
    )  # fmt: skip
    if surface.opacity <= 0.0:
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    point = shading_point(ray, placement, met, surface, spot.slope, distance)
    receiving = receiver(point, ray, met)
    color = ambient_light(point, shading) + point.emission
    reads = moved.reads
    for k in range(len(lights)):
        # every light falls on the displaced point, read from the displaced maps
        incoming = arriving(lights[k], point.position)
        light = reflectance(point, shading, incoming, variant)
        # what gives no light throws no shadow either
        if max(max(light.x, light.y), light.z) > 0.0:
            share = reaching_past_others(distances, views, k, receiving)
            if variant.shadows != "none" and variant.displaced:
                towards = placement.to_object @ incoming.direction
                reaching = self_shadowed(
                    field, met, moved, depth, smoothing, towards, shadowing, variant
                )
                share = share * reaching.share
                reads = reads + reaching.reads
            if variant.occlusion_kind == "directional":
                open = open_from_above(point, moved.height, incoming.direction, shading)
                share = share * open
            color = color + light * share
    if variant.fog != "none":
        color = fogged(color, distance, fog, variant)
    return Pixel(Vec4(color, surface.opacity), distance, moved.uv, True, reads)


# --- a depth map ---------------------------------------------------------------------------------


@struct
class Reach:
    """How far a ray goes until it meets the object, in world units; `hit` says whether it does."""

    depth: float
    hit: bool


@shader
def reach(
    at: IVec2,
    view: View,
    placement: Placement,
    depth: Depth,
    smoothing: Smoothing,
    settings: Settings,
    finish: SurfaceSettings,
    places: MapPlaces,
    field: HeightField,
    baked: Texture,
    base_color: Texture,
    normal: Texture,
    response: Texture,
    emission: Texture,
    layer_color: Texture,
    layer_normal: Texture,
    variant: Variant,
) -> Reach:
    """The pixel of a depth map: the same object, relief and opacity, and no light."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement)
    if not met.point.found:
        return Reach(0.0, False)
    moved = displaced(field, baked, met, depth, smoothing, settings)
    distance = met.point.distance + moved.further
    if distance <= 0.0 or not inside((moved.uv - placement.shift) / placement.tiling):
        return Reach(0.0, False)
    surface = surface_at(
        spot_on(field, met, moved, depth), finish, places, base_color, normal, response, emission,
        layer_color, layer_normal, variant,
    )  # fmt: skip
    return Reach(distance, surface.opacity >= SOLID)


# --- the steps -----------------------------------------------------------------------------------


@shader
def spot_on(field: HeightField, met: Meeting, moved: Displaced, depth: Depth) -> Spot:
    """The place on the relief where the ray ended."""
    slope = slope_of(field, moved, met, depth)
    return Spot(
        uv=moved.uv,
        footprint=met.footprint,
        height=moved.height,
        found=moved.found,
        slope=slope.normal,
        deep=slope.deep,
        aspect=met.frame.aspect,
    )


@shader
def shading_point(
    ray: CameraRay,
    placement: Placement,
    met: Meeting,
    surface: Surface,
    slope: Vec3,
    distance: float,
) -> ShadingPoint:
    """The displaced point in world space, its normal bent by the normal map."""
    # a tile of other proportions than its maps is as steep as they are stretched
    stretch = met.frame.aspect / placement.proportion
    slanted = Vec3(surface.normal.x, surface.normal.y * stretch, surface.normal.z)
    bent = from_tangent(met.frame, facing(slanted, slope))
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


@slot
def facing(normal: Vec3, slope: Vec3) -> Vec3:
    """Which way the surface faces in tangent space: the maps' normal, and the relief's own."""


@shader
def as_mapped(normal: Vec3, slope: Vec3) -> Vec3:
    """The maps know."""
    return normal


@shader
def as_the_side(normal: Vec3, slope: Vec3) -> Vec3:
    """On the side of a box as the side does, which no map knows."""
    return slope if slope.z < 0.5 else normal


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


@shader
def within_rims(place: Vec2) -> bool:
    """The same on a shape that goes round: it has rims above and below, and none along u."""
    return place.y >= 0.0 and place.y <= 1.0


# --- where other objects' shadows fall -----------------------------------------------------------


@slot
def receiver(point: ShadingPoint, ray: CameraRay, met: Meeting) -> Vec3:
    """The place, in world space, on which the shadows of other objects fall."""


@shader
def on_the_relief(point: ShadingPoint, ray: CameraRay, met: Meeting) -> Vec3:
    """Where the surface is seen."""
    return point.position


@shader
def on_the_polygon(point: ShadingPoint, ray: CameraRay, met: Meeting) -> Vec3:
    """On the polygon, as where displacement does not reach the shadows: they float above it."""
    return ray.origin + ray.direction * met.point.distance


# --- occlusion with a direction ------------------------------------------------------------------


@shader
def open_from_above(point: ShadingPoint, height: float, direction: Vec3, shading: Shading) -> float:
    """How much of a light's direction the surroundings leave open: the occlusion map mixed with
    depth and N · L, a cheap likeness of soft shadows.

    Light along the normal reaches everything; the flatter it comes, the less reaches what is
    occluded and what is deep. After S. Halliwell, Parallax Offset, 2014, who gives no formula.
    """
    # what a march has not met may lie below all heights
    sheltered = point.occlusion * saturate(height)
    left = mix(sheltered, 1.0, saturate(dot(point.normal, direction)))
    return mix(1.0, left, shading.directional_occlusion)
