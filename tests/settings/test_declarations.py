"""Settings are declared once: docstrings, options and completion agree with the declarations."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import typer.main

from basrelief.cli.main import app
from basrelief.lang import Vec3, struct
from basrelief.material.options import MAPS, Lengths, ReadOptions
from basrelief.scene import SURFACES, LookAt, Object, Orbit, Scene, Tiling
from basrelief.scene.checks import FAR, NEAR
from basrelief.scene.lights import LIGHTS
from basrelief.scene.motion import MOTIONS
from basrelief.scene.records import SCENE_RECORDS
from basrelief.settings import Setting, parameters_of, setting, settings_of
from basrelief.techniques import TECHNIQUES
from basrelief.techniques.height import Smoothing

RECORDS: dict[str, Any] = {
    record.__name__: record
    for record in (
        Object, Scene, Orbit, LookAt, Tiling, ReadOptions, Lengths, Smoothing, *SURFACES.values(),
        *MOTIONS.values(), *(record for record, _ in SCENE_RECORDS.values()),
        *(technique.settings for technique in TECHNIQUES.values()),
    )
}  # fmt: skip
"""All records with settings, by name."""
FUNCTIONS: dict[str, Callable[..., Any]] = dict(LIGHTS)
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


def declarations() -> Iterator[tuple[str, Setting]]:
    """All settings, with the name of their record or function before their own."""
    for name, record in RECORDS.items():
        yield from ((f"{name}.{setting}", s) for setting, s in settings_of(record).items())
    for name, function in FUNCTIONS.items():
        yield from ((f"{name}.{setting}", s) for setting, s in parameters_of(function).items())


SETTINGS = dict(declarations())


# --- meanings and ranges --------------------------------------------------------------------------


@pytest.mark.parametrize("name", SETTINGS)
def test_every_setting_has_a_meaning(name: str) -> None:
    meaning = SETTINGS[name].doc
    assert len(meaning.split()) >= (1 if name == "Scene.camera" else 2)
    assert not meaning.endswith(".")


def wrong_ranges(declared: Setting) -> list[str]:
    """The ranges of a meaning that differ from the declaration's, and a missing one."""
    text = f"{declared.doc}. {declared.details}".replace("−", "-")
    stated = re.findall(r"(-?\d[\d.]*) (?:\([^)]*\) )?to (-?\d+(?:\.\d+)?)", text)
    low, high = declared.low, declared.high
    wrong = [" to ".join(ends) for ends in stated if tuple(map(float, ends)) != (low, high)]
    opened = re.search(r"above (-?\d+) and below (-?\d+)", text)
    if opened:
        near = (
            math.isclose(float(opened[k + 1]), end or 0.0, abs_tol=0.011)
            for k, end in enumerate((low, high))
        )
        wrong += [] if all(near) else [opened[0]]
    if (bound := re.search(r"(\d+) or above|above (\d+)(?! and below)", text)) and not opened:
        end = float(bound[1] or bound[2])
        wrong += [] if low is None or 0.0 <= low - end <= NEAR else [bound[0]]
    return wrong


def lacks_range(declared: Setting) -> bool:
    """Whether a docstring does not state a range with two ends that a user could reach."""
    reachable = declared.low is not None and declared.high is not None and declared.high < FAR
    return reachable and not re.search(
        r"\d to |\) to |above \d+ and below", f"{declared.doc}. {declared.details}"
    )


@pytest.mark.parametrize("name", [n for n, s in SETTINGS.items() if s.kind != "flag"])
def test_the_range_of_a_docstring_is_the_declared_one(name: str) -> None:
    assert wrong_ranges(SETTINGS[name]) == []


@pytest.mark.parametrize(
    "name", [name for name, s in SETTINGS.items() if s.doc[:1].isupper() and "as for" not in s.doc]
)
def test_a_docstring_states_the_range(name: str) -> None:
    """Phrases in a declaration need none, since what prints them adds the range."""
    assert not lacks_range(SETTINGS[name])


@struct
class Wrong:
    """Ranges that differ from the declarations.

    Attributes
    ----------
    a : float
        A number, 0 to 4.
    b : float
        A number, above 0 and below 90.
    c : float
        A number.
    d : float
        A number, 1 or above.
    """

    a: float = setting(default=1.0, low=0.0, high=5.0)
    b: float = setting(default=1.0, low=0.0, high=45.0)
    c: float = setting(default=1.0, low=0.0, high=5.0)
    d: float = setting(default=1.0, low=0.0)


