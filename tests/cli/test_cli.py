"""The command line against the library: each option, each format, each command."""

from __future__ import annotations

import itertools
import json
import os
import pty
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import basrelief
from basrelief.cli import main
from basrelief.engine import choose_device, cpu, gpu, select
from basrelief.images import read_picture, srgb_encode, write_data
from basrelief.material import describe, report
from basrelief.scene import Layer, Tiling, placed, rotated
from basrelief.settings import settings_of
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.techniques import TECHNIQUES
from helpers.command_line import (
    COMMAND,
    FILE_NAMES,
    done,
    environment,
    interruptible,
    refused,
    run,
    run_apart,
    write_heights,
    write_material,
)

SIZE = (28, 20)
NAMED = 128
"""Texels a side of samples that tests load by name."""
DRAW = ("--size", "28x20", "--samples", "1", "--device", "cpu")


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all eight maps."""
    return write_material(tmp_path_factory.mktemp("maps") / "wall")


@pytest.fixture(scope="module")
def bumps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with only a height map."""
    return write_heights(tmp_path_factory.mktemp("maps") / "bumps")


@pytest.fixture(scope="module")
def others(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Another file for each map, with a name that does not identify it."""
    folder = tmp_path_factory.mktemp("others")
    noise = np.random.default_rng(8)
    for kind in FILE_NAMES:
        channels = 3 if kind in ("base_color", "normal", "emission", "height") else 1
        pixels = noise.integers(100, 200, (12, 12, channels), np.uint8)
        write_data(folder / f"{kind[0]}{len(kind)}.png", pixels)
    return folder


def other(others: Path, kind: str) -> Path:
    return others / f"{kind[0]}{len(kind)}.png"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that commands run in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def drawn(path: Path, loading: dict[str, Any] | None = None, **options: Any) -> np.ndarray:
    """The picture that the library draws: linear, (height, width, 4)."""
    options = {"size": SIZE, "samples": 1, **options}
    material = basrelief.load(path, **(loading or {}))
    return basrelief.render(material, device=choose_device("cpu"), **options).color


def drawn_by_command(*arguments: str | Path) -> np.ndarray:
    """The picture that the command line draws, through a file of 32-bit floats."""
    done("render", *arguments, "-o", "picture.tif", "--bits", "32")
    return read_picture("picture.tif").pixels


def same(drawn: np.ndarray, expected: np.ndarray) -> bool:
    """Whether pictures are equal to the last bit; opaque ones are stored without alpha."""
    if drawn.shape[2] == 3:
        assert (expected[:, :, 3] == 1.0).all()
    return drawn.shape[:2] == expected.shape[:2] and bool(
        (drawn == expected[:, :, : drawn.shape[2]]).all()
    )


# --- options --------------------------------------------------------------------------------------

LIT = {"intensity": 3.0, "position": (0.4, 1.0, 0.3)}
OPTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "technique": ("--technique steep", {"technique": "steep"}),
    "setting": (
        "--technique steep --set steps=3", {"technique": "steep", "settings": {"steps": 3}},
    ),
    "settings": (
        "--set min_steps=2 --set max-steps=3 --set search_steps=0",
        {"settings": {"min_steps": 2, "max_steps": 3, "search_steps": 0}},
    ),
    "surface_parameters": (
        "--set roughness=0.2 --set base_color=0.9,0.1/0.2 --set normal_strength=0",
        {"surface_parameters": SurfaceParameters(
            basrelief.lang.Vec3(0.9, 0.1, 0.2), roughness=0.2, normal_strength=0.0
        )},
    ),
    "shading": (
        "--set ambient=0.7", {"shading": basrelief.Shading(ambient=basrelief.lang.Vec3(0.7))},
    ),
    "shading model": (
        "--shading-model phong --set shininess=3",
        {"shading_model": "phong", "surface_parameters": {"shininess": 3.0}},
    ),
    "shape": ("--shape cylinder", {"shape": "cylinder"}),
    "scale": ("--scale 0.21", {"scale": 0.21}),
    "level": ("--reference-height 0.3", {"reference_height": 0.3}),
    "projection": ("--projection limited", {"projection": "limited"}),
    "bias": ("--projection biased --bias 0.1", {"projection": "biased", "bias": 0.1}),
    "clamp": ("--edge clamp --scale 0.3", {"edge": "clamp", "scale": 0.3}),
    "clip": ("--edge clip --scale 0.3", {"edge": "clip", "scale": 0.3}),
    "tiling": ("--tiling 2x3", {"tiling": (2.0, 3.0)}),
    "one number of tiles": ("--tiling 2", {"tiling": (2.0, 2.0)}),
    "shift": ("--shift 0.25,0.6", {"shift": (0.25, 0.6)}),
    "orbit": (
        "--camera azimuth=-60,elevation=50,distance=1.5,field_of_view=40,target=0.1/0/0.2",
        {"camera": basrelief.Orbit(-60.0, 50.0, 1.5, (0.1, 0.0, 0.2), 40.0)},
    ),
    "framed": ("--camera azimuth=70", {"camera": basrelief.Orbit(70.0)}),
    "position": (
        "--camera position=0.5/0.9/0.4,up=1/0/0,target=0/0/0.1",
        {"camera": basrelief.LookAt((0.5, 0.9, 0.4), (0.0, 0.0, 0.1), (1.0, 0.0, 0.0))},
    ),
    "orthographic": (
        "--camera orthographic-height=1.2,elevation=60",
        {"camera": basrelief.Orbit(elevation=60.0, orthographic_height=1.2)},
    ),
    "directional": (
        "--light directional,azimuth=10,elevation=70,intensity=2,color=1/0.5/0.2",
        {"lights": [basrelief.directional(10.0, 70.0, (1.0, 0.5, 0.2), 2.0)]},
    ),
    "point": (
        "--light point,position=0.4/1/0.3,intensity=3,falloff=1",
        {"lights": [basrelief.point(**LIT, falloff=1.0)]},
    ),
    "spot": (
        "--light spot,position=0.4/1/0.3,target=0.1/0/0,angle=30,softness=0.5,intensity=3",
        {"lights": [basrelief.spot(**LIT, target=(0.1, 0.0, 0.0), angle=30.0, softness=0.5)]},
    ),
    "two lights": (
        "--light directional --light point,position=0.4/1/0.3,intensity=3",
        {"lights": [basrelief.directional(), basrelief.point(**LIT)]},
    ),
    "smooth heights": (
        "--heights smooth --set mip-bias=2 --set mip_fade=1",
        {"heights": "smooth", "smoothing": {"mip_bias": 2.0, "mip_fade": 1.0}},
    ),
    "fade": ("--fade 1.5,3", {"fade": (1.5, 3.0)}),
    "own tiling": (
        "--tiling 2 --map-tiling normal=3x2 --map-shift normal=0.1,0",
        {"tiling": (2.0, 2.0), "tilings": {"normal": Tiling((3.0, 2.0), (0.1, 0.0))}},
    ),
    "alpha": ("--alpha opaque", {"alpha": "opaque"}),
    "mapping": ("--mapping triplanar", {"mapping": "triplanar"}),
    "layer": (
        "--layer sample:grid --layer-tiling 5x3 --layer-shift 0.25,0 --set layer_color=0.5",
        {
            "layer": Layer(basrelief.sample("grid", NAMED), Tiling((5.0, 3.0), (0.25, 0.0))),
            "surface_parameters": {"layer_color": 0.5},
        },
    ),
    "layer offset": (
        "--layer sample:grid --layer-tiling 5x3 --layer-offset unscaled",
        {
            "layer": Layer(basrelief.sample("grid", NAMED), Tiling((5.0, 3.0))),
            "layer_offset": "unscaled",
        },
    ),
    "noise over stretched texels": ("--mapping noise", {"mapping": "noise"}),
    "landscape": (
        "--surface landscape --set water_level=0.6 --set sky-color=0/1/0",
        {
            "surface": "landscape",
            "surface_parameters": {"water_level": 0.6, "sky_color": (0.0, 1.0, 0.0)},
        },
    ),
    "fog": ("--fog-mode exponential --set fog_density=0.9", {
        "fog_mode": "exponential", "fog": {"fog_density": 0.9},
    }),
    "occlusion": (
        "--occlusion-kind directional --set directional_occlusion=0.7",
        {"occlusion_kind": "directional", "shading": {"directional_occlusion": 0.7}},
    ),
    "shadows": (
        "--shadows soft --set light_angle=20 --scale 0.3",
        {"shadows": "soft", "shadowing": {"light_angle": 20.0}, "scale": 0.3},
    ),
    "a hole": ("--opening 0.8 --shadows hard", {"opening": 0.8, "shadows": "hard"}),
    "preset": ("--preset gamedev", {"preset": "gamedev"}),
    "over a preset": (
        "--preset gamedev --scale 0.2 --set max_steps=9", {
            "preset": "gamedev", "scale": 0.2, "settings": {"max_steps": 9},
        },
    ),
    "background": ("--background 0.8,0.1,0.3", {"background": (0.8, 0.1, 0.3)}),
    "grey background": ("--background 0.5", {"background": (0.5, 0.5, 0.5)}),
    "no background": ("--background none", {"background": None}),
    "samples": ("--samples 3", {"samples": 3}),
    "size": ("--size 13×9", {"size": (13, 9)}),
}  # fmt: skip


NEED_MAPS = (
    "own tiling",
    "alpha",
    "mapping",
    "layer",
    "occlusion",
    "layer offset",
    "noise over stretched texels",
)


@pytest.mark.parametrize("option", OPTIONS)
def test_options_of_drawing(option: str, bumps: Path, wall: Path, here: Path) -> None:
    """Each option has an effect, and the same as in Python, to the last bit."""
    text, options = OPTIONS[option]
    path = wall if option in NEED_MAPS else bumps
    picture = drawn_by_command(path, *DRAW, *text.split())
    expected = drawn(path, **options)
    assert same(picture, expected)
    default = drawn(path)
    assert picture.shape[:2] != default.shape[:2] or not same(picture, default)


def test_a_hole_by_maps_of_ones_own(bumps: Path, wall: Path, here: Path) -> None:
    """Cracks and dust are those of files, folders or samples."""
    files = here / "files"
    files.mkdir()
    ramp = np.linspace(0, 255, 16 * 16).reshape(16, 16, 1).astype(np.uint8)
    for name in ("thick", "split"):
        write_data(files / f"{name}.png", ramp if name == "thick" else ramp[::-1])
    pictures = []
    for cracks, dust in (
        ("sample:cracks", "sample:dust"), (files / "split.png", files / "thick.png"),
        (bumps, bumps), (bumps, "sample:noise"),
    ):  # fmt: skip
        maps = {"height": str(cracks), "dust": str(dust)}
        options = ("--height", maps["height"], "--dust", maps["dust"], "--opening", "0.7")
        picture = drawn_by_command(bumps, *DRAW, *options)
        assert same(picture, drawn(bumps, loading=maps, opening=0.7))
        pictures.append(picture)
    assert not any((a == b).all() for a, b in itertools.combinations(pictures, 2))
    assert "dust from sample:noise: requested" in done("info", bumps, "--dust", "sample:noise")


def test_stretch(bumps: Path, here: Path) -> None:
    picture = drawn_by_command(bumps, *DRAW, "--shape", "box", "--stretch", "1,0.5,2")
    expected = drawn(bumps, shape="box", transform=placed(scale=(1.0, 0.5, 2.0)))
    assert same(picture, expected)
    # a plane is horizontal before it is stretched
    picture = drawn_by_command(bumps, *DRAW, "--stretch", "1/1/2")
    lying = basrelief.Object(basrelief.load(bumps)).resolved.transform
    expected = drawn(bumps, transform=placed(scale=(1.0, 1.0, 2.0)) @ lying)
    assert same(picture, expected)


def test_turn(bumps: Path, here: Path) -> None:
    lying = basrelief.Object(basrelief.load(bumps)).resolved.transform
    picture = drawn_by_command(bumps, *DRAW, "--turn", "x/90")
    assert same(picture, drawn(bumps, transform=rotated("x", 90.0) @ lying))
    assert not same(picture, drawn(bumps))
    # the shape is stretched first, as an added object is
    picture = drawn_by_command(bumps, *DRAW, "--turn", "z/-30", "--stretch", "1,1,0.5")
    expected = drawn(bumps, transform=rotated("z", -30.0) @ placed(scale=(1.0, 1.0, 0.5)) @ lying)
    assert same(picture, expected)


ADDED = "sphere,position=0/0.2/0,size=0.5,material=sample:tiles,technique=steep,scale=0.1"


def test_further_objects(bumps: Path, here: Path) -> None:
    box = "box,position=0.3/0.2/0,size=0.2/0.4/0.2,turn=y/30,color=1/0.5/0.2"
    lit = ("--shadows", "hard", "--shadows-on", "polygon")
    picture = drawn_by_command(bumps, *DRAW, *lit, "--add", ADDED, "--add", box)
    white = basrelief.Map(np.ones((1, 1, 3), np.float32), False, "white")
    objects = (
        basrelief.Object(basrelief.load(bumps)),
        basrelief.Object(
            basrelief.sample("tiles", NAMED), "sphere", "steep", scale=0.1,
            transform=placed((0.0, 0.2, 0.0), 0.5),
        ),
        basrelief.Object(
            basrelief.Material("white", base_color=white), "box",
            surface_parameters={"base_color": (1.0, 0.5, 0.2)},
            transform=placed((0.3, 0.2, 0.0)) @ rotated("y", 30.0) @ placed(scale=(0.2, 0.4, 0.2)),
        ),
    )  # fmt: skip
    scene = basrelief.Scene(objects, shadows="hard", shadows_on="polygon")
    expected = basrelief.render(scene, size=SIZE, samples=1, device="cpu").color
    assert same(picture, expected)


def test_casting_none(bumps: Path, here: Path) -> None:
    """An object that casts no shadow does not darken others."""
    above = "box,position=0/0.3/0,size=0.4"
    noon = ("--shadows", "hard", "--light", "directional,elevation=85")
    with_it = drawn_by_command(bumps, *DRAW, *noon, "--add", f"{above},casts=none")
    shadow = drawn_by_command(bumps, *DRAW, *noon, "--add", above)
    assert (shadow <= with_it).all()
    assert (shadow < with_it).any()
    picture = drawn_by_command(bumps, *DRAW, "--casts", "opaque")
    assert same(picture, drawn(bumps, casts="opaque"))


READING = {
    "depth and tile": ("--depth 0.3 --tile 1.5", {"depth": 0.3, "tile": 1.5}),
    "green": ("--normal-convention dx", {"normal_convention": "dx"}),
    "packing": ("--normal-packing rg", {"normal_packing": "rg"}),
    "polarity": ("--height-polarity depth", {"height_polarity": "depth"}),
    "stretched": ("--stretch-height", {"stretch_height": True}),
}


@pytest.mark.parametrize("option", READING)
def test_options_of_reading(option: str, wall: Path, here: Path) -> None:
    text, loading = READING[option]
    expected = drawn(wall, loading)
    assert same(drawn_by_command(wall, *DRAW, *text.split()), expected)
    assert not (expected == drawn(wall)).all()
    info = json.loads(done("info", wall, "--json", *text.split()))
    assert info == as_json(basrelief.load(wall, **loading))
    assert info != as_json(basrelief.load(wall))


def as_json(material: basrelief.Material) -> Any:
    return json.loads(json.dumps(describe(material)))


@pytest.mark.parametrize("kind", FILE_NAMES)
def test_a_file_for_each_map(kind: str, wall: Path, others: Path, here: Path) -> None:
    option, file = f"--{kind.replace('_', '-')}", other(others, kind)
    expected = drawn(wall, {kind: file})
    assert same(drawn_by_command(wall, *DRAW, option, file), expected)
    assert not (expected == drawn(wall)).all()
    info = json.loads(done("info", wall, "--json", option, file))
    assert info["maps"][kind]["source"].startswith(file.name)


def test_height_channel(wall: Path, others: Path, here: Path) -> None:
    file = other(others, "height")
    expected = drawn(wall, {"height": file, "height_channel": "b"})
    picture = drawn_by_command(wall, *DRAW, "--height", file, "--height-channel", "b")
    assert same(picture, expected)
    assert not (expected == drawn(wall, {"height": file})).all()
    info = json.loads(done("info", wall, "--json", "--height", file, "--height-channel", "b"))
    assert info["maps"]["height"]["source"] == f"{file.name} (B)"


def test_info_reads_as_render_does() -> None:
    """Both commands have all options of reading maps."""
    named = {name: set(command_options(name)) for name in ("info", "render")}
    assert named["info"] - {"json"} < named["render"]
    assert set(command_options("info")) - {"json"} >= {*FILE_NAMES, "depth", "tile"}


def command_options(name: str) -> list[str]:
    (command,) = [c for c in main.app.registered_commands if c.callback.__name__ == name]
    return list(command.callback.__annotations__)


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("file", "extra", "dtype", "close"),
    [
        ("a.png", (), np.uint8, 0.5 / 255),
        ("a.PNG", ("--bits", "16"), np.uint16, 0.5 / 65535),
        ("a.jpg", ("--quality", "100"), np.uint8, 3 / 255),
        ("a.jpeg", (), np.uint8, 25 / 255),
        ("a.webp", ("--quality", "100"), np.uint8, 0.5 / 255),
    ],
)
def test_formats_for_the_eye(
    file: str, extra: tuple[str, ...], dtype: type, close: float, bumps: Path, here: Path
) -> None:
    # explicit, so that compression errors do not change with the defaults
    explicit = (
        *("--camera", "distance=1.8"),
        *("--light", "directional,azimuth=-50,elevation=35,color=1/0.96/0.9,intensity=2.6"),
        *("--light", "directional,azimuth=120,elevation=25,color=0.8/0.9/1,intensity=0.6"),
    )
    printed = done("render", bumps, *DRAW, *explicit, "-o", file, *extra)
    assert printed == f"{file}  (cpu: {choose_device('cpu').adapter})\n"
    assert os.listdir() == [file]
    back = read_picture(file).pixels
    assert back.dtype == dtype
    most = np.iinfo(dtype).max
    lights = (
        basrelief.directional(-50.0, 35.0, (1.0, 0.96, 0.9), 2.6),
        basrelief.directional(120.0, 25.0, (0.8, 0.9, 1.0), 0.6),
    )
    color = drawn(bumps, camera=basrelief.Orbit(distance=1.8), lights=lights)
    wanted = srgb_encode(np.clip(color[:, :, :3], 0.0, 1.0))
    assert np.abs(back / most - wanted).max() < close + 1e-6


@pytest.mark.parametrize(("bits", "close"), [((), 2**-11), (("--bits", "32"), 0.0)])
def test_exr_is_linear(bits: tuple[str, ...], close: float, bumps: Path, here: Path) -> None:
    done("render", bumps, *DRAW, "-o", "a.exr", *bits)
    wanted = drawn(bumps)[:, :, :3]
    assert read_picture("a.exr").pixels == pytest.approx(wanted, rel=close, abs=close)


def test_quality_makes_smaller_files(bumps: Path, here: Path) -> None:
    for quality in ("20", "90"):
        done("render", bumps, *DRAW, "-o", f"{quality}.jpg", "--quality", quality)
    assert Path("20.jpg").stat().st_size < Path("90.jpg").stat().st_size


def test_a_background_of_none_is_transparent(bumps: Path, here: Path) -> None:
    done("render", bumps, *DRAW, "-o", "a.png", "--background", "none")
    alpha = read_picture("a.png").pixels[:, :, 3]
    assert set(np.unique(alpha)) == {0, 255}


@pytest.mark.parametrize("technique", ["relief", "flat"])
def test_the_file_is_named_after_material_and_technique(
    technique: str, bumps: Path, here: Path
) -> None:
    chosen = () if technique == "relief" else ("--technique", technique)
    assert done("render", bumps, *DRAW, *chosen).startswith(f"bumps-{technique}-basrelief.png ")
    assert os.listdir() == [f"bumps-{technique}-basrelief.png"]


def test_an_old_file_is_replaced(bumps: Path, here: Path) -> None:
    Path("a.png").write_text("old")
    done("render", bumps, *DRAW, "-o", "a.png")
    assert read_picture("a.png").pixels.shape == (20, 28, 3)


def test_samples_by_name(here: Path) -> None:
    done("render", "sample:tiles", *DRAW, "--technique", "flat", "-o", "a.png")
    color = drawn("sample:tiles", technique="flat")[:, :, :3]
    wanted = srgb_encode(np.clip(color, 0, 1)) * 255
    assert np.abs(read_picture("a.png").pixels - wanted).max() < 0.51


def test_a_material_without_heights_is_drawn_flat_with_a_note(tmp_path: Path, here: Path) -> None:
    folder = tmp_path / "paper"
    folder.mkdir()
    pixels = np.random.default_rng(5).integers(0, 255, (4, 4, 3), np.uint8)
    write_data(folder / "paper_Color.png", pixels)
    outcome = run("render", folder, *DRAW)
    assert outcome.code == 0
    assert outcome.out.startswith("paper-flat-basrelief.png ")
    assert outcome.err == "note: paper has no height map, so it is drawn flat\n"
    assert run("render", folder, *DRAW, "--technique", "flat").err == ""


# --- devices --------------------------------------------------------------------------------------


@pytest.mark.gpu
def test_device_gpu(bumps: Path, here: Path) -> None:
    printed = done("render", bumps, *DRAW, "--device", "gpu", "-o", "gpu.png")
    assert printed == f"gpu.png  (gpu: {choose_device('gpu').adapter})\n"
    done("render", bumps, *DRAW, "-o", "cpu.png")
    difference = read_picture("gpu.png").pixels.astype(int) - read_picture("cpu.png").pixels
    assert (np.abs(difference) <= 2).mean() > 0.99


@pytest.mark.parametrize("kind", ["CPU", "DiscreteGPU"])
def test_device_auto_chooses_only_a_hardware_gpu(
    kind: str, bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Adapter:
        info = {"adapter_type": kind}  # noqa: RUF012

    class GpuEngine(cpu.CpuEngine):
        name = "gpu"

    monkeypatch.setattr(select, "_has_device_file", lambda: True)
    monkeypatch.setattr(gpu, "request_adapter", Adapter)
    monkeypatch.setattr(select, "has_hardware_gpu", select.has_hardware_gpu.__wrapped__)
    monkeypatch.setattr(gpu, "GpuEngine", GpuEngine)
    monkeypatch.setattr("basrelief.engine.select.choose_device", fresh_choice)
    name = "cpu" if kind == "CPU" else "gpu"
    assert f"({name}: " in done("render", bumps, "--size", "8x8")


def test_without_a_device_no_driver_is_started(monkeypatch: pytest.MonkeyPatch) -> None:
    def started() -> Any:
        raise AssertionError("a driver was started")

    monkeypatch.setattr(gpu, "request_adapter", started)
    monkeypatch.setattr(select.sys, "platform", "linux")
    monkeypatch.setattr(select, "_DEVICE_FILES", ("no-such-device*",))
    assert not select.has_hardware_gpu.__wrapped__()
    monkeypatch.setattr(select, "_DEVICE_FILES", ("null",))
    with pytest.raises(AssertionError, match="was started"):
        select.has_hardware_gpu.__wrapped__()


def fresh_choice(name: str) -> Any:
    """`choose_device` without the engines of earlier calls."""
    with mock.patch.dict(select._engines, clear=True):
        return choose_device(name)


# --- info, techniques, help -----------------------------------------------------------------------


def test_info_reports_the_maps_and_how_they_were_recognised(wall: Path) -> None:
    printed = done("info", wall)
    assert printed == report(basrelief.load(wall)) + "\n"
    for name in FILE_NAMES.values():
        assert f"wall_{name}.png" in printed
    assert "normals with green up: GL by its name" in printed


def test_info_as_json(wall: Path) -> None:
    printed = json.loads(done("info", wall, "--json"))
    assert printed == as_json(basrelief.load(wall))
    assert printed["maps"]["height"]["bits"] == 16


def test_techniques_lists_each_with_its_settings_and_its_source() -> None:
    printed = done("techniques")
    parts = {part.split("\n")[0]: part for part in printed.split("\n\n")}
    assert list(parts)[: len(TECHNIQUES)] == list(TECHNIQUES)
    for name, made in TECHNIQUES.items():
        assert "Cost: " in " ".join(parts[name].split())
        for setting in settings_of(made.settings):
            assert f"\n    {setting}=" in parts[name]
    assert "Reference: F. Policarpo" in " ".join(parts["relief"].split())
    assert "----" not in printed
    assert "Defaults: --reference-height 0.5 --projection limited" in parts["offset_limited"]
    assert "    min_steps=8     1 to 4096  steps when looking straight down" in parts["relief"]
    assert "--set sets the numbers below" in parts["with every technique"]
    for heading, shown in (
        (
            "the standard surface (--surface standard)",
            "base_color=1/1/1 from 0 Factor of the base colour map, linear",
        ),
        (
            "the landscape surface (--surface landscape)",
            "water_level=0.4 0 to 1 Height of the water",
        ),
        ("smooth heights (--heights smooth, mip)", "mip_bias=1 0 to 16 mip levels"),
        ("the standard surface (--surface standard)", "shininess=10 1 to 1000"),
        ("the shading", "ambient=0.1/0.1/0.1 from 0"),
        ("shadows of the relief on itself (--shadows hard, soft)", "max_shadow_steps=64 1 to 4096"),
        (
            "the fog (--fog-mode linear, exponential, exponential_squared)",
            "fog_density=0.3 0 to 1000",
        ),
    ):
        assert f" {shown}" in " ".join(parts[heading].split())
    assert max(map(len, printed.splitlines())) <= 100


def test_version() -> None:
    assert done("--version") == f"basrelief {basrelief.__version__}\n"


def test_help(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    top = done("--help")
    for name in ("render", "info", "techniques", "presets", "demo"):
        assert name in top
        text = done(name, "-h")
        assert f"basrelief {name}" in text
        called = {"settings": "set", "lights": "light"}
        for option in set(command_options(name)) - {"path", "return"}:
            assert f"--{called.get(option, option).replace('_', '-')} " in text


@pytest.mark.parametrize("columns", [80, 120])
def test_help_is_complete_and_in_panels(columns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    text = done("render", "--help")
    assert max(map(len, text.splitlines())) <= columns
    # rich cuts long text with an ellipsis; others are part of the text
    cut = [line for line in text.splitlines() if line.rstrip(" │").endswith("…")]
    assert all(line.strip(" │") == "…" or "exr …" in line for line in cut)
    panels = [line.split()[1] for line in text.splitlines() if line.startswith("╭─")]
    assert panels == [
        "Arguments", "Options", "Relief", "Surface", "Light", "Fog", "Camera", "Picture", "Maps",
        "Further",
    ]  # fmt: skip
    words = " ".join(text.replace("│", " ").split())
    assert "normal_tiling=2x3; repeatable." in words
    assert "field_of_view=30 · position=1/1/1," in words


def test_help_is_fast() -> None:
    """It imports no heavy module."""
    code = (
        "import sys; sys.argv = ['basrelief', 'render', '--help']\n"
        "from basrelief.cli.main import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "print([m for m in ('numpy', 'llvmlite', 'wgpu', 'OpenImageIO') if m in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout.splitlines()[-1] == "[]", result.stderr


def test_presets_lists_each_with_its_source() -> None:
    printed = done("presets")
    parts = {part.split("\n")[0]: " ".join(part.split()) for part in printed.split("\n\n")}
    for name in basrelief.PRESETS:
        made = basrelief.preset(name)
        assert f"{made.about} After {made.source}." in parts[name]
    assert max(map(len, printed.splitlines())) <= 100


def test_without_arguments_help_is_printed() -> None:
    outcome = run()
    assert "Usage: " in outcome.out + outcome.err
    assert "techniques" in outcome.out + outcome.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["draw"], "No such command 'draw'"),
        (["--nothing"], "No such option: --nothing"),
        (["render"], "Missing argument"),
        (["render", "x", "y"], "unexpected extra argument"),
        (["render", "x", "--tecnique", "relief"], "No such option: --tecnique"),
        (["render", "x", "--samples", "few"], "--samples few: write a whole number"),
        (["render", "x", "--scale", "deep"], "--scale deep: write a number"),
        (["render", "x", "--quality", "0"], "--quality 0: give a number"),
        (["render", "x", "--shape"], "'--shape' requires an argument"),
        (["info", "x", "--size", "3x3"], "No such option: --size"),
        (["techniques", "relief"], "unexpected extra argument"),
    ],
)
def test_misspelt_commands(arguments: list[str], message: str) -> None:
    line = refused(*arguments)
    assert message.lower() in line.lower()
    assert line.endswith("(see basrelief COMMAND --help)")


# --- interrupted ----------------------------------------------------------------------------------


def test_interrupted_while_drawing(
    bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(choose_device("cpu"), "run", interrupted, raising=False)
    Path("a.png").write_text("old")
    outcome = run("render", bumps, *DRAW, "-o", "a.png")
    assert outcome == (130, "", "basrelief: interrupted; no unfinished file is left\n")
    assert os.listdir() == ["a.png"]
    assert Path("a.png").read_text() == "old"


def test_interrupted_while_writing(
    bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half(path: Path, _: bytes) -> None:
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "write_bytes", half)
    Path("a.png").write_text("old")
    assert run("render", bumps, *DRAW, "-o", "a.png").code == 130
    assert os.listdir() == ["a.png"]
    assert Path("a.png").read_text() == "old"


def test_ctrl_c_at_a_terminal(bumps: Path, here: Path) -> None:
    """A large picture, interrupted once its progress bar is shown."""
    Path("a.png").write_text("old")
    ours, its = pty.openpty()
    arguments = ("render", bumps, "--size", "4000x4000", "--samples", "200", "--device", "cpu")
    with subprocess.Popen(
        [*COMMAND, *map(str, arguments), "-o", "a.png"],
        stdout=subprocess.PIPE,
        stderr=its,
        env={**os.environ, **environment(), "TERM": "xterm", "COLUMNS": "100"},
        start_new_session=True,
        preexec_fn=interruptible,
    ) as process:
        os.close(its)
        shown = read_until(ours, b"drawing bumps")
        process.send_signal(signal.SIGINT)
        shown += read_until(ours, b"is left")
        assert process.wait(60) == 130
        assert process.stdout is not None
        assert process.stdout.read() == b""
    os.close(ours)
    assert b"basrelief: interrupted; no unfinished file is left" in shown
    assert b"Traceback" not in shown
    assert os.listdir() == ["a.png"]
    assert Path("a.png").read_text() == "old"


def read_until(terminal: int, wanted: bytes) -> bytes:
    """The output of a terminal, up to some text or its end."""
    seen = b""
    while wanted not in seen:
        try:
            seen += os.read(terminal, 4096)
        except OSError:  # the other side is closed
            break
    return seen


def test_too_little_memory(bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def too_much(*_: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(choose_device("cpu"), "run", too_much, raising=False)
    assert "does not fit in memory; use a smaller --size" in refused("render", bumps, *DRAW)
    assert os.listdir() == []


def test_internal_errors_keep_their_traceback(
    bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: Any) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(choose_device("cpu"), "run", broken, raising=False)
    with pytest.raises(ZeroDivisionError, match="a bug"):
        run("render", bumps, *DRAW)


# --- progress -------------------------------------------------------------------------------------


class Terminal:
    """A standard error that claims to be a terminal and records its text."""

    encoding = "utf-8"

    def __init__(self, is_terminal: bool = True) -> None:
        self.is_terminal = is_terminal
        self.text = ""

    def isatty(self) -> bool:
        return self.is_terminal

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def flush(self) -> None:
        pass


class Clock:
    """A fake `threading.Timer`, whose time the test sets."""

    def __init__(self, seconds: float, act: Any) -> None:
        self.seconds, self.act = seconds, act
        self.ident: int | None = None
        self.cancelled = False

    def start(self) -> None:
        self.ident = 1

    def cancel(self) -> None:
        self.cancelled = True

    def join(self) -> None:
        assert self.ident is not None

    def passes(self, seconds: float) -> None:
        if self.ident is not None and seconds > self.seconds and not self.cancelled:
            self.act()


@pytest.fixture
def progress(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr("threading.Timer", Clock)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return main._Progress("drawing stones")


@pytest.mark.parametrize(
    ("seconds", "terminal", "shown"), [(0.9, True, False), (1.1, True, True), (1.1, False, False)]
)
def test_a_bar_after_a_second_at_a_terminal(
    seconds: float,
    terminal: bool,
    shown: bool,
    progress: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    error = Terminal(terminal)
    monkeypatch.setattr(sys, "stderr", error)
    with progress:
        progress.timer.passes(seconds)
        progress(0.25)
        if progress.bar is not None:
            progress.bar.refresh()
        progress.task = "drawing trees"
        progress(0.5)
    assert ("drawing stones" in error.text) == shown
    assert ("drawing trees" in error.text) == shown
    assert ("25%" in error.text) == ("50%" in error.text) == shown
    assert bool(error.text) == shown
    assert progress.timer.cancelled
    assert capsys.readouterr().out == ""


def test_the_bar_shows_before_a_share_is_known(
    progress: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    error = Terminal()
    monkeypatch.setattr(sys, "stderr", error)
    with progress:
        progress.timer.passes(2.0)
    assert "drawing stones" in error.text
    assert "0%" not in error.text


# --- in a separate process -----------------------------------------------------------------------


def test_in_a_separate_process(bumps: Path, here: Path) -> None:
    result = run_apart("render", bumps, *DRAW, "-o", "a.png")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith("a.png  (cpu: ")
    wanted = srgb_encode(np.clip(drawn(bumps)[:, :, :3], 0, 1)) * 255
    assert np.abs(read_picture("a.png").pixels - wanted).max() < 0.51
    result = run_apart("render", "nowhere")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.count("\n") == 1
    assert result.stderr.startswith("basrelief: nowhere: ")


def test_a_terminal_without_unicode() -> None:
    result = run_apart("info", "sample:tiles", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert (result.returncode, result.stderr) == (0, "")
    assert "512?512" in result.stdout


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_closed_pipe(unbuffered: str) -> None:
    """As in `basrelief techniques | head -1`."""
    with subprocess.Popen(
        [*COMMAND, "techniques"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **environment(), "PYTHONUNBUFFERED": unbuffered},
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(60) == 1


# --- the package ----------------------------------------------------------------------------------


def test_basrelief_render_is_the_function() -> None:
    code = (
        "import basrelief.rendering.render, basrelief, types\n"
        "assert isinstance(basrelief.render, types.FunctionType)\n"
        "import basrelief.rendering.render\n"
        "from basrelief import render\n"
        "assert render is basrelief.rendering.render.render is basrelief.render\n"
        "from basrelief import *\n"
        "assert not set(basrelief.__all__) - {'__version__'} - set(globals())\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stderr == ""


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("render wall --technique parallax", "parallax_occlusion"),
        ("tune wall --preset gamed", "gamedev"),
        ("bake wall --device g", "gpu"),
        ("bake wall norm", "normal"),
    ],
)
def test_the_shell_completes_names(words: str, completed: str) -> None:
    line = f"basrelief {words}"
    count = str(len(line.split()) - 1)
    script = "from basrelief.cli.main import app; app(prog_name='basrelief')"
    variables = {"COMP_WORDS": line, "COMP_CWORD": count, "_BASRELIEF_COMPLETE": "complete_bash"}
    outcome = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True, text=True, env={**os.environ, **variables}, timeout=60,
    )  # fmt: skip
    assert outcome.stdout.split() == [completed]


def test_a_film_of_a_hole_refuses_what_it_would_ignore(tmp_path: Path) -> None:
    film = ("--motion", "opening", "--frames", "3", "-o", tmp_path / "hole.png", *DRAW)
    for options, message in (
        (("--depth", "0.02", "--tile", "1"), "give --scale, or omit --motion opening"),
        (("--opening", "0.5"), "replaces the opening 0.5 of the first object; omit one of them"),
    ):
        error = refused("render", "sample:cracks", *options, *film)
        assert message in error
    assert not [*tmp_path.iterdir()]


def test_a_note_says_that_dust_needs_a_hole(tmp_path: Path) -> None:
    note = "note: no hole opens, so --dust changes nothing; add --opening 0.6"
    dust = ("render", "sample:cracks", "--dust", "sample:noise", *DRAW)
    for options, printed in (
        ((), True), (("--show", "reads"), True), (("--opening", "0.5"), False),
        (("--frames", "2", "--motion", "opening"), False),
    ):  # fmt: skip
        outcome = run(*dust, *options, "-o", tmp_path / "made.png")
        assert outcome.code == 0
        assert (note in outcome.err) == printed
