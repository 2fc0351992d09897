"""The relief of an object: the hit of the view ray, the normal there, and the relief's shadow on
itself."""

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
from basrelief.shading.intersection import Intersection, Placement
from basrelief.shading.ray_differentials import Footprint, level_of_detail
from basrelief.shading.self_shadow import LightVisibility, Shadowing, light_visibility
from basrelief.shading.shapes import Interval, max_shell_distance, max_tile_width
from basrelief.shading.tangent_frame import aspect, to_tangent, to_texture
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import INSET, column_top_at, side_normal
from basrelief.techniques.height import Smoothing, gradient_at, sharp, surface_height
from basrelief.techniques.projection import MIN_COSINE, biased, full, limited
from basrelief.techniques.ray import Ray
from basrelief.techniques.technique import Settings, displace


@struct
class ReliefParameters:
    """Parameters of the relief.

    `scale` is the height range as a fraction of a tile's width, `reference_height` the height that
    lies on the polygon, `bias` that of the projection `biased`. A relief that fades with distance
    has its full depth up to `fade_near` and is flat from `fade_far`, in world units.
    """

    scale: float
    reference_height: float
    bias: float
    fade_near: float = 0.0
    fade_far: float = 0.0


@struct
class ReliefHit:
    """The end of a ray in the relief.

    `distance` is along the ray, in world units; `uv` and `height` are the position, `found` says
    whether the surface is hit there, `reads` counts the heights read. `visibility` is that of the
    light the ray goes to, 1 for a view ray. `scale` is the height range drawn there in tile widths,
    0 where the relief is flat; `lod` the mip level of its heights.
    """

    found: bool
    distance: float
    uv: Vec2
    height: float
    reads: int
    visibility: float = 1.0
    scale: float = 0.0
    lod: float = 0.0


# --- depth and level of detail -------------------------------------------------------------------


@shader
def faded_relief(relief: ReliefParameters, distance: float, variant: Variant) -> ReliefParameters:
    """The relief's parameters at a distance from the camera: where it fades, its scale falls
    linearly to 0, plain normal mapping without any height reads."""
    if not variant.fades:
        return relief
    span = max(relief.fade_far - relief.fade_near, 1e-6)
    # not (far − distance): with that, Mesa 22.3's software driver compiles a program that crashes
    fade = 1.0 - saturate((distance - relief.fade_near) / span)
    return ReliefParameters(
        relief.scale * fade, relief.reference_height, relief.bias, relief.fade_near, relief.fade_far
    )


@shader
def height_lod(field: HeightField, footprint: Footprint, smoothing: Smoothing) -> float:
    """The mip level that heights are read from."""
    if field.filter == "smooth":
        # from the gradients of the undisplaced coordinates, plus the bias
        return level_of_detail(footprint, size(field, 0)) + smoothing.mip_bias
    if field.filter == "mip":
        # the single level whose texels are nearest in size to the pixel footprint
        lod = level_of_detail(footprint, size(field, 0))
        return floor(clamp(lod + 0.5, 0.0, float(levels(field) - 1)))
    return 0.0


@shader
def object_height_range(relief: ReliefParameters, placement: Placement, variant: Variant) -> float:
    """The height range in object units: one number for the whole object, that of its widest
    tile."""
    return relief.scale * max_tile_width(variant) / abs(placement.tiling.x)


# --- tracing -------------------------------------------------------------------------------------


@shader
def trace(
    field: HeightField,
    baked: Texture,
    ray: Ray,
    interval: Interval,
    settings: Settings,
    shadowing: Shadowing,
    to_light: bool,
    variant: Variant,
) -> ReliefHit:
    """Trace a ray through the relief: a view ray by the technique, a ray to a light by the
    self-shadow.

    `ray` is the segment over `interval`, which is in world units; so is the distance of the result.
    For a light only `visibility` and `reads` are valid.
    """
    if variant.shadows != "none" and to_light:
        light = light_visibility(field, baked, ray, settings, shadowing, variant)
        return ReliefHit(
            light.visibility < 1.0,
            interval.t_exit,
            ray.uv,
            ray.height,
            light.reads,
            light.visibility,
        )
    hit = displace(field, baked, ray, settings)
    distance = interval.t_enter + hit.t * (interval.t_exit - interval.t_enter)
    # the base at height 0 is solid
    found = hit.found or hit.t >= 1.0
    return ReliefHit(found, distance, hit.uv, hit.height, hit.reads, 1.0, ray.scale, ray.lod)


