"""Operations that shading languages lack or define differently from the subset, as shaders.

Printers print the helpers that a program needs. The intrinsics here, such as the read of one texel,
are for these helpers alone. On the CPU, where maps are in memory with a border, `llvm.py` does not
use the helpers of maps: it reads two texels by one load.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from basrelief.lang.intrinsics import (
    Text,
    fixed,
    float_bits,
    intrinsic,
    levels,
    size,
)
from basrelief.lang.resources import HeightField, Map, Texture
from basrelief.lang.shader import shader
from basrelief.lang.values import IVec2, Vec2, Vec4

_i32: Any = np.int32
TINY = 1.17549435e-38
"""The smallest positive normal float32."""


# --- intrinsics of targets -----------------------------------------------------------------------


@intrinsic(fixed(int, int, int), wgsl=Text("({0} / {1})"), glsl=Text("({0} / {1})"))
def truncated_quotient(a: int, b: int) -> int:
    """Quotient rounded towards 0, for b other than 0 and −1."""
    size = abs(int(a)) // abs(int(b))
    return _i32(size if (a < 0) == (b < 0) else -size)


@intrinsic(fixed(int, int, int), wgsl=Text("({0} >> u32({1}))"), glsl=Text("({0} >> {1})"))
def shifted_right(n: int, k: int) -> int:
    """n >> k for k from 0 to 31."""
    return _i32(n) >> _i32(k)


@intrinsic(fixed(float, float), wgsl="log", glsl="log")
def native_log(x: float) -> float:
    """The target's own natural logarithm, for x > 0."""
    return np.log(x)


@intrinsic(fixed(float, float), wgsl="log2", glsl="log2")
def native_log2(x: float) -> float:
    """The target's own logarithm to base 2, for x > 0."""
    return np.log2(x)


@intrinsic(fixed(float, float, float), wgsl="pow", glsl="pow")
def native_pow(x: float, y: float) -> float:
    """The target's own power, for x > 0."""
    return np.power(x, y)


@intrinsic(
    fixed(float, HeightField, IVec2, int),
    wgsl=Text("textureLoad({0}, {1}, {2}).x"),
    glsl=Text("texelFetch({0}, {1}, {2}).x"),
)
def height_of(field: HeightField, cell: IVec2, level: int) -> float:
    """Height of a texel, which must be in the map."""
    return field.levels[level][cell.y, cell.x]


@intrinsic(
    fixed(Vec4, Texture, IVec2, int),
    wgsl=Text("vec4f(textureLoad({0}, {1}, {2}))"),
    glsl=Text("vec4(texelFetch({0}, {1}, {2}))"),
)
def channels_of(map: Texture, cell: IVec2, level: int) -> Vec4:
    """The four channels of a texel, which must be in the map, 0 to 65535."""
    return Vec4(*map.levels[level][cell.y, cell.x])


@intrinsic(fixed(Vec4, HeightField, Vec2), wgsl=Text("textureGather(0, {0}, edge_sampler, {1})"))
def gathered(field: HeightField, uv: Vec2) -> Vec4:
    """Heights of the four texels around a corner of level 0, at (0, 1), (1, 1), (1, 0), (0, 0); the
    sampler applies the edge."""
    height, width = field.shape
    x, y = (int(np.floor(c * n - 0.5)) for c, n in ((uv.x, width), (uv.y, height)))
    cells = ((x, y + 1), (x + 1, y + 1), (x + 1, y), (x, y))
    return Vec4(*(field.levels[0][field.texel_index(*cell, 0)[1:]] for cell in cells))


# --- numbers -------------------------------------------------------------------------------------


@shader
def floor_divide(a: int, b: int) -> int:
    """a // b, rounded down as in Python; 0 for a division by 0."""
    # by 0, and the least int by −1, a division traps or is undefined
    divisor = 1 if b == 0 or b == -1 else b
    quotient = truncated_quotient(a, divisor)
    rest = a - quotient * divisor
    rounded = quotient - 1 if rest != 0 and (rest ^ divisor) < 0 else quotient
    return 0 if b == 0 else (-a if b == -1 else rounded)


