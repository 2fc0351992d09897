"""Lights: the light that arrives at a point.

Colours are linear Rec. 709. Direction vectors have unit length; `Light.direction` is the direction
in which the light travels, all others point away from the surface.
"""

from __future__ import annotations

from basrelief.lang import Vec3, clamp, dot, length, pow, shader, smoothstep, struct

DIRECTIONAL = 0
POINT = 1
SPOT = 2

FAR_AWAY = 1e18
"""The distance of a directional light: beyond everything, and its square is finite."""
MIN_DISTANCE = 1e-3
"""World units: point and spot lights are no brighter than at this distance."""
MAX_DISTANCE = 1e4
"""World units: nor darker than at this distance, whose powers are still float32 numbers."""
MIN_CONE_WIDTH = 1e-6
"""Lower limit of the difference between the cosines of a spot's two cones: some units in the last
place."""


@struct
class Light:
    """A light of the scene. Fields that its kind does not need are ignored.

    Attributes
    ----------
    kind : int
        DIRECTIONAL, POINT or SPOT.
    position : Vec3
        World position of a point or spot light.
    direction : Vec3
        The unit direction in which a directional or spot light travels.
    color : Vec3
        Linear radiance, intensity included; of point and spot lights that at distance 1.
    falloff : float
        The power of the distance that divides a point or spot light: 1, or 2 for the inverse
        square.
    cos_inner, cos_outer : float
        Cosines of a spot's cones: full brightness within the inner one, none outside the outer one,
        whose cosine is the smaller.
    """

    kind: int
    position: Vec3
    direction: Vec3
    color: Vec3
    falloff: float
    cos_inner: float
    cos_outer: float


@struct
class IncidentLight:
    """Light at a point: the unit direction towards it, its radiance and its distance."""

    direction: Vec3
    radiance: Vec3
    distance: float


@shader
def incident_light(light: Light, position: Vec3) -> IncidentLight:
    """The unoccluded light at a world position."""
    if light.kind == DIRECTIONAL:
        return IncidentLight(-light.direction, light.color, FAR_AWAY)
    offset = light.position - position
    distance = length(offset)
    # at the light itself any direction will do
    direction = Vec3(0.0, 1.0, 0.0)
    if distance > MIN_CONE_WIDTH:
        direction = offset / distance
    radiance = light.color / pow(clamp(distance, MIN_DISTANCE, MAX_DISTANCE), light.falloff)
    if light.kind == SPOT:
        radiance = radiance * spot_attenuation(light, -dot(direction, light.direction))
    return IncidentLight(direction, radiance, distance)


@shader
def spot_attenuation(light: Light, cosine: float) -> float:
    """Attenuation of a spot light at an angle from its axis, 0 to 1: exactly 0 outside the outer
    cone, exactly 1 within the inner one."""
    inner = max(light.cos_inner, light.cos_outer + MIN_CONE_WIDTH)
    return smoothstep(light.cos_outer, inner, cosine)
