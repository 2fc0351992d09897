"""The functions that every target provides, as plain Python, with the rule that types each call.

What Python computes here is the meaning; printers reproduce it. Componentwise functions take a
float or a float vector; further scalar arguments are spread over the components. `min` and `max`
return their first argument unless the second is strictly beyond it, as Python's own do, so a NaN
stays only where it came first.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from basrelief.lang.resources import Buffer, HeightField, Texture, is_handle
from basrelief.lang.types import VECTORS, type_name
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4

_V = TypeVar("_V", float, Vec2, Vec3, Vec4)
_f32: Any = np.float32
_i32: Any = np.int32
_N = TypeVar("_N", Vec2, Vec3, Vec4)


@dataclass(frozen=True)
class Intrinsic:
    """One function that targets provide: its name, meaning, and the type of a call's result."""

    name: str
    python: Callable[..., Any]
    rule: Callable[[tuple[Any, ...]], Any]


INTRINSICS: dict[str, Intrinsic] = {}
"""Every intrinsic by name, the built-ins `abs`, `min`, `max`, `float`, `int` and `len` included."""
BY_FUNCTION: dict[Any, Intrinsic] = {}
"""The same, found by the object that a shader's source names."""


def _intrinsic(rule: Callable[[tuple[Any, ...]], Any]) -> Callable[[_F], _F]:
    def register(function: _F) -> _F:
        made = Intrinsic(function.__name__, function, rule)
        INTRINSICS[made.name] = BY_FUNCTION[function] = made
        return function

    return register


_F = TypeVar("_F", bound=Callable[..., Any])


def _refuse(wanted: str, given: tuple[Any, ...]) -> TypeError:
    return TypeError(f"takes {wanted}, not ({', '.join(map(type_name, given))})")


def _fixed(result: Any, *wanted: Any) -> Callable[[tuple[Any, ...]], Any]:
    """Exactly these argument types."""

    def rule(given: tuple[Any, ...]) -> Any:
        if given != wanted:
            raise _refuse(f"({', '.join(map(type_name, wanted))})", given)
        return result

    return rule


def _componentwise(count: int) -> Callable[[tuple[Any, ...]], Any]:
    """A float or float vector; further arguments of the same type, or float."""

    def rule(given: tuple[Any, ...]) -> Any:
        first: Any = given[0] if given else None
        floats = first is float or (first in VECTORS and VECTORS[first][0] is float)
        if len(given) != count or not floats or any(t not in (first, float) for t in given[1:]):
            raise _refuse(f"{count} floats or float vectors", given)
        return first

    return rule


def _vectors(count: int, result: Any = None) -> Callable[[tuple[Any, ...]], Any]:
    """Float vectors of one size; the result is of that type unless told otherwise."""

    def rule(given: tuple[Any, ...]) -> Any:
        if (
            len(given) != count
            or len(set(given)) != 1
            or VECTORS.get(given[0], (None,))[0] is not float
        ):
            raise _refuse(f"{count} float vectors of one size", given)
        return result or given[0]

    return rule


def _map(function: Callable[..., Any], first: Any, *others: Any) -> Any:
    if isinstance(first, Vec2 | Vec3 | Vec4):
        return first.map(function, *others)
    return function(first, *others)


# --- scalars and components -----------------------------------------------------------------


def _min(a: Any, b: Any) -> Any:
    return b if b < a else a


def _max(a: Any, b: Any) -> Any:
    return b if b > a else a


def _saturating_int(x: Any) -> Any:
    """Towards zero; beyond the range the nearest end, NaN to 0."""
    if isinstance(x, bool | np.bool_ | int | np.integer):
        return np.int32(x)
    if x != x:
        return np.int32(0)
    return np.int32(min(max(np.trunc(np.float64(x)), -2147483648.0), 2147483647.0))


def _scalar_pair(given: tuple[Any, ...]) -> Any:
    if given in ((float, float), (int, int)):
        return given[0]
    raise _refuse("two floats or two ints (minimum and maximum take vectors)", given)


def _one_number(result: Any = None, *extra: Any) -> Callable[[tuple[Any, ...]], Any]:
    def rule(given: tuple[Any, ...]) -> Any:
        if len(given) != 1 or given[0] not in (float, int, *extra):
            raise _refuse("one number", given)
        return result or given[0]

    return rule


