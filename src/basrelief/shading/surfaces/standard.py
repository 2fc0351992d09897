"""The standard surface: the maps of a metallic-roughness material.

For a map that the material does not have a plain value stands, and nothing is read. A second layer
of colours and normals, finer than the first, may lie over it.
"""

from __future__ import annotations

from basrelief.lang import Texture, Vec2, Vec3, Vec4, mix, normalize, setting, shader, struct
from basrelief.shading.surfaces.surface import (
    MapPlaces,
    Spot,
    Surface,
    SurfaceMaps,
    mirrored_with,
    retiled,
    spot_on_map,
    turned,
)
from basrelief.shading.texture import pixelated, trilinear
from basrelief.shading.variant import Variant

MIDDLE_GREY = 0.214041
"""Half of sRGB's range, linear: a detail map of this grey changes nothing."""
FLATTEST = 1e-3
"""The least z of a stored normal: a map of (½, ½, ½) gives the surface's own normal."""


@struct
class SurfaceParameters:
    """Numbers that multiply the maps, or stand for those that are missing."""

    base_color: Vec3 = setting(default=Vec3(1.0), doc="colour, times the map's, linear", low=0.0)
    normal_strength: float = setting(
        default=1.0, doc="how far normals lean, 1 as stored", low=0.0, high=4.0
    )
    roughness: float = setting(default=1.0, doc="times the map's", low=0.0, high=1.0)
    metallic: float = setting(default=1.0, doc="times the map's", low=0.0, high=1.0)
    occlusion: float = setting(
        default=1.0, doc="how much of the map's occlusion acts", low=0.0, high=1.0
    )
    emission: Vec3 = setting(default=Vec3(1.0), doc="times the map's, linear", low=0.0)
    cutoff: float = setting(
        default=0.5, doc="the least opacity that is there, where alpha is a mask", low=0.0, high=1.0
    )
    layer_color: float = setting(
        default=1.0, doc="how much of a second layer's colour acts", low=0.0, high=1.0
    )
    layer_normal: float = setting(
        default=1.0, doc="how far a second layer's normals lean, 1 as stored", low=0.0, high=4.0
    )


# --- base colour and opacity ------------------------------------------------------------------


@shader
def base_color_of(map: Texture, spot: Spot, variant: Variant) -> Vec4:
    """Linear colour, and opacity."""
    if not variant.base_color_map:
        # light grey, so that a material of heights alone shows its relief
        return Vec4(0.6, 0.6, 0.6, 1.0)
    if variant.displaced and variant.mapping == "triplanar":
        return triplanar(map, spot)
    if variant.columns:
        return pixelated(map, spot.uv, spot.footprint)
    return trilinear(map, spot.uv, spot.footprint)


@shader
def triplanar(map: Texture, spot: Spot) -> Vec4:
    """A map laid on from three sides of tangent space, weighed by how they face the relief:
    on a steep slope its texels are no longer drawn out.

    S. Halliwell, Parallax Offset, 2014, suggests it; R. Geiss, Generating Complex Procedural
    Terrains Using the GPU, 2007, for the blending.
    """
    squared = spot.slope * spot.slope
    weight = squared * squared
    # the height runs along u on slopes that face along u, along v on the others
    beside = Vec2(spot.deep, spot.uv.y)
    # from the tile's lower edge up, so that it is within the tile where tiles do not repeat
    above = Vec2(spot.uv.x, 1.0 - spot.deep * spot.aspect)
    total = trilinear(map, spot.uv, spot.footprint) * weight.z
    total = total + trilinear(map, beside, spot.footprint) * weight.x
    total = total + trilinear(map, above, spot.footprint) * weight.y
    return total / (weight.x + weight.y + weight.z)


@shader
def normal_of(map: Texture, spot: Spot, strength: float, variant: Variant) -> Vec3:
    """The unit normal in tangent space, green up, leaning more or less than is stored; without a
    map the surface's own."""
    if not variant.normal_map:
        return Vec3(0.0, 0.0, 1.0)
    stored = trilinear(map, spot.uv, spot.footprint).xyz * 2.0 - 1.0
    leaning = stored.xy * strength
    return normalize(Vec3(leaning, max(stored.z, FLATTEST)))


