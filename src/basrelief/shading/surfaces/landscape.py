"""A landscape: ground that changes with the height, and water below a height.

After habrador, Advanced shaders in Unity: 3. Parallax mapping: grass in the valleys, stone on the
mountains, water in the lowest places, and a plain colour where the ray met nothing.
"""

from __future__ import annotations

from basrelief.lang import Texture, Vec3, mix, setting, shader, slot, struct
from basrelief.shading.surfaces.standard import base_color_of, layer_color_of, normal_of
from basrelief.shading.surfaces.surface import MapPlaces, Spot, Surface, apart, spot_of, turned


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


@slot
def high_ground(low: Vec3, layer_color: Texture, spot: Spot, places: MapPlaces) -> Vec3:
    """The linear colour of the mountains, given that of the valleys."""


@shader
def of_the_layer(layer_color: Texture, spot: Spot, places: MapPlaces) -> Vec3:
    """The layer's."""
    return layer_color_of(layer_color, apart(spot, places.layer))


@shader
def as_below(low: Vec3) -> Vec3:
    """There is no layer: the same ground everywhere."""
    return low


@shader
def landscape_surface(
    spot: Spot,
    finish: Landscape,
    places: MapPlaces,
    base_color: Texture,
    normal: Texture,
    response: Texture,
    emission: Texture,
    layer_color: Texture,
    layer_normal: Texture,
) -> Surface:
    """The base colour in the valleys, the layer's on the mountains, water, or nothing met."""
    low = base_color_of(base_color, spot_of(spot, places.base_color)).xyz
    color = mix(low, high_ground(low, layer_color, spot, places), spot.height)
    leaning = normal_of(normal, spot_of(spot, places.normal), finish.normal_strength)
    level = turned(leaning, places.normal)
    if spot.height < finish.water_level:
        # a ray that has sunk so low has met the water, whether or not it came to the ground
        color = finish.water_color * spot.height
        level = Vec3(0.0, 0.0, 1.0)
    elif not spot.found:
        color = finish.sky_color
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
