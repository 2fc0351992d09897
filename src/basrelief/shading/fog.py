"""Fog: what lies further away takes on the colour of the air."""

from __future__ import annotations

from basrelief.lang import Vec3, exp2, mix, saturate, setting, shader, struct
from basrelief.shading.variant import Variant

PER_E = 1.4426950408889634
"""1 ÷ ln 2: exp(x) is exp2(x · this)."""


@struct
class Fog:
    """The numbers of fog; distances in world units."""

    fog_color: Vec3 = setting(default=Vec3(0.5, 0.55, 0.6), doc="of the air, linear", low=0.0)
    fog_density: float = setting(
        default=0.3, doc="of exponential fog, per world unit", low=0.0, high=1000.0
    )
    fog_start: float = setting(
        default=1.0, doc="the distance at which linear fog begins", low=0.0, high=1e6
    )
    fog_end: float = setting(
        default=5.0, doc="the distance at which linear fog hides all", low=0.0, high=1e6
    )


@shader
def fogged(color: Vec3, distance: float, fog: Fog, variant: Variant) -> Vec3:
    """A colour as it is seen through so much air."""
    if variant.fog_mode == "linear":
        return linear(color, distance, fog)
    if variant.fog_mode == "exponential":
        return exponential(color, distance, fog)
    if variant.fog_mode == "exponential_squared":
        return exponential_squared(color, distance, fog)
    return color


@shader
def linear(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Evenly more from one distance to another."""
    through = saturate((fog.fog_end - distance) / max(fog.fog_end - fog.fog_start, 1e-6))
    return mix(fog.fog_color, color, through)


@shader
def exponential(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Even air: each unit of it takes the same share."""
    return mix(fog.fog_color, color, exp2(-fog.fog_density * distance * PER_E))


@shader
def exponential_squared(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Clear near by, then closing in."""
    thick = fog.fog_density * distance
    return mix(fog.fog_color, color, exp2(-thick * thick * PER_E))
