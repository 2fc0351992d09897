"""Settings, each declared once: a field of a record, with its range and its meaning.

A field has a type and a default, `setting` adds the range, and the docstring of the record says
what it means. Checks, command line, presets, notebook, the controls of the viewer and the table in
the documentation are made from `settings_of`. The command line's help imports this module, so it
imports little.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import sys
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Literal, get_args, get_origin

from basrelief.errors import InputError
from basrelief.settings.kinds import SYNONYMS

Kind = Literal["choice", "text", "flag", "integer", "number", "pair", "triple", "numbers", "other"]
_KINDS: dict[str, Kind] = {
    "str": "text",
    "bool": "flag",
    "int": "integer",
    "float": "number",
    "tuple[float, float]": "pair",
    "tuple[float, float, float]": "triple",
    "Vec3": "triple",
}
"""Kinds of settings by their annotation; a `Literal` is a choice."""


@dataclasses.dataclass(frozen=True)
class Setting:
    """The declaration of a setting.

    Attributes
    ----------
    name : str
        Name of the field.
    kind : str
        Kind of its values; "numbers" is a record of numbers, set by a mapping.
    default : object
        Default value; None where it is computed, and where a value is required.
    doc : str
        Meaning, a phrase without a full stop.
    details : str
        The sentences of the docstring after the first, such as how a default is computed.
    in_tiles : bool
        Whether it is a length in tile widths, for which a preset may have another unit.
    low, high : float or None
        The inclusive range of its numbers; None leaves that side open.
    choices : tuple
        The values of a choice.
    optional : bool
        Whether None is allowed.
    required : bool
        Whether a value has to be given.
    control : mapping
        The viewer's slider where it differs from the range: `low`, `high`, `step`.
    spelling : str
        Example of its values on the command line, such as "U,V".
    group : str
        Section of the help, the panel and the documentation.
    """

    name: str
    kind: Kind
    default: Any
    doc: str
    low: float | None = None
    high: float | None = None
    choices: tuple[Any, ...] = ()
    optional: bool = False
    required: bool = False
    control: Mapping[str, float] = dataclasses.field(default_factory=dict)
    spelling: str = ""
    group: str = ""
    details: str = ""
    in_tiles: bool = False

    @property
    def option(self) -> str:
        """The option's name on the command line."""
        return f"--{self.name.replace('_', '-')}"

    @property
    def default_text(self) -> str:
        """The default as the command line writes it; "" where there is none."""
        default = self.default
        if default is None or self.kind in ("numbers", "other"):
            return ""
        if isinstance(default, bool | str):
            return str(default).lower()
        # of a pair, a triple or a vector
        numbers = [default] if isinstance(default, int | float) else [*default]
        return "/".join(f"{number:g}" for number in numbers)

    @property
    def range_text(self) -> str:
        """The range in words, such as "0 to 10" or "from 0"; "" where it is open."""
        low, high = (
            None if end is None else f"{end:.10g}".replace("-", "−", end < 0.0)
            for end in (self.low, self.high)
        )
        if low is None or high is None:
            return f"from {low}" if low else f"up to {high}" if high else ""
        return f"{low} to {high}"


