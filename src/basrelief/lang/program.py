"""A program: an entry shader, what its slots are bound to, and how its maps behave at their edges.

The entry's first parameter is the pixel, an `IVec2`; then come records (the uniforms) and resource
handles; its result is a record, one plane of the picture for each of its leaves.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, NamedTuple

from basrelief.lang import tree
from basrelief.lang.frontend import analyse, bound_types
from basrelief.lang.resources import (
    Edge,
    Filter,
    buffer_record,
    conditions_on,
    flattened,
    members_of,
)
from basrelief.lang.shader import Shader, code_text
from basrelief.lang.types import (
    SCALARS,
    ShaderError,
    fields_of,
    is_record,
    is_static,
    is_type_slot,
    leaves,
)
from basrelief.lang.values import IVec2


@dataclass(frozen=True)
class Program:
    """What an engine compiles and runs. Equal contents have equal `key`s."""

    entry: Shader[..., Any]
    bindings: Mapping[Shader[..., Any], Shader[..., Any]] = field(default_factory=dict)
    edge: Edge = "wrap"
    filter: Filter = "sharp"
    variant: Any = None
    """The value of the static record that the entry takes."""

    def __post_init__(self) -> None:
        given, result = self.entry.signature
        if next(iter(given.values()), None) is not IVec2 or not is_record(result):
            raise ShaderError(
                f"{self.entry.location}: the entry {self.entry.name} takes a pixel: IVec2 first "
                "and returns a record"
            )
        self._check_parameters()
        for name, t in given.items():
            if is_static(t) and not isinstance(self.variant, t):
                raise ShaderError(
                    f"{self.entry.location}: the entry {self.entry.name} takes {name}: "
                    f"{t.__name__}; give the program one as `variant`"
                )

    def _check_parameters(self) -> None:
        """Refuse what an engine could not tell apart: two lists of one record."""
        seen: set[Any] = set()
        for name, t in self.parameters.items():
            record = buffer_record(t)
            if record is not None and record in seen:
                raise ShaderError(
                    f"{self.entry.location}: {name}: there is a Buffer[{record.__name__}] already; "
                    "put what both hold into one"
                )
            seen.add(record)

    @functools.cached_property
    def module(self) -> tree.Module:
        """The typed tree; raises ShaderError where the source is outside the subset."""
        return analyse(self.entry, self.bindings, self.static_value)

    def static_value(self, name: str) -> Any:
        """What a static condition reads by name: of the program's maps, or of its variant."""
        match name:
            case "map.edge":
                return self.edge
            case "map.filter":
                return self.filter
        return getattr(self.variant, name)

    @functools.cached_property
    def parameters(self) -> dict[str, Any]:
        """The entry's parameters after the pixel that an engine is given values for, with type
        slots filled in."""
        types = bound_types(self.bindings)
        given = dict(list(self.entry.signature[0].items())[1:])
        return {name: types.get(t, t) for name, t in flattened(given).items()}

    @property
    def planes(self) -> list[tuple[str, type]]:
        """The leaves of the result: dotted name and type."""
        return list(leaves(self.entry.signature[1]))

    @functools.cached_property
    def key(self) -> str:
        """A digest of all that the program is made of: code, numbers, types, bindings, and of the
        variant what its shaders read."""
        same = (self.entry, *self.bindings.items(), self.edge, self.filter, self.variant)
        known = _keys.get(same)
        if known is None or any(each.find(name) is not value for each, name, value in known.names):
            contents = _Contents(self)
            contents.visit(self.entry)
            digest = hashlib.sha256()
            for part in contents.found:
                digest.update(len(part).to_bytes(8, "little"))
                digest.update(part)
            known = _Key(digest.hexdigest(), contents.names)
            if len(_keys) >= _MOST_KEYS:
                _keys.pop(next(iter(_keys)), None)
            _keys[same] = known
        return known.text


class _Key(NamedTuple):
    """A program's key, and what the names in its shaders stood for."""

    text: str
    names: list[tuple[Shader[..., Any], str, Any]]


_keys: dict[Any, _Key] = {}
"""Keys by what programs are made of: a picture asks for them each time that it is drawn."""
_MOST_KEYS = 256


class _Contents:
    """Walks the shaders, numbers and records that a program can reach, in a fixed order."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.seen: dict[Any, int] = {}
        self.found: list[bytes] = [program.edge.encode()]
        self.names: list[tuple[Shader[..., Any], str, Any]] = []

    def visit(self, obj: Any) -> None:
        if isinstance(obj, Shader) or is_record(obj) or members_of(obj):
            if obj in self.seen:
                self.found.append(f"the same as {self.seen[obj]}".encode())
                return
            self.seen[obj] = len(self.seen)
            if isinstance(obj, Shader):
                self.shader(obj)
            elif members_of(obj):
                for name, t in members_of(obj).items():
                    self.found.append(name.encode())
                    self.visit(t)
            else:
                self.record(obj)
        elif buffer_record(obj) is not None:
            self.visit(buffer_record(obj))
        elif is_type_slot(obj):
            self.found.append(obj.__name__.encode())
        elif type(obj) in SCALARS:
            self.found.append(repr(obj).encode())
        else:
            self.found.append(getattr(obj, "__name__", type(obj).__name__).encode())

    def shader(self, shader: Shader[..., Any]) -> None:
        parameters, result = shader.signature
        self.found.append(shader.name.encode())
        for name, t in [*parameters.items(), ("return", result)]:
            self.found.append(name.encode())
            self.visit(t)
        if shader.is_slot:
            bound = self.program.bindings.get(shader)
            if bound is None:
                raise ShaderError(f"{shader.location}: the slot {shader.name} is not bound")
            self.visit(bound)
            return
        code = shader.function.__code__
        for t in dict.fromkeys([*parameters.values(), *flattened(parameters).values()]):
            for attribute, static in conditions_on(t).items():
                # the field of another record may have the same name, and change the key in vain
                if attribute in code.co_names:
                    value = self.program.static_value(static.name)
                    self.found.append(f"{static.name} = {value!r}".encode())
        self.found.append(code_text(code).encode())
        for name in shader.names:
            # None where it is unknown, which the front end reports
            value = shader.find(name)
            self.names.append((shader, name, value))
            self.found.append(name.encode())
            self.visit(value)

    def record(self, record: type) -> None:
        self.found.append(record.__name__.encode())
        for f in fields(record):
            self.found.append(f.name.encode())
            self.visit(fields_of(record)[f.name])
            if f.default is not MISSING:
                self.found.append(repr(f.default).encode())
