"""The relief of an object: where the view ray ends in it, and what it hides from a light."""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    Texture,
    Vec2,
    Vec3,
    clamp,
    floor,
    length,
    levels,
    normalize,
    saturate,
    shader,
    size,
    struct,
)
from basrelief.shading.intersection import Meeting, Placement
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.shading.self_shadow import Reaching, Shadowing, shadow
from basrelief.shading.shapes import Interval, shell_depth, widest
from basrelief.shading.tangent_frame import aspect, to_tangent, to_texture
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import INSET, side_at, top_at
from basrelief.techniques.height import Smoothing, sharp, slope_at, surface_height
from basrelief.techniques.projection import SHALLOWEST, biased, full, limited
from basrelief.techniques.ray import Ray
from basrelief.techniques.technique import Settings, displace


@struct
class ReliefParameters:
    """Depth of the relief: `scale` is the whole range as a fraction of a tile's width.

    `reference_height` is the height that lies on the polygon; `bias` is what the projection
    `biased` adds. Where the relief fades with distance, it is whole up to `fade_near` and gone from
    `fade_far` on, in world units.
    """

    scale: float
    reference_height: float
    bias: float
    fade_near: float = 0.0
    fade_far: float = 0.0


@struct
class Intersection:
    """Where a ray ends in the relief.

    `distance` is along the ray, in world units; `uv` and `height` are the place, `found` whether
    anything was met there, `reads` the heights read. `open` is the visibility of the light that
    the ray goes to, 1 where nothing is in its way. The relief is drawn there `scale` tile widths
    deep (0 where it is flat), from the level `lod` of its heights.
    """

    found: bool
    distance: float
    uv: Vec2
    height: float
    reads: int
    open: float = 1.0
    scale: float = 0.0
    lod: float = 0.0


# --- how deep, seen from here --------------------------------------------------------------------


@shader
def faded_relief(relief: ReliefParameters, distance: float, variant: Variant) -> ReliefParameters:
    """How deep the relief is drawn at a distance from the camera: where it fades, shallower with
    distance, to plain normal mapping, where nothing is read any more."""
    if not variant.fades:
        return relief
    span = max(relief.fade_far - relief.fade_near, 1e-6)
    # not (far − distance): from that, Mesa 22.3's software driver makes a program that crashes
    left = 1.0 - saturate((distance - relief.fade_near) / span)
    return ReliefParameters(
        relief.scale * left, relief.reference_height, relief.bias, relief.fade_near, relief.fade_far
    )


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


@shader
def height_range(relief: ReliefParameters, placement: Placement, variant: Variant) -> float:
    """The range of heights in units of object space: one number for all of the object, by its
    widest tile."""
    return relief.scale * widest(variant) / abs(placement.tiling.x)


# --- where a ray ends ----------------------------------------------------------------------------


@shader
def trace(
    field: HeightField,
    baked: Texture,
    ray: Ray,
    span: Interval,
    settings: Settings,
    shadowing: Shadowing,
    to_light: bool,
    variant: Variant,
) -> Intersection:
    """Follow a ray through the relief: the view ray as the technique does, one to a light as the
    self-shadow does.

    `ray` is the segment that it covers over the interval `span`, in world units; the distance of
    the result counts from where the interval does. For a light only `open` and `reads` count.
    """
    if variant.shadows != "none" and to_light:
        reaching = shadow(field, ray, shadowing, variant)
        return Intersection(
            reaching.share < 1.0, span.leave, ray.uv, ray.height, reaching.reads, reaching.share
        )
    hit = displace(field, baked, ray, settings)
    distance = span.enter + hit.t * (span.leave - span.enter)
    # the base is solid
    found = hit.found or hit.t >= 1.0
    return Intersection(found, distance, hit.uv, hit.height, hit.reads, 1.0, ray.scale, ray.lod)


@shader
def displaced(
    field: HeightField,
    baked: Texture,
    met: Meeting,
    footprint: Footprint,
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    shadowing: Shadowing,
    variant: Variant,
) -> Intersection:
    """Where the view ray ends: on the relief, as the technique says, or on the polygon itself."""
    if not variant.displaced:
        return Intersection(True, met.distance, met.uv, 1.0, 0)
    seen = faded_relief(relief, met.distance, variant)
    # where it is flat the technique reads nothing
    if seen.scale <= 0.0:
        return Intersection(True, met.distance, met.uv, flat_height(field, met.uv, variant), 0)
    deep = height_range(seen, placement, variant)
    lod = lod_seen(field, footprint, smoothing)
    ray = relief_ray(met, seen, deep, lod, smoothing.mip_fade, variant)
    span = span_of(met, seen.reference_height, deep)
    ended = trace(field, baked, ray, span, settings, shadowing, False, variant)
    # the relief of a curved surface is that of its tangent plane, which near the outline runs far
    # from the shape: what is pushed in stays within it, what is raised within a shell around it
    shell = shell_depth((1.0 - seen.reference_height) * deep, variant) / met.stretch
    distance = clamp(met.distance + ended.distance, met.distance - shell, met.t_exit)
    return Intersection(
        ended.found, distance, ended.uv, ended.height, ended.reads, 1.0, ended.scale, ended.lod
    )


