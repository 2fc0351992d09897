"""Pictures drawn again from the texts of recipes: a command, Python, and a preset."""

from __future__ import annotations

import functools
import re
import shlex
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from basrelief import Layer, LookAt, Object, Orbit, Scene, Tiling, directional, load, point, spot
from basrelief.cli import arguments, demo
from basrelief.gallery import PAGES
from basrelief.gallery.drawing import TEXELS, command_of
from basrelief.images import read_picture, write_data
from basrelief.scene import LYING, placed, rotated
from basrelief.scene.presets import preset
from basrelief.scene.recipe import (
    Recipe,
    omitted_by_command,
    placement_options,
    portable_path,
)
from basrelief.settings import settings_of
from helpers.command_line import done, write_heights

SIZE = (48, 32)
DRAWING = {"size": SIZE, "samples": 1}
STONE, GRAVEL = "sample:stone", "sample:gravel"


def scene(material: Any = None, objects: tuple[Object, ...] = (), **options: Any) -> Scene:
    of_scene = {name: options.pop(name) for name in [*options] if name in settings_of(Scene)}
    main = Object(load(STONE) if material is None else material, **options)
    return Scene((main, *objects), **of_scene)


@functools.cache
def scenes() -> dict[str, Scene]:
    """Scenes that together have a value for every setting."""
    return {
        "defaults": scene(),
        "a technique": scene(
            technique="parallax_occlusion", settings={"min_steps": 6, "max_steps": 24}, scale=0.13,
            reference_height=0.25, projection="biased", bias=0.2, camera=Orbit(20.0, 20.0),
        ),
        "heights": scene(
            heights="smooth", smoothing={"mip_bias": 2.0}, fade=(1.0, 4.5), edge="clamp",
            tiling=(2.0, -3.0), shift=(-0.25, 0.5),
            camera=LookAt((0.5, 0.9, 1.1), field_of_view=50.0),
        ),
        "filtered heights": scene(technique="relief", filter="hardware", shadows="hard"),
        "a surface": scene(
            shape="box", mapping="triplanar", alpha="mask",
            surface_parameters={"base_color": (1.0, 0.5, 0.25), "roughness": 0.3},
            tilings={"normal": Tiling((3.0, 2.0), (0.5, 0.0)), "base_color": Tiling((-1.0, 1.0))},
            camera=Orbit(-35.0, 25.0, 3.0, (0.1, 0.0, -0.1), 40.0),
        ),
        "a landscape": scene(
            surface="landscape", surface_parameters={"water_level": 0.3},
            layer=Layer(load(GRAVEL), Tiling((6.0, 5.0), (0.25, 0.0))), layer_offset="unscaled",
            background=(0.2, 0.3, 0.5),
        ),
        "a stretched shape": scene(
            shape="cylinder", transform=placed(scale=(0.5, 1.25, 0.75)), casts="opaque",
            camera=Orbit(orthographic_height=2.0),
        ),
        "a hole": scene(
            load(STONE, height="sample:cracks", dust="sample:noise"), opening=0.75, shadows="hard",
        ),
        "a wall": scene(transform=rotated("x", 90.0) @ placed(scale=(1.0, 1.0, 1.5)) @ LYING),
        "lights": scene(
            lights=(
                directional(70.0, 25.0, (1.0, 0.5, 0.25), 1.5),
                point((-0.5, 0.75, 0.5), falloff=1.0),
                spot((0.5, 1.0, 0.75), (0.125, 0.0, 0.25), (0.5, 1.0, 0.5), 3.0, 1.5, 50.0, 0.5),
            ),
            shading_model="phong", shading={"ambient": 0.1}, shadows="hard",
            surface_parameters={"shininess": 60.0, "specular": (0.5, 0.25, 0.125)},
            shadowing={"max_shadow_steps": 24, "light_angle": 5.0},
            occlusion_kind="directional",
            shadows_on="polygon", shadow_map_size=512,
        ),
        "fog without a light": scene(
            lights=(), fog_mode="linear", fog={"fog_start": 0.5, "fog_end": 4.0, "fog_color": 0.25},
            surface_parameters={"emission": (0.25, 0.5, 0.75)},
        ),
        "no background": scene(shape="sphere", background=None),
    }  # fmt: skip


