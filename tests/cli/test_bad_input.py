"""Bad input: a one-line message, exit code 2, no file overwritten or left; unusual valid input."""

from __future__ import annotations

import os
import struct
import sys
import types
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.cli import demo
from basrelief.engine import choose_device
from basrelief.engine.cache import cache_folder
from basrelief.images import read_picture, write_data, write_picture
from basrelief.material import sample
from helpers.command_line import done, environment, refused, run_apart, write_heights, write_map

DRAW = ("--size", "12x9", "--samples", "1", "--device", "cpu")


@pytest.fixture(scope="module")
def bumps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with only a height map."""
    return write_heights(tmp_path_factory.mktemp("maps") / "bumps")


@pytest.fixture
def out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that commands run in, with an old picture in it."""
    folder = tmp_path / "out"
    folder.mkdir()
    monkeypatch.chdir(folder)
    (folder / "old.png").write_bytes(b"the old picture")
    return folder


def refused_to_draw(path: str | Path, *arguments: str | Path) -> str:
    """The error message; asserts that the old picture is unchanged and the only file."""
    line = refused("render", path, *DRAW, "-o", "old.png", *arguments)
    assert os.listdir() == ["old.png"]
    assert Path("old.png").read_bytes() == b"the old picture"
    return line


def colors(height: int = 4, width: int = 4, channels: int = 3) -> np.ndarray:
    return np.random.default_rng(2).integers(0, 255, (height, width, channels), np.uint8)


def folder_of(tmp_path: Path, **maps: np.ndarray) -> Path:
    """A folder named wall with these maps."""
    folder = tmp_path / "wall"
    folder.mkdir()
    for kind, pixels in maps.items():
        write_map(folder, kind, pixels)
    return folder


# --- folders and files ----------------------------------------------------------------------------


def test_a_folder_that_is_missing(out: Path) -> None:
    line = refused_to_draw("nowhere")
    assert line.startswith("nowhere: there is no such file or folder")
    assert refused("info", "nowhere") == line


def test_a_folder_without_a_picture(tmp_path: Path, out: Path) -> None:
    full = tmp_path / "full"
    (full / "of folders").mkdir(parents=True)
    (full / "notes.txt").write_text("nothing to see")
    for folder in (full, full / "of folders"):
        line = refused_to_draw(folder)
        assert line.startswith(f"{folder}: no picture in this folder")


def test_file_names_that_identify_no_map(tmp_path: Path, out: Path) -> None:
    for name in ("a", "b"):
        write_data(tmp_path / f"{name}.png", colors())
    line = refused_to_draw(tmp_path)
    assert "no file name identifies a map (a.png, b.png); name one: --base-color FILE" in line


@pytest.mark.parametrize("technique", ["relief", "steep", "offset"])
def test_no_heights_for_a_technique(technique: str, tmp_path: Path, out: Path) -> None:
    folder = folder_of(tmp_path, base_color=colors())
    line = refused_to_draw(folder, "--technique", technique)
    assert line.startswith(f"wall has no height map, which {technique} needs")
    assert "the technique flat" in line
    assert "wall-flat-basrelief.png" in done("render", folder, *DRAW)


def test_columns_are_not_measured_against_another_surface(bumps: Path, out: Path) -> None:
    line = refused_to_draw(bumps, "--technique", "texel", "--show", "missed")
    assert "--show missed measures against the bilinear surface, but texel draws columns" in line
    done("render", bumps, *DRAW, "--technique", "texel", "--show", "reads")


def test_two_files_for_one_map(tmp_path: Path, out: Path) -> None:
    folder = tmp_path / "two"
    folder.mkdir()
    for name in ("one", "two"):
        write_map(folder, "height", np.full((4, 4, 1), 7, np.uint8), name)
    line = refused_to_draw(folder)
    assert "one_Height.png and two_Height.png both fit the height map; name one picture" in line
    assert "--height FILE" in line
    done("render", folder, *DRAW, "--height", folder / "two_Height.png")