@shader
def floor_modulo(a: int, b: int) -> int:
    """a % b, with the sign of b as in Python; 0 for a division by 0."""
    return 0 if b == 0 else a - floor_divide(a, b) * b


@shader
def copy_sign(x: float, sign: float) -> float:
    """|x| with the sign of the other argument, signed zeros included."""
    return -abs(x) if float_bits(sign) < 0 else abs(x)


@shader
def power(x: float, y: float) -> float:
    """Power xʸ for x ≥ 0; 0ʸ is 0, 0⁰ is 1."""
    return native_pow(max(x, TINY), y) if x > 0.0 else (1.0 if y == 0.0 else 0.0)


@shader
def log_clamped(x: float) -> float:
    """Natural logarithm of x, or of the smallest positive normal number if x is less."""
    return native_log(max(x, TINY))


@shader
def log2_clamped(x: float) -> float:
    """Logarithm to base 2 of x, or of the smallest positive normal number if x is less."""
    return native_log2(max(x, TINY))


# --- maps ----------------------------------------------------------------------------------------


@shader
def level_size(finest: IVec2, level: int) -> IVec2:
    """Size of a level, from that of level 0."""
    # not by the target's own function: where the level differs between pixels, that of Mesa's
    # software driver returns the size of one level for all
    width = max(shifted_right(finest.x, level), 1)
    return IVec2(width, max(shifted_right(finest.y, level), 1))


@shader
def clamped_level(level: int, count: int) -> int:
    """Level clamped to those of a map."""
    return min(max(level, 0), count - 1)


@shader
def size_of_level(finest: IVec2, count: int, level: int) -> IVec2:
    """Size of a level, clamped to those of a map."""
    return level_size(finest, clamped_level(level, count))


@shader
def at_edge(map: Map, index: int, count: int) -> int:
    """Row or column of a texel of a map or of its border, −1 … count."""
    if map.edge == "clamp":
        return min(max(index, 0), count - 1)
    low = index + count if index < 0 else index
    return low - count if low >= count else low


@shader
def corners(field: HeightField, cell: IVec2, level: int) -> Vec4:
    """Heights of the texels (x, y), (x+1, y), (x, y+1), (x+1, y+1)."""
    k = clamped_level(level, levels(field))
    extent = level_size(size(field, 0), k)
    x = min(max(cell.x, -1), extent.x - 1)
    y = min(max(cell.y, -1), extent.y - 1)
    left = at_edge(field, x, extent.x)
    right = at_edge(field, x + 1, extent.x)
    top = at_edge(field, y, extent.y)
    bottom = at_edge(field, y + 1, extent.y)
    return Vec4(
        height_of(field, IVec2(left, top), k),
        height_of(field, IVec2(right, top), k),
        height_of(field, IVec2(left, bottom), k),
        height_of(field, IVec2(right, bottom), k),
    )


@shader
def corners_of_finest(field: HeightField, cell: Vec2) -> Vec4:
    """Heights of the texels (x, y), (x+1, y), (x, y+1), (x+1, y+1) of level 0 in one read: gathered
    around their common corner."""
    extent = size(field, 0)
    return gathered(field, (cell + 1.0) * (1.0 / Vec2(float(extent.x), float(extent.y)))).wzxy


@shader
def texel(map: Texture, cell: IVec2, level: int) -> Vec4:
    """The four channels of a texel, 0 to 65535."""
    k = clamped_level(level, levels(map))
    extent = level_size(size(map, 0), k)
    x = at_edge(map, min(max(cell.x, -1), extent.x), extent.x)
    y = at_edge(map, min(max(cell.y, -1), extent.y), extent.y)
    return channels_of(map, IVec2(x, y), k)
