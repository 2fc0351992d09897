"""The table of intrinsics, the built-in functions of the subset.

An entry is a function in plain Python, which defines the result, with its typing rule and its
spelling in each target. `elementary.py` and `helpers.py` add entries: functions that are shaders
themselves, and what targets have that the subset has not. Componentwise functions take a float
or a float vector; further scalar arguments are broadcast. `min` and `max` return their first
argument unless the second is strictly smaller or larger, as in Python, so that a NaN is returned
only if it came first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
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


Rule = Callable[[tuple[Any, ...]], Any]
"""Type of a call's result by those of its arguments. Raises TypeError for others."""


class Written(str):
    """Name of a shader in `elementary.py` or `helpers.py` that a target calls for an intrinsic."""


class Text(str):
    """Text of a call, with the arguments at `{0}`, `{1}` …"""


@dataclass(frozen=True)
class Intrinsic:
    """Built-in function: its name, its definition in Python, and the type of a call's result.

    `spelling` is by target, and the name itself where it is missing: the name of a function of the
    language, a `Text`, or the name of a function that is `Written`. For "llvm" it is that of an
    LLVM intrinsic that is applied to each component; `llvm.py` has a function for each of the rest.
    """

    name: str
    python: Callable[..., Any]
    rule: Rule
    spelling: Mapping[str, str]


INTRINSICS: dict[str, Intrinsic] = {}
"""Intrinsics by name, among them Python's `abs`, `min`, `max`, `float`, `int` and `len`."""
BY_FUNCTION: dict[Any, Intrinsic] = {}
"""Intrinsics by the function object that a shader names."""


def intrinsic(rule: Rule, **spelling: str) -> Callable[[_F], _F]:
    """Decorator that enters a function in the table, with its typing rule and its spelling."""

    def register(function: _F) -> _F:
        entry = Intrinsic(function.__name__, function, rule, spelling)
        INTRINSICS[entry.name] = BY_FUNCTION[function] = entry
        return function

    return register


def intrinsic_of(target: Any) -> Intrinsic | None:
    """The intrinsic that an object of a shader's globals is; None for others."""
    try:
        return BY_FUNCTION.get(target)
    except TypeError:
        return None  # it cannot be hashed


_F = TypeVar("_F", bound=Callable[..., Any])


def _refuse(expected: str, types: tuple[Any, ...]) -> TypeError:
    return TypeError(f"takes {expected}, not ({', '.join(map(type_name, types))})")


def fixed(result: Any, *expected: Any) -> Rule:
    """Rule for exactly these argument types."""

    def rule(types: tuple[Any, ...]) -> Any:
        if types != expected:
            raise _refuse(f"({', '.join(map(type_name, expected))})", types)
        return result

    return rule


@dataclass(frozen=True)
class Componentwise:
    """Rule for a float or float vector, and further arguments of the same type or float.

    Shading languages want all arguments to have one type, except the `scalars` last ones.
    """

    count: int
    scalars: int = 0

    def __call__(self, types: tuple[Any, ...]) -> Any:
        first: Any = types[0] if types else None
        floats = first is float or (first in VECTORS and VECTORS[first][0] is float)
        others = any(t not in (first, float) for t in types[1:])
        if len(types) != self.count or not floats or others:
            raise _refuse(f"{self.count} floats or float vectors", types)
        return first


def _vectors(count: int, result: Any = None) -> Rule:
    """Rule for float vectors of one size, with a result of the same type or of type `result`."""

    def rule(types: tuple[Any, ...]) -> Any:
        if (
            len(types) != count
            or len(set(types)) != 1
            or VECTORS.get(types[0], (None,))[0] is not float
        ):
            raise _refuse(f"{count} float vectors of one size", types)
        return result or types[0]

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
    """Conversion to int32: truncated and clamped to the range; NaN becomes 0."""
    if isinstance(x, bool | np.bool_ | int | np.integer):
        return np.int32(x)
    if x != x:
        return np.int32(0)
    return np.int32(min(max(np.trunc(np.float64(x)), -2147483648.0), 2147483647.0))


def _scalar_pair_rule(types: tuple[Any, ...]) -> Any:
    if types in ((float, float), (int, int)):
        return types[0]
    raise _refuse("two floats or two ints (minimum and maximum take vectors)", types)


def _number_rule(result: Any = None, *extra: Any) -> Rule:
    def rule(types: tuple[Any, ...]) -> Any:
        if len(types) != 1 or types[0] not in (float, int, *extra):
            raise _refuse("one number", types)
        return result or types[0]

    return rule


def _length_rule(types: tuple[Any, ...]) -> Any:
    if len(types) != 1 or getattr(types[0], "__origin__", None) is not Buffer:
        raise _refuse("a Buffer", types)
    return int