@shader
def trace_relief(
    field: HeightField,
    baked: Texture,
    intersection: Intersection,
    footprint: Footprint,
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    shadowing: Shadowing,
    variant: Variant,
) -> ReliefHit:
    """The hit of the view ray: on the relief, by the technique, or on the flat polygon."""
    if not variant.displaced:
        return ReliefHit(True, intersection.distance, intersection.uv, 1.0, 0)
    faded = faded_relief(relief, intersection.distance, variant)
    # a flat relief needs no technique
    if faded.scale <= 0.0:
        return ReliefHit(
            True,
            intersection.distance,
            intersection.uv,
            flat_height(field, intersection.uv, variant),
            0,
        )
    height_range = object_height_range(faded, placement, variant)
    lod = height_lod(field, footprint, smoothing)
    ray = relief_ray(intersection, faded, height_range, lod, smoothing.mip_fade, variant)
    interval = relief_interval(intersection, faded.reference_height, height_range)
    hit = trace(field, baked, ray, interval, settings, shadowing, False, variant)
    # the relief of a curved surface is that of its tangent plane, which near the outline runs far
    # from the shape: keep the distance within the shape, or the shell that a raised relief fills
    shell = (
        max_shell_distance((1.0 - faded.reference_height) * height_range, variant)
        / intersection.object_units_per_world
    )
    distance = clamp(
        intersection.distance + hit.distance, intersection.distance - shell, intersection.t_exit
    )
    return ReliefHit(hit.found, distance, hit.uv, hit.height, hit.reads, 1.0, hit.scale, hit.lod)


@shader
def flat_height(field: HeightField, uv: Vec2, variant: Variant) -> float:
    """The height reported where the relief is flat: the map's, if a landscape's water or
    directional occlusion depends on it."""
    if variant.surface == "landscape" or variant.occlusion_kind == "directional":
        return column_top_at(field, uv) if field.filter == "columns" else sharp(field, uv)
    return 1.0


@shader
def relief_ray(
    intersection: Intersection,
    relief: ReliefParameters,
    height_range: float,
    lod: float,
    fade: float,
    variant: Variant,
) -> Ray:
    """The technique's ray through the relief of an intersection, by the projection.

    With D the height range, travel = −D · offset per height, in texture coordinates.
    """
    travel = to_texture(
        intersection.frame,
        offset_per_height(intersection.view, relief.bias, variant) * -height_range,
    )
    return falling_ray(
        intersection.uv,
        travel,
        intersection.view.z,
        relief.reference_height,
        height_range / intersection.frame.width,
        lod,
        fade,
    )


@shader
def falling_ray(
    uv: Vec2,
    travel: Vec2,
    cosine: float,
    reference_height: float,
    scale: float,
    lod: float,
    fade: float,
) -> Ray:
    """The ray through the whole relief, from height 1 to 0, that meets the polygon at `uv`.

    It does so at the reference height, so it starts at uv + travel · (reference_height − 1).
    """
    return Ray(
        uv=uv + travel * (reference_height - 1.0),
        travel=travel,
        height=1.0,
        drop=1.0,
        cosine=cosine,
        reference_height=reference_height,
        scale=scale,
        lod=lod,
        fade=fade,
    )


@shader
def rising_ray(
    uv: Vec2, height: float, travel: Vec2, cosine: float, scale: float, lod: float, fade: float
) -> Ray:
    """The ray from a point of the relief to a light, up to height 1."""
    return Ray(
        uv=uv,
        travel=travel,
        height=height,
        drop=-(1.0 - height),
        cosine=cosine,
        scale=scale,
        lod=lod,
        fade=fade,
    )


@shader
def relief_interval(
    intersection: Intersection, reference_height: float, height_range: float
) -> Interval:
    """The interval of the true view ray within the relief, in world units from the polygon.

    The depth of a warped ray is that of its height along the true ray, so that other objects
    intersect the relief correctly.
    """
    whole = height_range / (
        max(intersection.view.z, MIN_COSINE) * intersection.object_units_per_world
    )
    return Interval((reference_height - 1.0) * whole, reference_height * whole)