@pytest.mark.parametrize("suffix", [".png", ".exr", ".jpg", ".webp"])
def test_a_file_that_is_cut_off(suffix: str, tmp_path: Path, out: Path) -> None:
    folder = tmp_path / "wall"
    folder.mkdir()
    path = folder / f"wall_Height{suffix}"
    write_picture(path, np.random.default_rng(1).random((40, 40, 3), np.float32))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    line = refused_to_draw(folder)
    assert line.startswith(f"{path}: ")
    assert "damaged or cut off" in line or "is not a picture that can be read" in line
    assert line.endswith(("get the file again", "replace the file"))


@pytest.mark.parametrize("suffix", [".png", ".exr", ".jpg"])
@pytest.mark.parametrize("content", [b"", b"no picture at all\n" * 9], ids=["empty", "text"])
def test_a_file_that_is_not_a_picture(
    content: bytes, suffix: str, tmp_path: Path, out: Path
) -> None:
    folder = tmp_path / "wall"
    folder.mkdir()
    path = folder / f"wall_Height{suffix}"
    path.write_bytes(content)
    line = refused_to_draw(folder)
    assert line.startswith(f"{path}: is not a picture that can be read (")
    assert line.endswith("replace the file")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_heights_that_are_not_finite(bad: float, tmp_path: Path, out: Path) -> None:
    heights = np.full((4, 4, 1), 0.5, np.float32)
    heights[1, 2] = bad
    folder = folder_of(tmp_path, height=heights)
    line = refused_to_draw(folder)
    assert line.startswith("wall_Height.exr: 1 of its texels are NaN or infinite")


def test_proportions_that_disagree(tmp_path: Path, out: Path) -> None:
    folder = folder_of(tmp_path, base_color=colors(8, 8), height=np.full((4, 8, 1), 9, np.uint8))
    line = refused_to_draw(folder)
    assert line.startswith("wall_Height.png: the height map, 8×4, has other proportions")
    assert "the base_color map, 8×8" in line


def test_a_map_that_is_missing(bumps: Path, out: Path) -> None:
    assert refused_to_draw(bumps, "--normal", "no.png").startswith("no.png: there is no such file")
    assert refused_to_draw(bumps, "--normal", bumps).startswith(
        f"{bumps} has no normal map; choose"
    )


# --- settings -------------------------------------------------------------------------------------

