"""User-defined techniques from a file: drawing, and error messages with file and line."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from basrelief.engine import choose_device
from basrelief.errors import BasreliefError
from basrelief.images import read_picture
from basrelief.lang import HeightField, IVec2, Texture, Vec2, stored
from basrelief.techniques import TECHNIQUES, Nothing, technique
from basrelief.techniques.own import technique_from_file
from basrelief.techniques.ray import Hit, Ray
from helpers.command_line import done, refused, write_heights
from helpers.rays import flat_ray
from helpers.repository import REPOSITORY

PAGE = REPOSITORY / "docs" / "write-a-technique.md"
DRAW = ("--size", "20x14", "--samples", "1", "--set", "roughness=0.5")

HEAD = """\
from basrelief.lang import HeightField, setting, shader, slot, struct
from basrelief.techniques.height import sharp
from basrelief.techniques import Hit, Nothing, Ray, hit_at, t_at, technique


"""
SINK = (
    HEAD
    + '''@struct
class Sinking:
    """Settings."""

    depth_steps: int = setting(default=2, doc="how deep, in quarters", low=0, high=4)


@technique(reference_height=1.0)
def sink(field: HeightField, ray: Ray, settings: Sinking) -> Hit:
    """Follow the ray some quarters down, whatever the heights say."""
    height = 1.0 - 0.25 * float(settings.depth_steps)
    return hit_at(ray, t_at(ray, height), True, 0)
'''
)


@pytest.fixture
def work_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder of the commands, with a material in `bumps`."""
    monkeypatch.chdir(tmp_path)
    write_heights(tmp_path / "bumps")
    return tmp_path


def write_technique(text: str, name: str = "my.py") -> None:
    Path(name).write_text(text)


def drawn(technique: str, *arguments: str) -> np.ndarray:
    done("render", "bumps", *DRAW, "--technique", technique, *arguments, "-o", "a.tif")
    return read_picture("a.tif").pixels


def line_of(text: str, part: str) -> int:
    """The number of the line that contains a text, from 1."""
    return next(n for n, line in enumerate(text.splitlines(), 1) if part in line)


# --- use ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_a_technique_from_a_file_draws_and_takes_settings(device: str, work_folder: Path) -> None:
    write_technique(SINK)
    flat = drawn("flat", "--device", "cpu")
    pictures = [
        drawn("my.py:sink", "--device", device, "--set", f"depth_steps={n}") for n in range(3)
    ]
    # at the reference height nothing is displaced
    assert np.abs(pictures[0] - flat).max() < 1e-3
    assert np.abs(pictures[2] - drawn("my.py:sink", "--device", device)).max() == 0.0
    assert not (pictures[1] == pictures[2]).all()
    assert done("render", "bumps", *DRAW, "--technique", "my.py:sink").startswith(
        "bumps-sink-basrelief.png"
    )


def test_the_hit_is_that_of_the_closed_form(work_folder: Path) -> None:
    """A hit at half the height range moves uv by half the ray's travel."""
    write_technique(SINK)
    material = basrelief.load("bumps")
    ortho = basrelief.Orbit(0.0, 45.0, orthographic_height=1.0)
    options = {"scale": 0.2, "camera": ortho, "size": (9, 9), "device": choose_device("cpu")}
    flat = basrelief.render(material, technique="flat", **options)
    sunk = basrelief.render(material, technique="my.py:sink", **options)
    moved = (sunk.uv - flat.uv)[4, 4]
    # a view at 45 degrees; the tile's height is 6/8 of its width
    assert moved == pytest.approx([0.0, -0.5 * 0.2 / (6 / 8)], abs=1e-5)


def test_a_technique_can_be_called_as_a_function(work_folder: Path) -> None:
    write_technique(SINK)
    sink = technique_from_file("my.py", "sink")
    assert sink.reference_height == 1.0
    assert sink.settings().depth_steps == 2
    ray = flat_ray((0.5, 0.5), (0.25, 0.5), cosine=0.7)
    hit = sink(HeightField([np.zeros((1, 1), np.float32)]), ray, sink.settings())
    assert hit == Hit(Vec2(0.625, 0.75), 0.5, 0.5, True, 0)