@shader
def offset_per_height(view: Vec3, bias: float, variant: Variant) -> Vec2:
    """The offset of the ray along the surface, towards the viewer, per unit of height."""
    if variant.projection == "biased":
        return biased(view, bias)
    if variant.projection == "limited":
        return limited(view, bias)
    return full(view, bias)


# --- the relief's normal -------------------------------------------------------------------------


@struct
class ReliefNormal:
    """The relief's unit normal in tangent space, and its height in tile widths."""

    normal: Vec3
    height_in_tiles: float


@shader
def relief_normal(
    field: HeightField, relief_hit: ReliefHit, intersection: Intersection, variant: Variant
) -> ReliefNormal:
    """The relief's normal at the hit, for the sides of columns and for colours that depend on the
    slope; (0, 0, 1) where neither needs it."""
    if variant.columns:
        return column_normal(field, relief_hit, intersection)
    if (
        variant.displaced
        and variant.mapping != "planar"
        and (variant.base_color_map or variant.layer_color_map)
    ):
        return height_field_normal(field, relief_hit, intersection)
    return ReliefNormal(Vec3(0.0, 0.0, 1.0), 0.0)


@shader
def height_field_normal(
    field: HeightField, relief_hit: ReliefHit, intersection: Intersection
) -> ReliefNormal:
    """The normal of the bilinear surface."""
    gradient = gradient_at(field, relief_hit.uv) * relief_hit.scale
    # v points down, y up, and a tile is as high as it is wide ÷ aspect
    normal = normalize(Vec3(-gradient.x, gradient.y * aspect(intersection.frame), 1.0))
    return ReliefNormal(normal, relief_hit.height * relief_hit.scale)


@shader
def column_normal(
    field: HeightField, relief_hit: ReliefHit, intersection: Intersection
) -> ReliefNormal:
    """The normal of a column's top or side."""
    height_in_tiles = relief_hit.height * relief_hit.scale
    if relief_hit.scale <= 0.0 or not relief_hit.found:
        return ReliefNormal(Vec3(0.0, 0.0, 1.0), height_in_tiles)
    side = side_normal(
        field,
        relief_hit.uv,
        relief_hit.height,
        to_texture(intersection.frame, -intersection.view.xy),
    )
    # v points down, y up
    return ReliefNormal(Vec3(side.x, -side.y, 1.0 - abs(side.x) - abs(side.y)), height_in_tiles)


# --- self-shadow ---------------------------------------------------------------------------------


@shader
def self_shadow_visibility(
    field: HeightField,
    baked: Texture,
    intersection: Intersection,
    relief_hit: ReliefHit,
    smoothing: Smoothing,
    towards: Vec3,
    settings: Settings,
    shadowing: Shadowing,
    variant: Variant,
) -> LightVisibility:
    """The visibility of a light from the displaced point through the relief; 0 for a light below
    the polygon. `towards` is the direction to the light in object space."""
    light = to_tangent(intersection.frame, normalize(towards))
    if light.z <= MIN_COSINE:
        return LightVisibility(0.0, 0)
    if relief_hit.scale <= 0.0:
        return LightVisibility(1.0, 0)
    uv = relief_hit.uv
    height = relief_hit.height
    if variant.columns:
        # start outside the column: mirror the inset at which the hit lies within its side
        side = side_normal(field, uv, height, to_texture(intersection.frame, -intersection.view.xy))
        extent = size(field, 0)
        uv = uv + side * (2.0 * INSET) / Vec2(float(extent.x), float(extent.y))
    else:
        # start on the surface: a technique may end the view ray below it
        height = surface_height(field, uv, relief_hit.lod, smoothing.mip_fade)
    climb = 1.0 - height
    whole = relief_hit.scale * intersection.frame.width / light.z
    travel = to_texture(intersection.frame, light.xy * (whole * climb))
    ray = rising_ray(
        uv, height, travel, light.z, relief_hit.scale, relief_hit.lod, smoothing.mip_fade
    )
    interval = Interval(0.0, whole * climb / length(towards))
    hit = trace(field, baked, ray, interval, settings, shadowing, True, variant)
    return LightVisibility(hit.visibility, hit.reads + 1)
