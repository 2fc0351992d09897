"""`compare` and `tune` with a preset: what they take from it, and what they print."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

import basrelief
from basrelief.cli import arguments
from basrelief.measure.compare import candidates
from basrelief.measure.errors import errors
from basrelief.measure.truth import truth
from basrelief.measure.views import at_angle
from basrelief.scene.presets import preset
from helpers.command_line import done, refused, write_heights

MINE = """
[object]
shape = "box"
tiling = [2, 2]
edge = "clamp"
scale = 0.2
technique = "relief"

[object.settings]
min_steps = 6
max_steps = 7

[object.tilings.base_color]
tiles = [4, 2]

[scene.camera]
azimuth = 10
"""


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_heights(tmp_path / "wall")
    (tmp_path / "mine.toml").write_text(MINE)


def printed(output: str) -> list[str]:
    (line,) = (line for line in output.splitlines() if line.startswith("basrelief render "))
    return shlex.split(line)


def test_compare_measures_the_settings_of_a_preset() -> None:
    out = done(
        "compare", "wall", "--preset", "mine.toml", "--technique", "relief", "--angles", "60",
        "--size", "32x24", "--samples", "1", "--device", "cpu", "-o", "out",
    )  # fmt: skip
    (relief,) = (
        each for each in json.loads(Path("out/compare.json").read_text())["techniques"]
        if each["name"] == "relief"
    )  # fmt: skip
    assert (relief["settings"]["min_steps"], relief["settings"]["max_steps"]) == (6, 7)
    # the printed command draws the preset's shape, tilings and camera
    command = " ".join(printed(out))
    for option in (
        "--shape box", "--tiling 2x2", "--edge clamp", "--map-tiling base_color=4x2",
        "--camera azimuth=10",
    ):  # fmt: skip
        assert option in command


def test_tune_keeps_what_a_preset_says_of_the_picture() -> None:
    out = done(
        "tune", "wall", "--preset", "mine.toml", "--technique", "steep", "--missed", "90%",
        "--angles", "60-60", "--size", "32x24", "--device", "cpu", "-o", "tuned.toml",
    )  # fmt: skip
    assert "--shape box" in " ".join(printed(out))
    values = preset("tuned.toml").values["object"]
    assert (values["shape"], values["edge"], tuple(values["tiling"])) == ("box", "clamp", (2, 2))
    assert tuple(values["tilings"]["base_color"]["tiles"]) == (4, 2)


def test_heights_of_a_preset_that_a_technique_does_not_read_are_left_out() -> None:
    out = done(
        "compare", "wall", "--preset", "gamedev", "--technique", "steep", "--angles", "60",
        "--size", "32x24", "--samples", "1", "--device", "cpu", "-o", "out",
    )  # fmt: skip
    commands = {
        each["name"]: each["command"]
        for each in json.loads(Path("out/compare.json").read_text())["techniques"]
    }
    assert "--heights smooth" in commands["steep"]
    assert "--heights" not in commands["exact"]
    assert "basrelief render wall" in out


def test_tilings_of_single_maps_keep_their_proportion_to_the_heights() -> None:
    own = {"normal": basrelief.Tiling((2.0, 0.5))}
    scene = at_angle(basrelief.load("wall"), 60.0, (32, 24), {"tilings": own})
    (obj,) = scene.resolved
    assert obj.tilings["normal"].tiles == (2 * obj.tiling.tiles[0], obj.tiling.tiles[1] / 2)


def test_a_file_in_place_of_the_folder_is_refused_before_measuring() -> None:
    Path("out").write_text("mine")
    line = refused("compare", "wall", "-o", "out")
    assert "out: is a file" in line


SHAPE_UNIT = """
[object]
lengths = "shape"
tiling = [4, 2]
technique = "offset"
scale = 0.05

