"""The landscape surface: ground that changes with the height, and water below a height.

The base colour in the valleys, the second layer's on the mountains, water in the lowest places, and
a plain sky colour where the ray hits nothing.
After habrador, Advanced shaders in Unity: 3. Parallax mapping.
"""

from __future__ import annotations

from basrelief.lang import Vec3, mix, setting, shader, struct
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.surfaces.standard import base_color_of, layer_color_of, normal_of
from basrelief.shading.surfaces.surface import (
    MapTilings,
    Surface,
    SurfacePoint,
    oriented_normal,
    point_on_map,
    retiled,
)
from basrelief.shading.variant import Variant


@struct
class Landscape:
    """Settings of the landscape surface."""

    water_color: Vec3 = setting(
        default=Vec3(0.1, 0.3, 0.8),
        doc="colour of the water, multiplied with the height, linear",
        low=0.0,
    )
    water_level: float = setting(default=0.4, doc="height of the water surface", low=0.0, high=1.0)
    sky_color: Vec3 = setting(
        default=Vec3(1.0), doc="colour where the ray hits nothing, linear", low=0.0
    )
    normal_strength: float = setting(
        default=1.0, doc="slope of the normals; 1 is as stored", low=0.0, high=4.0
    )


@shader
def landscape_surface(
    point: SurfacePoint,
    surface_parameters: Landscape,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """mix(valley colour, mountain colour, height); water below the water level; the sky where
    nothing is hit."""
    valley_color = base_color_of(
        maps.base_color, point_on_map(point, tilings.base_color, variant), variant
    ).xyz
    # without a layer the ground is the same everywhere
    mountain_color = valley_color
    if variant.layer:
        mountain_color = layer_color_of(maps.layer_color, retiled(point, tilings.layer), variant)
    color = mix(valley_color, mountain_color, point.height)
    normal_point = point_on_map(point, tilings.normal, variant)
    map_normal = normal_of(maps.normal, normal_point, surface_parameters.normal_strength, variant)
    normal = oriented_normal(map_normal, tilings.normal, variant)
    if not point.found:
        # also below the water level: a ray that ran out of steps there hit nothing
        color = surface_parameters.sky_color
        normal = Vec3(0.0, 0.0, 1.0)
    elif point.height < surface_parameters.water_level:
        color = surface_parameters.water_color * point.height
        normal = Vec3(0.0, 0.0, 1.0)
    return Surface(
        base_color=color,
        opacity=1.0,
        normal=normal,
        occlusion=1.0,
        roughness=0.8,
        metallic=0.0,
        emission=Vec3(0.0),
    )