# written out, so that collecting the tests makes no scenes
NAMES = (
    "defaults",
    "a technique",
    "heights",
    "filtered heights",
    "a surface",
    "a landscape",
    "a stretched shape",
    "a hole",
    "a wall",
    "lights",
    "fog without a light",
    "no background",
)


DRAWN = [pytest.param(n, marks=pytest.mark.gpu) if n == "filtered heights" else n for n in NAMES]


def device_of(drawn: Scene) -> str:
    """The device that draws a scene: the CPU, where it can."""
    return "gpu" if any(obj.filter == "hardware" for obj in drawn.objects) else "cpu"


@pytest.fixture(autouse=True)
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def color(drawn: Scene) -> np.ndarray:
    """The linear colour of the frame of a scene."""
    return basrelief.render(drawn, device=device_of(drawn), **DRAWING).color


def drawn_by_command(command: str, *more: str) -> np.ndarray:
    """The pixels of the picture that a command line draws."""
    program, *arguments = shlex.split(command, comments=True)
    assert program == "basrelief"
    device = "gpu" if "--filter hardware" in command else "cpu"
    done(*arguments, "-o", "again.png", "--device", device, *more)
    return read_picture(Path("again.png")).pixels


def drawn_by_python(line: str) -> np.ndarray:
    """The colour of the frame that a line of Python draws."""
    namespace: dict[str, Any] = {}
    exec(line.replace("; basrelief.render(", "; frame = basrelief.render("), namespace)
    return namespace["frame"].color


def saved_pixels(drawn: Scene) -> np.ndarray:
    """The pixels of the picture file of a scene."""
    basrelief.render(drawn, device=device_of(drawn), **DRAWING).save("once.png")
    return read_picture(Path("once.png")).pixels


# --- every setting --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DRAWN)
def test_the_command_draws_the_same_picture(name: str) -> None:
    command = Recipe(scenes()[name], DRAWING).command
    assert "#" not in command
    np.testing.assert_array_equal(drawn_by_command(command), saved_pixels(scenes()[name]))


@pytest.mark.parametrize("name", DRAWN)
def test_the_python_draws_the_same_picture(name: str) -> None:
    line = Recipe(scenes()[name], {**DRAWING, "device": device_of(scenes()[name])}).python
    assert np.abs(drawn_by_python(line) - color(scenes()[name])).max() < 1e-5


@pytest.mark.parametrize("name", [n for n in DRAWN if n != "no background"])
def test_the_preset_draws_the_same_picture(name: str) -> None:
    file = Recipe(scenes()[name]).preset("again").save("again.toml")
    again = preset(file).scene(load(STONE, **preset(file).maps))
    assert np.abs(color(again) - color(scenes()[name])).max() < 1e-5


@pytest.mark.parametrize("options", [{"scale": 0.1}, {"opening": 0.5}])
def test_lengths_of_the_material_are_not_written_beside_what_replaces_them(
    options: dict[str, Any],
) -> None:
    drawn = scene(load(STONE, depth=0.2, tile=1.0), **options)
    command = Recipe(drawn, DRAWING).command
    assert "--depth" not in command
    np.testing.assert_array_equal(drawn_by_command(command), saved_pixels(drawn))


def test_every_setting_is_written_in_a_scene() -> None:
    assert tuple(scenes()) == NAMES
    for record in (Object, Scene):
        for name, declared in settings_of(record).items():
            owners = [s.objects[0] if record is Object else s for s in scenes().values()]
            assert any(
                getattr(owner, name) is not declared.default
                and repr(getattr(owner, name)) != repr(declared.default)
                for owner in owners
            ), name


@pytest.mark.parametrize("shape", ["plane", "box"])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("degrees", [0.0, 30.0, -90.0, 180.0, 217.5])
@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (0.5, 2.0, 1.25), (-1.0, 1.5, -0.5)])
def test_every_turn_and_stretch_is_written_as_options(axis, degrees, factors, shape) -> None:
    material = load(STONE)
    base = Object(material, shape).resolved.transform
    transform = rotated(axis, degrees) @ placed(scale=factors) @ base
    options = placement_options(Object(material, shape, transform=transform))
    assert options is not None
    again = arguments.scene(material, shape=shape, **options).objects[0].resolved
    np.testing.assert_allclose(again.transform, transform, atol=1e-8)