def test_a_shader_without_the_mark_is_a_technique(work_folder: Path) -> None:
    write_technique(SINK.replace("@technique(reference_height=1.0)", "@shader"))
    marked = drawn("my.py:sink", "--device", "cpu")
    write_technique(SINK, "other.py")
    assert (marked == drawn("other.py:sink", "--device", "cpu")).all()


def test_a_technique_reads_a_bake_of_the_library(work_folder: Path) -> None:
    """`cone` of the library under another name."""
    write_technique(
        """\
from basrelief.techniques import CONE_MAP, HeightField, Hit, Ray, Texture, technique
from basrelief.techniques.cone import Cones, cone


@technique(bake=CONE_MAP)
def mine(field: HeightField, baked: Texture, ray: Ray, settings: Cones) -> Hit:
    return cone(field, baked, ray, settings)
"""
    )
    wanted = drawn("cone", "--device", "cpu")
    assert (drawn("my.py:mine", "--device", "cpu") == wanted).all()
    assert not (drawn("flat", "--device", "cpu") == wanted).all()


def test_an_unknown_bake_is_refused(work_folder: Path) -> None:
    head = "from basrelief.techniques import *\nfrom basrelief.techniques import TECHNIQUES\n"
    by_name = '@technique(bake="cone_map")\ndef mine(field, baked, ray, settings): ...\n'
    write_technique(head + by_name)
    line = refused("render", "bumps", *DRAW, "--technique", "my.py:mine")
    assert re.search(r"my\.py:3: `@technique\(bake=\"cone_map\"\)`: .*as CONE_MAP of", line), line
    other = 'MINE = Bake("heaps", ())\nmine = technique(bake=MINE)(TECHNIQUES["cone"])\n'
    write_technique(head + other)
    line = refused("render", "bumps", *DRAW, "--technique", "my.py:mine")
    assert "no function runs the bake heaps" in line


