"""GLSL 3.30: functions for a host shader that has its own entry point, textures and uniforms.

Height fields are `sampler2D`, other maps `usampler2D` of 16-bit fractions. Both are read texel by
texel (`texelFetch`) at level 0, and interpolated by the shaders, so that the host's filters and
mips do not matter; `sampled` (`textureLod`) alone uses them. The text has no `main`, no uniforms
and no `#version`.
"""

from __future__ import annotations

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
    return "\n".join(GlslPrinter(module.functions, edge).declarations().values())


class _FunctionPrinter(FunctionPrinter):
    """Printer of one function as GLSL."""

    language = "glsl"

    def text(self) -> str:
        return _ascii(super().text())


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
    declared_names = frozenset()

    def __init__(self, functions: list[tree.Function], edge: Edge) -> None:
        for function in functions:
            for name, t in function.parameters.items():
                if buffer_record(t) is not None:
                    raise ShaderError(
                        f"{function.location}: {name} is a buffer; GLSL 3.30 has none"
                    )
        super().__init__(functions, edge)

    def record_text(self, record: Any) -> str:
        fields = fields_of(record)
        lines = [f"  {self.type(t)} {self.field(name)};" for name, t in fields.items()]
        return "\n".join(
            [f"struct {self.scope[record]} {{", *(lines or ["  float unused;"]), "};\n"]
        )


def _ascii(text: str) -> str:
    """The text in ASCII, the only characters that GLSL 3.30 allows, even in comments."""
    for character, substitute in _ASCII.items():
        text = text.replace(character, substitute)
    return unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()


_ASCII = {
    "·": "*", "×": "x", "−": "-", "÷": "/", "≤": "<=", "≥": ">=", "–": "-", "∂": "d", "π": "pi",
    "½": "1/2", "¼": "1/4", "²": "^2", "√": "sqrt", "…": "...", "→": "->", "“": '"', "”": '"',
}  # fmt: skip

# Keywords and reserved words (GLSL 3.30, section 3.6), and functions beside the intrinsics.
GlslPrinter.reserved_words = frozenset(
    """
    attribute const uniform varying layout centroid flat smooth noperspective break continue
    do for while switch case default if else in out inout float int void bool true false
    invariant discard return mat2 mat3 mat4 vec2 vec3 vec4 ivec2 ivec3 ivec4 bvec2 bvec3 bvec4
    uint uvec2 uvec3 uvec4 lowp mediump highp precision sampler1D sampler2D sampler3D
    samplerCube usampler2D struct common partition active asm class union enum typedef
    template this packed goto inline noinline volatile public static extern external interface
    long short half fixed unsigned superp input output filter sizeof cast namespace using
    row_major patch sample subroutine buffer shared coherent restrict readonly writeonly
    resource main texture asin acos atan ceil mod round texelFetch textureSize
    """.split()  # noqa: SIM905
)
