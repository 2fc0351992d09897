"""Groups of resources: one parameter of a shader, one for each member in a program."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.engine.gpu import GpuEngine
from basrelief.lang import Buffer, HeightField, ShaderError, Texture
from basrelief.lang.frontend import analyse
from basrelief.lang.library import library_of
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from helpers.comparing import write_module
from helpers.linking import linked
from helpers.refusals import refusal_in

SOURCE = """
@struct
class Out:
    x: float

@struct
class Number:
    value: float

@resources
class Maps:
    low: HeightField
    color: Texture
    high: HeightField
    numbers: Buffer[Number]

@shader
def beyond(map: Map, x: float) -> float:
    return x if map.edge == "wrap" else -x

@slot
def chosen(x: float, maps: Maps, unread: float) -> float: ...

@shader
def heights(x: float, maps: Maps) -> float:
    return x + corners(maps.low, IVec2(0, 0), 0).x - 2.0 * corners(maps.high, IVec2(0, 0), 0).x

@shader
def numbers(maps: Maps) -> float:
    return maps.numbers[1].value * float(len(maps.numbers))

@shader
def inner(maps: Maps, height: HeightField) -> float:
    found = chosen(3.0, maps, 0.0) + corners(height, IVec2(0, 0), 0).x * 100.0
    return beyond(maps.color, found)

@shader
def entry(pixel: IVec2, maps: Maps) -> Out:
    return Out(inner(maps, maps.high))
"""


@pytest.fixture
def module(tmp_path: Path) -> Any:
    return write_module(tmp_path, SOURCE)


def values(module: Any) -> dict[str, Any]:
    """Values of the members, all different."""
    return {
        "low": HeightField([np.full((1, 1), 0.25, np.float32)]),
        "color": Texture([np.full((1, 1, 4), 7, np.uint16)]),
        "high": HeightField([np.full((1, 1), 0.875, np.float32)]),
        "numbers": Buffer([module.Number(5.0), module.Number(11.0)]),
    }


EXPECTED = {"heights": 3.0 + 0.25 - 1.75 + 87.5, "numbers": 22.0 + 87.5}


@pytest.mark.parametrize("bound", EXPECTED)
def test_python_and_cpu_agree(module: Any, bound: str) -> None:
    program = Program(module.entry, {module.chosen: getattr(module, bound)})
    members = values(module)
    with module.bound(program.bindings):
        assert module.entry((0, 0), module.Maps(**members)).x == EXPECTED[bound]
    flat = {f"maps_{name}": value for name, value in members.items()}
    assert list(program.parameters) == list(flat)
    assert CpuEngine().run(program, flat, (1, 1))["x"] == EXPECTED[bound]


@pytest.mark.gpu
@pytest.mark.parametrize("bound", EXPECTED)
def test_gpu_and_linked_programs_agree(module: Any, bound: str) -> None:
    options = {module.chosen: [module.heights, module.numbers]}
    library, engine = library_of([module.entry], options), GpuEngine()
    program = Program(module.entry, {module.chosen: getattr(module, bound)})
    flat = {f"maps_{name}": value for name, value in values(module).items()}
    assert engine.run(program, flat, (1, 1))["x"] == EXPECTED[bound]
    needed = library.bindings["entry"]
    with engine.prepare_text(linked(library, program), program, flat, (1, 1), needed) as job:
        job.dispatch(0, 1)
        assert job.read(1)[0].view(np.float32)[0] == EXPECTED[bound]


def test_a_program_has_only_the_members_that_it_reads(module: Any) -> None:
    made = Program(module.entry, {module.chosen: module.numbers}).module
    assert list(made.entry.parameters) == ["pixel", "maps_high", "maps_numbers"]
    text = print_wgsl(made, "wrap")
    assert "maps_low" not in text
    assert "fn inner(height: texture_2d<f32>) -> f32" in text


def test_a_key_depends_on_the_members(module: Any, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    swapped = SOURCE.replace("    low: HeightField\n", "").replace(
        "    high: HeightField\n", "    high: HeightField\n    low: HeightField\n"
    )
    changed = write_module(other, swapped)
    keys = [Program(m.entry, {m.chosen: m.heights}).key for m in (module, changed)]
    assert keys[0] != keys[1]


def test_a_group_contains_only_handles(tmp_path: Path) -> None:
    with pytest.raises(ShaderError, match=r"Odd\.x: a group of resources holds handles"):
        write_module(tmp_path, "@resources\nclass Odd:\n    x: float\n")


REFUSED = {
    "y = maps": "maps is a group of resources; name a member, or pass it",
    "y = corners(maps.middle, IVec2(0, 0), 0).x": "no member middle; it has low, color, high",
    "y = inner(x, maps.high)": "maps is Maps; pass the one of this shader",
    'y = 1.0 if maps.low.edge == "clip" else x': "there is no edge 'clip'",
}


@pytest.mark.parametrize("body", REFUSED)
def test_refused(tmp_path: Path, body: str) -> None:
    head = "@shader\ndef wrong(x: float, maps: Maps) -> float:\n"
    module = write_module(tmp_path, f"{SOURCE}\n{head}    {body}\n    return y\n")
    with pytest.raises(ShaderError, match=re.escape(REFUSED[body])) as caught:
        analyse(module.wrong)
    assert refusal_in(caught.value).file == module.__file__


def test_a_name_that_a_member_has_in_a_program_is_refused(tmp_path: Path) -> None:
    text = (
        "@shader\ndef wrong(maps: Maps) -> float:\n    maps_low = 1.0\n    return maps_low\n"
        "@shader\ndef right(maps: Maps) -> float:\n    low = 1.0\n    return low\n"
    )
    module = write_module(tmp_path, f"{SOURCE}\n{text}")
    with pytest.raises(ShaderError, match=r"maps_low is the name of maps\.low in a program"):
        analyse(module.wrong)
    assert analyse(module.right).entry.name == "right"


def test_a_group_cannot_be_a_result(tmp_path: Path) -> None:
    text = "@shader\ndef wrong(maps: Maps) -> Maps:\n    return maps\n"
    module = write_module(tmp_path, f"{SOURCE}\n{text}")
    with pytest.raises(ShaderError, match="Maps is not a type"):
        analyse(module.wrong)
