"""Resource handles: the maps and buffers that a program reads, as NumPy arrays.

Shaders read them by intrinsics (`corners`, `sampled`, `texel`, `size`, `levels`), and a `Buffer` by
`len(buffer)` and `buffer[index]`. Engines use the arrays without conversion. `@resources` makes a
group of handles, which shaders pass on as one.
"""

from __future__ import annotations

import copy
import dataclasses
import itertools
import typing
from collections.abc import Callable, Mapping, Sequence
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
Sampling = Literal["texel", "hardware"]
_T = TypeVar("_T")
_MEMBERS = "__members__"


class Map:
    """Map with mip levels: the largest first, each half the size of the one before, down to 1 × 1.

    `edge` says how the map continues beyond its edges. It is the same for all maps of a program, so
    shaders branch on it as on a static field: `if map.edge == "wrap"`. A shader parameter of this
    type accepts any map, and is for such conditions only.

    All levels are in one array, `storage`, each with a border of one texel that is filled according
    to the edge; `offsets` are the indices of their texels (0, 0) in it. `levels` are views of it.
    """

    def __init__(self, levels: Sequence[NDArray[Any]], edge: Edge) -> None:
        if not levels:
            raise ValueError("a map needs at least one level")
        if edge not in get_args(Edge):
            raise ValueError(f"edge is {edge!r}: use {' or '.join(get_args(Edge))}")
        self.edge: Edge = edge
        height, width = levels[0].shape[:2]
        for k, level in enumerate(levels):
            if level.shape[:2] != (max(height >> k, 1), max(width >> k, 1)):
                raise ValueError(
                    f"level {k} is {level.shape[:2]}; it must be half of the level before"
                )
        self._allocate([level.shape for level in levels], levels[0].dtype)
        for number, level in enumerate(levels):
            self.levels[number][:] = level
            self._fill_border(number)

    def _allocate(self, shapes: Sequence[tuple[int, ...]], dtype: Any) -> None:
        """Make the storage of levels of these shapes, which stay to be filled."""
        sizes = [(height + 2) * (width + 2) for height, width, *_ in shapes]
        ends = list(itertools.accumulate(sizes))
        self.storage = np.empty((ends[-1], *shapes[0][2:]), dtype)
        self.offsets = [
            end - size + shape[1] + 3 for end, size, shape in zip(ends, sizes, shapes, strict=True)
        ]
        self._blocks = [
            self.storage[end - size : end].reshape(shape[0] + 2, shape[1] + 2, *shape[2:])
            for end, size, shape in zip(ends, sizes, shapes, strict=True)
        ]
        self.levels = tuple(block[1:-1, 1:-1] for block in self._blocks)

    def _fill_border(self, number: int) -> None:
        """Fill the border of a level from its texels."""
        match self.edge:
            case "wrap":
                before, after = -2, 1
            case "clamp":
                before, after = 1, -2
            case _:
                assert_never(self.edge)
        block = self._blocks[number]
        block[0], block[-1] = block[before], block[after]
        block[:, 0], block[:, -1] = block[:, before], block[:, after]

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of level 0, in texels."""
        height, width = self.levels[0].shape[:2]
        return height, width

    def texel_index(self, x: int, y: int, level: int) -> tuple[int, int, int]:
        """Level, row and column of the texel that a read returns.

        A map has a border of one texel: coordinates are clamped to −1 … count, where −1 and count
        are the texels of the opposite side (wrap) or of the same side (clamp).
        """
        level = min(max(int(level), 0), len(self.levels) - 1)
        height, width = self.levels[level].shape[:2]
        return level, self._border_index(int(y), height), self._border_index(int(x), width)

    def _border_index(self, index: int, count: int) -> int:
        clamped = min(max(index, -1), count)
        match self.edge:
            case "wrap":
                return clamped % count
            case "clamp":
                return min(max(clamped, 0), count - 1)
            case _:
                assert_never(self.edge)


class HeightField(Map):
    """Heights, 0 to 1, as float32: levels of shape (H, W).

    `filter` says which levels the shaders of `techniques.height` read, and `sampling` whether they
    interpolate texels themselves ("texel") or by `sampled` ("hardware"). Both are static too. A
    compiled program has its own; the field's are for shaders that run as plain Python.
    """

    def __init__(
        self,
        levels: Sequence[NDArray[Any]],
        edge: Edge = "wrap",
        filter: Filter = "sharp",
        sampling: Sampling = "texel",
    ) -> None:
        super().__init__([np.asarray(level, np.float32) for level in levels], edge)
        self.filter: Filter = filter
        self.sampling: Sampling = sampling

    def with_filter(self, filter: Filter) -> HeightField:
        """The same heights with another filter."""
        field = copy.copy(self)
        field.filter = filter
        return field


class Texture(Map):
    """Four channels as 16-bit fractions of one: levels of shape (H, W, 4), uint16."""

    def __init__(self, levels: Sequence[NDArray[Any]], edge: Edge = "wrap") -> None:
        if any(level.dtype != np.uint16 or level.shape[2:] != (4,) for level in levels):
            raise ValueError("a texture's levels are uint16 arrays of shape (H, W, 4)")
        super().__init__(levels, edge)

    @classmethod
    def with_mips(
        cls,
        shape: tuple[int, int],
        edge: Edge,
        fill: Callable[[NDArray[Any]], object],
        halved: Callable[[NDArray[Any]], NDArray[Any]],
    ) -> Texture:
        """A texture with all levels down to 1 × 1: `fill` writes the first in place, and `halved`
        makes each of the one before. None is in memory twice."""
        texture = cls.__new__(cls)
        texture.edge = edge
        height, width = shape
        count = max(shape).bit_length()
        shapes = [(max(height >> k, 1), max(width >> k, 1), 4) for k in range(count)]
        texture._allocate(shapes, np.uint16)
        fill(texture.levels[0])
        texture._fill_border(0)
        for number in range(1, count):
            texture.levels[number][:] = halved(texture.levels[number - 1])
            texture._fill_border(number)
        return texture


class Buffer(Generic[_T]):
    """List of records of one type; a program has at most one buffer for each record type.

    An index outside it reads the last item; an empty buffer reads zeros.
    """

    def __init__(self, items: Sequence[_T], record: type[_T] | None = None) -> None:
        if record is None:
            if not items:
                raise ValueError("an empty buffer needs the argument record")
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
    HeightField: {
        **_EDGE,
        "filter": StaticField("map.filter", str, get_args(Filter)),
        "sampling": StaticField("map.sampling", str, get_args(Sampling)),
    },
}


def condition_fields(t: Any) -> Mapping[str, StaticField]:
    """Fields of a map or static record of type t that static conditions can read, by name."""
    return static_fields(t) if is_static(t) else _STATIC_FIELDS.get(t, {})


def is_erased(t: Any) -> bool:
    """Whether a parameter of type t is for static conditions only, and absent from a program."""
    return t is Map or is_static(t)


def is_handle(t: Any) -> bool:
    """Whether t is a resource handle: a map, or `Buffer[Record]`."""
    return t in HANDLES or getattr(t, "__origin__", None) is Buffer


@dataclass_transform(frozen_default=True)
def resources(cls: type[_T]) -> type[_T]:
    """Class decorator: a group of resource handles.

    A shader takes the group as one parameter and names its members, as in `maps.normal`. In a
    program each member is a parameter of its own, as `maps_normal`.

    Raises
    ------
    ShaderError
        For a field that is not a handle.
    """
    group: Any = dataclasses.dataclass(frozen=True)(cls)
    members = typing.get_type_hints(group)
    for name, t in members.items():
        if not is_handle(t):
            raise ShaderError(
                f"{cls.__module__}: {cls.__name__}.{name}: a group of resources holds handles: "
                "HeightField, Texture or Buffer"
            )
    setattr(group, _MEMBERS, members)
    return group


def members_of(t: Any) -> Mapping[str, Any]:
    """Members of a group of resources by name, with their types; empty for other types."""
    return vars(t).get(_MEMBERS, {}) if isinstance(t, type) else {}


def flatten_parameter(name: str, t: Any) -> dict[str, Any]:
    """Parameters of a program for one of a shader: the members of a group, none if it is erased."""
    if is_erased(t):
        return {}
    members = members_of(t)
    return {f"{name}_{member}": kind for member, kind in members.items()} or {name: t}


def flatten_parameters(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters of a program for all parameters of a shader."""
    return {k: v for name, t in parameters.items() for k, v in flatten_parameter(name, t).items()}


def buffer_record(t: Any) -> type | None:
    """Record type of a `Buffer[Record]` annotation, None for other types."""
    return t.__args__[0] if getattr(t, "__origin__", None) is Buffer else None
