"""Bakes run on the engine that draws and on no other, for every way of drawing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import basrelief
from basrelief.baking.files import FILE_BAKES
from basrelief.engine import choose_device
from basrelief.engine.cpu import CpuEngine
from basrelief.images import write_data
from basrelief.material import Material
from basrelief.measure.compare import compare
from basrelief.measure.truth import truth
from basrelief.measure.tune import tune
from basrelief.rendering.render import render
from basrelief.scene import Layer, Object, Orbit, Scene, placed
from basrelief.techniques import BAKES, RELAXED_CONE_MAP, TECHNIQUES
from basrelief.techniques.horizon_bake import horizon, sky_visibility
from basrelief.techniques.normal_bake import normals
from basrelief.viewer import write_view
from helpers.command_line import done, write_heights
from helpers.engines import RecordingEngine
from helpers.stills import no_stills
from helpers.synthetic import map_of, noise

BAKED = {name: made for name, made in TECHNIQUES.items() if made.bake is not None}
PICTURE = {"size": (8, 6), "samples": 1}


def _runs_elsewhere(*_: object) -> None:
    raise AssertionError("a program runs on another engine than the one that draws")


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> RecordingEngine:
    """A recording engine; runs on the default CPU engine fail."""
    monkeypatch.setattr(choose_device("cpu"), "run", _runs_elsewhere)
    return RecordingEngine()


def bumps(seed: int) -> Material:
    """A new material of heights only, without cached bakes."""
    return Material("bumps", height=map_of(noise(seed, (12, 16), 1)))


@pytest.mark.parametrize("name", BAKED)
def test_rendering_bakes_on_the_engine_that_draws(engine: RecordingEngine, name: str) -> None:
    render(Object(bumps(1), technique=name), device=engine, **PICTURE)
    bake = BAKED[name].bake
    assert bake is not None
    assert set(engine.entries) >= {normals, *bake.programs}


def test_normals_of_a_layer_are_baked_on_the_engine_that_draws(engine: RecordingEngine) -> None:
    with_normals = Material("flat", normal=map_of(np.full((1, 1, 3), (0.5, 0.5, 1.0))))
    render(Object(with_normals, layer=Layer(bumps(2))), device=engine, **PICTURE)
    assert engine.entries.count(normals) == 1


def test_shadow_casters_are_baked_on_the_engine_that_draws(engine: RecordingEngine) -> None:
    ground = Object(bumps(3), technique="flat")
    ball = Object(bumps(4), "sphere", "cone", transform=placed(position=(0.0, 0.5, 0.0)))
    scene = Scene((ground, ball), camera=Orbit(20.0, 40.0, 3.0), shadows="hard")
    assert scene.casts
    render(scene, device=engine, **PICTURE)
    assert set(engine.entries) >= {normals, *BAKES["cone_map"].programs}


def test_the_truth_is_computed_on_the_given_engine(engine: RecordingEngine) -> None:
    truth(Object(bumps(5), technique="exact"), (8, 6), device=engine)
    assert engine.entries


def test_comparisons_bake_on_the_given_engine(engine: RecordingEngine) -> None:
    compare(bumps(6), list(BAKED), angles=(40.0,), runs=1, device=engine, **PICTURE)
    assert set(engine.entries) >= {each for bake in BAKES.values() for each in bake.programs}


def test_tuning_bakes_on_the_given_engine(engine: RecordingEngine) -> None:
    tune(
        bumps(7), missed=1.0, techniques=["relaxed_cone"], angles=(40.0, 40.0), size=(8, 6),
        device=engine,
    )  # fmt: skip
    assert set(engine.entries) >= set(RELAXED_CONE_MAP.programs)


def test_a_page_contains_bakes_of_the_given_engine(engine: RecordingEngine, tmp_path: Path) -> None:
    scene = Scene((Object(bumps(8), layer=Layer(bumps(11))),))
    with no_stills():
        write_view(scene, tmp_path / "page.html", device=engine)
    assert set(engine.entries) >= {normals, *RELAXED_CONE_MAP.programs}


# --- the command line -----------------------------------------------------------------------------


def with_both_maps(folder: Path) -> tuple[str | Path, ...]:
    """Arguments of the command that bakes everything from heights and normals."""
    made = write_heights(folder / "bumps", (noise(10, (20, 28), 1) * 65535).astype(np.uint16))
    file = write_data(folder / "leaning_normal.png", np.full((4, 6, 3), 40000, np.uint16))
    return ("bake", made, *FILE_BAKES, "--normal", file)


def test_bake_runs_on_the_given_engine(
    engine: RecordingEngine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("basrelief.engine.choose_device", {"gpu": engine}.__getitem__)
    done(*with_both_maps(tmp_path), "--device", "gpu")
    wanted = {each for bake in BAKES.values() for each in bake.programs}
    assert set(engine.entries) == {normals, horizon, sky_visibility, *wanted}
    assert len(list((tmp_path / "bumps" / "baked").iterdir())) == len(FILE_BAKES) + 1


@pytest.mark.gpu
def test_all_bakes_run_on_a_gpu(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CpuEngine, "run", _runs_elsewhere)
    done(*with_both_maps(tmp_path), "--device", "gpu")
    for name in BAKED:
        frame = basrelief.render(bumps(9), technique=name, device="gpu", **PICTURE)
        assert frame.device.startswith("gpu: ")
        assert frame.hit.any()
