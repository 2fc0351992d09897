"""The landscape surface: ground that changes with the height, and water below a height.

The base colour in the valleys, the second layer's on the mountains, water in the lowest places, and
a plain sky colour where the ray hits nothing. The ground has all maps of its material, as on the
standard surface.
After habrador, Advanced shaders in Unity: 3. Parallax mapping.
"""

from __future__ import annotations

from basrelief.lang import Vec3, mix, setting, shader, struct
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.surfaces.standard import (
    SurfaceParameters,
    layer_color_of,
    material_surface,
    packed_response,
    tilted_by_layer,
)
from basrelief.shading.surfaces.surface import MapTilings, Surface, SurfacePoint, point_on_layer
from basrelief.shading.variant import Variant

PLAIN_ROUGHNESS = 0.8
"""Roughness of water and sky: that of a material without a map."""


@struct
class Landscape:
    """Parameters of the landscape surface: its water and sky, and those of the standard surface.

    Attributes
    ----------
    water_color : Vec3
        Colour of the water, multiplied with the height, linear.
    water_level : float
        Height of the water surface, 0 to 1.
    sky_color : Vec3
        Colour where the ray hits nothing, linear.
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
        Share of the layer's colour on the highest ground, 0 to 1.
    layer_normal : float
        Factor of the slopes of the layer, 0 to 4; 1 is as stored.
    """

    water_color: Vec3 = setting(default=Vec3(0.1, 0.3, 0.8), low=0.0)
    water_level: float = setting(default=0.4, low=0.0, high=1.0)
    sky_color: Vec3 = setting(default=Vec3(1.0), low=0.0)
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


@shader
def ground_parameters(landscape: Landscape) -> SurfaceParameters:
    """The parameters that a landscape shares with the standard surface."""
    return SurfaceParameters(
        base_color=landscape.base_color,
        normal_strength=landscape.normal_strength,
        roughness=landscape.roughness,
        metallic=landscape.metallic,
        occlusion=landscape.occlusion,
        emission=landscape.emission,
        specular=landscape.specular,
        shininess=landscape.shininess,
        cutoff=landscape.cutoff,
        layer_color=landscape.layer_color,
        layer_normal=landscape.layer_normal,
    )


@shader
def landscape_surface(
    point: SurfacePoint,
    surface_parameters: Landscape,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """mix(valley colour, mountain colour, height · mask); water below the water level; the sky
    where nothing is hit.

    The opacity of the ground is that of the water above it. The sky is opaque.
    """
    # also below the water level: a ray that ran out of steps there hit nothing
    if not point.found:
        return plain(surface_parameters.sky_color, 1.0, surface_parameters)
    packed = packed_response(point, tilings, maps, variant)
    parameters = ground_parameters(surface_parameters)
    ground = material_surface(packed, point, parameters, tilings, maps, variant)
    if point.height < surface_parameters.water_level:
        water = surface_parameters.water_color * point.height
        return plain(water, ground.opacity, surface_parameters)
    # without a layer the ground is the same everywhere
    if variant.layer:
        return with_mountains(
            ground, point.height * packed.w, point, parameters, tilings, maps, variant
        )
    return ground


@shader
def plain(color: Vec3, opacity: float, landscape: Landscape) -> Surface:
    """A level surface of one colour: water, or the sky."""
    return Surface(
        base_color=color,
        opacity=opacity,
        normal=Vec3(0.0, 0.0, 1.0),
        occlusion=1.0,
        roughness=PLAIN_ROUGHNESS,
        metallic=0.0,
        emission=Vec3(0.0),
        specular=landscape.specular,
        shininess=landscape.shininess,
    )


@shader
def with_mountains(
    ground: Surface,
    share: float,
    point: SurfacePoint,
    surface_parameters: SurfaceParameters,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """The ground with a share of the second layer: its colour is mixed in, its normal tilts."""
    layer_point = point_on_layer(point, tilings.layer, variant)
    mountain_color = layer_color_of(maps.layer_color, layer_point, variant)
    slope = share * surface_parameters.layer_normal
    return Surface(
        base_color=mix(ground.base_color, mountain_color, share * surface_parameters.layer_color),
        opacity=ground.opacity,
        normal=tilted_by_layer(ground.normal, slope, layer_point, tilings, maps, variant),
        occlusion=ground.occlusion,
        roughness=ground.roughness,
        metallic=ground.metallic,
        emission=ground.emission,
        specular=ground.specular,
        shininess=ground.shininess,
    )
