"""The relief of an object: where the view ray ends in it, and what it hides from a light."""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    Texture,
    Vec2,
    Vec3,
    clamp,
    floor,
    levels,
    normalize,
    saturate,
    shader,
    size,
    sqrt,
    struct,
)
from basrelief.shading.intersection import Meeting
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.shading.self_shadow import Reaching, Shadowing, ShadowRay, shadow
from basrelief.shading.tangent_frame import to_tangent, to_texture
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import INSET, side_at, top_at
from basrelief.techniques.height import Smoothing, height_at, slope_at, surface_height
from basrelief.techniques.projection import SHALLOWEST, biased, full, limited
from basrelief.techniques.ray import Hit, Ray
from basrelief.techniques.technique import Settings, displace


@struct
class Depth:
    """How deep the relief is: `scale` is the whole range as a fraction of a tile's width.

    `level` is the height that lies on the polygon; `bias` is what the projection `biased` adds.
    Where the relief fades with distance, it is whole up to `fade_near` and gone from `fade_far`
    on, in world units.
    """

    scale: float
    level: float
    bias: float
    fade_near: float = 0.0
    fade_far: float = 0.0


@struct
class Displaced:
    """Where the ray ends: texture coordinates, how far beyond the polygon, the height there,
    whether anything was met, heights read. And how the relief is drawn there: its `scale` (0 where
    it is flat), and the level `lod` that heights are read from."""

    uv: Vec2
    further: float
    height: float
    found: bool
    reads: int
    scale: float = 0.0
    lod: float = 0.0


# --- how deep, seen from here --------------------------------------------------------------------


@shader
def depth_seen(depth: Depth, distance: float, variant: Variant) -> Depth:
    """How deep the relief is drawn at a distance from the camera: where it fades, shallower with
    distance, to plain normal mapping, where nothing is read any more."""
    if not variant.fades:
        return depth
    span = max(depth.fade_far - depth.fade_near, 1e-6)
    # not (far − distance): from that, Mesa 22.3's software driver makes a program that crashes
    left = 1.0 - saturate((distance - depth.fade_near) / span)
    return Depth(depth.scale * left, depth.level, depth.bias, depth.fade_near, depth.fade_far)


@shader
def lod_seen(field: HeightField, footprint: Footprint, smoothing: Smoothing) -> float:
    """The level that heights are read from."""
    if field.filter == "smooth":
        # by the gradients of the undisplaced coordinates, and lower still
        return level_of_detail(footprint, size(field, 0)) + smoothing.mip_bias
    if field.filter == "mip":
        # the one whose texels are nearest in size to what the pixel covers
        lod = level_of_detail(footprint, size(field, 0))
        return floor(clamp(lod + 0.5, 0.0, float(levels(field) - 1)))
    return 0.0


# --- where the ray ends --------------------------------------------------------------------------


@shader
def displaced(
    field: HeightField,
    baked: Texture,
    met: Meeting,
    depth: Depth,
    smoothing: Smoothing,
    settings: Settings,
    variant: Variant,
) -> Displaced:
    """Where the ray ends: on the relief, as the technique says, or on the polygon itself."""
    if not variant.displaced:
        return Displaced(met.uv, 0.0, 1.0, True, 0)
    deep = depth_seen(depth, met.point.distance, variant)
    # where it is flat the technique reads nothing
    if deep.scale <= 0.0:
        return Displaced(met.uv, 0.0, flat_height(field, met.uv, variant), True, 0)
    lod = lod_seen(field, met.footprint, smoothing)
    ray = relief_ray(met, deep, lod, smoothing.mip_fade, variant)
    hit = displace(field, baked, ray, settings)
    further = beyond(met, deep, hit)
    return Displaced(hit.uv, further, hit.height, hit.found, hit.reads, deep.scale, lod)


@shader
def flat_height(field: HeightField, uv: Vec2, variant: Variant) -> float:
    """The height that a flat relief reports: the map's, where a landscape's water or the shade of a
    pit go by it."""
    if variant.surface == "landscape" or variant.occlusion_kind == "directional":
        return top_at(field, uv) if field.filter == "boxes" else height_at(field, uv)
    return 1.0


