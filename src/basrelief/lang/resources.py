"""Resource handles: the maps and lists that a program reads, as NumPy arrays.

Shaders read them through intrinsics (`corners`, `texel`, `size`, `levels`) and, for a `Buffer`,
through `len(buffer)` and `buffer[index]`. Engines take the arrays as they are. `@resources` makes
a record of handles, which shaders pass on as one.
"""

from __future__ import annotations

import copy
import dataclasses
import itertools
import typing
from collections.abc import Mapping, Sequence
from typing import (
    Any,
    Generic,
    Literal,
    TypeVar,
    assert_never,
    dataclass_transform,
    get_args,
)

import numpy as np
from numpy.typing import NDArray

from basrelief.lang.types import ShaderError, StaticField, from_leaves, is_static, static_fields

Edge = Literal["wrap", "clamp"]
Filter = Literal["sharp", "smooth", "mip", "columns"]
_T = TypeVar("_T")
_MEMBERS = "__members__"


class Map:
    """Levels of one map, the first the largest, each half of the one before, down to one texel.

    `edge` says what lies beyond the map; it is one for all maps of a program, so that shaders
    branch on it as on a static record's field: `if map.edge == "wrap"`. A shader's parameter of
    this type may be any map, and is there for that alone.

    Levels are kept in one array, `stored`, each with a border of one texel around it, filled as the
    edge says; `firsts` are the places of their texels (0, 0) in it. `levels` are views of it.
    """

    def __init__(self, levels: Sequence[NDArray[Any]], edge: Edge) -> None:
        if not levels:
            raise ValueError("a map has at least one level")
        if edge not in get_args(Edge):
            raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
        self.edge: Edge = edge
        height, width = levels[0].shape[:2]
        for k, level in enumerate(levels):
            if level.shape[:2] != (max(height >> k, 1), max(width >> k, 1)):
                raise ValueError(f"level {k} is {level.shape[:2]}; each is half of the one before")
        count = sum((level.shape[0] + 2) * (level.shape[1] + 2) for level in levels)
        self.stored = np.empty((count, *levels[0].shape[2:]), levels[0].dtype)
        self.firsts: list[int] = []
        self._end = 0
        self.levels = tuple(self._store(level) for level in levels)

    def _store(self, level: NDArray[Any]) -> NDArray[Any]:
        height, width = level.shape[:2]
        stride = width + 2
        start = self._end
        self._end += (height + 2) * stride
        self.firsts.append(start + stride + 1)
        block = self.stored[start : self._end].reshape(height + 2, stride, *level.shape[2:])
        block[1:-1, 1:-1] = level
        match self.edge:
            case "wrap":
                before, after = -2, 1
            case "clamp":
                before, after = 1, -2
            case _:
                assert_never(self.edge)
        block[0], block[-1] = block[before], block[after]
        block[:, 0], block[:, -1] = block[:, before], block[:, after]
        return block[1:-1, 1:-1]

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the first level, in texels."""
        height, width = self.levels[0].shape[:2]
        return height, width

    def texel_index(self, x: int, y: int, level: int) -> tuple[int, int, int]:
        """Level, row and column of the texel that a read lands on.

        A map has a border of one texel, filled as its edge says: coordinates are held to
        −1 … count, and −1 and count stand for the far side (wrap) or the near (clamp).
        """
        level = min(max(int(level), 0), len(self.levels) - 1)
        height, width = self.levels[level].shape[:2]
        return level, self._beside(int(y), height), self._beside(int(x), width)

    def _beside(self, index: int, count: int) -> int:
        held = min(max(index, -1), count)
        match self.edge:
            case "wrap":
                return held % count
            case "clamp":
                return min(max(held, 0), count - 1)
            case _:
                assert_never(self.edge)


class HeightField(Map):
    """Heights, 0 to 1, as float32: levels of shape (H, W).

    `filter` says how the shaders of `techniques.height` read them; static too. A program has its
    own, a field's is for shaders that run as plain Python.
    """

    def __init__(
        self, levels: Sequence[NDArray[Any]], edge: Edge = "wrap", filter: Filter = "sharp"
    ) -> None:
        super().__init__([np.asarray(level, np.float32) for level in levels], edge)
        self.filter: Filter = filter

    def with_filter(self, filter: Filter) -> HeightField:
        """The same heights, to be read in another way."""
        made = copy.copy(self)
        made.filter = filter
        return made


class Texture(Map):
    """Four channels as 16-bit fractions of one: levels of shape (H, W, 4), uint16."""

    def __init__(self, levels: Sequence[NDArray[Any]], edge: Edge = "wrap") -> None:
        if any(level.dtype != np.uint16 or level.shape[2:] != (4,) for level in levels):
            raise ValueError("a texture's levels are uint16 arrays of shape (H, W, 4)")
        super().__init__(levels, edge)


class Buffer(Generic[_T]):
    """A list of records of one type; a program has at most one buffer of each record type.

    An index that is outside it reads the last item; an empty one reads as zeros.
    """

    def __init__(self, items: Sequence[_T], record: type[_T] | None = None) -> None:
        if record is None:
            if not items:
                raise ValueError("an empty buffer must be told its record type")
            record = type(items[0])
        self.items = tuple(items)
        self.record: type[_T] = record

    def __len__(self) -> int:
        return len(self.items)

    def __getitem__(self, index: int) -> _T:
        last = len(self.items) - 1
        if last < 0:
            return from_leaves(itertools.repeat(0), self.record)
        return self.items[index if 0 <= index <= last else last]


HANDLES: tuple[type, ...] = (HeightField, Texture)
MAPS: tuple[type, ...] = (Map, *HANDLES)


_EDGE = {"edge": StaticField("map.edge", str, get_args(Edge))}
_STATIC_FIELDS: dict[Any, dict[str, StaticField]] = {
    Map: _EDGE,
    Texture: _EDGE,
    HeightField: {**_EDGE, "filter": StaticField("map.filter", str, get_args(Filter))},
}


def conditions_on(t: Any) -> Mapping[str, StaticField]:
    """What static conditions on a parameter of type t can read: of a map or a static record."""
    return static_fields(t) if is_static(t) else _STATIC_FIELDS.get(t, {})


def is_erased(t: Any) -> bool:
    """Whether a parameter of type t is for static conditions alone, and nothing in a program."""
    return t is Map or is_static(t)


def is_handle(t: Any) -> bool:
    """Whether t is a resource handle: a map, or `Buffer[Record]`."""
    return t in HANDLES or getattr(t, "__origin__", None) is Buffer


@dataclass_transform(frozen_default=True)
def resources(cls: type[_T]) -> type[_T]:
    """Make a group of resource handles: a shader takes it as one parameter and names its members,
    as `maps.normal`; a program has each member by itself, as `maps_normal`.

    Raises ShaderError for a field that is no handle.
    """
    made: Any = dataclasses.dataclass(frozen=True)(cls)
    members = typing.get_type_hints(made)
    for name, t in members.items():
        if not is_handle(t):
            raise ShaderError(
                f"{cls.__module__}: {cls.__name__}.{name}: a group of resources holds handles: "
                "HeightField, Texture or Buffer"
            )
    setattr(made, _MEMBERS, members)
    return made


def members_of(t: Any) -> Mapping[str, Any]:
    """The members of a group of resources, with their types; none of anything else."""
    return vars(t).get(_MEMBERS, {}) if isinstance(t, type) else {}


def flat_names(name: str, t: Any) -> dict[str, Any]:
    """A parameter as a program has it: each member of a group by itself, what is erased not."""
    if is_erased(t):
        return {}
    members = members_of(t)
    return {f"{name}_{each}": kind for each, kind in members.items()} or {name: t}


def flattened(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """All parameters of a shader as a program has them."""
    return {k: v for name, t in parameters.items() for k, v in flat_names(name, t).items()}


def buffer_record(t: Any) -> type | None:
    """The record type of a `Buffer[Record]` annotation, else None."""
    return t.__args__[0] if getattr(t, "__origin__", None) is Buffer else None
