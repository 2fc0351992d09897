"""Figures by matplotlib: reproducible files, and no import of matplotlib before one is drawn."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from basrelief.errors import InputError
from basrelief.measure.explain import explain
from basrelief.measure.figures import has_matplotlib, write_figure
from helpers.synthetic import uniform_material

matplotlib = pytest.importorskip("matplotlib")


def draw(figure: Any) -> None:
    axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    axes.plot([0, 1, 2], [1, 3, 2], clip_on=True)
    axes.fill_between([0, 1, 2], 0, [1, 2, 1])
    axes.set_title("a & <b>")


def write(path: Path) -> bytes:
    write_figure(path, (3.0, 2.0), draw, {"font.size": 9.0})
    return path.read_bytes()


@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf", ".SVG"])
def test_the_same_drawing_is_the_same_file(suffix: str, tmp_path: Path) -> None:
    """Independently of the user's settings of matplotlib, which do not change."""
    before = write(tmp_path / f"a{suffix}")
    with matplotlib.rc_context({"lines.linewidth": 9.0, "axes.grid": True, "font.size": 30.0}):
        assert write(tmp_path / f"b{suffix}") == before
        assert matplotlib.rcParams["font.size"] == 30.0
    assert b"Date" not in before


def test_text_of_an_svg_is_text(tmp_path: Path) -> None:
    assert b">a &amp; &lt;b&gt;</text>" in write(tmp_path / "a.svg")


def test_a_figure_that_cannot_be_drawn_leaves_no_file(tmp_path: Path) -> None:
    def fails(figure: Any) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_figure(tmp_path / "a.svg", (3.0, 2.0), fails, {})
    assert list(tmp_path.iterdir()) == []


def test_without_matplotlib_the_error_names_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    explanation = explain(
        uniform_material(height=0.3), pixel=(20, 15), size=(40, 30), technique="steep", scale=0.1
    )
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert not has_matplotlib()
    with pytest.raises(InputError, match=r"pip install 'basrelief\[plots\]', or print it as a"):
        explanation.save(tmp_path / "ray.svg")
    assert list(tmp_path.iterdir()) == []


def test_matplotlib_is_imported_when_a_figure_is_drawn() -> None:
    code = """
import sys
import basrelief.cli.main, basrelief.measure.compare, basrelief.measure.explain
assert "matplotlib" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)
