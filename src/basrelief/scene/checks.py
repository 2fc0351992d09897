"""Checking the values that users give: one clear line for what does not fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from basrelief.errors import InputError, suggestion
from basrelief.lang.types import VECTORS, fields_of, is_record

NEAR, FAR = 1e-6, 1e6
"""Sizes, places and tilings that float32 holds with room for squares, cubes and quotients."""

FOG_IS_NUMBERS = "fog is {0!r}: fog holds the numbers now; write fog_mode = {0!r}"
"""The refusal of a fog mode given as `fog`, as it was called before."""

NUMBERS: tuple[Any, ...] = (int, float, np.integer, np.floating)
_MOST_IN_32_BITS: dict[Any, float] = {int: 2**31 - 1, float: float(np.finfo(np.float32).max)}


def check_choice(what: str, value: Any, allowed: Sequence[Any]) -> None:
    """Raise InputError unless the value is one of those allowed."""
    if value not in allowed:
        names = ", ".join(str(a) for a in allowed if a is not None)
        raise InputError(f"{what} is one of {names}, not {value!r}")


def check_range(what: str, value: float, low: float | None, high: float | None) -> None:
    """Raise InputError unless the value is a finite number in the range, ends included."""
    below = low is not None and value < low
    above = high is not None and value > high
    if not math.isfinite(value) or below or above:
        ends = f"from {low:g}" if high is None else f"from {low or 0:g} to {high:g}"
        raise InputError(f"{what} is {value:g}: give a number {ends}")


def settings_record(record: Any, given: Any, owner: str) -> Any:
    """A record of settings from itself, or from a mapping of the fields to change, checked."""
    if isinstance(given, Mapping):
        return checked_record(record, given, owner)
    if not isinstance(given, record):
        raise InputError(f"{owner} takes settings of type {record.__name__}")
    return checked_record(record, {f.name: getattr(given, f.name) for f in fields(record)}, owner)


def checked_record(record: Any, values: Mapping[str, Any], owner: str) -> Any:
    """A record of settings with some fields changed; raises InputError for what does not fit."""
    assert is_record(record)
    known = {f.name: f for f in fields(record)}
    for name in values:
        if name not in known:
            raise InputError(
                f"{owner} has no setting {name!r}; {suggestion(name, known, 'it has')}"
            )
    for name, each in known.items():
        if each.default is MISSING and name not in values:
            raise InputError(f"{owner} needs a value for {name}")
    types = fields_of(record)
    return record(**{n: _checked(n, v, types[n], known[n].metadata) for n, v in values.items()})


def _checked(name: str, value: Any, wanted: Any, meta: Mapping[str, Any]) -> Any:
    """A number, or a vector's numbers, each within the setting's range and 32 bits."""
    component: Any
    component, size = (wanted, 1) if wanted in (int, float) else VECTORS.get(wanted, (None, 0))
    if component is None:
        return value
    several = size > 1 and not isinstance(value, str | Mapping) and np.iterable(value)
    numbers = [*value] if several else [value]
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, NUMBERS):
            raise InputError(f"{name} is a number, not {value!r}")
        if abs(float(number)) > _MOST_IN_32_BITS[component]:
            raise InputError(f"{name} is further from 0 than 32 bits reach")
        check_range(name, float(number), meta.get("low"), meta.get("high"))
        if component is int and int(number) != number:
            raise InputError(f"{name} is a whole number, not {number:g}")
    if len(numbers) not in (1, size):
        raise InputError(f"{name} is one number, or {size} of them, not {value!r}")
    return wanted(*numbers)
