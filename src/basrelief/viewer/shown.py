"""Scenes from the states of a page: the inverse of `viewer.state`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from basrelief.errors import InputError
from basrelief.scene import LookAt, Orbit, Scene, Tiling
from basrelief.scene.checks import check_range
from basrelief.scene.lights import (
    LIGHT_CONSTRUCTORS,
    LIGHTS,
    light_numbers,
    light_of_numbers,
    light_parameters,
)
from basrelief.settings import check_choice, settings_of
from basrelief.shading.lights import Light
from basrelief.viewer.printed import MENUS
from basrelief.viewer.state import camera_to_dict, techniques_of

_SHARED = (
    *MENUS, "scale", "reference_height", "bias", "smoothing", "tiling", "shift", "opening",
    "shading", "shadowing", "fog",
)  # fmt: skip
"""Keys of a state that are fields of `Object` or `Scene`."""


def scene_from_state(state: Mapping[str, Any], scene: Scene) -> Scene:
    """The scene of a page's state, with the material of `scene`, which the page was made of.

    Raises InputError for values out of range.
    """
    obj = scene.objects[0]
    technique = techniques_of(obj)[state["technique"]]
    layer = obj.layer and replace(obj.layer, tiling=tiling_of(state["layer_tiling"]))
    own = {name: tiling_of(tiling) for name, tiling in state["tilings"].items()}
    of_object, of_scene = (
        {name: state[name] for name in _SHARED if hasattr(owner, name)} for owner in (obj, scene)
    )
    if state["heights"] not in technique.takes_heights:
        of_object["heights"] = "sharp"
    drawn = replace(
        obj,
        **of_object,
        technique=technique,
        settings=state["settings"][state["technique"]],
        surface_parameters=state["surface_parameters"][state["surface"]],
        fade=tuple(state["fade"]) if state["fades"] else None,
        tilings=own if state["apart"] else {},
        layer=layer if state["layer"] else None,
        # the scene's transform belongs to the shape of its object
        transform=obj.transform if state["shape"] == obj.shape else None,
    )
    # a page shows no background as black
    background = tuple(state["background"])
    none = scene.background is None and not any(background)
    return replace(
        scene,
        objects=(drawn,),
        camera=camera_of(state["camera"]),
        lights=tuple(light_of(light) for light in state["lights"]),
        background=None if none else background,
        **of_scene,
    )


def tiling_of(value: Any) -> Tiling:
    """A tiling from a `Tiling` or a page's mapping. Raises InputError for other values."""
    try:
        pairs = (value.tiles, value.shift) if isinstance(value, Tiling) else _pairs(**value)
        (u, v), (right, down) = pairs
        tiling = Tiling((float(u), float(v)), (float(right), float(down)))
    except (TypeError, ValueError):
        raise InputError(f"a tiling is {value!r}: give a Tiling((2, 2))") from None
    return tiling.checked("tiling")


def _pairs(tiles: Any = (1.0, 1.0), shift: Any = (0.0, 0.0)) -> tuple[Any, Any]:
    return tiles, shift


def camera_of(value: Any) -> Orbit:
    """An orbit from a camera, or from a mapping of an orbit's fields.

    Raises InputError for other values.
    """
    if not isinstance(value, Orbit | LookAt):
        known = settings_of(Orbit)
        if not isinstance(value, Mapping) or not all(name in known for name in value):
            raise InputError(f"camera is {value!r}: give an Orbit or a LookAt")
        value = Orbit(**value)
    try:
        value.camera((16, 9))
        numbers = camera_to_dict(value)
    except (TypeError, ValueError):
        raise InputError(f"camera is {value!r}: give it finite numbers") from None
    return Orbit(**{**numbers, "target": tuple(numbers["target"])})


def light_of(value: Mapping[str, Any]) -> Light:
    """A light from a page's mapping. Raises InputError for invalid numbers."""
    check_range("intensity", float(value["intensity"]), 0.0, None)
    check_choice("the kind of a light", value["kind"], tuple(LIGHTS))
    return light_of_numbers(value)


def as_light_dict(value: Any) -> dict[str, Any]:
    """A page's light from a `Light`, or from a mapping of some of its numbers.

    Missing numbers are those of the kind's function. Raises InputError for other values.
    """
    if isinstance(value, Light):
        return light_numbers(value)
    if not isinstance(value, Mapping):
        raise InputError(f"a light is {value!r}: give one made by {LIGHT_CONSTRUCTORS}")
    kind = value.get("kind", "directional")
    check_choice("the kind of a light", kind, tuple(LIGHTS))
    place = {"position": (0.0, 1.0, 0.0)} if "position" in light_parameters(kind) else {}
    defaults = light_numbers(LIGHTS[kind](**place))
    for name in value:
        check_choice("a light's number", name, tuple(defaults))
    light = {**defaults, **value}
    try:
        light_of(light)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(f"a light is {value!r}: give it finite numbers") from None
    return light
