"""A landscape: ground that changes with the height, and water below a height.

After habrador, Advanced shaders in Unity: 3. Parallax mapping: grass in the valleys, stone on the
mountains, water in the lowest places, and a plain colour where the ray met nothing.
"""

from __future__ import annotations

from basrelief.lang import Texture, Vec3, mix, setting, shader, struct
from basrelief.shaders.surfaces.standard import base_color_of, layer_color_of, normal_of
from basrelief.shaders.surfaces.surface import MapPlaces, Spot, Surface, apart, spot_of, turned


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
    high = layer_color_of(layer_color, apart(spot, places.layer))
    color = mix(low, high, spot.height)
    leaning = normal_of(normal, spot_of(spot, places.normal), finish.normal_strength)
    level = turned(leaning, places.normal)
    if spot.height < finish.water_level:
        color = finish.water_color * spot.height
        level = Vec3(0.0, 0.0, 1.0)
    if not spot.found:
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
