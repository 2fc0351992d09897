"""Validation of presets: known keys, and the type of each value."""

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

TEXT, BOOLEAN, NUMBER, INTEGER = "a text", "true or false", "a number", "a whole number"
PAIR, TRIPLE = "two numbers, as [1, 2]", "three numbers, as [1, 2, 3]"
NUMBERS, TABLE = "numbers by their names", "a table"

MAPS_KEYS: dict[str, str] = {
    "normal_convention": TEXT,
    "normal_packing": TEXT,
    "height_polarity": TEXT,
    "height_channel": TEXT,
    "stretch_height": BOOLEAN,
    **dict.fromkeys(MAPS, TEXT),
}
OBJECT_KEYS: dict[str, str] = {
    **dict.fromkeys(("technique", *menus_of(Object), "lengths"), TEXT),
    **dict.fromkeys(("scale", "reference_height", "bias"), NUMBER),
    **dict.fromkeys(("fade", "tiling", "shift"), PAIR),
    **dict.fromkeys(("settings", "smoothing", "surface_parameters"), NUMBERS),
    **dict.fromkeys(("tilings", "layer"), TABLE),
}
TILING_KEYS = {"tiles": PAIR, "shift": PAIR}
LAYER_KEYS = {"material": TEXT, **TILING_KEYS}
SCENE_KEYS: dict[str, str] = {
    **dict.fromkeys(menus_of(Scene), TEXT),
    **dict.fromkeys(("shading", "shadowing", "fog"), NUMBERS),
    "shadow_map_size": INTEGER,
    "background": TRIPLE,
    "camera": TABLE,
    "lights": "tables, each [[scene.lights]]",
}
MOTION_KEYS = {"scroll": PAIR}


def freeze(value: Any, key: str) -> Any:
    """An immutable TOML value: read-only tables, tuples, texts, Python numbers."""
    if isinstance(value, Mapping):
        return MappingProxyType({str(k): freeze(v, f"{key}.{k}") for k, v in value.items()})
    if isinstance(value, np.bool_ | np.integer | np.floating):
        return value.item()
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple | np.ndarray | Vec3):
        return tuple(freeze(item, key) for item in value)
    raise InputError(f"{key.lstrip('.')} is {value!r}: give a text, numbers or a table")


def check_table(table: Any, known: Mapping[str, str], what: str) -> None:
    """Raise InputError for a table with unknown keys, or values of another type."""
    if not isinstance(table, Mapping):
        raise InputError(f"{what} is {table!r}: make it a table, [{what}]")
    for key, value in table.items():
        if key not in known:
            raise InputError(f"{what} has no key {key!r}; {suggestion(key, known, 'it has')}")
        if key == "fog" and isinstance(value, str):
            raise InputError(FOG_IS_NUMBERS.format(value))
        _check_kind(value, known[key], f"{what}.{key}")


def _check_kind(value: Any, kind: str, key: str) -> None:
    fits = {
        TEXT: isinstance(value, str),
        BOOLEAN: isinstance(value, bool),
        NUMBER: _is_number(value),
        INTEGER: _is_number(value) and isinstance(value, int),
        PAIR: _is_sequence(value, 2),
        TRIPLE: _is_sequence(value, 3),
        TABLE: isinstance(value, Mapping),
        NUMBERS: isinstance(value, Mapping),
    }
    if not fits.get(kind, isinstance(value, tuple)):
        raise InputError(f"{key} is {_shown(value)}: give {kind}")
    if kind is NUMBERS:
        for name, item in value.items():
            if not _is_number(item) and not _is_sequence(item, 3):
                raise InputError(f"{key}.{name} is {_shown(item)}: give a number, or three")


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_sequence(value: Any, count: int) -> bool:
    return isinstance(value, tuple) and len(value) == count and all(map(_is_number, value))


def _shown(value: Any) -> str:
    return "a table" if isinstance(value, Mapping) else repr(value)


# --- cameras and lights ---------------------------------------------------------------------------


def camera_of(table: Mapping[str, Any]) -> Orbit | LookAt:
    """A camera from its table: a `LookAt` if there is a `position`, else an `Orbit`."""
    kind = LookAt if "position" in table else Orbit
    check_table(table, _kinds(f.name for f in fields(kind)), "scene.camera")
    camera = kind(**table)
    camera.camera((8, 8))
    return camera


def light_of(table: Any) -> Any:
    """A light from its table, which names its `kind`."""
    if not isinstance(table, Mapping) or table.get("kind") not in LIGHTS:
        raise InputError(f"scene.lights: give each a kind: {', '.join(LIGHTS)}")
    constructor = LIGHTS[table["kind"]]
    known = inspect.signature(constructor).parameters
    numbers = {key: value for key, value in table.items() if key != "kind"}
    check_table(numbers, _kinds(known), f"scene.lights ({table['kind']})")
    for name, item in known.items():
        if item.default is item.empty and name not in numbers:
            raise InputError(f"scene.lights ({table['kind']}): give it a {name}")
    return constructor(**numbers)


def _kinds(names: Iterable[str]) -> dict[str, str]:
    vectors = ("position", "target", "up", "color")
    return {name: TRIPLE if name in vectors else NUMBER for name in names}