def _length_rule(given: tuple[Any, ...]) -> Any:
    if len(given) != 1 or getattr(given[0], "__origin__", None) is not Buffer:
        raise _refuse("a Buffer", given)
    return int


for _builtin, _python, _rule in (
    (abs, abs, _one_number()),
    (min, _min, _scalar_pair),
    (max, _max, _scalar_pair),
    (float, _f32, _one_number(float, bool)),
    (int, _saturating_int, _one_number(int, bool)),
    (len, lambda buffer: np.int32(len(buffer)), _length_rule),
):
    INTRINSICS[_builtin.__name__] = BY_FUNCTION[_builtin] = Intrinsic(
        _builtin.__name__, _python, _rule
    )


@_intrinsic(_componentwise(1))
def sqrt(x: _V) -> _V:
    """The square root, correctly rounded."""
    return _map(np.sqrt, x)


@_intrinsic(_componentwise(1))
def floor(x: _V) -> _V:
    """The largest whole number not above x."""
    return _map(np.floor, x)


@_intrinsic(_componentwise(1))
def fract(x: _V) -> _V:
    """x − floor(x)."""
    return _map(lambda c: c - np.floor(c), x)


@_intrinsic(_componentwise(2))
def minimum(a: _V, b: _V | float) -> _V:
    """The smaller, component by component."""
    return _map(_min, a, b)


@_intrinsic(_componentwise(2))
def maximum(a: _V, b: _V | float) -> _V:
    """The larger, component by component."""
    return _map(_max, a, b)


@_intrinsic(_componentwise(3))
def clamp(x: _V, low: _V | float, high: _V | float) -> _V:
    """min(max(x, low), high)."""
    return _map(lambda c, a, b: _min(_max(c, a), b), x, low, high)


@_intrinsic(_componentwise(1))
def saturate(x: _V) -> _V:
    """x held to 0 … 1."""
    return _map(lambda c: _min(_max(c, _f32(0)), _f32(1)), x)


@_intrinsic(_componentwise(3))
def mix(a: _V, b: _V | float, t: _V | float) -> _V:
    """a · (1 − t) + b · t: a at 0, b at 1, both exactly."""
    return _map(lambda p, q, s: p * (_f32(1) - s) + q * s, a, b, t)


@_intrinsic(_fixed(float, float, float, float))
def smoothstep(low: float, high: float, x: float) -> float:
    """0 below low, 1 above high, 3t² − 2t³ between."""
    t = saturate((x - low) / (high - low))
    return t * t * (_f32(3) - _f32(2) * t)


@_intrinsic(_fixed(float, float, float))
def copysign(x: float, sign: float) -> float:
    """|x| with the sign of the other, that of a zero included."""
    return np.copysign(_f32(x), _f32(sign))


# --- vectors ---------------------------------------------------------------------------------


@_intrinsic(_vectors(2, float))
def dot(a: _N, b: _N) -> float:
    """The sum of the products of the components, from the first on."""
    products = [p * q for p, q in zip(a, b, strict=True)]
    total = products[0]
    for product in products[1:]:
        total = total + product
    return total


@_intrinsic(_vectors(1, float))
def length(v: _N) -> float:
    """sqrt(v · v)."""
    return np.sqrt(dot(v, v))


@_intrinsic(_vectors(1))
def normalize(v: _N) -> _N:
    """v · (1 / length(v)); a zero vector gives NaN, so never pass one."""
    return v * (_f32(1) / length(v))


@_intrinsic(_fixed(Vec3, Vec3, Vec3))
def cross(a: Vec3, b: Vec3) -> Vec3:
    """The vector product, right-handed."""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@_intrinsic(_vectors(2))
def reflect(incident: _N, normal: _N) -> _N:
    """incident − normal · (2 · (incident · normal)); the normal is of unit length."""
    return incident - normal * (_f32(2) * dot(incident, normal))


@_intrinsic(_fixed(Mat3, Mat3))
def transpose(m: Mat3) -> Mat3:
    """Rows for columns; the inverse of a rotation."""
    x, y, z = m.x, m.y, m.z
    return Mat3(Vec3(x.x, y.x, z.x), Vec3(x.y, y.y, z.y), Vec3(x.z, y.z, z.z))


# --- bits --------------------------------------------------------------------------------------


@_intrinsic(_fixed(int, float))
def float_bits(x: float) -> int:
    """The 32 bits of a float as an int."""
    return _f32(x).view(np.int32)