[object.settings]
max_offset = 0.01
"""
QUICK = ("--angles", "60-60", "--size", "32x24", "--device", "cpu")


def test_measurements_keep_the_lengths_of_a_preset_in_its_unit() -> None:
    """Lengths of a shape with 4 × 2 tiles, the preset's and explicit ones, in tiles."""
    Path("shape.toml").write_text(SHAPE_UNIT)
    material = basrelief.load("wall")
    for options, scale, settings, own in (
        ({}, 0.2, (0.04, 0.5), None),
        ({"scale": 0.1}, 0.4, (0.04, 0.5), None),
        ({"settings": ["max_offset=0.02"]}, 0.2, (0.08, 0.5), None),
        ({"settings": ["max_offset_ratio=3"]}, 0.2, (0.04, 1.5), None),
        ({"techniques": ["offset,max_offset=0.03"]}, 0.2, (0.04, 0.5), (0.12, 0.5)),
        ({"techniques": ["relief,search_steps=3", "offset"]}, 0.2, (0.04, 0.5), None),
    ):
        read = arguments.measured_options(
            material, **{"techniques": None, "settings": [], **options}, preset=preset("shape.toml")
        )
        assert read.measured["scale"] == pytest.approx(scale)
        assert read.drawn["scale"] == pytest.approx(scale)
        measured = {**read.preset_settings, **read.settings}
        assert (measured["max_offset"], measured["max_offset_ratio"]) == pytest.approx(settings)
        offset = next(
            c for c in candidates(read.techniques, measured) if c.technique.name == "offset"
        )
        found = offset.settings["max_offset"], offset.settings["max_offset_ratio"]
        assert found == pytest.approx(own or settings)


def test_what_measurements_print_draws_the_same_relief() -> None:
    """The printed commands and the written preset have lengths of tiles."""
    Path("shape.toml").write_text(SHAPE_UNIT)
    out = done(
        "compare", "wall", "--preset", "shape.toml", "--technique", "offset,max_offset=0.03",
        "--scale", "0.1", "--samples", "1", *QUICK[2:], "--angles", "60", "-o", "out",
    )  # fmt: skip
    (offset,) = (
        each for each in json.loads(Path("out/compare.json").read_text())["techniques"]
        if each["technique"] == "offset"
    )  # fmt: skip
    assert "--scale 0.4 " in offset["command"]
    assert "--set max_offset=0.12 --set max_offset_ratio=0.5" in offset["command"]
    assert "basrelief render wall" in out
    done(
        "tune", "wall", "--preset", "shape.toml", "--technique", "offset", "--missed", "100%",
        "--set", "max_offset=0.02", *QUICK, "-o", "tuned.toml",
    )  # fmt: skip
    (obj,) = preset("tuned.toml").scene(basrelief.load("wall")).resolved
    assert (obj.scale, *obj.tiling.tiles) == pytest.approx((0.2, 4.0, 2.0))
    numbers = obj.settings.max_offset, obj.settings.max_offset_ratio
    assert numbers == pytest.approx((0.08, 0.5))


def test_measurements_are_of_the_hole() -> None:
    opened = ("--opening", "0.8", "--dust", "sample:noise")
    options = ("--technique", "relief", "--device", "cpu")
    out = done(
        "compare", "wall", *options, *opened, "--angles", "60", "--size", "32x24", "--samples", "1",
        "-o", "out",
    )  # fmt: skip
    assert set(opened) <= set(printed(out))
    hole = basrelief.Object(basrelief.load("wall", dust="sample:noise"), opening=0.8)
    assert printed(out)[printed(out).index("--opening") + 1] == "0.8"
    results = json.loads(Path("out/compare.json").read_text())["results"]
    (measured,) = (each for each in results if each["technique"] == "relief")
    scene = at_angle(hole.material, 60.0, (32, 24), {"technique": "relief", "opening": 0.8})
    found = errors(
        basrelief.render(scene, size=(32, 24), samples=1, device="cpu"),
        truth(scene, (32, 24), device="cpu"),
    )
    assert (measured["reads"], measured["missed"]) == (found.reads, found.missed)
    done("tune", "wall", *options, *opened, "--missed", "100%", "--angles", "60", "--size", "32x24",
         "-o", "tuned.toml")  # fmt: skip
    again = preset("tuned.toml")
    (obj,) = again.scene(basrelief.load("wall", **again.maps)).resolved
    expected = hole.resolved.material.height
    assert obj.material.height is not None
    assert expected is not None
    assert (obj.material.height.pixels == expected.pixels).all()


def test_bakes_take_the_scale_of_a_preset_in_its_unit() -> None:
    Path("shape.toml").write_text(SHAPE_UNIT)
    for explicit, scale in ((), "0.2"), (("--scale", "0.1"), "0.4"):
        out = done("bake", "wall", "normal", "--preset", "shape.toml", *explicit, "--device", "cpu",
                   "--overwrite")  # fmt: skip
        assert f"scale {scale}: height range as a fraction of the map's width" in out