@shader
def flat_height(field: HeightField, uv: Vec2, variant: Variant) -> float:
    """The height that a flat relief reports: the map's, where a landscape's water or the shade of a
    pit go by it."""
    if variant.surface == "landscape" or variant.occlusion_kind == "directional":
        return top_at(field, uv) if field.filter == "columns" else sharp(field, uv)
    return 1.0


@shader
def relief_ray(
    met: Meeting, relief: ReliefParameters, deep: float, lod: float, fade: float, variant: Variant
) -> Ray:
    """The ray that a technique follows through a relief that is `deep`: the chosen projection."""
    travel = to_texture(met.frame, move_of(met.view, relief.bias, variant) * -deep)
    return Ray(
        uv=met.uv + travel * (relief.reference_height - 1.0),
        travel=travel,
        height=1.0,
        drop=1.0,
        cosine=met.view.z,
        reference_height=relief.reference_height,
        scale=deep / met.frame.width,
        lod=lod,
        fade=fade,
    )


@shader
def span_of(met: Meeting, reference_height: float, deep: float) -> Interval:
    """Where the true view ray is in the relief, in world units from the polygon on.

    A bent ray's depth too is that of its height, so that other objects meet the relief rightly.
    """
    whole = deep / (max(met.view.z, SHALLOWEST) * met.stretch)
    return Interval((reference_height - 1.0) * whole, reference_height * whole)


@shader
def move_of(view: Vec3, bias: float, variant: Variant) -> Vec2:
    """How far the ray moves along the surface while it falls by one, towards the viewer."""
    if variant.projection == "biased":
        return biased(view, bias)
    if variant.projection == "limited":
        return limited(view, bias)
    return full(view, bias)


# --- how steep -----------------------------------------------------------------------------------


@struct
class Slope:
    """The relief's unit normal in tangent space, and how high it is in tile widths."""

    normal: Vec3
    deep: float


@shader
def slope_of(field: HeightField, moved: Intersection, met: Meeting, variant: Variant) -> Slope:
    """How the relief lies where the ray ended, for what asks: the sides of boxes, and colours that
    are laid on from three sides."""
    if variant.columns:
        return column_slope(field, moved, met)
    if variant.displaced and variant.mapping == "triplanar" and variant.base_color_map:
        return of_heights(field, moved, met)
    return Slope(Vec3(0.0, 0.0, 1.0), 0.0)


@shader
def of_heights(field: HeightField, moved: Intersection, met: Meeting) -> Slope:
    """As the bilinear surface lies."""
    slope = slope_at(field, moved.uv) * moved.scale
    # v runs down where y runs up, and a tile is as high as it is wide ÷ aspect
    normal = normalize(Vec3(-slope.x, slope.y * aspect(met.frame), 1.0))
    return Slope(normal, moved.height * moved.scale)


@shader
def column_slope(field: HeightField, moved: Intersection, met: Meeting) -> Slope:
    """Level on the top of a box; on its side, as the side faces."""
    deep = moved.height * moved.scale
    if moved.scale <= 0.0 or not moved.found:
        return Slope(Vec3(0.0, 0.0, 1.0), deep)
    side = side_at(field, moved.uv, moved.height, to_texture(met.frame, -met.view.xy))
    # v runs down where y runs up
    return Slope(Vec3(side.x, -side.y, 1.0 - abs(side.x) - abs(side.y)), deep)


# --- what it hides from a light ------------------------------------------------------------------


@shader
def self_shadow_visibility(
    field: HeightField,
    baked: Texture,
    met: Meeting,
    moved: Intersection,
    smoothing: Smoothing,
    towards: Vec3,
    settings: Settings,
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
    uv = moved.uv
    height = moved.height
    if variant.columns:
        # from the box's top, or as far before its side as the view ray was put within it
        side = side_at(field, uv, height, to_texture(met.frame, -met.view.xy))
        extent = size(field, 0)
        uv = uv + side * (2.0 * INSET) / Vec2(float(extent.x), float(extent.y))
    else:
        # from the surface itself: a technique may end the view ray below it
        height = surface_height(field, uv, moved.lod, smoothing.mip_fade)
    climb = 1.0 - height
    whole = moved.scale * met.frame.width / light.z
    ray = Ray(
        uv=uv,
        travel=to_texture(met.frame, light.xy * (whole * climb)),
        height=height,
        drop=-climb,
        cosine=light.z,
        scale=moved.scale,
        lod=moved.lod,
        fade=smoothing.mip_fade,
    )
    span = Interval(0.0, whole * climb / length(towards))
    ended = trace(field, baked, ray, span, settings, shadowing, True, variant)
    return Reaching(ended.open, ended.reads + 1)
