"""Fog: colours fade to the fog colour with distance."""

from __future__ import annotations

from basrelief.lang import Vec3, exp2, mix, saturate, setting, shader, struct
from basrelief.shading.variant import Variant

LOG2_E = 1.4426950408889634
"""1 ÷ ln 2: exp(x) = exp2(x · LOG2_E)."""


@struct
class Fog:
    """Settings of the fog; distances in world units."""

    fog_color: Vec3 = setting(
        default=Vec3(0.5, 0.55, 0.6), doc="colour of the fog, linear", low=0.0
    )
    fog_density: float = setting(
        default=0.3, doc="density of exponential fog, per world unit", low=0.0, high=1000.0
    )
    fog_start: float = setting(
        default=1.0, doc="distance at which linear fog begins", low=0.0, high=1e6
    )
    fog_end: float = setting(
        default=5.0, doc="distance at which linear fog is opaque", low=0.0, high=1e6
    )


@shader
def apply_fog(color: Vec3, distance: float, fog: Fog, variant: Variant) -> Vec3:
    """A colour seen through fog over a distance."""
    if variant.fog_mode == "linear":
        return linear_fog(color, distance, fog)
    if variant.fog_mode == "exponential":
        return exponential_fog(color, distance, fog)
    if variant.fog_mode == "exponential_squared":
        return exponential_squared_fog(color, distance, fog)
    return color


@shader
def linear_fog(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Transmittance falls linearly from 1 at `fog_start` to 0 at `fog_end`."""
    transmittance = saturate((fog.fog_end - distance) / max(fog.fog_end - fog.fog_start, 1e-6))
    return mix(fog.fog_color, color, transmittance)


@shader
def exponential_fog(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Homogeneous fog (Beer-Lambert): transmittance exp(−density · distance)."""
    return mix(fog.fog_color, color, exp2(-fog.fog_density * distance * LOG2_E))


@shader
def exponential_squared_fog(color: Vec3, distance: float, fog: Fog) -> Vec3:
    """Transmittance exp(−(density · distance)²): clear nearby, then dense."""
    optical_depth = fog.fog_density * distance
    return mix(fog.fog_color, color, exp2(-optical_depth * optical_depth * LOG2_E))
