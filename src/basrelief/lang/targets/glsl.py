"""GLSL 3.30: functions for a host shader that has its own entry point, textures and uniforms.

Height fields are `sampler2D`, other maps `usampler2D` of 16-bit fractions. Both are read texel by
texel (`texelFetch`) at level 0, and interpolated by the shaders, so that the host's filters and
mips do not matter. The text has no `main`, no uniforms and no `#version`.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Any, ClassVar

from basrelief.lang import tree
from basrelief.lang.resources import Edge, HeightField, Texture, buffer_record
from basrelief.lang.targets.clike import FunctionPrinter, ModulePrinter
from basrelief.lang.types import ShaderError, fields_of
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4


def print_glsl(module: tree.Module, edge: Edge) -> str:
    """Text of a module as GLSL 3.30.

    Parameters
    ----------
    module
        A specialized module. Its entry may have any parameters; buffers are refused.
    edge
        The edge of all maps.

    Raises
    ------
    ShaderError
        For a buffer, which GLSL 3.30 does not have.
    """
    return GlslPrinter(module.functions, edge).functions_text()


class _FunctionPrinter(FunctionPrinter):
    """Printer of one function as GLSL."""

    spelling: ClassVar = {
        "minimum": "min",
        "maximum": "max",
        "float_bits": "floatBitsToInt",
        "bits_float": "intBitsToFloat",
        "copysign": "copy_sign",
        "pow": "power",
        "log": "log_clamped",
        "log2": "log2_clamped",
    }
    own_functions = frozenset({"asin", "acos", "atan", "atan2"})
    """GLSL does not specify their precision."""

    def text(self) -> str:
        return _ascii(super().text())

    def intrinsic_call(self, node: tree.IntrinsicCall, texts: list[str]) -> str:
        match node.name:
            case "saturate":
                return f"clamp({texts[0]}, 0.0, 1.0)"
            case "levels":
                return "1"
            case "size":
                return f"textureSize({texts[0]}, 0)"
        return super().intrinsic_call(node, texts)


class GlslPrinter(ModulePrinter):
    """Printer of the functions of a module as GLSL."""

    types: ClassVar = {
        float: "float",
        int: "int",
        bool: "bool",
        Vec2: "vec2",
        Vec3: "vec3",
        Vec4: "vec4",
        IVec2: "ivec2",
        Mat3: "mat3",
        HeightField: "sampler2D",
        Texture: "usampler2D",
    }
    function_printer = _FunctionPrinter

    def __init__(self, functions: list[tree.Function], edge: Edge) -> None:
        for function in functions:
            for name, t in function.parameters.items():
                if buffer_record(t) is not None:
                    raise ShaderError(
                        f"{function.location}: {name} is a buffer; GLSL 3.30 has none"
                    )
        super().__init__(functions)
        self.helper_texts = {**_EDGE_HELPERS[edge], **_HELPERS}

    def record_text(self, record: Any) -> str:
        fields = fields_of(record)
        lines = [f"  {self.type(t)} {self.field(name)};" for name, t in fields.items()]
        return "\n".join(
            [f"struct {self.scope[record]} {{", *(lines or ["  float unused;"]), "};\n"]
        )

    def needed_helper_texts(self) -> Any:
        if self.helpers & {"corners", "texel"}:
            self.helpers.add("at_edge")
        return super().needed_helper_texts()


def _ascii(text: str) -> str:
    """The text in ASCII, the only characters that GLSL 3.30 allows, even in comments."""
    for character, substitute in _ASCII.items():
        text = text.replace(character, substitute)
    return unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()


_ASCII = {
    "·": "*", "×": "x", "−": "-", "÷": "/", "≤": "<=", "≥": ">=", "–": "-", "∂": "d", "π": "pi",
    "½": "1/2", "¼": "1/4", "²": "^2", "√": "sqrt", "…": "...", "→": "->", "“": '"', "”": '"',
}  # fmt: skip

_EDGE_HELPERS: dict[Edge, dict[str, str]] = {
    "wrap": {
        "at_edge": """\
