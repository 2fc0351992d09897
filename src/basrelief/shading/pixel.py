"""The pixel shader: from the primary ray to the colour of one pixel."""

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
from basrelief.shading.fog import Fog, apply_fog
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import (
    CameraSample,
    Intersection,
    Placement,
    footprint_at,
    intersect,
    is_clipped,
)
from basrelief.shading.lights import Light, incident_light
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.relief import (
    ReliefHit,
    ReliefParameters,
    relief_normal,
    self_shadow_visibility,
    trace_relief,
)
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.shadow_map import ShadowMapView, shadow_map_visibility
from basrelief.shading.shapes import max_tile_width
from basrelief.shading.surfaces.surface import (
    MapTilings,
    Surface,
    SurfacePoint,
    SurfaceSettings,
    surface_at,
)
from basrelief.shading.tangent_frame import aspect, from_tangent
from basrelief.shading.variant import Variant
from basrelief.techniques.height import Smoothing, surface_height
from basrelief.techniques.technique import Settings

SOLID = 0.5
"""The least opacity that is drawn to depth and casts a shadow."""


@struct
class Pixel:
    """The result for one pixel.

    `color` is linear, with coverage. `distance` is along the ray, in world units, 0 where nothing
    is hit (except in a depth map). `uv` are the displaced texture coordinates, `hit` says whether
    the object is hit, `reads` counts the heights read.
    """

    color: Vec4
    distance: float
    uv: Vec2
    hit: bool
    reads: int


