"""A program: an entry shader, the bindings of its slots, and its static values.

The first parameter of the entry is the pixel, an `IVec2`; the others are records (the uniforms) and
resource handles. The result is a record, with one plane of the picture for each scalar of it. A
parameter whose type is that of the result is what the planes hold at the pixel before.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

from basrelief.lang.intrinsics import intrinsic_of
from basrelief.lang.resources import (
    Edge,
    Filter,
    Sampling,
    buffer_record,
    condition_fields,
    flatten_parameters,
    members_of,
)
from basrelief.lang.shader import Shader, canonical_code
from basrelief.lang.slots import bound_types
from basrelief.lang.types import (
    SCALARS,
    fields_of,
    is_record,
    is_static,
    is_type_slot,
    leaves,
)
from basrelief.lang.values import IVec2

if TYPE_CHECKING:
    from basrelief.lang import tree


@dataclass(frozen=True)
class Program:
    """Unit that an engine compiles and runs; programs with equal contents have equal `key`s.

    Attributes
    ----------
    entry
        The shader that runs for each pixel.
    bindings
        The shader bound to each slot.
    edge, filter
        The edge of all maps and the filter of all height fields.
    variant
        The value of the static record that the entry takes, None if it takes none.
    sampling
        Whether height fields are interpolated in shaders ("texel") or by the filter of the GPU
        ("hardware").
    """

    entry: Shader[..., Any]
    bindings: Mapping[Shader[..., Any], Shader[..., Any]] = field(default_factory=dict)
    edge: Edge = "wrap"
    filter: Filter = "sharp"
    variant: Any = None
    sampling: Sampling = "texel"

    def __post_init__(self) -> None:
        parameters, result = self.entry.signature
        if next(iter(parameters.values()), None) is not IVec2 or not is_record(result):
            raise self.entry.error(
                f"the entry {self.entry.name} must take a pixel: IVec2 first and return a record"
            )
        self._check_parameters()
        for name, t in parameters.items():
            if is_static(t) and not isinstance(self.variant, t):
                raise self.entry.error(
                    f"the entry {self.entry.name} takes {name}: {t.__name__}; pass one to Program "
                    "as `variant`",
                    name,
                )

    def _check_parameters(self) -> None:
        """Raise ShaderError for two buffers of one record type."""
        seen: set[Any] = set()
        for name, t in self.parameters.items():
            record = buffer_record(t)
            if record is not None and record in seen:
                raise self.entry.error(
                    f"there is already a Buffer[{record.__name__}]; merge the two", name
                )
            seen.add(record)

    @functools.cached_property
    def module(self) -> tree.Module:
        """The specialized typed tree. Raises ShaderError for source outside the subset."""
        # a program that is in the cache does without
        from basrelief.lang.frontend import analyse

        return analyse(self.entry, self.bindings, self.static_value)

    def static_value(self, name: str) -> Any:
        """Value of a static field by its name, of the program's maps or of its variant."""
        match name:
            case "map.edge":
                return self.edge
            case "map.filter":
                return self.filter
            case "map.sampling":
                return self.sampling
        return getattr(self.variant, name)

    @functools.cached_property
    def parameters(self) -> dict[str, Any]:
        """Parameters of the entry after the pixel, for which an engine takes values; type slots are
        replaced by their records."""
        types = bound_types(self.bindings)
        parameters, result = self.entry.signature
        passed = {name: t for name, t in list(parameters.items())[1:] if t is not result}
        return {name: types.get(t, t) for name, t in flatten_parameters(passed).items()}

    @property
    def planes(self) -> list[tuple[str, type]]:
        """Planes of the picture, one for each scalar of the result: dotted name and type."""
        return list(leaves(self.entry.signature[1]))

    @functools.cached_property
    def key(self) -> str:
        """Digest of the program: code, numbers, types, bindings, and the fields of the variant that
        its shaders read."""
        identity = (
            self.entry, *self.bindings.items(), self.edge, self.filter, self.sampling, self.variant,
        )  # fmt: skip
        cached = _keys.get(identity)
        if cached is None or not cached.is_current():
            contents = _Contents(self)
            contents.visit(self.entry)
            digest = hashlib.sha256()
            for part in contents.parts:
                digest.update(len(part).to_bytes(8, "little"))
                digest.update(part)
            cached = _Key.of(digest.hexdigest(), contents.names)
            if len(_keys) >= _MAX_KEYS:
                _keys.pop(next(iter(_keys)), None)
            _keys[identity] = cached
        return cached.text


