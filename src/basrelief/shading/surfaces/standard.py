"""The standard surface: the maps of a metallic-roughness material, and a second layer of details.

Without a map, a constant takes its place and nothing is sampled.
"""

from __future__ import annotations

from basrelief.lang import Texture, Vec2, Vec3, Vec4, mix, normalize, setting, shader, struct
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.stretch_noise import stretch_noise
from basrelief.shading.surfaces.surface import (
    MapTilings,
    Surface,
    SurfacePoint,
    mirrored_normal,
    oriented_normal,
    point_on_layer,
    point_on_map,
)
from basrelief.shading.texture import pixelated, trilinear
from basrelief.shading.variant import Variant

MIDDLE_GREY = 0.214041
"""sRGB 0.5 as a linear value: a detail map of this grey changes nothing."""
MIN_NORMAL_Z = 1e-3
"""The least z of a stored normal: a map of (½, ½, ½) gives the surface's own normal."""


@struct
class SurfaceParameters:
    """Parameters of the standard surface: factors of the maps, and values in place of missing maps.

    Attributes
    ----------
    base_color : Vec3
        Factor of the base colour map, linear.
    normal_strength : float
        Factor of the normal map's slopes, 0 to 4; 1 is as stored.
    roughness, metallic : float
        Factor of the map, 0 to 1.
    occlusion : float
        Strength of the ambient occlusion map, 0 to 1.
    emission : Vec3
        Factor of the emission map, linear.
    specular : Vec3
        Colour of the highlight of phong shading, linear.
    shininess : float
        Exponent of the highlight of phong shading, 1 to 1000.
    cutoff : float
        Least opacity that is drawn where `alpha` is "mask", 0 to 1.
    layer_color : float
        Strength of the second layer's colour, 0 to 1.
    layer_normal : float
        Factor of the second layer's slopes, 0 to 4; 1 is as stored.
    """

    base_color: Vec3 = setting(default=Vec3(1.0), low=0.0)
    normal_strength: float = setting(default=1.0, low=0.0, high=4.0)
    roughness: float = setting(default=1.0, low=0.0, high=1.0)
    metallic: float = setting(default=1.0, low=0.0, high=1.0)
    occlusion: float = setting(default=1.0, low=0.0, high=1.0)
    emission: Vec3 = setting(default=Vec3(1.0), low=0.0)
    specular: Vec3 = setting(default=Vec3(1.0), low=0.0)
    shininess: float = setting(default=10.0, low=1.0, high=1000.0)
    cutoff: float = setting(default=0.5, low=0.0, high=1.0)
    layer_color: float = setting(default=1.0, low=0.0, high=1.0)
    layer_normal: float = setting(default=1.0, low=0.0, high=4.0)


# --- base colour and opacity ------------------------------------------------------------------


@shader
def base_color_of(map: Texture, point: SurfacePoint, variant: Variant) -> Vec4:
    """Linear colour and opacity."""
    if not variant.base_color_map:
        # light grey: a material of heights alone shows its relief
        return Vec4(0.6, 0.6, 0.6, 1.0)
    if variant.displaced and variant.mapping == "triplanar":
        return triplanar(map, point)
    if variant.columns:
        return with_noise(pixelated(map, point.uv, point.footprint), map, point, variant)
    return with_noise(trilinear(map, point.uv, point.footprint), map, point, variant)


@shader
def triplanar(map: Texture, point: SurfacePoint) -> Vec4:
    """A map projected along the three axes of tangent space, so that steep slopes do not stretch
    its texels.

    The weights are the fourth powers of the relief normal's components, normalised.
    S. Halliwell, Parallax Offset, 2014 (suggestion); R. Geiss, Generating Complex Procedural
    Terrains Using the GPU, GPU Gems 3, 2007 (blending).
    """
    squared = point.relief_normal * point.relief_normal
    weight = squared * squared
    # height replaces u on slopes that face along u, v on those that face along v
    along_x = Vec2(point.height_in_tiles, point.uv.y)
    # from the tile's lower edge up, which stays within the tile where tiles do not repeat
    along_y = Vec2(point.uv.x, 1.0 - point.height_in_tiles * point.aspect)
    total = trilinear(map, point.uv, point.footprint) * weight.z
    total = total + trilinear(map, along_x, point.footprint) * weight.x
    total = total + trilinear(map, along_y, point.footprint) * weight.y
    return total / (weight.x + weight.y + weight.z)


@shader
def with_noise(color: Vec4, map: Texture, point: SurfacePoint, variant: Variant) -> Vec4:
    """A map's colour with the noise that breaks up its streaks on steep slopes."""
    if not variant.displaced or variant.mapping != "noise":
        return color
    noise = stretch_noise(
        map, point.uv, point.height_in_tiles, point.relief_normal, point.footprint
    )
    return Vec4(color.xyz * noise, color.w)


@shader
def normal_of(map: Texture, point: SurfacePoint, strength: float, variant: Variant) -> Vec3:
    """The unit normal in tangent space, green up, its slope scaled by `strength`; without a map the
    surface's own."""
    if not variant.normal_map:
        return Vec3(0.0, 0.0, 1.0)
    stored = trilinear(map, point.uv, point.footprint).xyz * 2.0 - 1.0
    scaled = stored.xy * strength
    return normalize(Vec3(scaled, max(stored.z, MIN_NORMAL_Z)))


@shader
def response_of(map: Texture, point: SurfacePoint, variant: Variant) -> Vec4:
    """Occlusion, roughness and metallic, packed as in glTF 2.0, and the mask of the second layer.
    Without a map: unoccluded, roughness 0.8, no metal, the layer everywhere."""
    if variant.response_map:
        return trilinear(map, point.uv, point.footprint)
    return Vec4(1.0, 0.8, 0.0, 1.0)


