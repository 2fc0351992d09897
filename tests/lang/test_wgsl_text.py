"""Text of the printed WGSL: names, docstrings and comments as in the Python source."""

from __future__ import annotations

import re

import pytest

from basrelief.lang import Buffer
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from helpers.comparing import write_module

SOURCE = '''
@struct
class Light:
    colour: Vec3
    power: float

@struct
class Result:
    colour: Vec3
    near: bool

@shader
def attenuated(light: Light, distance: float) -> Vec3:
    """Attenuated colour of a light.

    Inverse square of the distance.
    """
    # never divide by zero
    square = max(distance * distance, 0.01)
    total = Vec3(0.0)
    for k in range(3):
        # one more
        total = total + light.colour * (light.power / square) * float(k)
    return total

@shader
def read(field: HeightField, x: float) -> float:
    return corners(field, IVec2(int(x), 0), 0).x + sin(x)

@shader
def entry(pixel: IVec2, light: Light) -> Result:
    x = float(pixel.x)
    if x > 3.0:
        near = False
    elif x > 1.0:
        near = True
    else:
        near = x > 0.5
    return Result(attenuated(light, x), near)

@shader
def deep_entry(pixel: IVec2, light: Light, field: HeightField) -> Result:
    return Result(attenuated(light, read(field, float(pixel.x))), True)
'''


def text_of(folder, source, entry="entry"):
    return print_wgsl(Program(getattr(write_module(folder, source), entry)).module, "wrap")


def test_names_docstrings_and_comments_are_kept(folder):
    text = text_of(folder, SOURCE)
    assert (
        "// Attenuated colour of a light.\n//\n// Inverse square of the distance.\n"
        "fn attenuated(light: Light, distance: f32) -> vec3f {\n"
        "  // never divide by zero\n"
        "  let square = max(distance * distance, 0.01);\n"
        "  var total = vec3f(0.0);\n"
        "  for (var k = 0; k < 3; k++) {\n"
        "    // one more\n"
        "    total = total + light.colour * (light.power / square) * f32(k);\n"
        "  }\n"
        "  return total;\n"
        "}\n"
    ) in text
    assert re.search(r"struct Light \{\n  (@align\(16\) )?colour: vec3f,\n  power: f32,\n\}", text)
    assert "} else if (" in text


def test_dead_code_is_removed(folder):
    flat = text_of(folder, SOURCE)
    for name in ("fn read", "corners", "texture", "edge_wrap", "level_size", "floor_divide"):
        assert name not in flat
    deep = text_of(folder, SOURCE, "deep_entry")
    assert "fn read(field: texture_2d<f32>, x: f32) -> f32" in deep
    assert "fn corners_of_finest(" in deep
    assert "fn texel(" not in deep


WORDS = """
    target ref filter texture final macro loop var let fn struct switch discard static public
    sampler array vec3f f32 i32 select bitcast ptr main run planes result place atomic this
    enum move match mod new null of set use virtual volatile where abs max round
""".split()  # noqa: SIM905
"""Names that WGSL or the text around the functions uses."""


@pytest.mark.gpu
@pytest.mark.parametrize("start", range(0, len(WORDS), 16))
def test_words_of_wgsl_as_python_names(folder, start):
    """As parameters, locals, counters, fields, functions and records."""
    from basrelief.engine.gpu import GpuEngine

    words = WORDS[start : start + 16]
    fields = "\n".join(f"    {word}: float" for word in words)
    helpers = "\n".join(
        f"""
@shader
def helper_{n}({word}: float, other: float) -> float:
    {word}_1 = {word} + other
    for {word}_2 in range(2):
        {word}_1 = {word}_1 + float({word}_2)
    return {word}_1
"""
        for n, word in enumerate(words)
    )
    own = [word for word in words if word not in ("abs", "max", "round")]
    functions = "\n".join(
        f"""
@shader
def {word}(x: float) -> float:
    return x * {n + 1}.0
"""
        for n, word in enumerate(own)
    )
    assigned = "\n".join(
        f"    {word} = helper_{n}(item.{word}, {n}.0)" for n, word in enumerate(words)
    )
    total = " + ".join(words)
    called = " + ".join(f"{word}(x)" for word in own)
    source = f"""
@struct
class Input:
{fields}

@struct
class Result:
    total: float
    called: float
{helpers}
{functions}

@shader
def summed(item: Input) -> float:
{assigned}
    return {total}

@shader
def all_called(x: float) -> float:
    return {called}

@shader
def entry(pixel: IVec2, items: Buffer[Input]) -> Result:
    return Result(summed(items[pixel.x]), all_called(float(pixel.x)))
"""
    module = write_module(folder, source)
    items = Buffer([module.Input(*(float(n + k) for n in range(len(words)))) for k in range(3)])
    planes = GpuEngine().run(Program(module.entry), {"items": items}, (3, 1))
    for x in range(3):
        expected = module.entry((x, 0), items)
        assert planes["total"][0, x] == expected.total
        assert planes["called"][0, x] == expected.called
