"""Checking what a preset says: known keys, and values of the kind that each takes."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any

import numpy as np

from basrelief.errors import InputError, suggestion
from basrelief.lang import Vec3
from basrelief.material import MAPS
from basrelief.scene import LookAt, Object, Orbit, Scene
from basrelief.scene.checks import FOG_IS_NUMBERS
from basrelief.scene.lights import LIGHTS
from basrelief.shading.kinds import menus_of

TEXT, SWITCH, NUMBER, WHOLE = "a text", "true or false", "a number", "a whole number"
PAIR, TRIPLE = "two numbers, as [1, 2]", "three numbers, as [1, 2, 3]"
NUMBERS, TABLE = "numbers by their names", "a table"

OF_MAPS: dict[str, str] = {
    "normal_convention": TEXT,
    "normal_packing": TEXT,
    "height_polarity": TEXT,
    "height_channel": TEXT,
    "stretch_height": SWITCH,
    **dict.fromkeys(MAPS, TEXT),
}
OF_OBJECT: dict[str, str] = {
    **dict.fromkeys(("technique", *menus_of(Object), "lengths"), TEXT),
    **dict.fromkeys(("scale", "reference_height", "bias"), NUMBER),
    **dict.fromkeys(("fade", "tiling", "shift"), PAIR),
    **dict.fromkeys(("settings", "smoothing", "surface_parameters"), NUMBERS),
    **dict.fromkeys(("tilings", "layer"), TABLE),
}
OF_TILING = {"tiles": PAIR, "shift": PAIR}
OF_LAYER = {"material": TEXT, **OF_TILING}
OF_SCENE: dict[str, str] = {
    **dict.fromkeys(menus_of(Scene), TEXT),
    **dict.fromkeys(("shading", "shadowing", "fog"), NUMBERS),
    "shadow_map_size": WHOLE,
    "background": TRIPLE,
    "camera": TABLE,
    "lights": "tables, each [[scene.lights]]",
}
OF_MOTION = {"scroll": PAIR}


def frozen(value: Any, key: str) -> Any:
    """A value as TOML has it, that nobody can change: tables, tuples, texts, plain numbers."""
    if isinstance(value, Mapping):
        return MappingProxyType({str(k): frozen(v, f"{key}.{k}") for k, v in value.items()})
    if isinstance(value, np.bool_ | np.integer | np.floating):
        return value.item()
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple | np.ndarray | Vec3):
        return tuple(frozen(each, key) for each in value)
    raise InputError(f"{key.lstrip('.')} is {value!r}: give a text, numbers or a table")


def checked(said: Any, known: Mapping[str, str], what: str) -> None:
    """Raise InputError for a table with keys that are not known, or values of another kind."""
    if not isinstance(said, Mapping):
        raise InputError(f"{what} is {said!r}: make it a table, [{what}]")
    for key, value in said.items():
        if key not in known:
            raise InputError(f"{what} has no key {key!r}; {suggestion(key, known, 'it has')}")
        if key == "fog" and isinstance(value, str):
            raise InputError(FOG_IS_NUMBERS.format(value))
        _check_kind(value, known[key], f"{what}.{key}")


def _check_kind(value: Any, kind: str, key: str) -> None:
    fits = {
        TEXT: isinstance(value, str),
        SWITCH: isinstance(value, bool),
        NUMBER: _number(value),
        WHOLE: _number(value) and isinstance(value, int),
        PAIR: _several(value, 2),
        TRIPLE: _several(value, 3),
        TABLE: isinstance(value, Mapping),
        NUMBERS: isinstance(value, Mapping),
    }
    if not fits.get(kind, isinstance(value, tuple)):
        raise InputError(f"{key} is {_shown(value)}: give {kind}")
    if kind is NUMBERS:
        for name, each in value.items():
            if not _number(each) and not _several(each, 3):
                raise InputError(f"{key}.{name} is {_shown(each)}: give a number, or three")


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _several(value: Any, count: int) -> bool:
    return isinstance(value, tuple) and len(value) == count and all(map(_number, value))


def _shown(value: Any) -> str:
    return "a table" if isinstance(value, Mapping) else repr(value)


# --- cameras and lights ---------------------------------------------------------------------------


def camera_of(said: Mapping[str, Any]) -> Orbit | LookAt:
    """A camera from its numbers: one that stands somewhere, where they name a `position`."""
    kind = LookAt if "position" in said else Orbit
    checked(said, _kinds(f.name for f in fields(kind)), "scene.camera")
    made = kind(**said)
    made.camera((8, 8))
    return made


def light_of(said: Any) -> Any:
    """A light from its numbers and its `kind`."""
    if not isinstance(said, Mapping) or said.get("kind") not in LIGHTS:
        raise InputError(f"scene.lights: give each a kind: {', '.join(LIGHTS)}")
    made = LIGHTS[said["kind"]]
    known = inspect.signature(made).parameters
    numbers = {key: value for key, value in said.items() if key != "kind"}
    checked(numbers, _kinds(known), f"scene.lights ({said['kind']})")
    for name, each in known.items():
        if each.default is each.empty and name not in numbers:
            raise InputError(f"scene.lights ({said['kind']}): give it a {name}")
    return made(**numbers)


def _kinds(names: Iterable[str]) -> dict[str, str]:
    vectors = ("position", "target", "up", "color")
    return {name: TRIPLE if name in vectors else NUMBER for name in names}
