"""The types of the shader subset, and records.

A type *is* its Python class: `float`, `int`, `bool`, `Vec2` … `Mat3`, a record made by `@struct`,
or a resource handle. This module answers what they are made of. A `@static` record is no value: it
is known when a program is made, and only conditions read it.
"""

from __future__ import annotations

import dataclasses
import sys
import typing
from collections.abc import Iterator
from typing import Any, Literal, NamedTuple, TypeVar, dataclass_transform

import numpy as np

from basrelief.errors import BasreliefError
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4

VECTORS: dict[type, tuple[type, int]] = {
    t: (t.component, t.size) for t in (Vec2, Vec3, Vec4, IVec2)
}
SCALARS: tuple[type, ...] = (float, int, bool)
_FIELDS = "__shader_fields__"
_STATIC_FIELDS = "__static_fields__"
_T = TypeVar("_T")


class ShaderError(BasreliefError):
    """Source that is outside the shader subset: file, line, the offending text, what to write."""


def setting(*, default: Any, doc: str, low: float | None = None, high: float | None = None) -> Any:
    """A record's field with its default, its meaning and the range a user may choose from.

    `low` and `high` are inclusive; None leaves that side open. They are checked where a user's
    values come in, not when a shader builds a record.
    """
    return dataclasses.field(default=default, metadata={"doc": doc, "low": low, "high": high})


@dataclass_transform(frozen_default=True, field_specifiers=(setting,))
def struct(cls: type[_T]) -> type[_T]:
    """Make a record of a class with annotated fields: frozen, its values held as float32, int32."""
    fields: dict[str, Any] = {}

    def coerce_fields(self: Any) -> None:
        for name, wanted in fields.items():
            object.__setattr__(self, name, coerce(getattr(self, name), wanted))

    setattr(cls, "__post_init__", coerce_fields)  # noqa: B010
    made: Any = dataclasses.dataclass(frozen=True)(cls)
    module = vars(sys.modules[cls.__module__])
    for field in dataclasses.fields(made):
        written = field.type
        fields[field.name] = eval(written, module) if isinstance(written, str) else written
    setattr(made, _FIELDS, fields)
    return made


class StaticField(NamedTuple):
    """What static conditions can read of a record or map: its name in a program, str, bool or int,
    and its values, () for any."""

    name: str
    kind: type
    choices: tuple[str | int, ...]


@dataclass_transform(frozen_default=True)
def static(cls: type[_T]) -> type[_T]:
    """Make a static record of a class: frozen, its fields str, bool, int or a Literal of these.

    A shader that takes one as a parameter branches on its fields and properties; a program is given
    its value and contains the branches that are taken. Raises ShaderError for a field of another
    type.
    """
    made: Any = dataclasses.dataclass(frozen=True)(cls)
    fields = {name: _static_field(name, t) for name, t in typing.get_type_hints(made).items()}
    for name, field in fields.items():
        if field is None:
            raise ShaderError(
                f"{cls.__module__}: {cls.__name__}.{name}: a field of a static record is a str, "
                "bool, int or Literal"
            )
    for name in dir(made):
        got = getattr(made, name)
        if isinstance(got, property):
            fields[name] = _static_field(name, typing.get_type_hints(got.fget).get("return"))
    setattr(made, _STATIC_FIELDS, {name: field for name, field in fields.items() if field})
    return made


def _static_field(name: str, t: Any) -> StaticField | None:
    """The field of an annotation; None where conditions cannot be on it."""
    if typing.get_origin(t) is Literal:
        choices = typing.get_args(t)
        kinds = {type(value) for value in choices}
        return StaticField(name, kinds.pop(), choices) if len(kinds) == 1 else None
    return StaticField(name, t, ()) if t in (str, bool, int) else None


def is_static(t: Any) -> bool:
    """Whether t was made by `@static`."""
    return isinstance(t, type) and _STATIC_FIELDS in vars(t)


def static_fields(t: type) -> dict[str, StaticField]:
    """What conditions on a static record can read: its fields, and properties of the same types."""
    return vars(t)[_STATIC_FIELDS]


class TypeSlot:
    """A type that is known once the slots are bound; subclass it to name it.

    A slot may use it for one parameter; the shader bound to that slot decides what it is.
    """


def is_type_slot(t: Any) -> bool:
    """Whether t stands for a type that is not known yet."""
    return isinstance(t, type) and issubclass(t, TypeSlot)


def is_record(t: Any) -> bool:
    """Whether t was made by `@struct`."""
    return isinstance(t, type) and _FIELDS in vars(t)


def fields_of(t: type) -> dict[str, type]:
    """A record's fields in order: name to type."""
    return vars(t)[_FIELDS]


def leaves(t: type, name: str = "") -> Iterator[tuple[str, type]]:
    """The scalars that make up a value of type t, in order: dotted name and float, int or bool."""
    if t in SCALARS:
        yield name, t
        return
    for part, part_type in _parts(t).items():
        yield from leaves(part_type, f"{name}.{part}" if name else part)


def leaf_values(value: Any, t: type) -> Iterator[Any]:
    """The scalars of a value, in the order of `leaves`."""
    if t in SCALARS:
        yield value
    elif t in VECTORS:
        yield from value
    else:
        for part, part_type in _parts(t).items():
            yield from leaf_values(getattr(value, part), part_type)


def from_leaves(values: Iterator[Any], t: type) -> Any:
    """Build a value of type t from its scalars, in the order of `leaves`."""
    if t in SCALARS:
        return coerce(next(values), t)
    return t(*(from_leaves(values, part_type) for part_type in _parts(t).values()))


def _parts(t: type) -> dict[str, type]:
    """What a vector, matrix or record is made of: components, columns or fields."""
    if t in VECTORS:
        component, size = VECTORS[t]
        return dict.fromkeys("xyzw"[:size], component)
    return dict.fromkeys("xyz", Vec3) if t is Mat3 else fields_of(t)


def coerce(value: Any, t: Any) -> Any:
    """The value as the subset holds it: float32, int32 or bool; others must be of the type."""
    if t is float:
        return np.float32(value)
    if t is int:
        return np.int32(value)
    if t is bool:
        return bool(value)
    if t in VECTORS and not isinstance(value, t):
        return t(*value)
    if isinstance(t, type) and not is_type_slot(t) and not isinstance(value, t):
        raise TypeError(f"expected {t.__name__}, not {type(value).__name__}")
    return value


def type_name(t: Any) -> str:
    """How messages name a type."""
    return getattr(t, "__name__", str(t))