def test_wrong_ranges_are_noticed() -> None:
    """The checks above can fail."""
    a, b, c, d = settings_of(Wrong).values()
    assert wrong_ranges(a) == ["0 to 4"]
    assert wrong_ranges(b) == ["above 0 and below 90"]
    assert wrong_ranges(d) == ["1 or above"]
    assert not wrong_ranges(c)
    assert lacks_range(c)


@pytest.mark.parametrize(
    ("low", "high", "text"),
    [(0.0, 10.0, "0 to 10"), (0.0, None, "from 0"), (None, 4.0, "up to 4"), (None, None, ""),
     (-1000.0, 1e6, "−1000 to 1000000"), (1e-5, 1.0, "1e-05 to 1")],
)  # fmt: skip
def test_ranges_in_words(low: float | None, high: float | None, text: str) -> None:
    assert Setting("x", "number", None, "", low, high).range_text == text


@pytest.mark.parametrize(
    ("default", "text"),
    [(0.05, "0.05"), (Vec3(1.0, 0.5, 0.0), "1/0.5/0"), ((2.0, 3.0), "2/3"), ("wrap", "wrap"),
     (False, "false"), (None, "")],
)  # fmt: skip
def test_defaults_in_words(default: Any, text: str) -> None:
    assert Setting("x", "number", default, "").default_text == text


# --- options of the command line ------------------------------------------------------------------


def options() -> Iterator[tuple[str, Any]]:
    """All options of all commands, with the name of the command."""
    for command, made in COMMANDS.items():
        yield from ((command, p) for p in made.params if p.param_type_name == "option")


DECLARED = {
    **settings_of(Object),
    **settings_of(Scene),
    **settings_of(ReadOptions),
    **settings_of(Lengths),
}
REPEATABLE = ("technique", "settings", "lights")
"""Options that some commands take several times; the values are the same."""


def test_an_option_is_the_same_in_all_commands() -> None:
    """Options of settings and maps have one name, and one meaning and completion, everywhere."""
    names: dict[str, set[tuple[str, ...]]] = {}
    helps: dict[str, set[str]] = {}
    for _, option in options():
        if option.name in DECLARED or option.name in MAPS:
            names.setdefault(option.name, set()).add(tuple(option.opts))
            helps.setdefault(option.name, set()).add(option.help)
    assert {name for name, all_of_it in names.items() if len(all_of_it) != 1} == set()
    several = {name for name, all_of_it in helps.items() if len(all_of_it) != 1}
    assert several <= set(REPEATABLE)
    assert names["height"] == {("--height",)}
    assert names["bias"] == {("--bias",)}


def test_a_map_is_a_file_in_all_commands() -> None:
    maps = [(command, option) for command, option in options() if option.name in MAPS]
    assert {command for command, _ in maps} >= {"render", "view", "compare", "tune", "bake", "info"}
    for command, option in maps:
        number = "|NUMBER" if MAPS[option.name].channels == 1 else ""
        assert option.metavar == f"FILE|FOLDER|sample:NAME{number}", (command, option.name)


def test_settings_that_have_options_are_named_after_them() -> None:
    for _, option in options():
        declared = DECLARED.get(option.name)
        if declared is not None and option.name not in (*REPEATABLE, "camera", "layer"):
            assert declared.option in option.opts


def completed(command: str, name: str, text: str = "") -> list[str]:
    """Values that a shell offers for an option or argument, after the text typed so far."""
    made = COMMANDS[command]
    parameter = next(p for p in made.params if p.name == name)
    context = made.make_context(command, [], resilient_parsing=True)
    return [item.value for item in parameter.shell_complete(context, text)]


CHOICES = [
    (command, option.name)
    for command, option in options()
    if option.name in DECLARED and DECLARED[option.name].choices
]


@pytest.mark.parametrize(("command", "name"), CHOICES)
def test_the_shell_completes_choices(command: str, name: str) -> None:
    declared = DECLARED[name]
    assert completed(command, name) == [*declared.choices]
    first = declared.choices[0]
    assert first in completed(command, name, first[:1])


def test_every_choice_is_completed_by_render() -> None:
    choices = {name for name, declared in DECLARED.items() if declared.choices}
    assert choices == {name for command, name in CHOICES if command == "render"}


def test_kinds_of_lights_are_completed() -> None:
    assert completed("render", "lights") == [*LIGHTS]


def test_bakes_are_completed() -> None:
    assert "relaxed_cone" in completed("bake", "what")
