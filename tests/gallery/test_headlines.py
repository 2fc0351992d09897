"""The benchmark of the articles' headline figures measures the same scenes: G12 and H9."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np
import pytest

from basrelief.rendering.render import render
from helpers.repository import REPOSITORY

BENCHMARKS = REPOSITORY / "benchmarks"


@pytest.fixture
def sources(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield importlib.import_module("sources")
    for name in ("sources", "scenes", "figures"):
        sys.modules.pop(name, None)


def test_gamedev_takes_four_to_twenty_reads_at_640_by_480(sources) -> None:
    """G12: every pixel is covered and has at most twenty reads."""
    scene_of, size = sources.CASES["gamedev, 4 to 20 samples"]
    assert size == (640, 480)
    frame = render(scene_of(), size=(64, 48), samples=1, device="cpu")
    assert frame.hit.all()
    assert 1 <= frame.reads.min() <= frame.reads.max() <= 20
    settings = scene_of().resolved[0].settings
    assert (settings.min_steps, settings.max_steps) == (4, 20)


def test_halliwell_is_measured_with_and_without_self_shadow_at_1600_by_900(sources) -> None:
    """H9: the same picture except the shadow, which accounts for the extra reads."""
    frames = []
    for name in ("halliwell without self-shadow", "halliwell with self-shadow"):
        scene_of, size = sources.CASES[name]
        assert size == (1600, 900)
        frames.append(render(scene_of(), size=(64, 36), samples=1, device="cpu"))
    without, within = frames
    assert without.hit.all()
    assert within.hit.all()
    np.testing.assert_array_equal(without.uv, within.uv)
    assert within.reads.mean() > without.reads.mean() + 4
    darker = within.color[:, :, :3].sum(-1) < without.color[:, :, :3].sum(-1) - 0.02
    assert 0.02 < darker.mean() < 0.8


def test_the_figures_are_printed_beside_the_articles(sources, capsys) -> None:
    seconds = dict(zip(sources.CASES, (0.002, 0.01, 0.0144), strict=True))
    sources.show("an adapter", seconds)
    output = capsys.readouterr().out
    assert "1.44 times as long (halliwell: 650 to 450, 1.44)" in output
    assert "more than 60 frames a second there, 500 here" in output