@shader
def pixel(
    at: IVec2,
    sample: CameraSample,
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    surface_parameters: SurfaceSettings,
    tilings: MapTilings,
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
    """Intersect the object, displace the texture coordinates, sample the maps there and light the
    point."""
    ray = primary_ray(sample.camera, Vec2(float(at.x), float(at.y)) + sample.offset)
    intersection = intersect(ray, placement, variant)
    if not intersection.found:
        return Pixel(Vec4(0.0), 0.0, Vec2(0.0), False, 0)
    footprint = footprint_at(ray, placement, intersection, intersection.distance)
    relief_hit = trace_relief(
        field,
        baked,
        intersection,
        footprint,
        placement,
        relief,
        smoothing,
        settings,
        shadowing,
        variant,
    )
    distance = relief_hit.distance
    if distance <= 0.0 or is_clipped(relief_hit.uv, placement, variant):
        return Pixel(Vec4(0.0), 0.0, relief_hit.uv, False, relief_hit.reads)
    point = surface_point(field, intersection, relief_hit, footprint, smoothing, variant)
    surface = surface_at(point, surface_parameters, tilings, maps, variant)
    if variant.depth_only:
        return Pixel(Vec4(0.0), distance, relief_hit.uv, surface.opacity >= SOLID, relief_hit.reads)
    if surface.opacity <= 0.0:
        return Pixel(Vec4(0.0), 0.0, relief_hit.uv, False, relief_hit.reads)
    shaded = shading_point(
        ray, placement, intersection, surface, point.relief_normal, distance, variant
    )
    receiver = shadow_receiver(shaded, ray, intersection, variant)
    color = ambient_light(shaded, shading) + shaded.emission
    reads = relief_hit.reads
    for k in range(len(lights)):
        # every light falls on the displaced point, shaded by the displaced maps
        incident = incident_light(lights[k], shaded.position)
        light = reflectance(shaded, shading, incident, variant)
        # a light that contributes nothing needs no shadow
        if max(max(light.x, light.y), light.z) > 0.0:
            visibility = 1.0
            if variant.shadow_maps:
                visibility = shadow_map_visibility(distances, views, k, receiver)
            if variant.shadows != "none":
                towards = placement.to_object @ incident.direction
                self_shadow = self_shadow_visibility(
                    field,
                    baked,
                    intersection,
                    relief_hit,
                    smoothing,
                    towards,
                    settings,
                    shadowing,
                    variant,
                )
                visibility = visibility * self_shadow.visibility
                reads = reads + self_shadow.reads
            if variant.occlusion_kind == "directional":
                visibility = visibility * directional_visibility(
                    shaded, relief_hit.height, incident.direction, shading
                )
            color = color + light * visibility
    if variant.fog_mode != "none":
        color = apply_fog(color, distance, fog, variant)
    return Pixel(Vec4(color, surface.opacity), distance, relief_hit.uv, True, reads)


# --- the point that is shaded --------------------------------------------------------------------


@shader
def surface_point(
    field: HeightField,
    intersection: Intersection,
    relief_hit: ReliefHit,
    footprint: Footprint,
    smoothing: Smoothing,
    variant: Variant,
) -> SurfacePoint:
    """The point of the relief that the surface's maps are sampled for."""
    relief = relief_normal(field, relief_hit, intersection, variant)
    return SurfacePoint(
        uv=relief_hit.uv,
        offset=relief_hit.uv - intersection.uv,
        footprint=footprint,
        height=ground_height(field, relief_hit, smoothing, variant),
        found=relief_hit.found,
        relief_normal=relief.normal,
        height_in_tiles=relief.height_in_tiles,
        aspect=aspect(intersection.frame),
    )


@shader
def ground_height(
    field: HeightField, relief_hit: ReliefHit, smoothing: Smoothing, variant: Variant
) -> float:
    """The height that a landscape's colours follow: the surface's at the hit, as in habrador.

    A technique may end its ray above or below the surface. On columns, a side that is hit has the
    hit's height, which the top does not tell.
    """
    if variant.surface != "landscape" or not variant.displaced or variant.columns:
        return relief_hit.height
    # a flat relief has its height from the map already
    if relief_hit.scale <= 0.0:
        return relief_hit.height
    return surface_height(field, relief_hit.uv, relief_hit.lod, smoothing.mip_fade)


@shader
def shading_point(
    ray: CameraRay,
    placement: Placement,
    intersection: Intersection,
    surface: Surface,
    relief_normal: Vec3,
    distance: float,
    variant: Variant,
) -> ShadingPoint:
    """The displaced point in world space, with the normal of the normal map."""
    # on a tile of other proportions than its maps, slopes along v are stretched with it
    stretch = aspect(intersection.frame) / placement.proportion
    slope = slope_scale(intersection, placement, variant)
    stretched_normal = Vec3(
        surface.normal.x * slope, surface.normal.y * stretch * slope, surface.normal.z
    )
    object_normal = from_tangent(
        intersection.frame, shading_normal(stretched_normal, relief_normal, variant)
    )
    return ShadingPoint(
        position=ray.origin + ray.direction * distance,
        normal=normalize(transpose(placement.to_object) @ object_normal),
        view=-ray.direction,
        base_color=surface.base_color,
        roughness=surface.roughness,
        metallic=surface.metallic,
        occlusion=surface.occlusion,
        emission=surface.emission,
        specular=surface.specular,
        shininess=surface.shininess,
    )


@shader
def slope_scale(intersection: Intersection, placement: Placement, variant: Variant) -> float:
    """The slope of the relief relative to that on the widest tile, for which normal maps are made:
    on a sphere the relief is as deep on the narrower tiles."""
    if variant.shape == "sphere" and variant.displaced:
        return max_tile_width(variant) / (abs(placement.tiling.x) * intersection.frame.width)
    return 1.0


@shader
def shading_normal(normal: Vec3, relief_normal: Vec3, variant: Variant) -> Vec3:
    """The shading normal in tangent space: that of the normal map, but on the side of a column the
    side's own, which no map has."""
    if variant.columns and relief_normal.z < 0.5:
        return relief_normal
    return normal


# --- shadows of other objects --------------------------------------------------------------------


@shader
def shadow_receiver(
    point: ShadingPoint, ray: CameraRay, intersection: Intersection, variant: Variant
) -> Vec3:
    """The world position that receives the shadows of other objects: on the relief, or on the
    polygon, as in renderers whose shadows ignore displacement and float above the relief."""
    if variant.shadows_on == "relief":
        return point.position
    return ray.origin + ray.direction * intersection.distance


# --- directional occlusion -----------------------------------------------------------------------


@shader
def directional_visibility(
    point: ShadingPoint, height: float, direction: Vec3, shading: Shading
) -> float:
    """The visibility of a light by ambient occlusion, height and n·l, an inexpensive approximation
    of soft shadows:

        mix(1, mix(occlusion · height, 1, n·l), directional_occlusion)

    Light along the normal reaches everything; light at a grazing angle is blocked where the point
    is occluded or low. After S. Halliwell, Parallax Offset, 2014, who gives no formula.
    """
    # a march that finds no hit may end below all heights
    exposure = point.occlusion * saturate(height)
    visibility = mix(exposure, 1.0, saturate(dot(point.normal, direction)))
    return mix(1.0, visibility, shading.directional_occlusion)
