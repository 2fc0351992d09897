"""Text of the printed LLVM IR: readable, strict about floats, without dead code."""

from __future__ import annotations

import re

import pytest

from basrelief.lang.llvm import print_llvm
from basrelief.lang.program import Program
from helpers.comparing import write_module

SOURCE = '''
@struct
class Light:
    colour: Vec3
    power: float

@struct
class Result:
    colour: Vec3

@shader
def attenuated(light: Light, distance: float) -> Vec3:
    """Attenuated colour of a light.

    Inverse square of the distance.
    """
    # never divide by zero
    square = max(distance * distance, 0.01)
    return light.colour * (light.power / square)

@shader
def parallax_of(field: HeightField, x: float) -> float:
    return corners(field, IVec2(int(x), 0), 0).x + sin(x)

@slot
def brightness(light: Light, x: float) -> float: ...

@shader
def constant_brightness(light: Light, x: float) -> float:
    """Constant brightness."""
    return light.power

@shader
def waving_brightness(light: Light, x: float) -> float:
    return light.power * exp2(x)

@shader
def entry(pixel: IVec2, light: Light, field: HeightField) -> Result:
    x = float(pixel.x)
    return Result(attenuated(light, x) * brightness(light, x))

@shader
def flat_entry(pixel: IVec2, light: Light) -> Result:
    return Result(attenuated(light, float(pixel.x)))

@shader
def deep_entry(pixel: IVec2, light: Light, field: HeightField) -> Result:
    return Result(attenuated(light, parallax_of(field, float(pixel.x))))
'''


@pytest.fixture(scope="module")
def module(folder):
    return write_module(folder, SOURCE)


def text_of(module, entry, lanes=8, bindings=None):
    return print_llvm(Program(getattr(module, entry), bindings or {}).module, lanes)


def test_names_docstrings_and_comments_are_kept(module):
    text = text_of(module, "flat_entry")
    assert re.search(
        r"^; Attenuated colour of a light\.\n; *\n; Inverse square of the distance\.\n"
        r"define internal fastcc \{.*\} @attenuated\(",
        text,
        re.MULTILINE,
    )
    assert "%arg.light.colour.x" in text
    assert "%square." in text
    assert "  ; never divide by zero\n" in text


@pytest.mark.parametrize("lanes", [4, 8, 16])
def test_floats_keep_their_meaning(module, lanes):
    """No fast-math flags, no contraction, and one vector width."""
    bindings = {module.brightness: module.waving_brightness}
    for entry in ("entry", "deep_entry"):
        text = text_of(module, entry, lanes, bindings)
        operations = re.findall(r"= (fadd|fsub|fmul|fdiv|fneg|fcmp) (.*?)<(\d+) x float>", text)
        assert len(operations) > 10
        for operation, between, width in operations:
            assert re.fullmatch(r"[ou]\w\w " if operation == "fcmp" else "", between)
            assert width == str(lanes)
        assert "llvm.fma" not in text
        assert "llvm.fmuladd" not in text


def test_dead_code_is_removed(module):
    flat = text_of(module, "flat_entry")
    for name in ("parallax_of", "corners", "math.", "brightness", "sine"):
        assert name not in flat
    assert "%field" not in flat
    deep = text_of(module, "deep_entry")
    assert "@parallax_of" in deep
    assert "@math.sin" in deep
    assert "@math.exp" not in deep


def test_a_slot_becomes_the_bound_shader(module):
    plain = text_of(module, "entry", bindings={module.brightness: module.constant_brightness})
    assert "@constant_brightness" in plain
    assert "; Constant brightness." in plain
    assert "@brightness" not in plain
    assert "waving" not in plain
    # the height field is a parameter, but nothing reads it
    assert "%field" not in plain
    assert list(
        Program(module.entry, {module.brightness: module.constant_brightness})
        .module.entry.parameters
    ) == ["pixel", "light"]  # fmt: skip
