"""Validation of presets: known keys, and the type of each value."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from basrelief.errors import InputError, suggestion
from basrelief.lang import Vec3
from basrelief.material import MAPS
from basrelief.material.options import ReadOptions
from basrelief.scene import LookAt, Object, Orbit, Scene, Tiling
from basrelief.scene.checks import FOG_IS_NUMBERS, is_number
from basrelief.scene.lights import LIGHTS, light_parameters
from basrelief.settings import Setting, settings_of

WANTED: dict[str, str] = {
    "text": "a text",
    "choice": "a text",
    "source": "a file, or a number",
    "flag": "true or false",
    "number": "a number",
    "integer": "a whole number",
    "pair": "two numbers, as [1, 2]",
    "triple": "three numbers, as [1, 2, 3]",
    "numbers": "numbers by their names",
    "table": "a table",
    "tables": "tables, each [[scene.lights]]",
}
"""Kinds of values and their names in messages; the kinds are those of `Setting`, and tables."""
Kinds = Mapping[str, str]

MAPS_KEYS: Kinds = {
    **{name: declared.kind for name, declared in settings_of(ReadOptions).items()},
    **dict.fromkeys(MAPS, "source"),
}
OBJECT_KEYS: Kinds = {
    **{name: declared.kind for name, declared in settings_of(Object).items()},
    "lengths": "text",
    "tilings": "table",
    "layer": "table",
}
TILING_KEYS: Kinds = {name: declared.kind for name, declared in settings_of(Tiling).items()}
LAYER_KEYS: Kinds = {"material": "text", **TILING_KEYS}
SCENE_KEYS: Kinds = {
    **{name: declared.kind for name, declared in settings_of(Scene).items()},
    "camera": "table",
    "lights": "tables",
}
MOTION_KEYS: Kinds = {"scroll": "pair"}


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


def check_table(table: Any, known: Kinds, what: str) -> None:
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
    match kind:
        case "text" | "choice":
            fits = isinstance(value, str)
        case "source":
            fits = isinstance(value, str) or is_number(value)
        case "flag":
            fits = isinstance(value, bool)
        case "number":
            fits = is_number(value)
        case "integer":
            fits = is_number(value) and isinstance(value, int)
        case "pair" | "triple":
            fits = _is_sequence(value, {"pair": 2, "triple": 3}[kind])
        case "table" | "numbers":
            fits = isinstance(value, Mapping)
        case _:
            fits = isinstance(value, tuple)
    if not fits:
        raise InputError(f"{key} is {_shown(value)}: give {WANTED[kind]}")
    if kind == "numbers":
        for name, item in value.items():
            if not is_number(item) and not _is_sequence(item, 3):
                raise InputError(f"{key}.{name} is {_shown(item)}: give a number, or three")


def _is_sequence(value: Any, count: int) -> bool:
    return isinstance(value, tuple) and len(value) == count and all(map(is_number, value))


def _shown(value: Any) -> str:
    return "a table" if isinstance(value, Mapping) else repr(value)


# --- cameras and lights ---------------------------------------------------------------------------


def camera_of(table: Mapping[str, Any]) -> Orbit | LookAt:
    """A camera from its table: a `LookAt` if there is a `position`, else an `Orbit`."""
    record = LookAt if "position" in table else Orbit
    _check_settings(table, settings_of(record), "scene.camera")
    camera = record(**table)
    camera.camera((8, 8))
    return camera


def light_of(table: Any) -> Any:
    """A light from its table, which names its `kind`."""
    if not isinstance(table, Mapping) or table.get("kind") not in LIGHTS:
        raise InputError(f"scene.lights: give each a kind: {', '.join(LIGHTS)}")
    kind = table["kind"]
    numbers = {key: value for key, value in table.items() if key != "kind"}
    _check_settings(numbers, light_parameters(kind), f"scene.lights ({kind})")
    return LIGHTS[kind](**numbers)


def _check_settings(table: Any, known: Mapping[str, Setting], what: str) -> None:
    check_table(table, {name: declared.kind for name, declared in known.items()}, what)
    for name, declared in known.items():
        if declared.required and name not in table:
            raise InputError(f"{what}: give it a {name}")