@shader
def relief_ray(met: Meeting, depth: Depth, lod: float, fade: float, variant: Variant) -> Ray:
    """The ray that a technique follows: the chosen projection, in texture coordinates."""
    falling = move_of(met.view, depth.bias, variant) * -depth.scale
    fall = to_texture(falling, met.frame.aspect)
    return Ray(met.uv, fall, depth.level, met.view.z, depth.scale, lod, fade)


@shader
def move_of(view: Vec3, bias: float, variant: Variant) -> Vec2:
    """How far the ray moves along the surface while it falls by one, towards the viewer."""
    if variant.projection == "biased":
        return biased(view, bias)
    if variant.projection == "limited":
        return limited(view, bias)
    return full(view, bias)


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


# --- how steep -----------------------------------------------------------------------------------


@struct
class Slope:
    """The relief's unit normal in tangent space, and how high it is in tile widths."""

    normal: Vec3
    deep: float


@shader
def slope_of(field: HeightField, moved: Displaced, met: Meeting, variant: Variant) -> Slope:
    """How the relief lies where the ray ended, for what asks: the sides of boxes, and colours that
    are laid on from three sides."""
    if variant.boxed:
        return of_boxes(field, moved, met)
    if variant.displaced and variant.mapping == "triplanar" and variant.base_color_map:
        return of_heights(field, moved, met)
    return Slope(Vec3(0.0, 0.0, 1.0), 0.0)


@shader
def of_heights(field: HeightField, moved: Displaced, met: Meeting) -> Slope:
    """As the bilinear surface lies."""
    slope = slope_at(field, moved.uv) * moved.scale
    # v runs down where y runs up, and a tile is as high as it is wide ÷ aspect
    normal = normalize(Vec3(-slope.x, slope.y * met.frame.aspect, 1.0))
    return Slope(normal, moved.height * moved.scale)


@shader
def of_boxes(field: HeightField, moved: Displaced, met: Meeting) -> Slope:
    """Level on the top of a box; on its side, as the side faces."""
    deep = moved.height * moved.scale
    if moved.scale <= 0.0 or not moved.found:
        return Slope(Vec3(0.0, 0.0, 1.0), deep)
    way = to_texture(-met.view.xy, met.frame.aspect)
    side = side_at(field, moved.uv, moved.height, way)
    # v runs down where y runs up
    return Slope(Vec3(side.x, -side.y, 1.0 - abs(side.x) - abs(side.y)), deep)


# --- what it hides from a light ------------------------------------------------------------------


@shader
def self_shadowed(
    field: HeightField,
    met: Meeting,
    moved: Displaced,
    smoothing: Smoothing,
    towards: Vec3,
    shadowing: Shadowing,
    variant: Variant,
) -> Reaching:
    """How much of a light, in a direction of object space, the relief leaves for the displaced
    point; nothing of a light behind the polygon."""
    light = to_tangent(met.frame, normalize(towards))
    if light.z <= SHALLOWEST:
        return Reaching(0.0, 0)
    if moved.scale <= 0.0:
        return Reaching(1.0, 0)
    fade = smoothing.mip_fade
    uv = moved.uv
    height = moved.height
    if variant.boxed:
        # from the box's top, or as far before its side as the view ray was put within it
        side = side_at(field, uv, height, to_texture(-met.view.xy, met.frame.aspect))
        extent = size(field, 0)
        uv = uv + side * (2.0 * INSET) / Vec2(float(extent.x), float(extent.y))
    else:
        # from the surface itself: a technique may end the view ray below it
        height = surface_height(field, uv, moved.lod, fade)
    rise = to_texture(light.xy * (moved.scale / light.z), met.frame.aspect)
    reaching = shadow(field, ShadowRay(uv, height, rise, moved.lod, fade), shadowing, variant)
    return Reaching(reaching.share, reaching.reads + 1)