@shader
def emission_of(map: Texture, point: SurfacePoint, variant: Variant) -> Vec3:
    """The emitted light, linear."""
    if variant.emission_map:
        return trilinear(map, point.uv, point.footprint).xyz
    return Vec3(0.0)


@shader
def opacity_of(opacity: float, surface_parameters: SurfaceParameters, variant: Variant) -> float:
    """The coverage of a surface whose map has an opacity."""
    if variant.alpha == "mask":
        return alpha_mask(opacity, surface_parameters)
    return 1.0 if variant.alpha == "opaque" else opacity


@shader
def alpha_mask(opacity: float, surface_parameters: SurfaceParameters) -> float:
    """Coverage 1 from the cutoff on, else 0: a cut-out (glTF 2.0, alphaMode MASK)."""
    return 1.0 if opacity >= surface_parameters.cutoff else 0.0


# --- second layer --------------------------------------------------------------------------------


@shader
def layer_color_of(map: Texture, point: SurfacePoint, variant: Variant) -> Vec3:
    """The layer's linear colour; without a map the neutral grey."""
    if not variant.layer_color_map:
        return Vec3(MIDDLE_GREY)
    if variant.displaced and variant.mapping == "triplanar":
        return triplanar(map, point).xyz
    return with_noise(trilinear(map, point.uv, point.footprint), map, point, variant).xyz


@shader
def layer_normal_of(map: Texture, point: SurfacePoint, variant: Variant) -> Vec3:
    """The layer's unit normal in tangent space."""
    if not variant.layer_normal_map:
        return Vec3(0.0, 0.0, 1.0)
    stored = trilinear(map, point.uv, point.footprint).xyz * 2.0 - 1.0
    return normalize(Vec3(stored.xy, max(stored.z, MIN_NORMAL_Z)))


@shader
def add_detail_layer(
    surface: Surface,
    mask: float,
    point: SurfacePoint,
    surface_parameters: SurfaceParameters,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """Detail maps: multiply the colour and tilt the normal, weighted by the mask.

    Middle grey leaves the colour as it is; brighter greys brighten it.
    """
    layer_point = point_on_layer(point, tilings.layer, variant)
    tint = layer_color_of(maps.layer_color, layer_point, variant) / MIDDLE_GREY
    tint = mix(Vec3(1.0), tint, mask * surface_parameters.layer_color)
    slope = mask * surface_parameters.layer_normal
    return Surface(
        base_color=surface.base_color * tint,
        opacity=surface.opacity,
        normal=tilted_by_layer(surface.normal, slope, layer_point, tilings, maps, variant),
        occlusion=surface.occlusion,
        roughness=surface.roughness,
        metallic=surface.metallic,
        emission=surface.emission,
        specular=surface.specular,
        shininess=surface.shininess,
    )


@shader
def tilted_by_layer(
    normal: Vec3,
    slope: float,
    layer_point: SurfacePoint,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Vec3:
    """A normal tilted by the layer's, whose slopes are multiplied by `slope`:
    normalize(n₁.xy + n₂.xy, n₁.z · n₂.z), "whiteout" (C. Barré-Brisebois and S. Hill, Blending in
    Detail, 2012)."""
    detail = mirrored_normal(
        layer_normal_of(maps.layer_normal, layer_point, variant), tilings.layer
    )
    scaled = Vec2(detail.x, detail.y * tilings.layer_normal_stretch) * slope
    # normalised again: without slope z has to be 1
    layer_normal = normalize(Vec3(scaled, detail.z))
    return normalize(Vec3(normal.xy + layer_normal.xy, normal.z * layer_normal.z))


# --- the surface ---------------------------------------------------------------------------------


@shader
def packed_response(
    point: SurfacePoint, tilings: MapTilings, maps: SurfaceMaps, variant: Variant
) -> Vec4:
    """Occlusion, roughness, metallic and the mask of the layer at a point."""
    return response_of(maps.response, point_on_map(point, tilings.response, variant), variant)


@shader
def material_surface(
    packed: Vec4,
    point: SurfacePoint,
    surface_parameters: SurfaceParameters,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """The material at a point without a layer, by its maps and the surface parameters; `packed` is
    its response."""
    color = base_color_of(
        maps.base_color, point_on_map(point, tilings.base_color, variant), variant
    )
    emission = emission_of(maps.emission, point_on_map(point, tilings.emission, variant), variant)
    normal_point = point_on_map(point, tilings.normal, variant)
    normal = normal_of(maps.normal, normal_point, surface_parameters.normal_strength, variant)
    return Surface(
        base_color=color.xyz * surface_parameters.base_color,
        opacity=opacity_of(color.w, surface_parameters, variant),
        normal=oriented_normal(normal, tilings.normal, variant),
        occlusion=mix(1.0, packed.x, surface_parameters.occlusion),
        roughness=packed.y * surface_parameters.roughness,
        metallic=packed.z * surface_parameters.metallic,
        emission=emission * surface_parameters.emission,
        specular=surface_parameters.specular,
        shininess=surface_parameters.shininess,
    )


@shader
def standard_surface(
    point: SurfacePoint,
    surface_parameters: SurfaceParameters,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """Sample the maps at a point and apply the surface parameters."""
    packed = packed_response(point, tilings, maps, variant)
    surface = material_surface(packed, point, surface_parameters, tilings, maps, variant)
    if variant.layer:
        return add_detail_layer(
            surface, packed.w, point, surface_parameters, tilings, maps, variant
        )
    return surface
