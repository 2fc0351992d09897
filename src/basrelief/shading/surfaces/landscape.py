"""A landscape: ground that changes with the height, and water below a height.

After habrador, Advanced shaders in Unity: 3. Parallax mapping: grass in the valleys, stone on the
mountains, water in the lowest places, and a plain colour where the ray met nothing.
"""

from __future__ import annotations

from basrelief.lang import Vec3, mix, setting, shader, struct
from basrelief.shading.surfaces.standard import base_color_of, layer_color_of, normal_of
from basrelief.shading.surfaces.surface import (
    MapPlaces,
    Spot,
    Surface,
    SurfaceMaps,
    retiled,
    spot_on_map,
    turned,
)
from basrelief.shading.variant import Variant


@struct
class Landscape:
    """Numbers of a landscape."""

    water_color: Vec3 = setting(
        default=Vec3(0.1, 0.3, 0.8), doc="of water, times the height, linear", low=0.0
    )
    water_level: float = setting(
        default=0.4, doc="the height below which there is water", low=0.0, high=1.0
    )
    sky_color: Vec3 = setting(default=Vec3(1.0), doc="where the ray meets nothing, linear", low=0.0)
    normal_strength: float = setting(
        default=1.0, doc="how far normals lean, 1 as stored", low=0.0, high=4.0
    )


@shader
def landscape_surface(
    spot: Spot,
    surface_parameters: Landscape,
    places: MapPlaces,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """The base colour in the valleys, the layer's on the mountains, water, or nothing met."""
    low = base_color_of(maps.base_color, spot_on_map(spot, places.base_color, variant), variant).xyz
    # without a layer there is the same ground everywhere
    high = low
    if variant.layer:
        high = layer_color_of(maps.layer_color, retiled(spot, places.layer), variant)
    color = mix(low, high, spot.height)
    at_normal = spot_on_map(spot, places.normal, variant)
    leaning = normal_of(maps.normal, at_normal, surface_parameters.normal_strength, variant)
    level = turned(leaning, places.normal, variant)
    if spot.height < surface_parameters.water_level:
        # a ray that has sunk so low has met the water, whether or not it came to the ground
        color = surface_parameters.water_color * spot.height
        level = Vec3(0.0, 0.0, 1.0)
    elif not spot.found:
        color = surface_parameters.sky_color
        level = Vec3(0.0, 0.0, 1.0)
    return Surface(
        base_color=color,
        opacity=1.0,
        normal=level,
        occlusion=1.0,
        roughness=0.8,
        metallic=0.0,
        emission=Vec3(0.0),
    )