for _builtin, _python, _rule, _spelling in (
    (abs, abs, _number_rule(), {}),
    (min, _min, _scalar_pair_rule, {}),
    (max, _max, _scalar_pair_rule, {}),
    (float, _f32, _number_rule(float, bool), {"wgsl": "f32"}),
    (int, _saturating_int, _number_rule(int, bool), {"wgsl": "i32"}),
    (len, lambda buffer: np.int32(len(buffer)), _length_rule, {}),
):
    INTRINSICS[_builtin.__name__] = BY_FUNCTION[_builtin] = Intrinsic(
        _builtin.__name__, _python, _rule, _spelling
    )


@intrinsic(Componentwise(1), llvm="llvm.sqrt")
def sqrt(x: _V) -> _V:
    """Square root, correctly rounded."""
    return _map(np.sqrt, x)


@intrinsic(Componentwise(1), llvm="llvm.floor")
def floor(x: _V) -> _V:
    """Largest integer not above x."""
    return _map(np.floor, x)


@intrinsic(Componentwise(1))
def fract(x: _V) -> _V:
    """x − floor(x)."""
    return _map(lambda c: c - np.floor(c), x)


@intrinsic(Componentwise(2), wgsl="min", glsl="min")
def minimum(a: _V, b: _V | float) -> _V:
    """Minimum, component by component."""
    return _map(_min, a, b)


@intrinsic(Componentwise(2), wgsl="max", glsl="max")
def maximum(a: _V, b: _V | float) -> _V:
    """Maximum, component by component."""
    return _map(_max, a, b)


@intrinsic(Componentwise(3))
def clamp(x: _V, low: _V | float, high: _V | float) -> _V:
    """min(max(x, low), high)."""
    return _map(lambda c, a, b: _min(_max(c, a), b), x, low, high)


@intrinsic(Componentwise(1), glsl=Text("clamp({0}, 0.0, 1.0)"))
def saturate(x: _V) -> _V:
    """x clamped to 0 … 1."""
    return _map(lambda c: _min(_max(c, _f32(0)), _f32(1)), x)


@intrinsic(Componentwise(3, scalars=1))
def mix(a: _V, b: _V | float, t: _V | float) -> _V:
    """Linear interpolation a · (1 − t) + b · t; exact at t = 0 and t = 1."""
    return _map(lambda p, q, s: p * (_f32(1) - s) + q * s, a, b, t)


@intrinsic(fixed(float, float, float, float))
def smoothstep(low: float, high: float, x: float) -> float:
    """Smooth step: 0 below low, 1 above high, 3t² − 2t³ between."""
    t = saturate((x - low) / (high - low))
    return t * t * (_f32(3) - _f32(2) * t)


@intrinsic(
    fixed(float, float, float),
    wgsl=Written("copy_sign"),
    glsl=Written("copy_sign"),
    llvm="llvm.copysign",
)
def copysign(x: float, sign: float) -> float:
    """|x| with the sign of the other argument, signed zeros included."""
    return np.copysign(_f32(x), _f32(sign))


# --- vectors ---------------------------------------------------------------------------------


@intrinsic(_vectors(2, float))
def dot(a: _N, b: _N) -> float:
    """Dot product; components are added in order."""
    products = [p * q for p, q in zip(a, b, strict=True)]
    total = products[0]
    for product in products[1:]:
        total = total + product
    return total


@intrinsic(_vectors(1, float))
def length(v: _N) -> float:
    """Length, sqrt(v · v)."""
    return np.sqrt(dot(v, v))


@intrinsic(_vectors(1))
def normalize(v: _N) -> _N:
    """Unit vector v · (1 / length(v)); NaN for a zero vector, so never pass one."""
    return v * (_f32(1) / length(v))


@intrinsic(fixed(Vec3, Vec3, Vec3))
def cross(a: Vec3, b: Vec3) -> Vec3:
    """Cross product, right-handed."""
    return Vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@intrinsic(_vectors(2))
def reflect(incident: _N, normal: _N) -> _N:
    """Reflection incident − normal · (2 · (incident · normal)), for a unit normal."""
    return incident - normal * (_f32(2) * dot(incident, normal))


@intrinsic(fixed(Mat3, Mat3))
def transpose(m: Mat3) -> Mat3:
    """Transpose, which is the inverse of a rotation."""
    x, y, z = m.x, m.y, m.z
    return Mat3(Vec3(x.x, y.x, z.x), Vec3(x.y, y.y, z.y), Vec3(x.z, y.z, z.z))


# --- bits --------------------------------------------------------------------------------------


@intrinsic(fixed(int, float), wgsl="bitcast<i32>", glsl="floatBitsToInt")
def float_bits(x: float) -> int:
    """Bits of a float, as an int."""
    return _f32(x).view(np.int32)


@intrinsic(fixed(float, int), wgsl="bitcast<f32>", glsl="intBitsToFloat")
def bits_float(bits: int) -> float:
    """Float with these bits."""
    return _i32(bits).view(np.float32)