def test_the_file_runs_once_and_no_bytecode_is_written(
    work_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    write_technique(SINK + "\nwith open('runs', 'a') as file:\n    file.write('x')\n")
    done("render", "bumps", *DRAW, "--technique", "my.py:sink", "-o", "a.png")
    assert Path("runs").read_text() == "x"
    assert sorted(os.listdir()) == ["a.png", "bumps", "my.py", "runs"]


def test_the_file_is_compiled_without_future_imports(work_folder: Path) -> None:
    """A `from __future__` of the library does not apply to it."""
    write_technique(SINK + "\ndef f(x: int) -> None: ...\nassert f.__annotations__['x'] is int\n")
    assert technique_from_file("my.py", "sink").name == "sink"


def test_a_change_is_seen_at_once(work_folder: Path) -> None:
    """Also a change that keeps the file's size and modification time."""
    write_technique(SINK)
    first = drawn("my.py:sink", "--device", "cpu")
    stat = Path("my.py").stat()
    write_technique(SINK.replace("1.0 - 0.25", "1.0 - 0.15"))
    os.utime("my.py", ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert technique_from_file("my.py", "sink").function.__code__.co_consts.count(0.15) == 1
    os.utime("my.py")
    assert not (first == drawn("my.py:sink", "--device", "cpu")).all()


def test_two_files_of_one_name(work_folder: Path) -> None:
    for folder, factor in (("one", "0.25"), ("two", "0.1")):
        Path(folder).mkdir()
        write_technique(SINK.replace("0.25", factor), f"{folder}/my.py")
    one, two = (technique_from_file(f"{folder}/my.py", "sink") for folder in ("one", "two"))
    material = basrelief.load("bumps")
    options = {"size": (9, 9), "samples": 1, "device": choose_device("cpu")}
    first, second = (basrelief.render(material, technique=t, **options).uv for t in (one, two))
    assert not (first == second).all()


# --- messages -------------------------------------------------------------------------------------


def refusal(text: str, name: str = "sink") -> str:
    """The error message for a file."""
    write_technique(text)
    line = refused("render", "bumps", *DRAW, "--technique", f"my.py:{name}", "--device", "cpu")
    assert sorted(os.listdir()) == ["bumps", "my.py"]
    return line


def test_a_missing_file(work_folder: Path) -> None:
    line = refused("render", "bumps", "--technique", "mine.py:sink")
    assert line.startswith("mine.py: there is no such file")
    assert "--technique takes FILE.py:NAME" in line
    Path("folder.py").mkdir()
    assert "there is no such file" in refused("render", "bumps", "--technique", "folder.py:sink")
    assert "FILE.py:NAME" in refused("render", "bumps", "--technique", "my.py")


@pytest.mark.parametrize("name", ["sunk", "", "a:b", "sink.function"])
def test_a_missing_name(name: str, work_folder: Path) -> None:
    if ":" not in name:
        assert refusal(SINK, name) == f"my.py: it has no {name}; mark a technique with @technique()"
    else:
        assert "there is no such file" in refusal(SINK, name)


def test_a_name_that_is_not_a_technique(work_folder: Path) -> None:
    wanted = "my.py: it does not mark sink; mark a technique with @technique()"
    assert refusal(SINK.replace("@technique(reference_height=1.0)\n", "")) == wanted
    assert refusal("sink = 3") == wanted
    assert refusal(SINK.replace("@technique(reference_height=1.0)", "@slot")) == wanted


def test_a_syntax_error(work_folder: Path) -> None:
    text = SINK.replace("height = 1.0 - 0.25", "height = 1.0 - - * 0.25")
    line = line_of(text, "height = 1.0")
    assert refusal(text) == (
        f"my.py:{line}: `height = 1.0 - - * 0.25 * float(settings.depth_steps)`: "
        "the file fails to run: SyntaxError: invalid syntax"
    )


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("x = 1\ny = x / 0\n", "my.py:2: `y = x / 0`: the file fails to run: ZeroDivisionError: "),
        ("import no_such\n", "my.py:1: `import no_such`: the file fails to run: ModuleNotFoundErr"),
        ("import sys\nsys.exit(3)\n", "my.py:2: `sys.exit(3)`: the file fails to run: SystemExit"),
        ("def f():\n    return nope\n\nf()\n", "my.py:2: `return nope`: the file fails to run: "),
        ("raise ValueError('a\\nb')", "the file fails to run: ValueError: a b"),
        ("x = '\0'", "my.py: the file fails to run: SyntaxError: source code string cannot cont"),
    ],
)
def test_a_file_that_fails(text: str, what: str, work_folder: Path) -> None:
    assert what in refusal(text)


def test_a_file_that_is_not_text(work_folder: Path) -> None:
    Path("my.py").write_bytes(b"x = '\xff\xfe'\n")
    line = refused("render", "bumps", "--technique", "my.py:sink")
    assert line.startswith("my.py")
    assert "the file fails to run: SyntaxError: " in line


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(field: HeightField, ray: Ray, settings: Sinking)", "(field: HeightField, ray: Ray)"),
        ("(field: HeightField, ray: Ray, settings", "(ray: Ray, field: HeightField, settings"),
        ("settings: Sinking) -> Hit", "settings: Sinking) -> float"),
    ],
)
def test_a_signature_that_does_not_fit(old: str, new: str, work_folder: Path) -> None:
    line = refusal(SINK.replace(old, new))
    assert re.match(rf"(/.*/)?my\.py:{line_of(SINK, 'def sink')}: sink\(", line)
    assert "does not fit the slot displace; its signature is (field: HeightField, baked:" in line


def test_a_parameter_without_a_type(work_folder: Path) -> None:
    line = refusal(SINK.replace("ray: Ray,", "ray,"))
    assert f"my.py:{line_of(SINK, 'def sink')}: the parameter ray of sink has no type" in line


def test_settings_that_are_not_a_record(work_folder: Path) -> None:
    line = refusal(SINK.replace("settings: Sinking", "settings: int"))
    assert f"my.py:{line_of(SINK, 'def sink')}: the settings of sink are no record; make" in line