class _Key(NamedTuple):
    """Key of a program, and the values that the names in its shaders had: global ones, by the
    dictionary of their module, and others."""

    text: str
    global_names: list[tuple[dict[str, Any], str, Any]]
    other_names: list[tuple[Shader[..., Any], str, Any]]

    @classmethod
    def of(cls, text: str, names: list[tuple[Shader[..., Any], str, Any]]) -> _Key:
        """The key with names by their shaders, sorted so that they are checked fast."""
        global_names, other_names = [], []
        for shader, name, value in names:
            scope, enclosing = shader.function.__globals__, shader.function.__code__.co_freevars
            if name in scope and name not in enclosing:
                global_names.append((scope, name, value))
            else:
                other_names.append((shader, name, value))
        return cls(text, global_names, other_names)

    def is_current(self) -> bool:
        """Whether all names still have these values."""
        return all(scope.get(name) is value for scope, name, value in self.global_names) and all(
            shader.find(name) is value for shader, name, value in self.other_names
        )


_keys: dict[Any, _Key] = {}
"""Keys by the contents of programs, cached because every picture reads them again."""
_MAX_KEYS = 256


class _Contents:
    """Visits the shaders, numbers and records that a program can reach, in a fixed order."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.seen: dict[Any, int] = {}
        self.parts: list[bytes] = [program.edge.encode()]
        self.names: list[tuple[Shader[..., Any], str, Any]] = []

    def visit(self, obj: Any) -> None:
        if intrinsic_of(obj) is not None:
            self.parts.append(obj.__name__.encode())
        elif isinstance(obj, Shader) or is_record(obj) or members_of(obj):
            if obj in self.seen:
                self.parts.append(f"the same as {self.seen[obj]}".encode())
                return
            self.seen[obj] = len(self.seen)
            if isinstance(obj, Shader):
                self.shader(obj)
            elif members_of(obj):
                for name, t in members_of(obj).items():
                    self.parts.append(name.encode())
                    self.visit(t)
            else:
                self.record(obj)
        elif buffer_record(obj) is not None:
            self.visit(buffer_record(obj))
        elif is_type_slot(obj):
            self.parts.append(obj.__name__.encode())
        elif type(obj) in SCALARS:
            self.parts.append(repr(obj).encode())
        else:
            self.parts.append(getattr(obj, "__name__", type(obj).__name__).encode())

    def shader(self, shader: Shader[..., Any]) -> None:
        parameters, result = shader.signature
        self.parts.append(shader.name.encode())
        for name, t in [*parameters.items(), ("return", result)]:
            self.parts.append(name.encode())
            self.visit(t)
        if shader.is_slot:
            bound = self.program.bindings.get(shader)
            if bound is None:
                raise shader.error(f"the slot {shader.name} is not bound; pass a shader for it")
            self.visit(bound)
            return
        code = shader.function.__code__
        for t in dict.fromkeys([*parameters.values(), *flatten_parameters(parameters).values()]):
            for attribute, static in condition_fields(t).items():
                # a field of another record with this name changes the key needlessly, no more
                if attribute in code.co_names:
                    value = self.program.static_value(static.name)
                    self.parts.append(f"{static.name} = {value!r}".encode())
        self.parts.append(canonical_code(code).encode())
        for name in shader.names:
            # None for an unknown name, which the front end reports
            value = shader.find(name)
            self.names.append((shader, name, value))
            self.parts.append(name.encode())
            self.visit(value)

    def record(self, record: type) -> None:
        self.parts.append(record.__name__.encode())
        for f in fields(record):
            self.parts.append(f.name.encode())
            self.visit(fields_of(record)[f.name])
            if f.default is not MISSING:
                self.parts.append(repr(f.default).encode())
