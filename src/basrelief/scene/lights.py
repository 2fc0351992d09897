"""Lights: from far away, a lamp at a place, a lamp with a cone."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.scene.checks import FAR, check_range
from basrelief.shading.kinds import either
from basrelief.shading.lights import DIRECTIONAL, POINT, SPOT, Light

_Color = Sequence[float]
_WHITE = (1.0, 1.0, 1.0)


def directional(
    azimuth: float = -40.0, elevation: float = 40.0, color: _Color = _WHITE, intensity: float = 1.0
) -> Light:
    """A light from far away, from the direction of an orbit's azimuth and elevation."""
    around, above = np.radians([azimuth, elevation])
    with np.errstate(invalid="ignore"):
        level = np.array([np.sin(around), 0.0, np.cos(around)])
        towards = level * np.cos(above) + np.array([0.0, np.sin(above), 0.0])
    return _light(DIRECTIONAL, direction=-towards, color=color, intensity=intensity)


def point(
    position: Sequence[float], color: _Color = _WHITE, intensity: float = 1.0, falloff: float = 2.0
) -> Light:
    """A lamp at a position in world units; `intensity` is what arrives at distance 1.

    `falloff` is the power of the distance: 2 for the inverse square, 1 as in wikibooks.
    """
    return _light(POINT, position=position, color=color, intensity=intensity, falloff=falloff)


def spot(
    position: Sequence[float],
    target: Sequence[float] = (0.0, 0.0, 0.0),
    color: _Color = _WHITE,
    intensity: float = 1.0,
    falloff: float = 2.0,
    angle: float = 40.0,
    softness: float = 0.25,
) -> Light:
    """A lamp with a cone: `angle` is its whole width in degrees, `softness` the share of it (0 to
    1) over which it fades."""
    if not 0.0 < angle < 180.0 or not 0.0 <= softness <= 1.0:
        raise InputError(f"a spot of angle {angle}, softness {softness}: give 0–180 and 0–1")
    if len(target) != 3 or len(position) != 3:
        raise InputError(f"a spot at {position} towards {target}: give three numbers each")
    direction = np.subtract(target, position)
    half = math.radians(angle) / 2.0
    return _light(
        SPOT,
        position=position,
        direction=direction,
        color=color,
        intensity=intensity,
        falloff=falloff,
        cos_inner=math.cos(half * (1.0 - softness)),
        cos_outer=math.cos(half),
    )


LIGHTS: dict[str, Callable[..., Light]] = {
    "directional": directional,
    "point": point,
    "spot": spot,
}
"""What makes a light of each kind, by name, in the order of the shaders' numbers."""
LIGHT_CONSTRUCTORS = either(LIGHTS)


def light_kind(light: Light) -> str:
    """The kind of a light, by its name; raises InputError for a number that stands for none."""
    kinds = dict(enumerate(LIGHTS))
    if int(light.kind) not in kinds:
        known = ", ".join(f"{number} ({name})" for number, name in kinds.items())
        raise InputError(f"the kind of a light is one of {known}, not {light.kind}")
    return kinds[int(light.kind)]


def light_parameters(kind: str | Light) -> tuple[str, ...]:
    """The numbers that make a light of a kind, or one as a light is.

    A kind with a `position` is placed, one with an `azimuth` or a `target` aimed; one with an
    `angle` has a cone.
    """
    name = kind if isinstance(kind, str) else light_kind(kind)
    return tuple(inspect.signature(LIGHTS[name]).parameters)


def _light(
    kind: int,
    *,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    direction: Any = (0.0, -1.0, 0.0),
    color: _Color,
    intensity: float,
    falloff: float = 2.0,
    cos_inner: float = 1.0,
    cos_outer: float = 0.0,
) -> Light:
    way = np.asarray(direction, np.float64)
    length = float(np.linalg.norm(way))
    numbers = [*way, *position, *color, intensity]
    if len(position) != 3 or len(color) != 3:
        raise InputError(f"a light at {position} of colour {color}: give three numbers each")
    if not (np.abs(numbers) <= FAR).all() or length == 0.0:
        raise InputError("a light needs finite numbers, and a direction of some length")
    check_range("falloff", falloff, 0.0, 8.0)
    return Light(
        kind,
        Vec3(*position),
        Vec3(*(way / length)),
        Vec3(*(c * intensity for c in color)),
        falloff,
        cos_inner,
        cos_outer,
    )
