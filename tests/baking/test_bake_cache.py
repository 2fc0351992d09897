"""Bakes on disk: found by content, made anew when damaged, bounded, and never in the way."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from basrelief import baking
from basrelief.baking import cache
from basrelief.engine import cache as folder_of_programs
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
    """An empty cache, which does not exist yet."""
    monkeypatch.setenv("BASRELIEF_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


class Baking:
    """A bake that counts how often it is made."""

    def __init__(self) -> None:
        self.count = 0
        self.__module__, self.__qualname__ = __name__, "Baking"

    def __call__(self, heights, edge, **parameters):
        self.count += 1
        return np.full((3, 4), self.count, np.uint16)


def files(folder: Path) -> list[Path]:
    return sorted(folder.glob("bake-*"))


def test_the_second_time_it_is_read(folder: Path) -> None:
    made = Baking()
    first = cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)
    again = cache.kept(made, HEIGHTS.copy(), "wrap", CPU, scale=0.1)
    assert made.count == 1
    assert again.dtype == first.dtype
    np.testing.assert_array_equal(again, first)
    assert len(files(folder)) == 1


def test_another_of_anything_is_another_bake(folder: Path, monkeypatch) -> None:
    made = Baking()
    lower = HEIGHTS.copy()
    lower[5, 7] = 0
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)
    cache.kept(made, lower, "wrap", CPU, scale=0.1)
    cache.kept(made, HEIGHTS, "clamp", CPU, scale=0.1)
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.2)
    cache.kept(made, HEIGHTS.reshape(160, 128), "wrap", CPU, scale=0.1)
    monkeypatch.setattr(cache, "_source", lambda: "a changed method")
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)
    made.__qualname__ = "Another"
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)
    assert made.count == len(files(folder)) == 7


def test_what_another_device_made_is_not_taken(folder: Path) -> None:
    """Where numbers round otherwise; how many lanes or cores there are does not matter."""
    made = Baking()
    for engine in (CpuEngine(4, 1), CpuEngine(8, 2)):
        cache.kept(made, HEIGHTS, "wrap", engine)
    assert made.count == 1
    for rounding in ("one card", "another", "one card"):
        cache.kept(made, HEIGHTS, "wrap", RecordingEngine("gpu", rounding))
    assert made.count == len(files(folder)) == 3


@pytest.mark.gpu
def test_a_gpu_is_told_apart_by_its_driver_too() -> None:
    gpu = choose_device("gpu")
    info = gpu.adapter_info  # type: ignore[attr-defined]
    assert all(info[part] in gpu.rounding for part in ("device", "description", "backend_type"))
    assert gpu.rounding != CPU.rounding


@pytest.mark.parametrize("damage", [b"", b"short", b"x" * 4000])
def test_a_damaged_file_is_made_anew(folder: Path, damage: bytes) -> None:
    made = Baking()
    cache.kept(made, HEIGHTS, "wrap", CPU)
    (file,) = files(folder)
    file.write_bytes(damage)
    assert (cache.kept(made, HEIGHTS, "wrap", CPU) == 2).all()
    assert (cache.kept(made, HEIGHTS, "wrap", CPU) == 2).all()
    assert made.count == 2


def test_a_whole_file_that_holds_something_else_is_made_anew(folder: Path) -> None:
    made = Baking()
    cache.kept(made, HEIGHTS, "wrap", CPU)
    (file,) = files(folder)
    for header in ({}, {"dtype": "no such", "shape": [1]}, {"dtype": "<u2", "shape": [99]}):
        folder_of_programs.write(file.name, header, b"1234")
        before = made.count
        cache.kept(made, HEIGHTS, "wrap", CPU)
        assert made.count == before + 1


def test_where_nothing_can_be_kept_nothing_is(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("BASRELIEF_CACHE", str(tmp_path / "file" / "kept"))
    made = Baking()
    cache.kept(made, HEIGHTS, "wrap", CPU)
    cache.kept(made, HEIGHTS, "wrap", CPU)
    assert made.count == 2


def test_the_longest_unused_go_first(folder: Path, monkeypatch) -> None:
    made = Baking()
    scales = (0.1, 0.2, 0.3)
    for age, scale in enumerate(scales):
        known = set(files(folder))
        cache.kept(made, HEIGHTS, "wrap", CPU, scale=scale)
        (new,) = set(files(folder)) - known
        os.utime(new, (1000 + age, 1000 + age))
    (folder / "cpu-program").write_bytes(b"stays")
    size = files(folder)[0].stat().st_size
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)  # used again
    monkeypatch.setattr(folder_of_programs, "LIMIT", 3 * size + 20)
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.4)
    assert (made.count, len(files(folder))) == (4, 3)
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.1)
    assert made.count == 4
    cache.kept(made, HEIGHTS, "wrap", CPU, scale=0.2)
    assert made.count == 5
    assert (folder / "cpu-program").exists()


def test_more_than_the_limit_is_not_kept(folder: Path, monkeypatch) -> None:
    monkeypatch.setattr(folder_of_programs, "LIMIT", 10)
    cache.kept(Baking(), HEIGHTS, "wrap", CPU)
    assert files(folder) == []


def test_small_maps_are_not_kept(folder: Path) -> None:
    made = Baking()
    cache.kept(made, HEIGHTS[:8, :8], "wrap", CPU)
    assert files(folder) == []


def test_what_a_technique_needs_is_kept(folder: Path, monkeypatch) -> None:
    wanted = textures.bake_texture(Material("x", height=map_of(HEIGHTS)), "wrap", BOUNDS, CPU)
    assert len(files(folder)) == 1

    def never(*_: object) -> None:
        raise AssertionError("made again")

    never.__module__, never.__qualname__ = baking.bounds.__module__, baking.bounds.__qualname__
    monkeypatch.setattr("basrelief.baking.exact.bounds", never)
    again = textures.bake_texture(Material("x", height=map_of(HEIGHTS)), "wrap", BOUNDS, CPU)
    np.testing.assert_array_equal(again.levels[0], wanted.levels[0])