// A texel of a map or of its border, which repeats the opposite side.
ivec2 at_edge(ivec2 cell, ivec2 size) {
  return cell + size * ivec2(lessThan(cell, ivec2(0))) - size * ivec2(greaterThanEqual(cell, size));
}
"""
    },
    "clamp": {
        "at_edge": """\
// A texel of a map or of its border, which repeats the same side.
ivec2 at_edge(ivec2 cell, ivec2 size) {
  return clamp(cell, ivec2(0), size - 1);
}
"""
    },
}
_HELPERS = {
    "floor_divide": """\
int floor_divide(int a, int b) {
  if (b == 0) { return 0; }
  if (b == -1) { return -a; }
  int quotient = a / b;
  int rest = a - quotient * b;
  return rest != 0 && (rest ^ b) < 0 ? quotient - 1 : quotient;
}
""",
    "floor_modulo": """\
int floor_modulo(int a, int b) {
  return b == 0 ? 0 : a - floor_divide(a, b) * b;
}
""",
    "copysign": """\
float copy_sign(float x, float s) {
  return floatBitsToInt(s) < 0 ? -abs(x) : abs(x);
}
""",
    "pow": """\
float power(float x, float y) {
  return x > 0.0 ? pow(max(x, 1.17549435e-38), y) : (y == 0.0 ? 1.0 : 0.0);
}
""",
    "log": """\
float log_clamped(float x) {
  return log(max(x, 1.17549435e-38));
}
""",
    "log2": """\
float log2_clamped(float x) {
  return log2(max(x, 1.17549435e-38));
}
""",
    "corners": """\
// Heights of the texels (x, y), (x+1, y), (x, y+1), (x+1, y+1).
vec4 corners(sampler2D field, ivec2 cell, int level) {
  ivec2 size = textureSize(field, 0);
  ivec2 corner = clamp(cell, ivec2(-1), size - 1);
  ivec2 a = at_edge(corner, size);
  ivec2 b = at_edge(corner + 1, size);
  return vec4(
    texelFetch(field, a, 0).x,
    texelFetch(field, ivec2(b.x, a.y), 0).x,
    texelFetch(field, ivec2(a.x, b.y), 0).x,
    texelFetch(field, b, 0).x
  );
}
""",
    "stored": """\
// The four channels of a texel of a table.
vec4 stored(usampler2D map, ivec2 cell) {
  return vec4(texelFetch(map, cell, 0));
}
""",
    "texel": """\
// The four channels of a texel, 0 to 65535.
vec4 texel(usampler2D map, ivec2 cell, int level) {
  ivec2 size = textureSize(map, 0);
  return vec4(texelFetch(map, at_edge(clamp(cell, ivec2(-1), size), size), 0));
}
""",
}

# Keywords, reserved words and the built-in functions that are printed (GLSL 3.30, sections 3.6, 8).
GlslPrinter.reserved_words = frozenset(
    re.findall(
        r"\w+",
        """
    attribute const uniform varying layout centroid flat smooth noperspective break continue do for
    while switch case default if else in out inout float int void bool true false invariant discard
    return mat2 mat3 mat4 vec2 vec3 vec4 ivec2 ivec3 ivec4 bvec2 bvec3 bvec4 uint uvec2 uvec3 uvec4
    lowp mediump highp precision sampler1D sampler2D sampler3D samplerCube usampler2D struct common
    partition active asm class union enum typedef template this packed goto inline noinline volatile
    public static extern external interface long short half fixed unsigned superp input output
    filter sizeof cast namespace using row_major patch sample subroutine buffer shared coherent
    restrict readonly writeonly resource main texture
    abs acos asin atan ceil clamp cos cross dot exp exp2 floor fract length log log2 max min mix mod
    normalize pow reflect round sign sin smoothstep sqrt tan transpose texelFetch textureSize
    """,
    )
)
GlslPrinter.declared_names = frozenset(
    re.findall(
        r"^\w+ (\w+)\(",
        "".join([*_HELPERS.values(), *_EDGE_HELPERS["wrap"].values()]),
        re.MULTILINE,
    )
)
