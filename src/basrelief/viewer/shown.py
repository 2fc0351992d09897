"""What a page shows, as a scene: the other way of `viewer.state`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from basrelief.errors import InputError
from basrelief.scene import LookAt, Orbit, Scene, Tiling, directional
from basrelief.scene.checks import check_choice, check_range
from basrelief.scene.lights import LIGHT_CONSTRUCTORS, LIGHTS, light_parameters
from basrelief.shading.lights import Light
from basrelief.viewer.printed import MENUS
from basrelief.viewer.state import plain_camera, plain_light, techniques_of

_SHARED = (
    *MENUS, "scale", "reference_height", "bias", "smoothing", "tiling", "shift", "shading",
    "shadowing", "fog",
)  # fmt: skip
"""The settings that an object or a scene has by the same names."""


def shown_scene(state: Mapping[str, Any], scene: Scene) -> Scene:
    """The scene that a page of `scene` shows in a state, with the material of `scene`.

    Raises InputError for values out of range.
    """
    obj = scene.objects[0]
    technique = techniques_of(obj)[state["technique"]]
    over = obj.layer and replace(obj.layer, tiling=tiling_of(state["layer_tiling"]))
    own = {name: tiling_of(each) for name, each in state["tilings"].items()}
    of_object, of_scene = (
        {name: state[name] for name in _SHARED if hasattr(owner, name)} for owner in (obj, scene)
    )
    if state["heights"] not in technique.takes_heights:
        of_object["heights"] = "sharp"
    shown = replace(
        obj,
        **of_object,
        technique=technique,
        settings=state["settings"][state["technique"]],
        surface_parameters=state["surface_parameters"][state["surface"]],
        fade=tuple(state["fade"]) if state["fades"] else None,
        tilings=own if state["apart"] else {},
        layer=over if state["layer"] else None,
        # a transform is that of the shape that it was made for
        transform=obj.transform if state["shape"] == obj.shape else None,
    )
    # black is what a page shows where there is nothing behind
    behind = tuple(state["background"])
    none = scene.background is None and not any(behind)
    return replace(
        scene,
        objects=(shown,),
        camera=camera_of(state["camera"]),
        lights=tuple(light_of(each) for each in state["lights"]),
        background=None if none else behind,
        **of_scene,
    )


def tiling_of(said: Any) -> Tiling:
    """A tiling from a page's, or itself. Raises InputError for what makes none."""
    try:
        pairs = (said.tiles, said.shift) if isinstance(said, Tiling) else _pairs(**said)
        (u, v), (right, down) = pairs
        made = Tiling((float(u), float(v)), (float(right), float(down)))
    except (TypeError, ValueError):
        raise InputError(f"a tiling is {said!r}: give a Tiling((2, 2))") from None
    return made.checked("tiling")


def _pairs(tiles: Any = (1.0, 1.0), shift: Any = (0.0, 0.0)) -> tuple[Any, Any]:
    return tiles, shift


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
    check_range("intensity", float(said["intensity"]), 0.0, None)
    check_choice("the kind of a light", said["kind"], tuple(LIGHTS))
    names, numbers = light_parameters(said["kind"]), {**said}
    if "target" in names:
        # the way is that of a light from far away at these angles
        way = directional(said["azimuth"], said["elevation"]).direction
        numbers["target"] = [p + float(d) for p, d in zip(said["position"], way, strict=True)]
    return LIGHTS[said["kind"]](**{name: numbers[name] for name in names})


def said_light(given: Any) -> dict[str, Any]:
    """A page's light from a light, or from a mapping of what a page's light has.

    What a mapping leaves out is as the kind's own function has it. Raises InputError for what
    makes no light.
    """
    if isinstance(given, Light):
        return plain_light(given)
    if not isinstance(given, Mapping):
        raise InputError(f"a light is {given!r}: give one made by {LIGHT_CONSTRUCTORS}")
    kind = given.get("kind", "directional")
    check_choice("the kind of a light", kind, tuple(LIGHTS))
    place = {"position": (0.0, 1.0, 0.0)} if "position" in light_parameters(kind) else {}
    usual = plain_light(LIGHTS[kind](**place))
    for name in given:
        check_choice("a light's number", name, tuple(usual))
    made = {**usual, **given}
    try:
        light_of(made)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(f"a light is {given!r}: give it finite numbers") from None
    return made
