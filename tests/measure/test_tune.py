"""`tune` on maps whose result is known by a formula."""

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


def texels_late(steps: int, height: float) -> float:
    """Texels by which `steep` ends behind level ground, seen at 60 degrees; < 0: before it."""
    layers = [1 - k / steps for k in range(steps)]
    layer = next((top for top in layers if top <= height), layers[-1])
    return (height - layer) * 0.5 * math.tan(math.radians(60.0)) * TEXELS


@pytest.mark.parametrize("height", [0.37, 0.61, 0.12])
def test_the_fewest_steps_within_a_texel_are_found(height) -> None:
    """B5: the search ends where, by the formula, one step less fails."""
    result = tune(level_ground(height), missed=0.0, techniques=["steep"], **SMALL)
    steps = int(result.settings["steps"])
    assert abs(texels_late(steps, height)) <= 1.0 < abs(texels_late(steps - 1, height))
    assert result.chosen.error == 0.0
    assert result.chosen.passed


def test_the_cheapest_technique_that_passes_is_chosen() -> None:
    """B5: on level ground one read is exact and much cheaper than a hundred; `flat` fails."""
    deep = {**SMALL, "size": (192, 128), "settings": {"steps": 400}}
    ground = level_ground(0.004, 256)
    result = tune(ground, missed=0.001, techniques=["steep", "offset", "flat"], **deep)
    assert result.chosen.candidate.name == "offset"
    (steep,) = result.others
    assert steep.candidate.name == "steep"
    # enough steps to be slower also on a busy machine
    assert steep.candidate.settings["steps"] >= 100
    assert result.nearest is None or result.nearest.candidate.name == "flat"


@pytest.mark.gpu
def test_the_filter_of_the_heights_is_kept() -> None:
    """In the report, the command and the preset."""
    ground = level_ground(0.37)
    options = {**SMALL, "device": "gpu", "techniques": ["steep"], "missed": 0.0}
    result = tune(ground, filter="hardware", **options)
    assert result.settings == tune(ground, **options).settings
    assert (result.filter, result.filtered_format) == ("hardware", "r32float")
    assert result.report().endswith(
        "Heights are filtered by the graphics card (r32float), except by exact, which reads texels."
    )
    assert "--filter hardware" in result.command
    assert result.preset.values["object"]["filter"] == "hardware"


def test_the_bound_holds_over_a_range_of_angles() -> None:
    """B5: settings for 30 degrees fail at 75, and the report has the worst angle."""
    ground = Material("waves", height=map_of(noise(7, (32, 32), 1)))
    results = [
        tune(ground, missed=0.02, techniques=["steep"], **{**SMALL, "angles": angles})
        for angles in ((0.0, 30.0), (0.0, 75.0))
    ]
    assert results[0].settings["steps"] < results[1].settings["steps"]
    assert results[1].angles == (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
    assert results[1].chosen.error <= 0.02
    assert "just missed" in results[1].report() or "nothing cheaper" in results[1].report()


def test_other_numbers_and_minima_follow_the_effort() -> None:
    """The minimum of steps keeps its ratio to the maximum; other search steps are tried too."""
    ground = Material("waves", height=map_of(noise(7, (32, 32), 1)))
    result = tune(ground, missed=0.05, techniques=["relief"], **SMALL)
    assert result.settings["min_steps"] == max(1, round(result.settings["max_steps"] / 4))
    trials = {result.chosen, *result.others}
    assert {trial.candidate.settings.get("search_steps") for trial in trials} == {None, 2, 10}
    efforts = {"flat": None, "steep": "steps", "relief": "max_steps", "exact": None}
    assert {name: effort(TECHNIQUES[name], {}) for name in efforts} == efforts


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


def test_every_result_is_measured_itself() -> None:
    """B5: where errors do not fall with effort, the result itself was measured to pass."""
    result = tune(level_ground(0.3), missed=0.0, techniques=[lucky], **SMALL)
    assert result.settings == {"tries": 4}
    assert result.chosen.error == 0.0


def test_flip_can_be_the_bound(monkeypatch) -> None:
    ground = Material(
        "waves", base_color=map_of(noise(3, (32, 32))), height=map_of(noise(7, (32, 32), 1))
    )
    result = tune(ground, flip=0.05, techniques=["parallax_occlusion"], **SMALL)
    assert result.chosen.error <= 0.05
    assert result.measure == "flip"
    assert "FLIP" in result.report()
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    with pytest.raises(InputError, match="flip-evaluator"):
        tune(ground, flip=0.05, **SMALL)


def test_techniques_without_settings_and_with_fixed_settings(tmp_path) -> None:
    """The result can be saved and drawn again, with the settings that were fixed."""
    ground = level_ground(0.3)
    result = tune(ground, missed=1.0, techniques=["flat"], **SMALL)
    assert (
        basrelief.preset(result.preset.save(tmp_path / "a.toml")).values["object"]["scale"] == 0.5
    )
    fixed = {"settings": {"step_length": 0.03}, "bias": 0.1, "projection": "biased"}
    result = tune(ground, missed=1.0, techniques=["fixed_length"], **SMALL, **fixed)
    assert result.settings["step_length"] == 0.03
    assert "--set step_length=0.03 --scale 0.5 --projection biased --bias 0.1" in result.command
    values = basrelief.preset(result.preset.save(tmp_path / "b.toml")).values["object"]
    assert (values["bias"], values["projection"]) == (0.1, "biased")
    assert values["settings"]["step_length"] == 0.03


def test_impossible_requests_are_refused() -> None:
    ground = level_ground(0.3)
    with pytest.raises(InputError, match=r"nothing stays under 0 .* the closest is flat"):
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
        "0.1", "--reference-height", "0.5", "-o", preset, *small,
    )  # fmt: skip
    (line,) = [row for row in out.splitlines() if row.startswith("basrelief render ")]
    saved = basrelief.preset(preset)
    steps = saved.values["object"]["settings"]["steps"]
    assert saved.values["object"]["technique"] == "steep"
    assert f"--set steps={steps}" in line
    assert "--reference-height 0.5" in line
    arguments = shlex.split(line)[1:]
    done(*arguments, "-o", tmp_path / "a.png", *small)
    done("render", folder, "--preset", preset, "-o", tmp_path / "b.png", *small)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert "write 0% to 100%" in refused("tune", folder, "--missed", "130%")
    assert "smaller number first" in refused("tune", folder, "--missed", "1%", "--angles", "60-0")
    assert "give one bound" in refused("tune", folder)