@shader
def response_of(map: Texture, spot: Spot, variant: Variant) -> Vec4:
    """Occlusion, roughness, metallic, packed as in glTF 2.0, and how much of a second layer there
    is. Without a map not occluded, fairly rough, no metal, the layer everywhere."""
    if variant.response_map:
        return trilinear(map, spot.uv, spot.footprint)
    return Vec4(1.0, 0.8, 0.0, 1.0)


@shader
def emission_of(map: Texture, spot: Spot, variant: Variant) -> Vec3:
    """The light that the surface sends out by itself, linear."""
    if variant.emission_map:
        return trilinear(map, spot.uv, spot.footprint).xyz
    return Vec3(0.0)


@shader
def opacity_of(opacity: float, surface_parameters: SurfaceParameters, variant: Variant) -> float:
    """How much of what lies behind is hidden, given what the map says."""
    if variant.alpha == "mask":
        return masked(opacity, surface_parameters)
    return 1.0 if variant.alpha == "opaque" else opacity


@shader
def masked(opacity: float, surface_parameters: SurfaceParameters) -> float:
    """All or nothing: a cut-out (glTF 2.0, alphaMode MASK)."""
    return 1.0 if opacity >= surface_parameters.cutoff else 0.0


# --- a second layer ------------------------------------------------------------------------------


@shader
def layer_color_of(map: Texture, spot: Spot, variant: Variant) -> Vec3:
    """The layer's linear colour; without a map the grey that leaves what lies below as it is."""
    if variant.layer_color_map:
        return trilinear(map, spot.uv, spot.footprint).xyz
    return Vec3(MIDDLE_GREY)


@shader
def layer_normal_of(map: Texture, spot: Spot, variant: Variant) -> Vec3:
    """The unit normal of the layer in tangent space."""
    if not variant.layer_normal_map:
        return Vec3(0.0, 0.0, 1.0)
    stored = trilinear(map, spot.uv, spot.footprint).xyz * 2.0 - 1.0
    return normalize(Vec3(stored.xy, max(stored.z, FLATTEST)))


@shader
def with_details(
    surface: Surface,
    mask: float,
    spot: Spot,
    surface_parameters: SurfaceParameters,
    places: MapPlaces,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """Detail maps: a colour that multiplies, a normal that leans further, where the mask allows.

    Middle grey leaves the colour as it is, what is brighter makes it brighter. Slopes are added
    (C. Barré-Brisebois and S. Hill, Blending in Detail, 2012, "whiteout").
    """
    over = retiled(spot, places.layer)
    tint = layer_color_of(maps.layer_color, over, variant) / MIDDLE_GREY
    tint = mix(Vec3(1.0), tint, mask * surface_parameters.layer_color)
    finer = mirrored_with(layer_normal_of(maps.layer_normal, over, variant), places.layer)
    leaning = Vec2(finer.x, finer.y * places.layer_slant) * (mask * surface_parameters.layer_normal)
    # of unit length again: what leans less is also flatter, and where nothing leans it is level
    over_it = normalize(Vec3(leaning, finer.z))
    below = surface.normal
    return Surface(
        base_color=surface.base_color * tint,
        opacity=surface.opacity,
        normal=normalize(Vec3(below.xy + over_it.xy, below.z * over_it.z)),
        occlusion=surface.occlusion,
        roughness=surface.roughness,
        metallic=surface.metallic,
        emission=surface.emission,
    )


# --- all of it -----------------------------------------------------------------------------------


@shader
def standard_surface(
    spot: Spot,
    surface_parameters: SurfaceParameters,
    places: MapPlaces,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """Read the maps at a place and apply the finish."""
    color = base_color_of(maps.base_color, spot_on_map(spot, places.base_color, variant), variant)
    packed = response_of(maps.response, spot_on_map(spot, places.response, variant), variant)
    glow = emission_of(maps.emission, spot_on_map(spot, places.emission, variant), variant)
    at_normal = spot_on_map(spot, places.normal, variant)
    leaning = normal_of(maps.normal, at_normal, surface_parameters.normal_strength, variant)
    surface = Surface(
        base_color=color.xyz * surface_parameters.base_color,
        opacity=opacity_of(color.w, surface_parameters, variant),
        normal=turned(leaning, places.normal, variant),
        occlusion=mix(1.0, packed.x, surface_parameters.occlusion),
        roughness=packed.y * surface_parameters.roughness,
        metallic=packed.z * surface_parameters.metallic,
        emission=glow * surface_parameters.emission,
    )
    if variant.layer:
        return with_details(surface, packed.w, spot, surface_parameters, places, maps, variant)
    return surface
