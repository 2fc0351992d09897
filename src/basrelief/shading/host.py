"""Entries for a host that has its own renderer, such as a game engine.

The host supplies texture coordinates and unit vectors in tangent space (x along +u, y up in the
picture, z along the normal), the height map, and the aspect of a tile. It gets the displaced
coordinates and the visibility of a light, and shades by itself.
"""

from __future__ import annotations

from basrelief.lang import HeightField, Texture, Vec2, Vec3, shader
from basrelief.shading.relief import (
    ReliefParameters,
    falling_ray,
    offset_per_height,
    rising_ray,
)
from basrelief.shading.self_shadow import Shadowing, light_visibility
from basrelief.shading.variant import Variant
from basrelief.techniques.height import sharp
from basrelief.techniques.projection import MIN_COSINE
from basrelief.techniques.ray import Hit
from basrelief.techniques.technique import Settings, displace


@shader
def host_hit(
    field: HeightField,
    baked: Texture,
    uv: Vec2,
    view: Vec3,
    aspect: float,
    relief: ReliefParameters,
    settings: Settings,
    variant: Variant,
) -> Hit:
    """Hit of the view ray with the relief, by the technique and projection of the program.

    `uv` is where the ray meets the polygon, `view` the unit vector to the viewer in tangent space,
    `aspect` the width of a tile divided by its height.
    """
    travel = in_tiles(offset_per_height(view, relief.bias, variant) * -relief.scale, aspect)
    ray = falling_ray(uv, travel, view.z, relief.reference_height, relief.scale, 0.0, 0.0)
    return displace(field, baked, ray, settings)


@shader
def host_self_shadow(
    field: HeightField,
    baked: Texture,
    uv: Vec2,
    light: Vec3,
    aspect: float,
    relief: ReliefParameters,
    settings: Settings,
    shadowing: Shadowing,
    variant: Variant,
) -> float:
    """Visibility of a light through the relief, 0 to 1, from the displaced coordinates `uv`.

    `light` is the unit vector to the light in tangent space; a light below the polygon gives 0.
    """
    if light.z <= MIN_COSINE:
        return 0.0
    height = sharp(field, uv)
    travel = in_tiles(light.xy * (relief.scale * (1.0 - height) / light.z), aspect)
    ray = rising_ray(uv, height, travel, light.z, relief.scale, 0.0, 0.0)
    return light_visibility(field, baked, ray, settings, shadowing, variant).visibility


@shader
def in_tiles(offset: Vec2, aspect: float) -> Vec2:
    """An offset in tangent space, in tile widths, as one of texture coordinates: v runs down where
    y runs up."""
    return Vec2(offset.x, -offset.y * aspect)