WRONG = {
    "no steps": ("--technique steep --set steps=0", "steps is 0: give a number from 1 to 4096"),
    "no least steps": ("--set min_steps=0", "min_steps is 0: give a number from 1"),
    "an unknown setting": ("--set stepps=3", "--set stepps: there is no such setting here; there"),
    "no value": ("--set steps", "--set steps: write NAME=VALUE"),
    "no number": ("--set min_steps=many", "--set min_steps many: write a number"),
    "no finite number": ("--scale nan", "scale is nan: give a number from 0 to 10"),
    "an unknown sample": ("--technique bumpy", "no technique is called 'bumpy'; use one of flat"),
    "an unknown shape": ("--shape torus", "shape is one of plane, box, sphere, cylinder"),
    "an unknown device": ("--device abacus", "no device is called 'abacus'; use one of auto"),
    "a wrong size": ("--size big", "--size big: write width x height, for example 1280x720"),
    "no width": ("--size 0x9", "a picture of 0 × 9: give 1 to 32768 pixels a side"),
    "too large": ("--size 99999x9", "a picture of 99999 × 9: give 1 to 32768 pixels a side"),
    "no samples": ("--samples 0", "0 samples a pixel: give 1 to 1024"),
    "too many samples": ("--samples 9999", "9999 samples a pixel: give 1 to 1024"),
    "inside the sphere": (
        "--shape sphere --camera distance=0.3",
        "the camera is inside the sphere; move it away, for example --camera distance=3",
    ),
    "inside the box": ("--shape box --camera position=0.2/0.4/0", "the camera is inside the box"),
    "inside the cylinder": ("--shape cylinder --camera distance=0.4", "is inside the cylinder"),
    "inside the relief": (
        "--reference-height 0 --scale 0.5 --camera position=0.1/0.2/0",
        "the camera is inside the plane",
    ),
    "behind the plane": ("--camera elevation=-20", "the camera is behind the plane, which has no"),
    "no such light": ("--light lamp", "--light lamp: begin with directional, point, spot"),
    "no depth": ("--depth 0 --tile 1", "depth is a length above 0 metres, not 0"),
    "no such green": ("--normal-convention up", "normal_convention is one of auto, gl, dx"),
    "no such packing": ("--normal-packing bgr", "normal_packing is one of rgb, ag, rg"),
    "no such channel": ("--height-channel x", "height_channel is one of auto, r, g, b, a, lum"),
    "a number that is none": ("--bias x", "--bias x: write a number"),
    "no whole number": ("--shadow-map-size 1e3", "--shadow-map-size 1e3: write a whole number"),
    "a quality out of range": ("--quality 0", "--quality 0: give a number from 1 to 100"),
    "a setting as an option": ("--max-steps 3", "--max-steps: write --set max_steps=VALUE"),
    "a misspelled setting": ("--set maxsteps=3", "; did you mean max_steps?"),
    "a misspelled preset": ("--preset gamdev", "; did you mean gamedev?"),
    "a misspelled light": ("--light directonal", "; did you mean directional?"),
    "a turn without an axis": (
        "--turn 90", "--turn 90: write an axis and degrees, for example x/30",
    ),
    "a turn without degrees": ("--turn x", "--turn x: write an axis and degrees"),
    "no stretch": ("--stretch 1,0,2", "--stretch 1,0,2: write numbers other than 0"),
    "no such bits": ("--bits 12", "old.png: .png holds 8 or 16 bits a channel, not 12"),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_settings_that_cannot_be_drawn(what: str, bumps: Path, out: Path) -> None:
    text, message = WRONG[what]
    assert message in refused_to_draw(bumps, *text.split())


def test_an_unknown_sample(out: Path) -> None:
    line = refused_to_draw("sample:sand")
    assert line.startswith("there is no sample 'sand'; choose one of bricks, cobbles")


# --- places to write to ---------------------------------------------------------------------------


@pytest.fixture
def drawing_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make drawing fail: targets are checked before anything is drawn."""

    def drawn(*_: Any) -> None:
        raise AssertionError("it drew a picture that has no place")

    monkeypatch.setattr(choose_device("cpu"), "run", drawn, raising=False)


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("nowhere/a.png", "nowhere/a.png: the folder nowhere does not exist; make it first"),
        ("old.png/a.png", "old.png/a.png: the folder old.png does not exist; make it first"),
        ("a.bmp", "a.bmp: the suffix .bmp names no known format; use one of .png .jpg"),
        ("a", "a: a name without suffix names no known format; use one of .png .jpg"),
        ("../out", "../out: a name without suffix"),
        ("folder.png", "folder.png: is a folder; name a file"),
    ],
)
@pytest.mark.usefixtures("drawing_fails")
def test_targets_that_cannot_be_written(target: str, message: str, bumps: Path, out: Path) -> None:
    Path("folder.png").mkdir()
    assert message in refused("render", bumps, *DRAW, "-o", target)
    assert sorted(os.listdir()) == ["folder.png", "old.png"]
    assert os.listdir("folder.png") == []


@pytest.mark.usefixtures("drawing_fails")
def test_a_folder_that_cannot_be_written(
    bumps: Path, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.access
    locked = {out, Path()}
    monkeypatch.setattr(
        os, "access", lambda path, mode: real(path, mode) and not
        (mode & os.W_OK and Path(path) in locked)
    )  # fmt: skip
    message = "the folder . cannot be written; choose another place"
    assert refused_to_draw(bumps) == f"old.png: {message}"
    assert refused("render", bumps, *DRAW) == f"bumps-relief-basrelief.png: {message}"


def test_a_disk_that_is_full(bumps: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, _: bytes) -> None:
        path.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    line = refused_to_draw(bumps)
    assert line.startswith("old.png: cannot be written (No space left on device)")


@pytest.fixture
def small_demo(monkeypatch: pytest.MonkeyPatch) -> None:
    """A demo of two pictures of small samples."""
    monkeypatch.setattr(demo, "_SHOWN", ["flat"])
    monkeypatch.setattr(demo, "_SHAPES", (("cobbles", "plane"),))
    monkeypatch.setattr(demo, "sample", lambda name: sample(name, 16))


@pytest.mark.usefixtures("small_demo")
@pytest.mark.parametrize("place", ["old.png", "old.png/pictures"])
def test_a_demo_in_a_folder_that_cannot_be_made(place: str, out: Path) -> None:
    line = refused("demo", "--device", "cpu", "-o", place)
    assert line.startswith(f"{place}: cannot be made (")
    assert os.listdir() == ["old.png"]


# --- devices --------------------------------------------------------------------------------------


@pytest.fixture
def no_device_is_cached(monkeypatch: pytest.MonkeyPatch) -> None:
    """Do not use engines that an earlier test has made."""
    monkeypatch.setattr("basrelief.engine.select._engines", {})


@pytest.mark.usefixtures("no_device_is_cached", "small_demo")
@pytest.mark.parametrize("error", [RuntimeError("no adapter\nat all"), OSError("no driver")])
def test_no_gpu(error: Exception, bumps: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def request(**_: Any) -> None:
        raise error

    without = types.ModuleType("wgpu")
    without.gpu = types.SimpleNamespace(request_adapter_sync=request)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "wgpu", without)
    monkeypatch.setattr("basrelief.engine.gpu._exclude_opengl", lambda: None)
    reason = str(error).split("\n")[0]
    line = refused_to_draw(bumps, "--device", "gpu")
    assert line.startswith(f"no usable GPU found ({reason})")
    assert "--device cpu" in line
    assert refused("demo", "--device", "gpu") == line


@pytest.mark.usefixtures("no_device_is_cached")
def test_no_wgpu(bumps: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "wgpu", None)
    line = refused_to_draw(bumps, "--device", "gpu")
    assert line.startswith("the device gpu needs wgpu")
    assert "pip install 'basrelief[gpu]'" in line


def test_in_a_separate_process(bumps: Path, out: Path) -> None:
    """No traceback, and no message of other libraries."""
    for content in (b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0\0\x10JFIF\0half"):
        path = out.parent / f"wall_Height.{'png' if b'PNG' in content else 'jpg'}"
        path.write_bytes(content)
        result = run_apart("render", path, "-o", "old.png")
        assert (result.returncode, result.stdout) == (2, "")
        assert result.stderr.startswith(f"basrelief: {path}: ")
        assert result.stderr.count("\n") == 1
    assert os.listdir() == ["old.png"]


def test_tests_do_not_fill_the_users_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    of_tests = environment()["BASRELIEF_CACHE"]
    monkeypatch.delenv("BASRELIEF_CACHE")
    assert of_tests != str(cache_folder())


# --- unusual input that works ---------------------------------------------------------------------


def drawn(folder: Path, *arguments: str | Path) -> np.ndarray:
    """Codes of the picture; asserts that it shows more than the background."""
    done("render", folder, *DRAW, *arguments, "-o", "new.png")
    pixels = read_picture("new.png").pixels
    assert pixels.shape == (9, 12, 3)
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 1
    return pixels


def test_a_single_texel_is_flat(tmp_path: Path, out: Path) -> None:
    folder = folder_of(tmp_path, base_color=colors(1, 1), height=np.full((1, 1, 1), 255, np.uint8))
    assert (drawn(folder) == drawn(folder, "--technique", "flat")).all()


def test_a_single_texel_beside_larger_maps(tmp_path: Path, out: Path) -> None:
    noise = np.random.default_rng(4).integers(0, 255, (5, 7, 1), np.uint8)
    folder = folder_of(tmp_path, base_color=colors(1, 1), height=noise, roughness=noise[:1, :1])
    drawn(folder)


def test_maps_of_different_sizes(tmp_path: Path, out: Path) -> None:
    """A map of twice the size gives the same picture; sizes are not powers of two."""
    noise = np.random.default_rng(4).integers(0, 255, (6, 9, 1), np.uint8)
    grey = np.full((3, 5, 3), 90, np.uint8)
    folder = folder_of(tmp_path, height=noise, roughness=noise[:2, :3], base_color=grey[:2, :3])
    first = drawn(folder)
    write_map(folder, "base_color", np.full((10, 15, 3), 90, np.uint8))
    assert (drawn(folder) == first).all()


@pytest.mark.parametrize(("height", "width"), [(3, 17), (17, 3), (1, 5), (5, 1), (13, 13)])
def test_odd_sizes(height: int, width: int, tmp_path: Path, out: Path) -> None:
    noise = np.random.default_rng(4).integers(0, 65535, (height, width, 1), np.uint16)
    folder = folder_of(tmp_path, height=noise, base_color=colors(height, width))
    picture = drawn(folder, "--scale", "0.2")
    assert not (picture == drawn(folder, "--technique", "flat")).all()


@pytest.mark.parametrize("channels", [2, 3, 4])
def test_heights_in_several_channels(channels: int, tmp_path: Path, out: Path) -> None:
    """Equal channels and opaque alpha give the picture of a single channel."""
    noise = np.random.default_rng(4).integers(0, 255, (6, 8, 1), np.uint8)
    alone = drawn(folder_of(tmp_path, height=noise))
    several = np.repeat(noise, channels, axis=2)
    if channels in (2, 4):
        several[:, :, -1] = 255
    write_map(tmp_path / "wall", "height", several)
    assert (drawn(tmp_path / "wall") == alone).all()


@pytest.mark.parametrize("channels", [1, 4])
def test_colors_in_one_channel_or_four(channels: int, tmp_path: Path, out: Path) -> None:
    grey = colors(4, 4, 1)
    three = drawn(folder_of(tmp_path, base_color=np.repeat(grey, 3, axis=2)))
    pixels = grey if channels == 1 else np.dstack([grey, grey, grey, np.full_like(grey, 255)])
    write_map(tmp_path / "wall", "base_color", pixels)
    assert (drawn(tmp_path / "wall") == three).all()


def test_a_palette(tmp_path: Path, out: Path) -> None:
    entries = np.array([[200, 10, 30], [20, 180, 60], [5, 90, 250]], np.uint8)
    indices = np.random.default_rng(4).integers(0, 3, (5, 6), np.uint8)
    folder = folder_of(tmp_path, base_color=entries[indices])
    plain = drawn(folder)
    (folder / "wall_Color.png").write_bytes(palette_png(entries, indices))
    assert (drawn(folder) == plain).all()


def palette_png(entries: np.ndarray, indices: np.ndarray) -> bytes:
    """A PNG file of colour type 3 (ISO/IEC 15948, 2004, 11.2), by hand."""

    def chunk(name: bytes, body: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(name + body))
        return struct.pack(">I", len(body)) + name + body + check

    height, width = indices.shape
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
    rows = zlib.compress(b"".join(b"\0" + row.tobytes() for row in indices))
    body = chunk(b"PLTE", entries.tobytes()) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + head + body


def test_a_preset_that_cannot_be_written_is_refused_before_the_search(
    bumps: Path, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("basrelief.measure.tune.tune", lambda *_, **__: pytest.fail("searched"))
    for arguments, message in (
        (["-o", "missing/wall.toml"], "missing/wall.toml: the folder missing does not exist"),
        (["-o", "wall.json"], "wall.json: a preset is a .toml file"),
        (["--background", "none"], "a preset has no transparent background"),
    ):
        assert refused("tune", bumps, "--missed", "5%", *arguments).startswith(message)
    assert refused("tune", bumps) == "give one bound: --missed 0.1% or --flip 0.05"


def test_the_command_line_alone_prints_the_help_alone(out: Path) -> None:
    assert run_apart().stderr == ""
