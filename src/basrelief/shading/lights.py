"""Lights: the light that arrives at a point.

Colours are linear Rec. 709. Direction vectors are of unit length; `Light.direction` is the way the
light travels, all others point away from the surface.
"""

from __future__ import annotations

from basrelief.lang import Vec3, clamp, dot, length, pow, shader, smoothstep, struct

DIRECTIONAL = 0
POINT = 1
SPOT = 2

FAR_AWAY = 1e18
"""The distance of a directional light: so large that nothing lies behind it, its square finite."""
NEAREST = 1e-3
"""Point and spot lights give no more light than at this distance, in world units."""
FURTHEST = 1e4
"""Nor less than at this distance, whose powers are still float32 numbers."""
SHARPEST = 1e-6
"""The least difference of the cosines of a spot's two cones, some units in the last place."""


@struct
class Light:
    """A light. `kind` is DIRECTIONAL, POINT or SPOT; fields that a kind has no use for are unread.

    `position` in world units; `direction` the way the light travels, unit; `color` its radiance,
    intensity included: for a point or spot light, that at distance 1. `falloff` is the power of
    distance that divides it there: 1, or 2 for the inverse square. A spot is bright within the
    angle of cosine `cos_inner`, dark outside that of `cos_outer`, which is no larger.
    """

    kind: int
    position: Vec3
    direction: Vec3
    color: Vec3
    falloff: float
    cos_inner: float
    cos_outer: float


@struct
class Incoming:
    """Light at a point: the unit direction towards it, its radiance, how far away it is."""

    direction: Vec3
    radiance: Vec3
    distance: float


@shader
def arriving(light: Light, position: Vec3) -> Incoming:
    """The light that arrives at a position, in world units, with nothing in its way."""
    if light.kind == DIRECTIONAL:
        return Incoming(-light.direction, light.color, FAR_AWAY)
    offset = light.position - position
    distance = length(offset)
    # within the lamp itself any direction is as good as another
    direction = Vec3(0.0, 1.0, 0.0)
    if distance > SHARPEST:
        direction = offset / distance
    radiance = light.color / pow(clamp(distance, NEAREST, FURTHEST), light.falloff)
    if light.kind == SPOT:
        radiance = radiance * cone(light, -dot(direction, light.direction))
    return Incoming(direction, radiance, distance)


@shader
def cone(light: Light, cosine: float) -> float:
    """A spot's share, 0 to 1, at an angle from its axis: exactly 0 outside, 1 within."""
    inner = max(light.cos_inner, light.cos_outer + SHARPEST)
    return smoothstep(light.cos_outer, inner, cosine)
