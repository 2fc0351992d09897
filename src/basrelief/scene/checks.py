"""Validation of user-supplied values, with one-line error messages."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

from basrelief.errors import InputError
from basrelief.settings import Setting, check_choice, settings_of

NEAR, FAR = 1e-6, 1e6
"""Range of sizes, coordinates and tilings whose squares, cubes and quotients fit in float32."""
MIN_FIELD_OF_VIEW = 1e-3
"""Smallest field of view in degrees: below it float32 loses the width of a pixel."""

FOG_IS_NUMBERS = "fog is {0!r}: fog holds the numbers now; write fog_mode = {0!r}"
"""Message for a fog mode passed as `fog`, the former name of `fog_mode`."""


def check_range(what: str, value: float, low: float | None, high: float | None) -> None:
    """Raise InputError unless the value is finite and within the range, bounds included."""
    too_small = low is not None and value < low
    too_large = high is not None and value > high
    if not math.isfinite(value) or too_small or too_large:
        ends = f"from {low:g}" if high is None else f"from {low or 0:g} to {high:g}"
        raise InputError(f"{what} is {value:g}: give a number {ends}")


def check_setting(declared: Setting, value: Any) -> None:
    """Raise InputError unless a value has the kind and the range of a setting.

    Records of numbers and other objects are checked where they are resolved.
    """
    if value is None and declared.optional:
        return
    name = declared.name
    match declared.kind:
        case "choice":
            check_choice(name, value, declared.choices)
        case "number" | "integer":
            whole = declared.kind == "integer"
            if not is_number(value) or (whole and not float(value).is_integer()):
                raise InputError(f"{name} is {value!r}: give a {'whole ' * whole}number")
            check_range(name, value, declared.low, declared.high)
        case "pair" | "triple":
            count = {"pair": 2, "triple": 3}[declared.kind]
            if not isinstance(value, Iterable) or len(numbers := list(value)) != count:
                words = {2: "two numbers", 3: "three numbers"}[count]
                raise InputError(f"{name} is {value!r}: give {words}")
            for number in numbers:
                if not is_number(number):
                    raise InputError(f"{name} is {value!r}: give numbers")


def check_settings(record: Any) -> None:
    """Raise InputError unless all settings of a record have their kinds and ranges."""
    for name, declared in settings_of(type(record)).items():
        check_setting(declared, getattr(record, name))


def is_number(value: Any) -> bool:
    """Whether a value is a number, of Python or NumPy, and not a truth value."""
    return isinstance(value, Real) and not isinstance(value, bool)
