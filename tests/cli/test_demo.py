"""The demo's pictures, and the commands and examples of the README and the documentation."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest

import basrelief
from basrelief.cli import demo
from basrelief.images import read_picture
from basrelief.techniques import TECHNIQUES
from helpers.command_line import done, write_heights
from helpers.repository import blocks, commands

PAGES = (
    "README.md", "docs/command-line.md", "docs/presets.md", "docs/bake.md", "docs/draw.md",
    "docs/viewer.md", "docs/write-a-technique.md",
)  # fmt: skip
DRAWS_MANY = re.compile("basrelief (demo|gallery|compare|tune)")
SMALL = ["--size", "24x18", "--samples", "1"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with FOLDER, a material, and my.py, the technique of the documentation."""
    monkeypatch.chdir(tmp_path)
    write_heights(tmp_path / "FOLDER")
    (own,) = (block for block in blocks("docs/write-a-technique.md") if "@technique" in block)
    Path("my.py").write_text(own)
    return tmp_path


# --- the demo -------------------------------------------------------------------------------------


def heights_alone(name: str) -> basrelief.Material:
    return basrelief.Material(name, height=basrelief.sample(name, 16).height)


def test_demo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(demo, "_SHOWN", ["flat", "offset"])
    monkeypatch.setattr(demo, "_SHAPES", (("cobbles", "sphere"),))
    monkeypatch.setattr(demo, "_SIZE", (24, 18))
    monkeypatch.setattr(demo, "sample", heights_alone)
    names = ["bricks-flat.png", "bricks-offset.png", "cobbles-sphere.png"]
    output = done("demo", "--device", "cpu", "-o", "some/where")
    lines = output.splitlines()
    assert lines[0:6:2] == [f"some/where/{name}" for name in names]
    assert all(line.startswith("    basrelief render ") for line in lines[1:6:2])
    assert "The pictures are in some/where. Next: basrelief render" in output
    assert sorted(os.listdir("some/where")) == names
    pictures = [read_picture(f"some/where/{name}").pixels for name in names]
    assert all(picture.shape == (18, 24, 3) for picture in pictures)
    assert not (pictures[0] == pictures[1]).all()
    # into the default folder
    assert "basrelief-demo/bricks-flat.png" in done("demo", "--device", "cpu")
    assert sorted(os.listdir("basrelief-demo")) == names


def test_demo_reports_the_number_of_pictures() -> None:
    samples = {name: basrelief.sample(name, 4) for name in basrelief.material.SAMPLES}
    scenes = dict(demo._scenes(samples))
    assert len(scenes) == demo.COUNT == len(TECHNIQUES) - 1 + 4
    assert {scene.objects[0].shape for scene in scenes.values()} == set(basrelief.scene.SHAPES)


# --- examples of pages ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "line", [line for page in PAGES for line in commands(page) if not DRAWS_MANY.search(line)]
)
def test_commands_that_pages_show(line: str, here: Path) -> None:
    """Each command runs and writes its picture, small and with few frames."""
    words = shlex.split(line)[1:]
    if "--frames" in words:
        words[words.index("--frames") + 1] = "6"
    output = done(*words, *(SMALL if words[0] == "render" else []))
    assert output
    if words[0] in ("explain", "view"):
        assert not words.count("-o") or Path(words[words.index("-o") + 1]).is_file()
        return
    pictures = sorted(name for name in os.listdir() if name != "my.py" and Path(name).is_file())
    assert len(pictures) == (words[0] == "render") * pictures_of(words)
    assert not pictures or output.startswith(pictures[0])
    for name in pictures:
        if Path(name).suffix not in (".mp4", ".gif"):
            assert read_picture(name).pixels.shape[:2] == (18, 24)


def pictures_of(words: list[str]) -> int:
    """Number of files that a command writes: several for a film of numbered pictures."""
    file = words[words.index("-o") + 1] if "-o" in words else ".png"
    as_one = file.endswith((".mp4", ".gif", ".webp"))
    return 1 if as_one or "--frames" not in words else int(words[words.index("--frames") + 1])


def test_demos_that_pages_show(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    monkeypatch.setattr(
        demo,
        "pictures",
        lambda *arguments: calls.append(arguments) or [(Path("a.png"), "basrelief render")],
    )
    for line in commands("docs/command-line.md"):
        if "demo" in line:
            done(*shlex.split(line)[1:])
    assert calls == [(Path("basrelief-demo"), "auto"), (Path("pictures"), "cpu")]


def test_every_command_is_shown() -> None:
    shown = {line.split()[1] for line in commands("docs/command-line.md")}
    assert shown == {
        "render", "bake", "compare", "tune", "explain", "view", "info", "techniques", "presets",
        "demo", "gallery",
    }  # fmt: skip
    assert len(commands("README.md")) >= 5


def test_the_python_example_of_the_readme(here: Path) -> None:
    """With a smaller picture."""
    (example,) = (block for block in blocks("README.md") if "image.save" in block)
    small = example.replace("(1280, 720)", "(24, 18)")
    assert small != example
    scope: dict[str, object] = {}
    exec(compile(small, "README.md", "exec"), scope)
    assert isinstance(scope["image"], basrelief.Frame)
    assert read_picture("rock.png").pixels.shape == (18, 24, 3)


def test_the_film_from_python(here: Path) -> None:
    (example,) = blocks("docs/draw.md")
    exec(compile(example, "docs/draw.md", "exec"), {})
    assert sorted(set(os.listdir()) - {"FOLDER", "my.py"}) == [f"rock-000{k}.png" for k in "1234"]
