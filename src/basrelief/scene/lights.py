"""Light constructors: directional, point and spot lights."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Annotated, Any

import numpy as np

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.scene.checks import FAR, check_range
from basrelief.settings import Setting, parameters_of
from basrelief.settings.kinds import either
from basrelief.shading.lights import DIRECTIONAL, POINT, SPOT, Light

_Angle = Annotated[float, {"control": {"low": -180.0, "high": 180.0, "step": 1.0}}]
_Elevation = Annotated[float, {"control": {"low": -90.0, "high": 90.0, "step": 1.0}}]
_Point = Annotated[
    Sequence[float],
    {
        "kind": "triple", "low": -FAR, "high": FAR,
        "control": {"low": -4.0, "high": 4.0, "step": 0.05},
    },
]  # fmt: skip
_Color = Annotated[Sequence[float], {"kind": "triple", "low": 0.0, "high": FAR}]
_Intensity = Annotated[float, {"low": 0.0, "high": FAR, "control": {"high": 10.0, "step": 0.1}}]
_Falloff = Annotated[float, {"low": 0.0, "high": 8.0, "control": {"step": 0.1}}]
_Cone = Annotated[
    float,
    {"low": 0.01, "high": 179.99, "control": {"low": 1.0, "high": 179.0, "step": 1.0}},
]
_Softness = Annotated[float, {"low": 0.0, "high": 1.0, "control": {"step": 0.01}}]
_WHITE = (1.0, 1.0, 1.0)


def directional(
    azimuth: _Angle = -40.0,
    elevation: _Elevation = 40.0,
    color: _Color = _WHITE,
    intensity: _Intensity = 1.0,
) -> Light:
    """A directional light, infinitely far away.

    Parameters
    ----------
    azimuth, elevation : float
        Direction towards the light in degrees, as for `Orbit`.
    color : (float, float, float), default white
        Linear RGB, 0 or above.
    intensity : float, default 1.0
        Factor of the colour.

    Returns
    -------
    Light

    Raises
    ------
    InputError
        For values out of range.
    """
    azimuth_radians, elevation_radians = np.radians([azimuth, elevation])
    with np.errstate(invalid="ignore"):
        horizontal = np.array([np.sin(azimuth_radians), 0.0, np.cos(azimuth_radians)])
        towards = horizontal * np.cos(elevation_radians) + np.array(
            [0.0, np.sin(elevation_radians), 0.0]
        )
    return _light(DIRECTIONAL, direction=-towards, color=color, intensity=intensity)


def point(
    position: _Point,
    color: _Color = _WHITE,
    intensity: _Intensity = 1.0,
    falloff: _Falloff = 2.0,
) -> Light:
    """A point light.

    Parameters
    ----------
    position : (float, float, float)
        Position in world units.
    color : (float, float, float), default white
        Linear RGB, 0 or above.
    intensity : float, default 1.0
        Factor of the colour at distance 1.
    falloff : float, default 2.0
        Power of the distance by which the light is divided, 0 to 8: 2 is the inverse-square law, 1
        that of the preset `wikibooks`, 0 no attenuation.

    Returns
    -------
    Light

    Raises
    ------
    InputError
        For values out of range.
    """
    return _light(POINT, position=position, color=color, intensity=intensity, falloff=falloff)


def spot(
    position: _Point,
    target: _Point = (0.0, 0.0, 0.0),
    color: _Color = _WHITE,
    intensity: _Intensity = 1.0,
    falloff: _Falloff = 2.0,
    angle: _Cone = 40.0,
    softness: _Softness = 0.25,
) -> Light:
    """A spot light.

    Parameters
    ----------
    position : (float, float, float)
        Position in world units.
    target : (float, float, float), default (0, 0, 0)
        Point on the axis of the light's cone, in world units.
    color : (float, float, float), default white
        Linear RGB, 0 or above.
    intensity : float, default 1.0
        Factor of the colour at distance 1.
    falloff : float, default 2.0
        Power of the distance by which the light is divided, 0 to 8.
    angle : float, default 40.0
        Full angle of the cone in degrees, above 0 and below 180.
    softness : float, default 0.25
        Fraction of the cone over which the light fades to its edge, 0 to 1.

    Returns
    -------
    Light

    Raises
    ------
    InputError
        For values out of range, and for a target at the position.
    """
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
"""Light constructors by kind, in the order of the shaders' numbers."""
LIGHT_CONSTRUCTORS = either(LIGHTS)
"""The names of the constructors, for messages."""


def light_kind(light: Light) -> str:
    """The name of a light's kind; raises InputError for an unknown number."""
    kinds = dict(enumerate(LIGHTS))
    if int(light.kind) not in kinds:
        known = ", ".join(f"{number} ({name})" for number, name in kinds.items())
        raise InputError(f"the kind of a light is one of {known}, not {light.kind}")
    return kinds[int(light.kind)]