def test_other_transforms_are_not_written_as_options() -> None:
    twice = rotated("x", 30.0) @ rotated("y", 40.0)
    skewed = np.eye(4)
    skewed[0, 1] = 0.3
    for transform in (twice, skewed, placed((0.0, 0.1, 0.0)), rotated("z", 33.3) @ skewed):
        assert placement_options(Object(load(STONE), "box", transform=transform)) is None


# --- sources --------------------------------------------------------------------------------------


def test_options_of_reading_are_written() -> None:
    folder = write_heights(
        Path("wall"), np.linspace(9000, 40000, 20 * 28).reshape(20, 28, 1).astype(np.uint16)
    )
    other = write_heights(Path("other"))
    (file,) = other.iterdir()
    material = load(
        folder, height=file, height_polarity="depth", stretch_height=True, depth=0.1, tile=0.8
    )
    drawn = scene(material)
    recipe = Recipe(drawn, DRAWING)
    for option in ("--height ", "--height-polarity depth", "--stretch-height", "--depth 0.1"):
        assert option in recipe.command
    np.testing.assert_array_equal(drawn_by_command(recipe.command), saved_pixels(drawn))
    line = Recipe(drawn, {**DRAWING, "device": "cpu"}).python
    np.testing.assert_array_equal(drawn_by_python(line), color(drawn))
    saved = recipe.preset("again").save("again.toml")
    np.testing.assert_array_equal(drawn_by_command(f"basrelief render wall --preset {saved}",
                                                   "--size", "48x32", "--samples", "1"),
                                  saved_pixels(drawn))  # fmt: skip


def test_further_objects_are_written_in_python() -> None:
    ball = Object(load(GRAVEL), shape="sphere", transform=placed((0.0, 0.4, 0.0), 0.3) @ LYING)
    drawn = scene(objects=(ball,), shadows="soft", camera=Orbit(distance=2.5))
    line = Recipe(drawn, {**DRAWING, "device": "cpu"}).python
    assert np.abs(drawn_by_python(line) - color(drawn)).max() < 1e-5
    assert Recipe(drawn).command.endswith("  # without the further objects")


def test_samples_of_other_sizes_are_written_in_python() -> None:
    drawn = scene(basrelief.sample("stone", 64, seed=3))
    line = Recipe(drawn, {**DRAWING, "device": "cpu"}).python
    assert 'basrelief.sample("stone", size=64, seed=3)' in line
    np.testing.assert_array_equal(drawn_by_python(line), color(drawn))
    assert [*omitted_by_command(drawn)] == ["the size and seed of the sample"]


def test_maps_named_one_by_one_are_written_in_python() -> None:
    (file,) = write_heights(Path("wall")).iterdir()
    drawn = scene(load(height=file))
    line = Recipe(drawn, {**DRAWING, "device": "cpu"}).python
    np.testing.assert_array_equal(drawn_by_python(line), color(drawn))
    assert Recipe(drawn).command.endswith("  # without a folder: all maps were named one by one")


def test_numbers_of_numpy_are_written_as_numbers() -> None:
    drawn = scene(
        tiling=np.array([2, 3]), shift=np.array([0.1, 0.2], np.float32), fade=np.array([1.0, 3.0]),
        tilings={"normal": Tiling(np.array([2, 2]), np.array([0.1, 0.0]))},
        camera=Orbit(np.array(20.0), np.float32(25.5), target=np.array([0.0, 0.1, 0.0])),
        background=np.array([1.0, 0.5, 0.2], np.float32), shadow_map_size=np.int32(64),
    )  # fmt: skip
    assert Recipe(drawn).command == (
        "basrelief render sample:stone --fade 1,3 --tiling 2x3 --shift 0.1,0.2 "
        "--map-tiling normal=2x2 --map-shift normal=0.1,0 "
        "--camera azimuth=20,elevation=25.5,target=0/0.1/0 --shadow-map-size 64 "
        "--background 1,0.5,0.2"
    )
    assert "array" not in Recipe(drawn).python
    assert Recipe(drawn).preset("again").to_toml()


def test_paths_that_start_with_a_minus_are_written_as_paths() -> None:
    write_heights(Path("-wall"))
    drawn = scene(load("-wall"), layer=Layer(load("-wall")))
    assert portable_path("-wall") == portable_path(str(Path("-wall").resolve())) == "./-wall"
    command = Recipe(drawn, DRAWING).command
    assert command.startswith("basrelief render ./-wall --layer ./-wall ")
    np.testing.assert_array_equal(drawn_by_command(command), saved_pixels(drawn))