# --- resources -----------------------------------------------------------------------------------


def _map_rule(*rest: Any, result: Any, kind: Any = None) -> Rule:
    def rule(types: tuple[Any, ...]) -> Any:
        expected = type_name(kind) if kind else "HeightField or Texture"
        fits = types and is_handle(types[0]) and types[1:] == rest
        if not fits or (kind is not None and types[0] is not kind):
            raise _refuse(f"({', '.join([expected, *map(type_name, rest)])})", types)
        return result

    return rule


@intrinsic(_map_rule(result=int), wgsl=Text("i32(textureNumLevels({0}))"), glsl=Text("1"))
def levels(map: HeightField | Texture) -> int:
    """Number of mip levels of a map."""
    return _i32(len(map.levels))


@intrinsic(
    _map_rule(int, result=IVec2),
    wgsl=Text("vec2i(textureDimensions({0}))"),
    glsl=Text("textureSize({0}, 0)"),
)
def size(map: HeightField | Texture, level: int) -> IVec2:
    """Width and height of a level in texels; the level is clamped to those of the map."""
    height, width = map.levels[min(max(int(level), 0), len(map.levels) - 1)].shape[:2]
    return IVec2(width, height)


@intrinsic(
    _map_rule(IVec2, int, result=Vec4, kind=HeightField),
    wgsl=Written("corners"),
    glsl=Written("corners"),
)
def corners(field: HeightField, cell: IVec2, level: int) -> Vec4:
    """Heights of four texels: (x, y), (x+1, y), (x, y+1), (x+1, y+1).

    The cell is clamped to −1 … count − 1, so that all four lie in the map and its border of one
    texel, which repeats the opposite side (edge "wrap") or the same side (edge "clamp"). Take
    texture coordinates into the tile first: for cells further out, the result on a GPU is that of
    its sampler.
    """
    level = min(max(int(level), 0), len(field.levels) - 1)
    height, width = field.levels[level].shape
    x, y = (min(max(int(c), -1), n - 1) for c, n in ((cell.x, width), (cell.y, height)))
    heights = []
    for corner in ((x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)):
        k, row, column = field.texel_index(*corner, level)
        heights.append(field.levels[k][row, column])
    return Vec4(*heights)


@intrinsic(
    _map_rule(Vec2, float, result=float, kind=HeightField),
    wgsl=Text("textureSampleLevel({0}, filter_sampler, {1}, {2}).x"),
    glsl=Text("textureLod({0}, {1}, {2}).x"),
)
def sampled(field: HeightField, uv: Vec2, lod: float) -> float:
    """Height at texture coordinates, by the filter of the GPU: bilinear in a mip level, and linear
    between the two levels around `lod`, which is clamped to those of the map.

    Coordinates outside the tile are those of the edge. This function has exact weights; a GPU has
    weights of 8 bits or more, and perhaps heights of 16 bits. The CPU engine has no such filter.
    """
    clamped = min(max(_f32(lod), _f32(0)), _f32(len(field.levels) - 1))
    level = int(np.floor(clamped))
    finer, lower = (_bilinear(field, uv, k) for k in (level, level + 1))
    return mix(finer, lower, clamped - _f32(level))


def _bilinear(field: HeightField, uv: Vec2, level: int) -> Any:
    """The bilinear surface of a level, at any texture coordinates."""
    extent = size(field, level)
    tile = fract(uv) if field.edge == "wrap" else saturate(uv)
    at = tile * Vec2(float(extent.x), float(extent.y)) - _f32(0.5)
    first = floor(at)
    four = corners(field, IVec2(int(first.x), int(first.y)), level)
    part = at - first
    return mix(mix(four.x, four.y, part.x), mix(four.z, four.w, part.x), part.y)


@intrinsic(
    _map_rule(IVec2, int, result=Vec4, kind=Texture),
    wgsl=Written("texel"),
    glsl=Written("texel"),
)
def texel(texture: Texture, cell: IVec2, level: int) -> Vec4:
    """The four channels of a texel, 0 to 65535; the cell is clamped to the map and its border.

    Not divided by 65535, so that a filter divides once instead of for each texel.
    """
    k, row, column = texture.texel_index(cell.x, cell.y, level)
    return Vec4(*texture.levels[k][row, column])


@intrinsic(
    _map_rule(IVec2, result=Vec4, kind=Texture),
    wgsl=Text("vec4f(textureLoad({0}, {1}, 0))"),
    glsl=Text("vec4(texelFetch({0}, {1}, 0))"),
)
def stored(texture: Texture, cell: IVec2) -> Vec4:
    """The four channels of a texel of level 0, 0 to 65535, of a baked table.

    Nothing is clamped, to save time: the cell must be in the table. For others the result is
    undefined.
    """
    _, row, column = texture.texel_index(cell.x, cell.y, 0)
    return Vec4(*texture.levels[0][row, column])
