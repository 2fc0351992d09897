"""What a page shows, as a scene: the other way of `viewer.state`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from basrelief.errors import InputError
from basrelief.scene import LookAt, Orbit, Scene, directional, point, spot
from basrelief.scene.checks import one_of
from basrelief.shaders.lighting import Light
from basrelief.viewer.state import plain_camera, plain_light

OF_OBJECT = (
    "technique", "shape", "projection", "scale", "level", "bias", "tiling", "shift", "finish",
)  # fmt: skip
OF_SCENE = ("shadows", "shading_model", "shading", "shadowing")
"""The settings that objects and scenes have by the same names."""
_LIGHTS: dict[str, Callable[[], Light]] = {
    "directional": directional,
    "point": lambda: point((0.0, 1.0, 0.0)),
    "spot": lambda: spot((0.0, 1.0, 0.0)),
}
"""The kinds, and what a light of each has where nothing is said."""


def shown_scene(state: Mapping[str, Any], scene: Scene) -> Scene:
    """The scene that a page of `scene` shows in a state, with the material of `scene`.

    Raises InputError for values out of range.
    """
    settings = state["settings"][state["technique"]]
    of_object = {name: state[name] for name in OF_OBJECT}
    return replace(
        scene,
        objects=(replace(scene.objects[0], settings=settings, **of_object),),
        camera=camera_of(state["camera"]),
        lights=tuple(light_of(each) for each in state["lights"]),
        **{name: state[name] for name in OF_SCENE},
    )


def camera_of(said: Any) -> Orbit:
    """A page's camera from a camera, or from an orbit's numbers by name.

    Raises InputError for what makes none.
    """
    if not isinstance(said, Orbit | LookAt):
        known = Orbit.__dataclass_fields__
        if not isinstance(said, Mapping) or not all(name in known for name in said):
            raise InputError(f"camera is {said!r}: give an Orbit or a LookAt")
        said = Orbit(**said)
    try:
        said.camera((16, 9))
        plain = plain_camera(said)
    except (TypeError, ValueError):
        raise InputError(f"camera is {said!r}: give it finite numbers") from None
    return Orbit(**{**plain, "target": tuple(plain["target"])})


def light_of(said: Mapping[str, Any]) -> Light:
    """A light from a page's. Raises InputError for numbers that make none."""
    color, intensity, falloff = said["color"], said["intensity"], said["falloff"]
    if said["kind"] == "directional":
        return directional(said["azimuth"], said["elevation"], color, intensity)
    if said["kind"] == "point":
        return point(said["position"], color, intensity, falloff)
    outer, inner = math.acos(said["cos_outer"]), math.acos(said["cos_inner"])
    target = [p + d for p, d in zip(said["position"], said["direction"], strict=True)]
    angle, softness = math.degrees(outer) * 2.0, 1.0 - inner / outer
    return spot(said["position"], target, color, intensity, falloff, angle, softness)


def said_light(given: Any) -> dict[str, Any]:
    """A page's light from a light, or from a mapping of what a page's light has.

    What a mapping leaves out is as the kind's own function has it. Raises InputError for what
    makes no light.
    """
    if isinstance(given, Light):
        return plain_light(given)
    if not isinstance(given, Mapping):
        raise InputError(f"a light is {given!r}: give one made by directional, point or spot")
    kind = given.get("kind", "directional")
    one_of("the kind of a light", kind, tuple(_LIGHTS))
    usual = plain_light(_LIGHTS[kind]())
    for name in given:
        one_of("a light's number", name, tuple(usual))
    made = {**usual, **given}
    try:
        light_of(made)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(f"a light is {given!r}: give it finite numbers") from None
    return made