@pytest.mark.parametrize(
    "body",
    [
        "heights = [0.5, 0.25]",
        "print(ray.uv)",
        "height = 1 / 2",
        "height = 'deep'",
        "height = 1.0 if ray.uv.x > 0.0 else 2",
        "import math",
    ],
)
def test_source_outside_the_subset(body: str, work_folder: Path) -> None:
    """The message has the file, the line, and carets under the offending text."""
    wanted = "height = 1.0 - 0.25 * float(settings.depth_steps)"
    text = SINK.replace(wanted, body)
    line, source, carets = refusal(text).splitlines()
    assert re.search(rf"my\.py:{line_of(text, body)}: .*[;,] ", line)
    assert source == f"    {body}"
    marked = source[carets.index("^") : len(carets)]
    assert marked in body
    assert set(carets.strip()) == {"^"}


@pytest.mark.parametrize(
    ("setting", "what"),
    [
        ("depth_steps=9", "depth_steps is 9: give a number from 0 to 4"),
        ("depth_steps=1.5", "depth_steps is a whole number, not 1.5"),
        ("max_steps=9", "--set max_steps: there is no such setting here; there are depth_steps,"),
    ],
)
def test_settings_are_checked(setting: str, what: str, work_folder: Path) -> None:
    write_technique(SINK)
    line = refused("render", "bumps", "--technique", "my.py:sink", "--set", setting)
    assert what in line


# --- the example of the documentation -------------------------------------------------------------


def test_the_example_of_the_documentation(work_folder: Path) -> None:
    """It runs as written; with one guess it equals `offset`."""
    text = PAGE.read_text()
    (example,) = re.findall(r"^```python\n([^`]*@technique.*?)^```$", text, re.M | re.S)
    write_technique(example)
    material = basrelief.load("bumps")
    options = {"size": (20, 14), "samples": 1, "device": choose_device("cpu")}
    for guesses in (1, 4):
        frame = basrelief.render(
            material, technique="my.py:guess", settings={"guesses": guesses}, **options
        )
        assert frame.reads[frame.hit].tolist() == [guesses] * int(frame.hit.sum())
        offset = basrelief.render(material, technique="offset", **options)
        assert (np.abs(frame.uv - offset.uv).max() < 1e-6) == (guesses == 1)
    assert "guess" not in TECHNIQUES
    with pytest.raises(BasreliefError, match="guesses is 17"):
        basrelief.render(material, technique="my.py:guess", settings={"guesses": 17}, **options)
    assert sys.modules["basrelief_own_my"].__file__ == "my.py"


# --- from Python ----------------------------------------------------------------------------------


def unmarked(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """A function without a decorator."""
    return Hit(ray.uv, 1.0, 0.0, True, 0)


@technique()
def without_settings(field: HeightField, ray: Ray) -> Hit:
    """A technique that lacks a parameter."""
    return Hit(ray.uv, 1.0, 0.0, True, 0)


@technique()
def without_bake(field: HeightField, baked: Texture, ray: Ray, settings: Nothing) -> Hit:
    """A technique that does not name the bake of its table."""
    return Hit(ray.uv, stored(baked, IVec2(0, 0)).x, 0.0, True, 0)


@pytest.mark.parametrize("use", ["render", "compare", "preset", "object"])
@pytest.mark.parametrize(
    ("value", "line"),
    [
        (unmarked, "unmarked is no technique; mark one with @technique()"),
        (3.5, "3.5 is no technique; mark one with @technique()"),
        (without_settings, "does not fit the slot displace; its signature is (field: HeightField,"),
        (without_bake, "without_bake takes a table; name it, as in @technique(bake=CONE_MAP)"),
    ],
)
def test_what_is_no_technique_is_refused(use: str, value: Any, line: str) -> None:
    material = basrelief.sample("bricks", 16)
    calls = {
        "render": lambda: basrelief.render(material, technique=value, size=(8, 8)),
        "compare": lambda: basrelief.compare(material, techniques=[value]),
        "preset": lambda: basrelief.render(
            material, preset="gamedev", technique=value, size=(8, 8)
        ),
        "object": lambda: basrelief.Object(material, technique=value),
    }
    with pytest.raises(BasreliefError) as caught:
        calls[use]()
    assert line in str(caught.value)
    message = str(caught.value).removesuffix(caught.value.excerpt).rstrip()
    assert "\n" not in message
