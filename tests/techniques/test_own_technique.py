"""A technique of a user's own, from a file: it works like any other, and tells what is wrong."""

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
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a material in `bumps`, where commands run."""
    monkeypatch.chdir(tmp_path)
    write_heights(tmp_path / "bumps")
    return tmp_path


def own(text: str, name: str = "my.py") -> None:
    Path(name).write_text(text)


def drawn(technique: str, *arguments: str) -> np.ndarray:
    done("render", "bumps", *DRAW, "--technique", technique, *arguments, "-o", "a.tif")
    return read_picture("a.tif").pixels


def line_of(text: str, part: str) -> int:
    """The number of the line that has some text, from 1 on."""
    return next(n for n, line in enumerate(text.splitlines(), 1) if part in line)


# --- it works -------------------------------------------------------------------------------------


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_it_draws_and_its_settings_turn_it(device: str, here: Path) -> None:
    own(SINK)
    flat = drawn("flat", "--device", "cpu")
    pictures = [
        drawn("my.py:sink", "--device", device, "--set", f"depth_steps={n}") for n in range(3)
    ]
    # at the level itself the ray goes nowhere
    assert np.abs(pictures[0] - flat).max() < 1e-3
    assert np.abs(pictures[2] - drawn("my.py:sink", "--device", device)).max() == 0.0
    assert not (pictures[1] == pictures[2]).all()
    assert done("render", "bumps", *DRAW, "--technique", "my.py:sink").startswith(
        "bumps-sink-basrelief.png"
    )


def test_where_it_ends_is_known(here: Path) -> None:
    """Half the range down: the uv are moved by half the ray's fall, for each pixel."""
    own(SINK)
    material = basrelief.load("bumps")
    ortho = basrelief.Orbit(0.0, 45.0, orthographic_height=1.0)
    options = {"scale": 0.2, "camera": ortho, "size": (9, 9), "device": choose_device("cpu")}
    flat = basrelief.render(material, technique="flat", **options)
    sunk = basrelief.render(material, technique="my.py:sink", **options)
    moved = (sunk.uv - flat.uv)[4, 4]
    # seen at 45 degrees along the rows; a tile is as high as 6/8 of its width
    assert moved == pytest.approx([0.0, -0.5 * 0.2 / (6 / 8)], abs=1e-5)


def test_it_is_called_as_the_plain_function_that_it_is(here: Path) -> None:
    own(SINK)
    sink = technique_from_file("my.py", "sink")
    assert sink.reference_height == 1.0
    assert sink.settings().depth_steps == 2
    ray = flat_ray((0.5, 0.5), (0.25, 0.5), cosine=0.7)
    hit = sink(HeightField([np.zeros((1, 1), np.float32)]), ray, sink.settings())
    assert hit == Hit(Vec2(0.625, 0.75), 0.5, 0.5, True, 0)


def test_a_plain_shader_will_do(here: Path) -> None:
    own(SINK.replace("@technique(reference_height=1.0)", "@shader"))
    marked = drawn("my.py:sink", "--device", "cpu")
    own(SINK, "other.py")
    assert (marked == drawn("other.py:sink", "--device", "cpu")).all()


