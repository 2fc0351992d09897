"""Old names of options, settings, preset keys and Python names: refused, with the new name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import basrelief
import basrelief.viewer
from basrelief.errors import RENAMED
from helpers.command_line import refused
from helpers.repository import REPOSITORY

COMMANDS = ("render", "compare", "tune", "bake", "demo", "view", "gallery")
OLD, NEW = "most_reads", "max_steps"


@pytest.fixture
def setting_renamed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pretend that a setting was renamed."""
    monkeypatch.setitem(RENAMED, OLD, NEW)


# --- the command line -----------------------------------------------------------------------------


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("option", [("--engine", "gpu"), ("--engine=gpu",)])
def test_an_old_option_is_refused_with_the_new_one(command: str, option: tuple[str, ...]) -> None:
    assert "--engine is now --device" in refused(command, "sample:bricks", *option)


@pytest.mark.parametrize(
    ("old", "new"), [("--fog", "--fog-mode"), ("--level", "--reference-height")]
)
def test_an_old_option_of_the_scene_is_refused_with_the_new_one(old: str, new: str) -> None:
    assert f"{old} is now {new}" in refused("render", "sample:bricks", old, "0.5")


def test_no_hint_where_a_command_has_no_such_option() -> None:
    line = refused("info", "sample:bricks", "--engine", "gpu")
    assert "No such option: --engine" in line
    assert "--device" not in line


@pytest.mark.usefixtures("setting_renamed")
def test_an_old_setting_is_refused_with_the_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in (
        ("render", "sample:bricks", "--set", f"{OLD}=9"),
        ("compare", "sample:bricks", "--set", f"{OLD}=9"),
        ("compare", "sample:bricks", "--technique", f"relief,{OLD}=9"),
    ):
        assert f"{OLD} is now {NEW}" in refused(*command)
    # offset has no setting of the new name
    line = refused("render", "sample:bricks", "--technique", "offset", "--set", f"{OLD}=9")
    assert "is now" not in line


def test_an_old_name_within_an_option_is_refused_with_the_new_one(tmp_path: Path) -> None:
    line = refused("render", "sample:bricks", "--add", "box,level=0.5")
    assert "level is now reference_height" in line


# --- presets --------------------------------------------------------------------------------------


@pytest.mark.usefixtures("setting_renamed")
@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("[object]\nlevel = 0.5", "object has no key 'level'; level is now reference_height"),
        ("[object.finish]\nroughness = 1", "finish is now surface_parameters"),
        ("[scene.air]\nfog_end = 3", "air is now fog"),
        ("[scene]\nshadow_map = 256", "shadow_map is now shadow_map_size"),
        ("[scene]\nfog = 'linear'", "write fog_mode = 'linear'"),
        (f"[object.settings]\n{OLD} = 9", f"{OLD} is now {NEW}"),
    ],
)
def test_an_old_preset_key_is_refused_with_the_new_one(
    text: str, hint: str, tmp_path: Path
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    line = refused("render", "sample:bricks", "--preset", path)
    assert line.startswith(f"{path}: ")
    assert hint in line


def test_no_hint_at_a_key_that_presets_do_not_have(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("[object]\nengine = 'cpu'")
    line = refused("render", "sample:bricks", "--preset", path)
    assert "object has no key 'engine'" in line
    assert "device" not in line


# --- Python ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["choose_engine", "EngineError", "Finish", "turned", "Tuned"])
def test_an_old_python_name_is_refused_with_the_new_one(name: str) -> None:
    with pytest.raises(AttributeError, match=f"{name} is now {RENAMED[name]}"):
        getattr(basrelief, name)


def test_an_old_name_of_the_viewer_is_refused_with_the_new_one() -> None:
    with pytest.raises(AttributeError, match="View is now ViewerPage"):
        basrelief.viewer.View  # noqa: B018


def test_a_fog_mode_given_as_fog_is_refused_with_the_new_name() -> None:
    with pytest.raises(basrelief.InputError, match="write fog_mode = 'linear'"):
        basrelief.Scene((), fog="linear")


def test_an_old_keyword_is_refused_with_the_new_one() -> None:
    material = basrelief.sample("bricks", 16)
    for draw in (
        lambda: basrelief.render(material, engine="cpu"),
        lambda: basrelief.render(basrelief.Object(material), engine="cpu"),
        lambda: basrelief.frames(material, count=2, engine="cpu"),
        lambda: basrelief.compare(material, engine="cpu"),
        lambda: basrelief.tune(material, missed=0.5, engine="cpu"),
    ):
        with pytest.raises(basrelief.InputError, match="engine is now device"):
            draw()


# --- the changelog --------------------------------------------------------------------------------


def test_the_changelog_lists_every_renamed_name() -> None:
    text = (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([^`]+?)=?` \| `([^`]+?)=?` \|", text, re.MULTILINE)
    assert set(RENAMED.items()) <= set(rows)
