"""Cached bakes: keyed by content, baked again when damaged, limited in size."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from basrelief import baking
from basrelief.baking import cache
from basrelief.engine import cache as program_cache
from basrelief.engine import choose_device
from basrelief.engine.cpu import CpuEngine
from basrelief.material import Material
from basrelief.rendering import textures
from basrelief.techniques import BOUNDS
from helpers.engines import RecordingEngine
from helpers.synthetic import map_of

CPU = choose_device("cpu")
HEIGHTS = np.random.default_rng(2).random((128, 160)).astype(np.float32)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Path of an empty cache folder, which does not exist yet."""
    monkeypatch.setenv("BASRELIEF_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


class CountingBake:
    """A bake that counts its calls."""

    def __init__(self) -> None:
        self.count = 0
        self.__module__, self.__qualname__ = __name__, "CountingBake"

    def __call__(self, heights, edge, **parameters):
        self.count += 1
        return np.full((3, 4), self.count, np.uint16)


def files(folder: Path) -> list[Path]:
    return sorted(folder.glob("bake-*"))


def test_the_second_result_is_read(folder: Path) -> None:
    bake = CountingBake()
    first = cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)
    again = cache.cached(bake, HEIGHTS.copy(), "wrap", CPU, scale=0.1)
    assert bake.count == 1
    assert again.dtype == first.dtype
    np.testing.assert_array_equal(again, first)
    assert len(files(folder)) == 1


def test_every_input_changes_the_key(folder: Path, monkeypatch) -> None:
    bake = CountingBake()
    lower = HEIGHTS.copy()
    lower[5, 7] = 0
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)
    cache.cached(bake, lower, "wrap", CPU, scale=0.1)
    cache.cached(bake, HEIGHTS, "clamp", CPU, scale=0.1)
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.2)
    cache.cached(bake, HEIGHTS.reshape(160, 128), "wrap", CPU, scale=0.1)
    monkeypatch.setattr(cache, "_source", lambda: "a changed method")
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)
    bake.__qualname__ = "Another"
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)
    assert bake.count == len(files(folder)) == 7


def test_bakes_of_another_device_are_not_used(folder: Path) -> None:
    """If it rounds differently; lanes and threads do not matter."""
    bake = CountingBake()
    for engine in (CpuEngine(4, 1), CpuEngine(8, 2)):
        cache.cached(bake, HEIGHTS, "wrap", engine)
    assert bake.count == 1
    for rounding in ("one card", "another", "one card"):
        cache.cached(bake, HEIGHTS, "wrap", RecordingEngine("gpu", rounding))
    assert bake.count == len(files(folder)) == 3


@pytest.mark.gpu
def test_the_rounding_of_a_gpu_names_its_driver() -> None:
    gpu = choose_device("gpu")
    info = gpu.adapter_info  # type: ignore[attr-defined]
    assert all(info[part] in gpu.rounding for part in ("device", "description", "backend_type"))
    assert gpu.rounding != CPU.rounding


@pytest.mark.parametrize("damage", [b"", b"short", b"x" * 4000])
def test_a_damaged_file_is_baked_again(folder: Path, damage: bytes) -> None:
    bake = CountingBake()
    cache.cached(bake, HEIGHTS, "wrap", CPU)
    (file,) = files(folder)
    file.write_bytes(damage)
    assert (cache.cached(bake, HEIGHTS, "wrap", CPU) == 2).all()
    assert (cache.cached(bake, HEIGHTS, "wrap", CPU) == 2).all()
    assert bake.count == 2


def test_a_valid_entry_with_wrong_content_is_baked_again(folder: Path) -> None:
    bake = CountingBake()
    cache.cached(bake, HEIGHTS, "wrap", CPU)
    (file,) = files(folder)
    for header in ({}, {"dtype": "no such", "shape": [1]}, {"dtype": "<u2", "shape": [99]}):
        program_cache.write(file.name, header, b"1234")
        before = bake.count
        cache.cached(bake, HEIGHTS, "wrap", CPU)
        assert bake.count == before + 1


def test_without_a_usable_folder_nothing_is_cached(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("BASRELIEF_CACHE", str(tmp_path / "file" / "cache"))
    bake = CountingBake()
    cache.cached(bake, HEIGHTS, "wrap", CPU)
    cache.cached(bake, HEIGHTS, "wrap", CPU)
    assert bake.count == 2


def test_the_least_recently_used_are_removed_first(folder: Path, monkeypatch) -> None:
    bake = CountingBake()
    scales = (0.1, 0.2, 0.3)
    for age, scale in enumerate(scales):
        known = set(files(folder))
        cache.cached(bake, HEIGHTS, "wrap", CPU, scale=scale)
        (new,) = set(files(folder)) - known
        os.utime(new, (1000 + age, 1000 + age))
    (folder / "cpu-program").write_bytes(b"stays")
    size = files(folder)[0].stat().st_size
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)  # used again
    monkeypatch.setattr(program_cache, "LIMIT", 3 * size + 20)
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.4)
    assert (bake.count, len(files(folder))) == (4, 3)
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.1)
    assert bake.count == 4
    cache.cached(bake, HEIGHTS, "wrap", CPU, scale=0.2)
    assert bake.count == 5
    assert (folder / "cpu-program").exists()


def test_a_bake_above_the_limit_is_not_cached(folder: Path, monkeypatch) -> None:
    monkeypatch.setattr(program_cache, "LIMIT", 10)
    cache.cached(CountingBake(), HEIGHTS, "wrap", CPU)
    assert files(folder) == []


def test_bakes_of_small_maps_are_not_cached(folder: Path) -> None:
    bake = CountingBake()
    cache.cached(bake, HEIGHTS[:8, :8], "wrap", CPU)
    assert files(folder) == []


def test_bakes_of_techniques_are_cached(folder: Path, monkeypatch) -> None:
    expected = textures.bake_texture(Material("x", height=map_of(HEIGHTS)), "wrap", BOUNDS, CPU)
    assert len(files(folder)) == 1

    def never(*_: object) -> None:
        raise AssertionError("baked again")

    never.__module__, never.__qualname__ = baking.bounds.__module__, baking.bounds.__qualname__
    monkeypatch.setattr("basrelief.baking.exact.bounds", never)
    again = textures.bake_texture(Material("x", height=map_of(HEIGHTS)), "wrap", BOUNDS, CPU)
    np.testing.assert_array_equal(again.levels[0], expected.levels[0])
