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
    struct,
    transpose,
)
from basrelief.shading.brdf import Shading, ShadingPoint, ambient_light, reflectance
from basrelief.shading.camera import CameraRay, primary_ray
from basrelief.shading.fog import Fog, fogged
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import (
    Meeting,
    Placement,
    View,
    clipped,
    footprint_at,
    meet,
)
from basrelief.shading.lights import Light, arriving
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.relief import (
    Intersection,
    ReliefParameters,
    displaced,
    self_shadow_visibility,
    slope_of,
)
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.shadow_map import ShadowMapView, shadow_map_visibility
from basrelief.shading.shapes import widest
from basrelief.shading.surfaces.surface import (
    MapPlaces,
    Spot,
    Surface,
    SurfaceMaps,
    SurfaceSettings,
    surface_at,
)
from basrelief.shading.tangent_frame import aspect, from_tangent
from basrelief.shading.variant import Variant
from basrelief.techniques.height import Smoothing
from basrelief.techniques.technique import Settings

SOLID = 0.5
"""The least opacity that has a depth, and casts a shadow."""


@struct
class Pixel:
    """Linear colour with coverage, distance along the ray in world units (0 where nothing is hit,
    but in a depth map), displaced texture coordinates, whether anything is hit, heights read."""

    color: Vec4
    distance: float
    uv: Vec2
    hit: bool
    reads: int


@shader
def pixel(
    at: IVec2,
    view: View,
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    surface_parameters: SurfaceSettings,
    places: MapPlaces,
    shading: Shading,
    shadowing: Shadowing,
    fog: Fog,
    geometry: Geometry,
    field: HeightField,
    baked: Texture,
    maps: SurfaceMaps,
    lights: Buffer[Light],
    distances: HeightField,
    views: Buffer[ShadowMapView],
    variant: Variant,
) -> Pixel:
    """Find the object, displace the texture, read its maps there, and light it."""
    ray = primary_ray(view.camera, Vec2(float(at.x), float(at.y)) + view.sample)
    met = meet(ray, placement, variant)
    if not met.found:
        return Pixel(Vec4(0.0), 0.0, Vec2(0.0), False, 0)
    footprint = footprint_at(ray, placement, met, met.distance)
    moved = displaced(
        field, baked, met, footprint, placement, relief, smoothing, settings, shadowing, variant
    )
    distance = moved.distance
    if distance <= 0.0 or clipped(moved.uv, placement, variant):
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    spot = spot_on(field, met, moved, footprint, variant)
    surface = surface_at(spot, surface_parameters, places, maps, variant)
    if variant.depth_only:
        return Pixel(Vec4(0.0), distance, moved.uv, surface.opacity >= SOLID, moved.reads)
    if surface.opacity <= 0.0:
        return Pixel(Vec4(0.0), 0.0, moved.uv, False, moved.reads)
    point = shading_point(ray, placement, met, surface, spot.slope, distance, variant)
    receiving = receiver(point, ray, met, variant)
    color = ambient_light(point, shading) + point.emission
    reads = moved.reads
    for k in range(len(lights)):
        # every light falls on the displaced point, read from the displaced maps
        incoming = arriving(lights[k], point.position)
        light = reflectance(point, shading, incoming, variant)
        # what gives no light throws no shadow either
        if max(max(light.x, light.y), light.z) > 0.0:
            share = 1.0
            if variant.shadow_maps:
                share = shadow_map_visibility(distances, views, k, receiving)
            if variant.shadows != "none":
                towards = placement.to_object @ incoming.direction
                reaching = self_shadow_visibility(
                    field, baked, met, moved, smoothing, towards, settings, shadowing, variant
                )
                share = share * reaching.share
                reads = reads + reaching.reads
            if variant.occlusion_kind == "directional":
                share = share * directional_visibility(
                    point, moved.height, incoming.direction, shading
                )
            color = color + light * share
    if variant.fog_mode != "none":
        color = fogged(color, distance, fog, variant)
    return Pixel(Vec4(color, surface.opacity), distance, moved.uv, True, reads)


# --- the steps -----------------------------------------------------------------------------------


@shader
def spot_on(
    field: HeightField, met: Meeting, moved: Intersection, footprint: Footprint, variant: Variant
) -> Spot:
    """The place on the relief where the ray ended."""
    slope = slope_of(field, moved, met, variant)
    return Spot(
        uv=moved.uv,
        footprint=footprint,
        height=moved.height,
        found=moved.found,
        slope=slope.normal,
        deep=slope.deep,
        aspect=aspect(met.frame),
    )


@shader
def shading_point(
    ray: CameraRay,
    placement: Placement,
    met: Meeting,
    surface: Surface,
    slope: Vec3,
    distance: float,
    variant: Variant,
) -> ShadingPoint:
    """The displaced point in world space, its normal bent by the normal map."""
    # a tile of other proportions than its maps is as steep as they are stretched
    stretch = aspect(met.frame) / placement.proportion
    steeper = steepened(met, placement, variant)
    slanted = Vec3(
        surface.normal.x * steeper, surface.normal.y * stretch * steeper, surface.normal.z
    )
    bent = from_tangent(met.frame, facing(slanted, slope, variant))
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


@shader
def steepened(met: Meeting, placement: Placement, variant: Variant) -> float:
    """Slope of the relief as a multiple of that on the widest tile, for which normals are made:
    on a sphere the relief is as deep on narrower ones."""
    if variant.shape == "sphere" and variant.displaced:
        return widest(variant) / (abs(placement.tiling.x) * met.frame.width)
    return 1.0


@shader
def facing(normal: Vec3, slope: Vec3, variant: Variant) -> Vec3:
    """Which way the surface faces in tangent space: as the maps say, but on the side of a box as
    the side does, which no map knows."""
    if variant.columns and slope.z < 0.5:
        return slope
    return normal


# --- where other objects' shadows fall -----------------------------------------------------------


@shader
def receiver(point: ShadingPoint, ray: CameraRay, met: Meeting, variant: Variant) -> Vec3:
    """The place, in world space, on which the shadows of other objects fall: where the surface is
    seen, or on the polygon, as where displacement does not reach the shadows: they float above."""
    if variant.shadows_on == "relief":
        return point.position
    return ray.origin + ray.direction * met.distance


# --- occlusion with a direction ------------------------------------------------------------------


@shader
def directional_visibility(
    point: ShadingPoint, height: float, direction: Vec3, shading: Shading
) -> float:
    """How much of a light's direction the surroundings leave open: the occlusion map mixed with
    depth and N · L, a cheap likeness of soft shadows.

    Light along the normal reaches everything; the flatter it comes, the less reaches what is
    occluded and what is deep. After S. Halliwell, Parallax Offset, 2014, who gives no formula.
    """
    # what a march has not met may lie below all heights
    sheltered = point.occlusion * saturate(height)
    left = mix(sheltered, 1.0, saturate(dot(point.normal, direction)))
    return mix(1.0, left, shading.directional_occlusion)