def checked_lights(lights: Any) -> tuple[Light, ...]:
    """The lights of an iterable; raises InputError for other values."""
    if not isinstance(lights, Iterable):
        raise InputError("lights are a tuple, as (directional(),)")
    checked = tuple(lights)
    for light in checked:
        if not isinstance(light, Light):
            raise InputError(f"a light is {light!r}: give one made by {LIGHT_CONSTRUCTORS}")
        light_kind(light)
    return checked


def light_parameters(kind: str | Light) -> Mapping[str, Setting]:
    """Parameters of the constructor for a kind of light, or for the kind of a light, by name.

    Kinds with a `position` are placed, those with an `azimuth` or a `target` directed, those with
    an `angle` have a cone.
    """
    name = kind if isinstance(kind, str) else light_kind(kind)
    return parameters_of(LIGHTS[name])


def parameters_of_all_lights() -> dict[str, Setting]:
    """Parameters of all kinds of lights by name; angles stand for a target."""
    return {
        name: declared
        for kind in LIGHTS
        for name, declared in light_parameters(kind).items()
        if name != "target"
    }


def light_numbers(light: Light) -> dict[str, Any]:
    """The kind of a light and the parameters of all kinds; its direction is two angles in degrees.

    The intensity is separate from the colour, whose largest component is 1. Numbers that the
    light's own kind lacks have their defaults.
    """
    own = light_parameters(light)
    usual = {name: declared.default for name, declared in parameters_of_all_lights().items()}
    stored = {name: getattr(light, name) for name in (*own, "position") if hasattr(light, name)}
    intensity = max(*map(float, light.color), 1e-9)
    x, y, z = (-float(component) for component in light.direction)
    computed = {
        "azimuth": round(math.degrees(math.atan2(x, z)), 4),
        "elevation": round(math.degrees(math.asin(max(-1.0, min(1.0, y)))), 4),
        "color": [round(float(component) / intensity, 6) for component in light.color],
        "intensity": float(f"{intensity:.7g}"),
    }
    if "angle" in own:
        outer, inner = (math.acos(float(c)) for c in (light.cos_outer, light.cos_inner))
        computed["angle"] = round(math.degrees(2.0 * outer), 4)
        computed["softness"] = round(1.0 - inner / outer if outer > 0.0 else 0.0, 4)
    plain = {name: _plain(value) for name, value in {**usual, **stored}.items()}
    return {"kind": light_kind(light), **plain, **computed}


def _plain(value: Any) -> float | list[float]:
    """A number or a list of numbers, the shortest with the same 32 bits."""
    if isinstance(value, Iterable):
        return [float(str(component)) for component in value]
    return float(str(value))


def light_arguments(light: Light) -> tuple[str, dict[str, Any]]:
    """The kind of a light, and the arguments of its constructor that differ from the defaults."""
    numbers = light_numbers(light)
    if "target" in light_parameters(light):
        numbers["target"] = _target(numbers)
    arguments = {}
    for name, declared in light_parameters(light).items():
        value = tuple(numbers[name]) if isinstance(numbers[name], list) else numbers[name]
        if declared.required or value != declared.default:
            arguments[name] = value
    return numbers["kind"], arguments


def light_of_numbers(numbers: Mapping[str, Any]) -> Light:
    """The light that `light_numbers` describes."""
    names, values = light_parameters(numbers["kind"]), {**numbers}
    if "target" in names:
        values["target"] = _target(numbers)
    return LIGHTS[numbers["kind"]](**{name: values[name] for name in names})


def _target(numbers: Mapping[str, Any]) -> list[float]:
    """The point at distance 1 from a light, in the direction of its two angles."""
    direction = directional(numbers["azimuth"], numbers["elevation"]).direction
    return [p + float(d) for p, d in zip(numbers["position"], direction, strict=True)]


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
    direction_ = np.asarray(direction, np.float64)
    length = float(np.linalg.norm(direction_))
    numbers = [*direction_, *position, *color, intensity]
    if len(position) != 3 or len(color) != 3:
        raise InputError(f"a light at {position} of colour {color}: give three numbers each")
    if not (np.abs(numbers) <= FAR).all() or length == 0.0:
        raise InputError(
            "a light needs finite numbers and a direction that is not zero; check them"
        )
    for number in (*color, intensity):
        check_range("color or intensity of a light", number, 0.0, FAR)
    check_range("falloff", falloff, 0.0, 8.0)
    return Light(
        kind,
        Vec3(*position),
        Vec3(*(direction_ / length)),
        Vec3(*(c * intensity for c in color)),
        falloff,
        cos_inner,
        cos_outer,
    )
