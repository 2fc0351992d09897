"""The types of the shader subset, and records.

A type *is* its Python class: `float`, `int`, `bool`, `Vec2` … `Mat3`, a record made by `@struct`,
or a resource handle. This module decomposes them into fields and scalars. A `@static` record is
not a value: it is known when a program is made, and only conditions read it.
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
from basrelief.settings import setting

VECTORS: dict[type, tuple[type, int]] = {
    t: (t.component, t.size) for t in (Vec2, Vec3, Vec4, IVec2)
}
SCALARS: tuple[type, ...] = (float, int, bool)
_FIELDS = "__shader_fields__"
_STATIC_FIELDS = "__static_fields__"
_T = TypeVar("_T")


class ShaderError(BasreliefError):
    """Source outside the shader subset: file, line, what to write instead, and the source line."""


@dataclass_transform(frozen_default=True, field_specifiers=(setting,))
def struct(cls: type[_T]) -> type[_T]:
    """Class decorator: a frozen record with annotated fields, stored as float32, int32 and bool."""
    fields: dict[str, Any] = {}

    def coerce_fields(self: Any) -> None:
        for name, field_type in fields.items():
            object.__setattr__(self, name, coerce(getattr(self, name), field_type))

    setattr(cls, "__post_init__", coerce_fields)  # noqa: B010
    record: Any = dataclasses.dataclass(frozen=True)(cls)
    module = vars(sys.modules[cls.__module__])
    for field in dataclasses.fields(record):
        annotation = field.type
        fields[field.name] = eval(annotation, module) if isinstance(annotation, str) else annotation
    setattr(record, _FIELDS, fields)
    return record


class StaticField(NamedTuple):
    """Field that static conditions can read: its name in a program, its type (str, bool or int)
    and its possible values, () for any."""

    name: str
    kind: type
    choices: tuple[str | int, ...]


@dataclass_transform(frozen_default=True)
def static(cls: type[_T]) -> type[_T]:
    """Class decorator: a frozen record of static conditions.

    Fields are str, bool, int or a Literal of these. A shader that takes one as a parameter branches
    on its fields and properties. A program is made with a value of it, and contains only the
    branches that are taken.

    Raises
    ------
    ShaderError
        For a field of another type.
    """
    record: Any = dataclasses.dataclass(frozen=True)(cls)
    fields = {name: _static_field(name, t) for name, t in typing.get_type_hints(record).items()}
    for name, field in fields.items():
        if field is None:
            raise ShaderError(
                f"{cls.__module__}: {cls.__name__}.{name}: a field of a static record is a str, "
                "bool, int or Literal"
            )
    for name in dir(record):
        attribute = getattr(record, name)
        if isinstance(attribute, property):
            fields[name] = _static_field(name, typing.get_type_hints(attribute.fget).get("return"))
    setattr(record, _STATIC_FIELDS, {name: field for name, field in fields.items() if field})
    return record


def _static_field(name: str, t: Any) -> StaticField | None:
    """The static field of an annotation; None where conditions cannot read it."""
    if typing.get_origin(t) is Literal:
        choices = typing.get_args(t)
        kinds = {type(value) for value in choices}
        return StaticField(name, kinds.pop(), choices) if len(kinds) == 1 else None
    return StaticField(name, t, ()) if t in (str, bool, int) else None


def is_static(t: Any) -> bool:
    """Whether t was made by `@static`."""
    return isinstance(t, type) and _STATIC_FIELDS in vars(t)


def static_fields(t: type) -> dict[str, StaticField]:
    """Fields of a static record that conditions can read, and properties of the same types."""
    return vars(t)[_STATIC_FIELDS]


class TypeSlot:
    """Placeholder of a record type, decided when slots are bound; subclass it to name it.

    A slot may use it for one parameter; the shader bound to the slot decides the type.
    """


def is_type_slot(t: Any) -> bool:
    """Whether t is a placeholder of a type."""
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
    """Parts of a vector, matrix or record, by name: components, columns or fields."""
    if t in VECTORS:
        component, size = VECTORS[t]
        return dict.fromkeys("xyzw"[:size], component)
    return dict.fromkeys("xyz", Vec3) if t is Mat3 else fields_of(t)


def coerce(value: Any, t: Any) -> Any:
    """The value as float32, int32, bool or vector; any other must be of type t already."""
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
    """Name of a type in messages."""
    return getattr(t, "__name__", str(t))
