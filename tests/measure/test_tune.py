"""`tune` on maps where the answer is known by a formula."""

from __future__ import annotations

import math
import shlex
import sys

import numpy as np
import pytest

import basrelief
from basrelief.errors import InputError
from basrelief.lang import HeightField, setting, struct
from basrelief.material import Material
from basrelief.measure.tune import effort, tune
from basrelief.techniques import TECHNIQUES, Hit, Ray, height_under, hit_at, t_at, technique
from helpers.command_line import done, refused, write_heights
from helpers.synthetic import map_of, noise

SMALL = {"size": (24, 14), "device": "cpu", "scale": 0.5, "angles": (60.0, 60.0)}
TEXELS = 16


def level_ground(height: float, texels: int = TEXELS) -> Material:
    return Material("ground", height=map_of(np.full((texels, texels), height)))


def late(steps: int, height: float) -> float:
    """How many texels `steep` ends behind level ground, seen from 60 degrees; < 0: before it."""
    layers = [1 - k / steps for k in range(steps)]
    layer = next((each for each in layers if each <= height), layers[-1])
    return (height - layer) * 0.5 * math.tan(math.radians(60.0)) * TEXELS


@pytest.mark.parametrize("height", [0.37, 0.61, 0.12])
def test_the_least_steps_that_stay_within_a_texel(height) -> None:
    """B5: doubling and halving end where the formula says that one step less fails."""
    found = tune(level_ground(height), missed=0.0, techniques=["steep"], **SMALL)
    steps = int(found.settings["steps"])
    assert abs(late(steps, height)) <= 1.0 < abs(late(steps - 1, height))
    assert found.chosen.error == 0.0
    assert found.chosen.passed


def test_the_cheapest_is_taken_and_what_fails_is_not() -> None:
    """B5: on level ground one read is exact, and much cheaper than a hundred; none is not."""
    deep = {**SMALL, "size": (192, 128), "settings": {"steps": 400}}
    ground = level_ground(0.004, 256)
    found = tune(ground, missed=0.001, techniques=["steep", "offset", "flat"], **deep)
    assert found.chosen.candidate.name == "offset"
    (steep,) = found.others
    assert steep.candidate.name == "steep"
    # enough of them that a busy machine does not take them for cheap
    assert steep.candidate.settings["steps"] >= 100
    assert found.nearest is None or found.nearest.candidate.name == "flat"


