"""Records of settings from users' values, with one-line error messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from basrelief.errors import InputError, suggestion
from basrelief.lang.types import VECTORS, fields_of, is_record
from basrelief.scene.checks import check_range, is_number
from basrelief.settings import Setting, settings_of
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.techniques.height import Smoothing

SCENE_RECORDS: dict[str, tuple[Any, str]] = {
    "shading": (Shading, "the shading"),
    "shadowing": (Shadowing, "the self-shadow"),
    "fog": (Fog, "the fog"),
}
"""The records of numbers of a scene, and their names in messages."""
_LARGEST_32_BIT: dict[Any, float] = {int: 2**31 - 1, float: float(np.finfo(np.float32).max)}


def settings_record(record: Any, options: Any, owner: str) -> Any:
    """A checked record of settings, from such a record or from a mapping of fields to change."""
    if isinstance(options, Mapping):
        return checked_record(record, options, owner)
    if not isinstance(options, record):
        raise InputError(f"{owner} takes settings of type {record.__name__}")
    return checked_record(record, {f.name: getattr(options, f.name) for f in fields(record)}, owner)


def checked_record(record: Any, values: Mapping[str, Any], owner: str) -> Any:
    """A record of settings with some fields changed.

    Raises InputError for unknown or missing fields and for values out of range.
    """
    assert is_record(record)
    known = {f.name: f for f in fields(record)}
    for name in values:
        if name not in known:
            hint = _other_record(name) or suggestion(name, known, "it has")
            raise InputError(f"{owner} has no setting {name!r}; {hint}")
    for name, field in known.items():
        if field.default is MISSING and name not in values:
            raise InputError(f"{owner} needs a value for {name}")
    types, declared = fields_of(record), settings_of(record)
    return record(**{n: _checked(n, v, types[n], declared.get(n)) for n, v in values.items()})


def _other_record(name: str) -> str:
    """The hint to the record of a scene or an object that has a setting; "" for none."""
    records = {
        **{key: record for key, (record, _) in SCENE_RECORDS.items()},
        "smoothing": Smoothing,
        "surface_parameters": SurfaceParameters,
    }
    keys = [key for key, record in records.items() if name in settings_of(record)]
    return f"it belongs in {keys[0]}" if keys else ""


def _checked(name: str, value: Any, type_: Any, declared: Setting | None) -> Any:
    """A number, or the components of a vector, within the setting's range and 32 bits."""
    component: Any
    component, size = (type_, 1) if type_ in (int, float) else VECTORS.get(type_, (None, 0))
    if component is None:
        return value
    is_sequence = size > 1 and not isinstance(value, str | Mapping) and np.iterable(value)
    numbers = [*value] if is_sequence else [value]
    for number in numbers:
        if not is_number(number):
            raise InputError(f"{name} is a number, not {value!r}")
        if abs(float(number)) > _LARGEST_32_BIT[component]:
            raise InputError(f"{name} does not fit in 32 bits; give a smaller number")
        low, high = (declared.low, declared.high) if declared else (None, None)
        check_range(name, float(number), low, high)
        if component is int and int(number) != number:
            raise InputError(f"{name} is a whole number, not {number:g}")
    if len(numbers) not in (1, size):
        raise InputError(f"{name} is one number, or {size} of them, not {value!r}")
    return type_(*numbers)
