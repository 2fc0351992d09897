"""`basrelief bake`: contents and places of its files, and refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import basrelief
from basrelief import baking
from basrelief.baking.files import FILE_BAKES
from basrelief.images import read_picture, write_data
from helpers.command_line import done, refused, write_heights

HEIGHTS = (np.random.default_rng(4).random((20, 28, 1)) * 65535).astype(np.uint16)
NAMES = [name.replace("_", "-") for name in FILE_BAKES]


@pytest.fixture
def bumps(tmp_path: Path) -> Path:
    """A folder with only a height map."""
    return write_heights(tmp_path / "bumps", HEIGHTS)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def linear(folder: Path) -> np.ndarray:
    height = basrelief.load(folder).height
    assert height is not None
    return height.linear()[:, :, 0]


def codes(path: Path, bits: int = 16) -> np.ndarray:
    pixels = read_picture(path).pixels
    assert pixels.dtype == f"uint{bits}"
    return pixels


def test_contents_of_the_files(bumps: Path) -> None:
    flags = ("normal", "occlusion", "horizon", "bounds")
    out = done("bake", bumps, *flags, "--scale", "0.2", "--edge", "clamp")
    folder, heights = bumps / "baked", linear(bumps)
    assert all(str(folder / name) in out for name in names(folder))
    assert "scale 0.2" in out
    (start,) = {name.split("_")[0] for name in names(folder)}
    assert len(names(folder)) == 5
    horizon = [codes(folder / f"{start}_horizon_{k}.png") for k in (0, 1)]
    np.testing.assert_array_equal(
        np.concatenate(horizon, 2), baking.horizon_map(heights, "clamp", 0.2)
    )
    np.testing.assert_array_equal(
        codes(folder / f"{start}_bounds.png"), baking.bounds(heights, "clamp")
    )
    occlusion = baking.ambient_occlusion(heights, "clamp", 0.2)
    assert np.abs(codes(folder / f"{start}_ao.png")[:, :, 0] - occlusion * 65535.0).max() <= 0.51
    normals = baking.normal_map(heights, "clamp", 0.2)
    stored = codes(folder / f"{start}_normal_gl.png")
    assert np.abs(stored - (normals * 0.5 + 0.5) * 65535.0).max() <= 0.51


def test_maps_are_baked_of_a_hole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done("bake", "sample:cracks", "normal", "--opening", "0.7", "--device", "cpu")
    cracks = basrelief.load("sample:cracks")
    material = basrelief.Object(cracks, opening=0.7).resolved.material
    assert material.height is not None
    normals = baking.normal_map(material.height.linear()[:, :, 0], "wrap", 0.3)
    stored = codes(tmp_path / "baked" / "cracks_normal_gl.png")
    assert np.abs(stored / 65535.0 * 2.0 - 1.0 - normals).max() < 1e-4


def test_the_heights_of_a_hole_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    printed = done("bake", "sample:cracks", "height", "--opening", "0.5", "--device", "cpu")
    assert "cracks_height.png  (scale 0.3; a hole opened by 0.5)" in printed
    hole = basrelief.Object(basrelief.load("sample:cracks"), opening=0.5).resolved.material
    assert hole.height is not None
    stored = codes(tmp_path / "baked" / "cracks_height.png")
    np.testing.assert_array_equal(stored[:, :, 0], hole.height.pixels[:, :, 0])


def test_green_and_bits(bumps: Path) -> None:
    for green in ("gl", "dx"):
        done("bake", bumps, "normal", "--green", green, "--bits", "8")
    up, down = (codes(next((bumps / "baked").glob(f"*{g}.png")), 8) for g in ("gl", "dx"))
    np.testing.assert_array_equal(up[:, :, [0, 2]], down[:, :, [0, 2]])
    assert np.abs(up[:, :, 1].astype(int) + down[:, :, 1] - 255).max() <= 1
    assert np.abs(up[:, :, 1].astype(int) - down[:, :, 1]).max() > 50


def test_a_baked_normal_map_draws_as_the_computed_one(bumps: Path) -> None:
    computed = basrelief.render(bumps, scale=0.1, size=(32, 20), device="cpu").color
    for green in ("gl", "dx"):
        done("bake", bumps, "normal", "--scale", "0.1", "--green", green, "-o", bumps)
        (file,) = bumps.glob(f"*_normal_{green}.png")
        assert basrelief.load(bumps).normal is not None
        drawn = basrelief.render(bumps, scale=0.1, size=(32, 20), device="cpu").color
        np.testing.assert_allclose(drawn, computed, atol=2e-3)
        file.unlink()


def test_heights_from_a_folder_with_normals_alone(tmp_path: Path) -> None:
    heights = (HEIGHTS / 65535).astype(np.float32)[:, :, 0]
    normals = baking.normal_map(heights, "wrap", 0.1)
    folder = tmp_path / "wall"
    folder.mkdir()
    write_data(folder / "wall_normal.png", np.rint((normals * 0.5 + 0.5) * 65535).astype("uint16"))
    out = done("bake", folder, "height", "-o", folder)
    assert "scale 0.1" in out or "scale 0.09" in out
    baked = linear(folder)
    assert np.corrcoef(baked.ravel(), heights.ravel())[0, 1] > 0.95


def test_the_loader_ignores_tables(bumps: Path) -> None:
    done("bake", bumps, "horizon", "bounds", "-o", bumps)
    assert [kind for kind, _ in basrelief.load(bumps).maps()] == ["height"]


def test_samples_go_to_a_folder_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done("bake", "sample:grid", "height")
    assert names(tmp_path / "baked") == ["grid_height.png"]


def test_files_are_overwritten_only_on_request(bumps: Path) -> None:
    done("bake", bumps, "normal")
    (file,) = (bumps / "baked").iterdir()
    before = file.read_bytes()
    line = refused("bake", bumps, "normal", "bounds", "--scale", "0.3")
    assert file.name in line
    assert "--overwrite" in line
    assert file.read_bytes() == before
    assert names(bumps / "baked") == [file.name]
    done("bake", bumps, "normal", "bounds", "--scale", "0.3", "--overwrite")
    assert file.read_bytes() != before
    assert len(names(bumps / "baked")) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "nothing to bake"),
        (("height",), "has no normal map"),
        (("normal", "--edge", "mirror"), "edge is one of wrap, clamp, clip, not 'mirror'"),
        (("shadow",), "there is no bake 'shadow'"),
        (("--horizon",), "maps to bake are named without dashes"),
        (("--normal", "--green", "dx"), "--normal names a file"),
        (("normal", "--green", "up"), "green is one of gl, dx, not 'up'"),
        (("normal", "--bits", "32"), "bits is one of 8, 16, not 32"),
        (("normal", "--scale", "-1"), "scale"),
        (("horizon", "--directions", "6"), "--directions 6"),
        (("horizon", "--directions", "0"), "at least one direction"),
        (("normal", "-o", "{file}"), "cannot be written"),
    ],
)
def test_refusals_leave_nothing(bumps: Path, arguments: tuple[str, ...], message: str) -> None:
    (file,) = bumps.iterdir()
    line = refused("bake", bumps, *(argument.format(file=file) for argument in arguments))
    assert message in line
    assert names(bumps) == [file.name]


def test_all_or_none(bumps: Path) -> None:
    """Normals could be baked, heights cannot, so nothing is written."""
    refused("bake", bumps, *NAMES)
    assert not (bumps / "baked").exists()


def test_the_refusal_lists_all_bakes(bumps: Path) -> None:
    line = refused("bake", bumps)
    assert all(name in line for name in FILE_BAKES)


def test_without_heights(tmp_path: Path) -> None:
    folder = tmp_path / "flat"
    folder.mkdir()
    write_data(folder / "flat_Color.png", np.zeros((4, 4, 3), np.uint8))
    assert "has no height map" in refused("bake", folder, "bounds")