@_intrinsic(_fixed(float, int))
def bits_float(bits: int) -> float:
    """The float whose 32 bits these are."""
    return _i32(bits).view(np.float32)


# --- functions computed by shaders of our own where a target has none --------------------------


_bodies: dict[str, Callable[..., Any]] = {}


def define(**bodies: Callable[..., Any]) -> None:
    """Give elementary functions their bodies: shaders, which are made of the intrinsics above."""
    _bodies.update(bodies)


def _elementary(name: str, arguments: int) -> Any:
    def call(*given: float) -> Any:
        return _bodies[name](*given)

    call.__name__ = name
    ELEMENTARY.append(name)
    return _intrinsic(_fixed(float, *(float,) * arguments))(call)


ELEMENTARY: list[str] = []
"""Intrinsics that Python and the CPU compute with the shaders of `elementary`."""

exp: Callable[[float], float] = _elementary("exp", 1)
exp2: Callable[[float], float] = _elementary("exp2", 1)
log: Callable[[float], float] = _elementary("log", 1)
log2: Callable[[float], float] = _elementary("log2", 1)
sin: Callable[[float], float] = _elementary("sin", 1)
cos: Callable[[float], float] = _elementary("cos", 1)
tan: Callable[[float], float] = _elementary("tan", 1)
asin: Callable[[float], float] = _elementary("asin", 1)
acos: Callable[[float], float] = _elementary("acos", 1)
atan: Callable[[float], float] = _elementary("atan", 1)
pow: Callable[[float, float], float] = _elementary("pow", 2)
atan2: Callable[[float, float], float] = _elementary("atan2", 2)


# --- resources -----------------------------------------------------------------------------------


def _map_and(*rest: Any, result: Any, kind: Any = None) -> Callable[[tuple[Any, ...]], Any]:
    def rule(given: tuple[Any, ...]) -> Any:
        wanted = type_name(kind) if kind else "HeightField or Texture"
        right = given and is_handle(given[0]) and given[1:] == rest
        if not right or (kind is not None and given[0] is not kind):
            raise _refuse(f"({', '.join([wanted, *map(type_name, rest)])})", given)
        return result

    return rule


@_intrinsic(_map_and(result=int))
def levels(map: HeightField | Texture) -> int:
    """How many levels the map has."""
    return _i32(len(map.levels))


@_intrinsic(_map_and(int, result=IVec2))
def size(map: HeightField | Texture, level: int) -> IVec2:
    """Width and height of a level in texels; the level is held to those there are."""
    height, width = map.levels[min(max(int(level), 0), len(map.levels) - 1)].shape[:2]
    return IVec2(width, height)


@_intrinsic(_map_and(IVec2, int, result=Vec4, kind=HeightField))
def corners(field: HeightField, cell: IVec2, level: int) -> Vec4:
    """Heights of four texels: (x, y), (x+1, y), (x, y+1), (x+1, y+1).

    The cell is held to −1 … count − 1, so that all four lie within the map and its border of one
    texel, which repeats the far side (edge "wrap") or the near (edge "clamp"). Take texture
    coordinates into the tile first: of cells further out a GPU makes what its sampler does.
    """
    level = min(max(int(level), 0), len(field.levels) - 1)
    height, width = field.levels[level].shape
    x, y = (min(max(int(c), -1), n - 1) for c, n in ((cell.x, width), (cell.y, height)))
    found = []
    for beside in ((x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)):
        k, row, column = field.texel_index(*beside, level)
        found.append(field.levels[k][row, column])
    return Vec4(*found)


@_intrinsic(_map_and(IVec2, int, result=Vec4, kind=Texture))
def texel(texture: Texture, cell: IVec2, level: int) -> Vec4:
    """The four channels of one texel in 65535ths; held to the map and its border of one texel.

    Not divided, so that a filter divides once and not for each texel that it reads.
    """
    k, row, column = texture.texel_index(cell.x, cell.y, level)
    return Vec4(*texture.levels[k][row, column])


@_intrinsic(_map_and(IVec2, result=Vec4, kind=Texture))
def stored(texture: Texture, cell: IVec2) -> Vec4:
    """Four numbers, 0 to 65535, of what is baked: a texel of the first level, with no edge.

    For tables, where each read counts: the cell must be one there is. Of one that is not, an engine
    may make what it likes.
    """
    _, row, column = texture.texel_index(cell.x, cell.y, 0)
    return Vec4(*texture.levels[0][row, column])
