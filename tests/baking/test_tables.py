"""Declared bakes: a function runs the passes of each, and all lists of bakes agree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from basrelief.baking import passes
from basrelief.baking.files import FILE_BAKES, BakeInput
from basrelief.baking.horizon import ambient_occlusion, horizon_map
from basrelief.baking.normal import normal_map
from basrelief.baking.tables import TABLES, bake_function, table
from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.scene import Object
from basrelief.techniques import BAKES, BOUNDS, CONE_MAP, Bake, Technique, exact, technique
from helpers.engines import RecordingEngine
from helpers.synthetic import map_of

HEIGHTS = np.random.default_rng(5).random((37, 53)).astype(np.float32)
CPU = choose_device("cpu")


def test_every_declared_bake_has_a_function() -> None:
    assert set(TABLES) == set(BAKES)
    for name, bake in BAKES.items():
        assert bake.name == name
        assert bake_function(bake).__name__ == name


@pytest.mark.parametrize("name", BAKES)
def test_a_declaration_names_the_passes_that_run(name: str) -> None:
    engine = RecordingEngine()
    table(BAKES[name], HEIGHTS, "wrap", engine)
    assert set(engine.entries) == set(BAKES[name].programs)


@pytest.mark.parametrize("name", BAKES)
def test_tables_equal_the_results_of_the_functions(name: str) -> None:
    result = table(BAKES[name], HEIGHTS, "clamp", CPU)
    np.testing.assert_array_equal(result, bake_function(BAKES[name])(HEIGHTS, "clamp"))
    if BAKES[name].all_levels:
        whole = table(BAKES[name], HEIGHTS, "clamp", CPU, all_levels=True)
        np.testing.assert_array_equal(whole[: len(result)], result)
        assert len(whole) > len(result)


@pytest.mark.parametrize("name", BAKES)
def test_the_command_line_has_an_option_for_each(name: str) -> None:
    option = FILE_BAKES[name.removesuffix("_map")]
    assert option.help == TABLES[name][1]
    result = option.make(
        BakeInput(Material("x", height=map_of(HEIGHTS)), CPU, "wrap", 0.1, 16, "gl", 8)
    )
    assert set(result.files) == {name.removesuffix("_map")}
    np.testing.assert_array_equal(*result.files.values(), table(BAKES[name], HEIGHTS, "wrap", CPU))


def test_a_technique_reads_lower_levels_where_its_bake_covers_them() -> None:
    def with_bake(bake: Bake | None, **more: Any) -> Technique[..., Any]:
        return technique(bake=bake, **more)(exact.function)

    assert with_bake(BOUNDS).takes_heights == ("sharp", "mip")
    assert with_bake(CONE_MAP).takes_heights == ("sharp",)
    assert with_bake(BOUNDS, columns=True).takes_heights == ("sharp",)
    assert with_bake(None).takes_heights == ("sharp", "smooth", "mip")


# --- invalid declarations -------------------------------------------------------------------------


def test_the_name_of_a_bake_is_refused_in_a_declaration() -> None:
    with pytest.raises(TypeError, match=r"bake is 'cone_map'.*CONE_MAP of basrelief\.techniques"):
        technique(bake="cone_map")  # type: ignore[arg-type]


def test_a_bake_without_a_function_is_refused_before_drawing() -> None:
    """Also if its name is that of another bake."""
    material = Material("bumps", height=map_of(HEIGHTS))
    mine = technique(bake=Bake("cone_map", CONE_MAP.programs))(exact.function)
    with pytest.raises(InputError, match=r"exact: .* the bake cone_map .*import BOUNDS, CONE_MAP"):
        Object(material, technique=mine)


# --- bands ----------------------------------------------------------------------------------------

BANDED = {
    **{name: lambda engine, bake=bake: table(bake, HEIGHTS, "clamp", engine)
       for name, bake in BAKES.items()},
    "normals": lambda engine: normal_map(HEIGHTS, "clamp", 0.1, engine),
    "horizons": lambda engine: horizon_map(HEIGHTS, "clamp", 0.1, 4, engine),
}  # fmt: skip


@pytest.mark.parametrize("name", BANDED)
def test_a_gpu_runs_bands_of_rows(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bands change no result, and a CPU has none."""
    monkeypatch.setattr(passes, "MAX_TEXELS", 400)
    gpu, other = RecordingEngine("gpu"), RecordingEngine("cpu")
    result, whole = BANDED[name](gpu), BANDED[name](other)
    np.testing.assert_array_equal(result, whole)
    assert max(gpu.texels) <= 400
    assert len(other.texels) < len(gpu.texels)
    assert sum(gpu.texels) == sum(other.texels)


def test_more_directions_make_smaller_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    """For ambient occlusion, which follows all directions from each texel."""
    monkeypatch.setattr(passes, "MAX_TEXELS", 1600)
    gpu = RecordingEngine("gpu")
    result = ambient_occlusion(HEIGHTS, "wrap", 0.1, 16, gpu)
    np.testing.assert_array_equal(result, ambient_occlusion(HEIGHTS, "wrap", 0.1, 16))
    assert max(gpu.texels) <= 100