def test_a_material_made_in_python_is_named_as_left_out() -> None:
    made = basrelief.Material("made", height=load(STONE).height)
    command = Recipe(scene(made)).command
    assert (
        command
        == "basrelief render FOLDER  # without the material, which was not loaded from files"
    )


def test_scenes_that_a_preset_cannot_describe_are_refused() -> None:
    for drawn, why in (
        (scenes()["no background"], "no transparent background"),
        (scene(objects=(Object(load(GRAVEL)),)), "describes one object"),
    ):
        with pytest.raises(basrelief.InputError, match=why):
            Recipe(drawn).preset("again")


# --- commands that other commands print -----------------------------------------------------------


def printed_command(output: str) -> str:
    (line,) = re.findall(r"^basrelief render .*$", output, re.MULTILINE)
    return line


@pytest.mark.parametrize(
    "measure", [("tune", "--missed", "60%"), ("compare", "--angles", "60", "--size", "32x24")]
)
def test_the_printed_command_draws_the_measured_relief(measure: tuple[str, ...]) -> None:
    """The printed command has the options of reading, and draws the same relief."""
    folder = write_heights(Path("wall"))
    extra = write_data(Path("slanted.png"), np.full((4, 6, 3), 150, np.uint8))
    reading = (
        "--normal", str(extra), "--height-polarity", "depth", "--stretch-height",
        "--normal-convention", "dx",
    )  # fmt: skip
    technique = (
        "--technique", "steep", "--scale", "0.2", "--bias", "0.3", "--projection", "biased",
    )  # fmt: skip
    out = done(measure[0], folder, *measure[1:], *technique, *reading, "--device", "cpu",
               "-o", "out.toml" if measure[0] == "tune" else "out")  # fmt: skip
    command = printed_command(out)
    assert "--normal-convention dx" in command
    small = ("--size", "48x32", "--samples", "1")
    again = drawn_by_command(command, *small)
    words = shlex.split(command)
    settings = [word for option, word in pairwise(words) if option == "--set"]
    material = load(
        folder, normal=extra, height_polarity="depth", stretch_height=True, normal_convention="dx"
    )
    numbers = {name: float(value) for name, _, value in (s.partition("=") for s in settings)}
    wanted = scene(
        material, technique=words[words.index("--technique") + 1], settings=numbers,
        scale=0.2, bias=0.3, projection="biased",
    )  # fmt: skip
    np.testing.assert_array_equal(again, saved_pixels(wanted))
    if measure[0] == "tune":
        with_preset = "basrelief render wall --preset out.toml"
        np.testing.assert_array_equal(drawn_by_command(with_preset, *small), again)


def test_commands_of_the_demo_draw_its_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo, "_SIZE", SIZE)
    monkeypatch.setattr(demo, "_SAMPLES", 1)
    # the size of samples that commands draw
    monkeypatch.setattr(demo, "sample", lambda name: load(f"sample:{name}"))
    drawn = list(demo.pictures(Path("demo"), "cpu"))
    assert len(drawn) == demo.COUNT
    for path, command in drawn:
        np.testing.assert_array_equal(drawn_by_command(command), read_picture(path).pixels)


cached_sample = functools.cache(basrelief.sample)
GALLERY = [
    (page.name, number, panel)
    for page in PAGES.values()
    for number, panel in enumerate(page.panels(TEXELS))
]


@pytest.mark.parametrize(
    ("name", "number", "panel"),
    [case for case in GALLERY if command_of(case[2], SIZE, 1)],
    ids=lambda value: str(value) if isinstance(value, str | int) else "",
)
def test_commands_of_the_gallery_draw_its_pictures(
    name: str, number: int, panel: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the gallery's samples have the size that commands draw
    monkeypatch.setattr(sys.modules["basrelief.material.loading"], "sample", cached_sample)
    command = command_of(panel, SIZE, 1).replace(f" --show {panel.shown}", "")
    difference = drawn_by_command(command).astype(int) - saved_pixels(panel.scene)
    assert (np.abs(difference) > 1).mean() < 0.002