def test_it_reads_what_the_library_bakes(here: Path) -> None:
    """A march by cones of one's own: the library's, under another name."""
    own(
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


def test_a_bake_that_there_is_not_is_told(here: Path) -> None:
    head = "from basrelief.techniques import *\nfrom basrelief.techniques import TECHNIQUES\n"
    by_name = '@technique(bake="cone_map")\ndef mine(field, baked, ray, settings): ...\n'
    own(head + by_name)
    line = refused("render", "bumps", *DRAW, "--technique", "my.py:mine")
    assert re.search(r"my\.py:3: `@technique\(bake=\"cone_map\"\)`: .*as CONE_MAP of", line), line
    other = 'MINE = Bake("heaps", ())\nmine = technique(bake=MINE)(TECHNIQUES["cone"])\n'
    own(head + other)
    line = refused("render", "bumps", *DRAW, "--technique", "my.py:mine")
    assert "no function runs the bake heaps" in line


def test_it_runs_once_and_leaves_nothing_beside_it(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    own(SINK + "\nwith open('runs', 'a') as file:\n    file.write('x')\n")
    done("render", "bumps", *DRAW, "--technique", "my.py:sink", "-o", "a.png")
    assert Path("runs").read_text() == "x"
    assert sorted(os.listdir()) == ["a.png", "bumps", "my.py", "runs"]


def test_the_file_means_what_it_means_elsewhere(here: Path) -> None:
    """No `from __future__` but its own holds in it."""
    own(SINK + "\ndef f(x: int) -> None: ...\nassert f.__annotations__['x'] is int\n")
    assert technique_from_file("my.py", "sink").name == "sink"


def test_a_change_is_seen_at_once(here: Path) -> None:
    """Also one that keeps the size of the file, and its time as far as file systems tell."""
    own(SINK)
    first = drawn("my.py:sink", "--device", "cpu")
    stat = Path("my.py").stat()
    own(SINK.replace("1.0 - 0.25", "1.0 - 0.15"))
    os.utime("my.py", ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert technique_from_file("my.py", "sink").function.__code__.co_consts.count(0.15) == 1
    os.utime("my.py")
    assert not (first == drawn("my.py:sink", "--device", "cpu")).all()


def test_two_files_of_one_name(here: Path) -> None:
    for folder, factor in (("one", "0.25"), ("two", "0.1")):
        Path(folder).mkdir()
        own(SINK.replace("0.25", factor), f"{folder}/my.py")
    one, two = (technique_from_file(f"{folder}/my.py", "sink") for folder in ("one", "two"))
    material = basrelief.load("bumps")
    options = {"size": (9, 9), "samples": 1, "device": choose_device("cpu")}
    first, second = (basrelief.render(material, technique=t, **options).uv for t in (one, two))
    assert not (first == second).all()


# --- it tells what is wrong -----------------------------------------------------------------------


def told(text: str, name: str = "sink") -> str:
    """The line with which a file is refused."""
    own(text)
    line = refused("render", "bumps", *DRAW, "--technique", f"my.py:{name}", "--device", "cpu")
    assert sorted(os.listdir()) == ["bumps", "my.py"]
    return line


def test_no_file(here: Path) -> None:
    line = refused("render", "bumps", "--technique", "mine.py:sink")
    assert line == "mine.py: there is no such file; --technique takes FILE.py:NAME"
    Path("folder.py").mkdir()
    assert "there is no such file" in refused("render", "bumps", "--technique", "folder.py:sink")
    assert "FILE.py:NAME" in refused("render", "bumps", "--technique", "my.py")


@pytest.mark.parametrize("name", ["sunk", "", "a:b", "sink.function"])
def test_no_such_name(name: str, here: Path) -> None:
    if ":" not in name:
        assert told(SINK, name) == f"my.py: it has no {name}; mark a technique with @technique()"
    else:
        assert "there is no such file" in told(SINK, name)


def test_no_technique(here: Path) -> None:
    wanted = "my.py: it does not mark sink; mark a technique with @technique()"
    assert told(SINK.replace("@technique(reference_height=1.0)\n", "")) == wanted
    assert told("sink = 3") == wanted
    assert told(SINK.replace("@technique(reference_height=1.0)", "@slot")) == wanted


def test_a_syntax_error(here: Path) -> None:
    text = SINK.replace("height = 1.0 - 0.25", "height = 1.0 - - * 0.25")
    line = line_of(text, "height = 1.0")
    assert told(text) == (
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
def test_a_file_that_fails(text: str, what: str, here: Path) -> None:
    assert what in told(text)


def test_a_file_that_is_no_text(here: Path) -> None:
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
def test_a_signature_that_does_not_fit(old: str, new: str, here: Path) -> None:
    line = told(SINK.replace(old, new))
    assert re.match(rf"(/.*/)?my\.py:{line_of(SINK, 'def sink')}: sink\(", line)
    assert "does not fit the slot displace; its signature is (field: HeightField, baked:" in line


def test_a_parameter_without_a_type(here: Path) -> None:
    line = told(SINK.replace("ray: Ray,", "ray,"))
    assert f"my.py:{line_of(SINK, 'def sink')}: the parameter ray of sink has no type" in line


def test_settings_that_are_no_record(here: Path) -> None:
    line = told(SINK.replace("settings: Sinking", "settings: int"))
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
def test_what_is_outside_the_subset(body: str, here: Path) -> None:
    """File, line, and carets under the text in the source line."""
    wanted = "height = 1.0 - 0.25 * float(settings.depth_steps)"
    text = SINK.replace(wanted, body)
    line, source, carets = told(text).splitlines()
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
def test_its_settings_are_checked(setting: str, what: str, here: Path) -> None:
    own(SINK)
    line = refused("render", "bumps", "--technique", "my.py:sink", "--set", setting)
    assert what in line


# --- the documentation's --------------------------------------------------------------------------


def test_the_example_of_the_documentation(here: Path) -> None:
    """It runs as it is written there, and one guess is the technique `offset`."""
    text = PAGE.read_text()
    (example,) = re.findall(r"^```python\n([^`]*@technique.*?)^```$", text, re.M | re.S)
    own(example)
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


def plain(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """No mark."""
    return Hit(ray.uv, 1.0, 0.0, True, 0)


@technique()
def without_settings(field: HeightField, ray: Ray) -> Hit:
    """One parameter too few."""
    return Hit(ray.uv, 1.0, 0.0, True, 0)


@technique()
def without_bake(field: HeightField, baked: Texture, ray: Ray, settings: Nothing) -> Hit:
    """Of which table?"""
    return Hit(ray.uv, stored(baked, IVec2(0, 0)).x, 0.0, True, 0)


@pytest.mark.parametrize("use", ["render", "compare", "preset", "object"])
@pytest.mark.parametrize(
    ("given", "line"),
    [
        (plain, "plain is no technique; mark one with @technique()"),
        (3.5, "3.5 is no technique; mark one with @technique()"),
        (without_settings, "does not fit the slot displace; its signature is (field: HeightField,"),
        (without_bake, "without_bake takes a table; name it, as in @technique(bake=CONE_MAP)"),
    ],
)
def test_what_is_no_technique_is_refused(use: str, given: Any, line: str) -> None:
    material = basrelief.sample("bricks", 16)
    calls = {
        "render": lambda: basrelief.render(material, technique=given, size=(8, 8)),
        "compare": lambda: basrelief.compare(material, techniques=[given]),
        "preset": lambda: basrelief.render(
            material, preset="gamedev", technique=given, size=(8, 8)
        ),
        "object": lambda: basrelief.Object(material, technique=given),
    }
    with pytest.raises(BasreliefError) as caught:
        calls[use]()
    assert line in str(caught.value)
    message = str(caught.value).removesuffix(caught.value.excerpt).rstrip()
    assert "\n" not in message