def setting(
    *,
    default: Any = dataclasses.MISSING,
    factory: Any = dataclasses.MISSING,
    doc: str = "",
    low: float | None = None,
    high: float | None = None,
    kind: Kind | None = None,
    control: Mapping[str, float] | None = None,
    spelling: str = "",
    group: str = "",
    in_tiles: bool = False,
) -> Any:
    """Field of a record that users set: default, range and description.

    Parameters
    ----------
    default, factory
        The default value, or a function that returns it.
    doc
        One line for help texts; by default the first sentence about the field in the docstring of
        the record.
    low, high
        The inclusive range; None leaves that side open. It is checked when a user's values are
        read, not when a shader builds a record.
    kind, control, spelling, group, in_tiles
        As for `Setting`; the kind is that of the annotation by default.
    """
    metadata = {
        "doc": doc, "low": low, "high": high, "kind": kind, "control": control or {},
        "spelling": spelling, "group": group, "in_tiles": in_tiles,
    }  # fmt: skip
    if factory is not dataclasses.MISSING:
        return dataclasses.field(default_factory=factory, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def settings_of(record: Any) -> Mapping[str, Setting]:
    """The settings of a record by name: its fields that `setting` declares, in order."""
    return _settings_of(record)


# separate, because type checkers refuse `type[Any]` as an argument of a cached function
@functools.cache
def _settings_of(record: Any) -> Mapping[str, Setting]:
    meanings = _meanings(record)
    return {
        field.name: _setting(record, field, *meanings.get(field.name, ("", "")))
        for field in dataclasses.fields(record)
        if "doc" in field.metadata
    }


def _setting(record: Any, field: dataclasses.Field[Any], meaning: str, details: str) -> Setting:
    annotation = field.type if isinstance(field.type, str) else field.type.__name__
    value_type = annotation.removesuffix(" | None")
    literal = vars(sys.modules[record.__module__]).get(value_type)
    choices = get_args(literal) if get_origin(literal) is Literal else ()
    declared = {name: value for name, value in field.metadata.items() if value is not None}
    # other factories need modules that this one must not import
    default = {} if field.default_factory is dict else field.default
    required = default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
    if default is dataclasses.MISSING:
        default = None
    return Setting(
        **{
            "kind": "choice" if choices else _KINDS.get(value_type, "other"),
            **declared,
            "name": field.name,
            "default": default,
            "doc": field.metadata["doc"] or meaning,
            "details": "" if field.metadata["doc"] else details,
            "choices": choices,
            "optional": value_type != annotation,
            "required": required,
        }
    )


def check_choices(record: Any) -> None:
    """Raise InputError unless each choice of a record is one of its values."""
    for name, declared in settings_of(type(record)).items():
        if declared.choices:
            check_choice(name, getattr(record, name), declared.choices)


def check_choice(what: str, value: Any, allowed: Sequence[Any]) -> None:
    """Raise InputError unless the value is allowed; the message suggests the one that is meant."""
    if value not in allowed:
        names = [str(a) for a in allowed if a is not None]
        meant = meant_choice(value, names)
        hint = f"; did you mean {meant}?" if meant else ""
        raise InputError(f"{what} is one of {', '.join(names)}, not {value!r}{hint}")


def meant_choice(value: Any, allowed: Sequence[str]) -> str | None:
    """The allowed value that a misspelling or a word of another program means, if any."""
    name = str(value).strip().lower().replace("-", "_").replace(" ", "_")
    if SYNONYMS.get(name) in allowed:
        return SYNONYMS[name]
    return next(iter(get_close_matches(name, allowed, 1, 0.75)), None)


@functools.cache
def parameters_of(function: Any) -> Mapping[str, Setting]:
    """The parameters of a function as settings by name.

    A parameter declares its range by an `Annotated` type, whose metadata are fields of `Setting`.
    """
    meanings = _meanings(function)
    result = {}
    for name, parameter in inspect.signature(function).parameters.items():
        annotation = vars(sys.modules[function.__module__]).get(parameter.annotation)
        declared: dict[str, Any] = getattr(annotation, "__metadata__", ({},))[0]
        kind = declared.get("kind") or _KINDS.get(str(parameter.annotation), "number")
        required = parameter.default is parameter.empty
        default = None if required else parameter.default
        doc, details = meanings.get(name, ("", ""))
        result[name] = Setting(
            **{**declared, "name": name, "kind": kind, "default": default, "required": required,
               "doc": doc, "details": details}
        )  # fmt: skip
    return result


def _meanings(record: Any) -> dict[str, tuple[str, str]]:
    """The first sentence about each field in the docstring of a record, and the others.

    The first is without its full stop.
    """
    doc = inspect.cleandoc(record.__doc__ or "")
    entries = re.findall(r"^(\w[\w, ]*) : .*\n((?:(?:    .*)?\n?)+)", doc, re.MULTILINE)
    meanings = {}
    for names, text in entries:
        first, *others = re.split(r"\.(?:\s|$)", " ".join(text.split()), maxsplit=1)
        meanings.update(dict.fromkeys(names.split(", "), (first, "".join(others))))
    return meanings
