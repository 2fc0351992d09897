"""The shader subset of Python, and its compilers: shaders run as Python, on the CPU and on the GPU.

`@shader` marks a function, `@struct` a record, `@slot` a function whose body is bound when a
program is made, `@static` a record of static conditions, `@resources` a group of maps. Types and
intrinsics are imported from here. `CONVENTIONS.md` states the rules.
"""

import basrelief.lang.elementary  # noqa: F401  (defines the elementary functions)
from basrelief.lang.intrinsics import (
    acos,
    asin,
    atan,
    atan2,
    bits_float,
    clamp,
    copysign,
    corners,
    cos,
    cross,
    dot,
    exp,
    exp2,
    float_bits,
    floor,
    fract,
    length,
    levels,
    log,
    log2,
    maximum,
    minimum,
    mix,
    normalize,
    pow,
    reflect,
    saturate,
    sin,
    size,
    smoothstep,
    sqrt,
    stored,
    tan,
    texel,
    transpose,
)
from basrelief.lang.resources import Buffer, HeightField, Map, Texture, resources
from basrelief.lang.shader import Shader, bound, shader, slot, watched
from basrelief.lang.types import ShaderError, TypeSlot, static, static_fields, struct
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4
from basrelief.settings import setting

__all__ = [
    "Buffer", "HeightField", "IVec2", "Map", "Mat3", "Shader", "ShaderError", "Texture", "TypeSlot",
    "Vec2", "Vec3", "Vec4", "acos", "asin", "atan", "atan2", "bits_float", "bound", "clamp",
    "copysign", "corners", "cos", "cross", "dot", "exp", "exp2", "float_bits", "floor", "fract",
    "length", "levels", "log", "log2", "maximum", "minimum", "mix", "normalize", "pow", "reflect",
    "resources", "saturate", "setting", "shader", "sin", "size", "slot", "smoothstep", "sqrt",
    "static", "static_fields", "stored", "struct", "tan", "texel", "transpose", "watched",
]  # fmt: skip