def test_a_range_of_angles_is_held_all_through() -> None:
    """B5: what is enough at 30 degrees is not at 75, and the worst is told."""
    ground = Material("waves", height=map_of(noise(7, (32, 32), 1)))
    many = [
        tune(ground, missed=0.02, techniques=["steep"], **{**SMALL, "angles": angles})
        for angles in ((0.0, 30.0), (0.0, 75.0))
    ]
    assert many[0].settings["steps"] < many[1].settings["steps"]
    assert many[1].angles == (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
    assert many[1].chosen.error <= 0.02
    assert "just missed" in many[1].report() or "nothing cheaper" in many[1].report()


def test_lesser_numbers_and_partners_go_with_the_effort() -> None:
    """The least number of steps keeps its share; halvings are tried at other counts too."""
    ground = Material("waves", height=map_of(noise(7, (32, 32), 1)))
    found = tune(ground, missed=0.05, techniques=["relief"], **SMALL)
    assert found.settings["min_steps"] == max(1, round(found.settings["max_steps"] / 4))
    tried = {found.chosen, *found.others}
    assert {each.candidate.settings.get("search_steps") for each in tried} == {None, 2, 10}
    rotated = {"flat": None, "steep": "steps", "relief": "max_steps", "exact": None}
    assert {name: effort(TECHNIQUES[name], {}) for name in rotated} == rotated


@struct
class Luck:
    """Settings of a technique that is right by chance."""

    tries: int = setting(default=8, doc="odd numbers alone are right", low=1, high=64)


@technique()
def lucky(field: HeightField, ray: Ray, settings: Luck) -> Hit:
    """Right on level ground for 6 and for 4 tries, and for no other number."""
    height = height_under(field, ray, 0.0)
    right = settings.tries == 6 or settings.tries == 4
    reached = height if right else 1.0
    return hit_at(ray, t_at(ray, reached), True, 1)


def test_nothing_is_concluded_from_neighbours() -> None:
    """B5: where errors do not fall with effort, what is returned still passed by itself."""
    found = tune(level_ground(0.3), missed=0.0, techniques=[lucky], **SMALL)
    assert found.settings == {"tries": 4}
    assert found.chosen.error == 0.0


def test_flip_can_be_the_bound(monkeypatch) -> None:
    ground = Material(
        "waves", base_color=map_of(noise(3, (32, 32))), height=map_of(noise(7, (32, 32), 1))
    )
    found = tune(ground, flip=0.05, techniques=["parallax_occlusion"], **SMALL)
    assert found.chosen.error <= 0.05
    assert found.measure == "flip"
    assert "FLIP" in found.report()
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    with pytest.raises(InputError, match="flip-evaluator"):
        tune(ground, flip=0.05, **SMALL)


def test_a_technique_without_settings_and_numbers_that_stay(tmp_path) -> None:
    """What is chosen can be written and drawn again, with the numbers as they were given."""
    ground = level_ground(0.3)
    found = tune(ground, missed=1.0, techniques=["flat"], **SMALL)
    assert basrelief.preset(found.preset.save(tmp_path / "a.toml")).values["object"]["scale"] == 0.5
    kept = {"settings": {"step_length": 0.03}, "bias": 0.1, "projection": "biased"}
    found = tune(ground, missed=1.0, techniques=["fixed_length"], **SMALL, **kept)
    assert found.settings["step_length"] == 0.03
    assert "--set step_length=0.03 --set bias=0.1" in found.command
    read = basrelief.preset(found.preset.save(tmp_path / "b.toml")).values["object"]
    assert (read["bias"], read["projection"]) == (0.1, "biased")
    assert read["settings"]["step_length"] == 0.03


def test_what_cannot_be() -> None:
    ground = level_ground(0.3)
    with pytest.raises(InputError, match=r"nothing stays under 0 .* the nearest is flat"):
        tune(ground, missed=0.0, techniques=["flat"], **SMALL)
    with pytest.raises(InputError, match="give one bound"):
        tune(ground, missed=0.1, flip=0.1)
    with pytest.raises(InputError, match="give one bound"):
        tune(ground)
    with pytest.raises(InputError, match="a bound of 3"):
        tune(ground, missed=3.0)
    with pytest.raises(InputError, match="give the smaller first"):
        tune(ground, missed=0.1, angles=(50.0, 10.0))


def test_tune_on_the_command_line(tmp_path) -> None:
    """B5: it prints a command line that works, and writes a preset that draws the same."""
    folder, preset = write_heights(tmp_path / "two words"), tmp_path / "mine.toml"
    small = ["--size", "24x14", "--device", "cpu"]
    out = done(
        "tune", folder, "--missed", "5%", "--angles", "0-60", "--technique", "steep", "--scale",
        "0.1", "-o", preset, *small,
    )  # fmt: skip
    (line,) = [each for each in out.splitlines() if each.startswith("basrelief render ")]
    made = basrelief.preset(preset)
    steps = made.values["object"]["settings"]["steps"]
    assert made.values["object"]["technique"] == "steep"
    assert f"--set steps={steps}" in line
    arguments = shlex.split(line)[1:]
    done(*arguments, "-o", tmp_path / "a.png", *small)
    done("render", folder, "--preset", preset, "-o", tmp_path / "b.png", *small)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert "write 0% to 100%" in refused("tune", folder, "--missed", "130%")
    assert "smaller number first" in refused("tune", folder, "--missed", "1%", "--angles", "60-0")
    assert "give one bound" in refused("tune", folder)
