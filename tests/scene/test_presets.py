"""Presets follow their articles, yield to explicit options, and can be saved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

import basrelief
from basrelief import PRESETS, InputError, Material, Object, Orbit, Preset, Scene, preset
from basrelief.cli import arguments
from basrelief.images import write_data
from basrelief.lang import Vec3
from basrelief.material import Map
from basrelief.scene import Tiling, technique_named
from basrelief.scene.recipe import Recipe
from basrelief.shading.lights import DIRECTIONAL, POINT
from basrelief.techniques.offset import Offset
from helpers.command_line import done, refused, write_heights
from helpers.repository import REPOSITORY

SMALL = {"size": (24, 18), "samples": 1, "device": "cpu"}
SAMPLES = {"habrador": "noise", "habrador-hole": "hole", "habrador-bricks": "bricks"}
NAMES = (
    "catlike", "catlike-limited", "catlike-march", "gamedev", "habrador", "habrador-bricks",
    "habrador-hole", "halliwell", "halliwell-stock", "wikibooks",
)  # fmt: skip


def material_of_heights(value: float | None = None, **maps: Any) -> Material:
    """A material of heights, random or all of one value."""
    heights = np.random.default_rng(4).random((8, 12, 1), np.float32)
    if value is not None:
        heights = np.full((8, 12, 1), value, np.float32)
    return Material("bumpy", height=Map(heights, False, "made up"), **maps)


def drawn(name: str, **options: Any) -> tuple[Object, Scene]:
    """The object and the scene of a preset."""
    scene = preset(name).scene(material_of_heights(), **options)
    return scene.objects[0], scene


def error_message(make: Any) -> str:
    with pytest.raises(InputError) as caught:
        make()
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- all presets ----------------------------------------------------------------------------------


def test_names_of_the_presets() -> None:
    assert PRESETS == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_each_preset_draws(name: str) -> None:
    """A preset draws its sample by name and by its tables alike, and changes the picture."""
    made = preset(name)
    assert made.name == name
    assert len(made.about) > 80
    assert made.source
    path = f"sample:{SAMPLES.get(name, 'bricks')}"
    frame = basrelief.render(path, preset=name, **SMALL)
    assert frame.hit.any()
    assert np.isfinite(frame.color).all()
    without_preset = basrelief.render(path, **SMALL)
    assert not np.allclose(frame.color, without_preset.color)
    again = made.scene(basrelief.load(path, **made.maps))
    assert (basrelief.render(again, **SMALL).color == frame.color).all()


@pytest.mark.parametrize("name", NAMES)
def test_each_number_has_a_source(name: str) -> None:
    """Every number in a preset's file has a comment: the article's, the landscape's, or chosen."""
    file = Path(basrelief.__file__).parent / "scene" / "presets" / f"{name}.toml"
    for line in file.read_text().splitlines():
        _, sign, rest = line.partition(" = ")
        if sign and rest[0] in "0123456789[":
            comment = rest.partition("#")[2]
            assert "article's" in comment or "chosen" in comment or "landscape's" in comment, line


# --- the numbers of the articles ------------------------------------------------------------------


def test_catlike_follows_its_article() -> None:
    obj, scene = drawn("catlike")
    assert (obj.resolved.technique.name, obj.resolved.projection) == ("offset", "biased")
    assert (obj.bias, obj.scale, obj.reference_height) == (0.42, 0.03, 0.5)
    assert scene.shading_model == "ggx"
    assert preset("catlike").maps == {"height_channel": "g"}
    obj, _ = drawn("catlike-limited")
    assert (obj.resolved.technique.name, obj.resolved.projection) == ("offset_limited", "limited")
    assert (obj.scale, obj.reference_height) == (0.03, 0.5)
    obj, _ = drawn("catlike-march")
    assert (obj.resolved.technique.name, obj.resolved.projection) == ("relief", "biased")
    assert (obj.bias, obj.scale, obj.reference_height) == (0.0, 0.03, 1.0)
    assert (obj.resolved.settings.min_steps, obj.resolved.settings.max_steps) == (10, 10)
    assert obj.resolved.settings.search_steps == 3


def test_wikibooks_follows_its_article() -> None:
    obj, scene = drawn("wikibooks")
    assert (obj.resolved.technique.name, obj.resolved.projection) == ("offset", "full")
    assert (obj.scale, obj.reference_height, obj.resolved.settings.max_offset) == (
        0.01,
        0.5,
        np.float32(0.01),
    )
    assert scene.shading_model == "phong"
    surface = obj.resolved.surface_parameters
    assert (surface.specular, surface.shininess) == (scene.shading.diffuse * Vec3(1.0), 10.0)
    (lamp,) = scene.lights
    assert (lamp.kind, lamp.falloff) == (POINT, 1.0)
    # coordinates of the mesh are shifted: tiles of a quarter of the shape shift four times as far
    obj, _ = drawn("wikibooks", tiling=(4.0, 4.0))
    assert obj.scale == pytest.approx(0.04)
    assert obj.resolved.settings.max_offset == pytest.approx(0.04)
    assert obj.resolved.settings.max_offset_ratio == 1.0
    # the tiled coordinates are shifted
    assert drawn("catlike", tiling=(4.0, 4.0))[0].scale == 0.03


def test_gamedev_follows_its_article() -> None:
    obj, scene = drawn("gamedev")
    assert (obj.resolved.technique.name, obj.resolved.projection) == ("parallax_occlusion", "full")
    assert (obj.resolved.settings.min_steps, obj.resolved.settings.max_steps) == (4, 20)
    assert (obj.scale, obj.reference_height) == (0.1, 1.0)
    # mip levels by the gradients of the undisplaced coordinates, as SampleGrad takes them
    assert obj.heights == "smooth"
    assert obj.smoothing == {"mip_bias": 0.0, "mip_fade": 0.0}
    assert scene.shading_model == "phong"
    assert scene.shading.ambient == Vec3(0.1)
    assert (scene.shading.diffuse, obj.resolved.surface_parameters.specular) == (0.5, Vec3(0.0))


def test_halliwell_follows_its_article() -> None:
    stock, _ = drawn("halliwell-stock")
    assert (stock.resolved.technique.name, stock.resolved.projection) == ("offset", "biased")
    assert (stock.bias, stock.reference_height) == (0.42, 0.5)
    obj, scene = drawn("halliwell")
    assert (obj.resolved.technique.name, obj.heights, obj.reference_height) == (
        "relief",
        "smooth",
        1.0,
    )
    assert obj.resolved.settings.min_steps < obj.resolved.settings.max_steps
    assert obj.resolved.settings.search_steps > 0
    assert (scene.shadows, scene.occlusion_kind) == ("hard", "directional")
    assert obj.scale == stock.scale


def test_habrador_follows_its_article() -> None:
    obj, scene = drawn("habrador")
    assert (obj.resolved.technique.name, obj.surface, obj.reference_height) == (
        "fixed_length",
        "landscape",
        1.0,
    )
    # a quad's width is five tiles of the noise: a height of 1 and a step of 0.01, in fifths
    assert obj.tiling == (0.2, 0.2)
    assert obj.scale / obj.tiling[0] == pytest.approx(1.0)
    assert obj.resolved.settings.steps == 300
    assert obj.resolved.settings.step_length / obj.tiling[0] == pytest.approx(0.01)
    assert obj.tilings == {"base_color": Tiling((0.4, 0.4))}
    assert obj.layer is not None
    assert (obj.layer.material.name, obj.layer.tiling.tiles) == ("stone", (0.4, 0.4))
    assert obj.resolved.surface_parameters.water_level == np.float32(0.4)
    assert (
        obj.resolved.surface_parameters.sky_color,
        obj.resolved.surface_parameters.normal_strength,
    ) == (
        Vec3(1.0),
        0.0,
    )
    assert obj.resolved.surface_parameters.specular == Vec3(0.0)
    assert scene.shading_model == "phong"
    assert preset("habrador").scroll == (0.25, 0.0)
    assert preset("gamedev").scroll == (0.0, 0.0)
    for name in ("habrador-hole", "habrador-bricks"):
        obj, _ = drawn(name)
        assert (obj.resolved.technique.name, obj.resolved.settings.steps) == ("fixed_length", 300)


# --- closed forms ---------------------------------------------------------------------------------


def displayed_shift(name: str, value: float, **options: Any) -> tuple[np.ndarray, np.ndarray]:
    """Shift of the mesh's texture coordinates on a plane of constant height, (n, 2), and the unit
    view vectors in tangent space, (n, 3)."""
    camera = basrelief.LookAt((0.6, 0.5, 0.9))
    options = {"camera": camera, "transform": np.eye(4), **options}
    standing = {"lights": [basrelief.directional()], **options}
    frame = basrelief.render(material_of_heights(value), preset=name, **SMALL, **standing)
    flat = basrelief.render(
        material_of_heights(value), **SMALL, **{**standing, "technique": "flat", "settings": {}}
    )
    tiling = options.get("tiling", (1.0, 1.0))
    flat_uv = flat.uv.astype(np.float64) / tiling
    points = np.stack([flat_uv[..., 0] - 0.5, 0.5 - flat_uv[..., 1], 0.0 * flat_uv[..., 0]], -1)
    view = np.array(camera.position) - points
    view /= np.linalg.norm(view, axis=-1, keepdims=True)
    visible = frame.hit & flat.hit
    shift = frame.uv.astype(np.float64) / tiling - flat_uv
    return shift[visible], view[visible]


def to_texture(move: np.ndarray) -> np.ndarray:
    """From tangent space to texture space, where v points down."""
    return move * (1.0, -1.0)


@pytest.mark.parametrize("height", [0.1, 0.5, 1.0])
def test_the_stock_offset(height: float) -> None:
    """C8 and H1: h · height − height ÷ 2, over z + 0.42."""
    for name, depth in (("catlike", 0.03), ("halliwell-stock", 0.08)):
        shift, view = displayed_shift(name, height)
        h = height * depth - depth / 2.0
        expected = to_texture(h * view[:, :2] / (view[:, 2:] + 0.42))
        assert shift == pytest.approx(expected, abs=2e-6)
    shift, view = displayed_shift("catlike-limited", height)
    assert shift == pytest.approx(to_texture((height - 0.5) * 0.03 * view[:, :2]), abs=2e-6)


def test_the_clamped_offset() -> None:
    """W2 and W3: max height · (h − ½) · xy ÷ z, each component clamped."""
    shift, view = displayed_shift("wikibooks", 0.9)
    expected = to_texture(0.01 * (0.9 - 0.5) * view[:, :2] / view[:, 2:])
    assert shift == pytest.approx(expected, abs=2e-6)
    shift, view = displayed_shift("wikibooks", 1.0, scale=0.2)
    expected = np.clip(to_texture(0.2 * 0.5 * view[:, :2] / view[:, 2:]), -0.01, 0.01)
    assert (np.abs(expected) == 0.01).any()
    assert shift == pytest.approx(expected, abs=2e-6)


@pytest.mark.parametrize("tiling", [(1.0, 1.0), (2.0, 4.0), (4.0, 1.0)])
def test_the_clamp_is_in_the_coordinates_of_the_mesh(tiling: tuple[float, float]) -> None:
    """W3: 0.01 along u and along v, whatever the tilings of the maps."""
    shift, view = displayed_shift("wikibooks", 1.0, tiling=tiling, scale=0.2)
    expected = np.clip(to_texture(0.2 * 0.5 * view[:, :2] / view[:, 2:]), -0.01, 0.01)
    assert (np.abs(expected) == 0.01).any(axis=0).all()
    assert shift == pytest.approx(expected, abs=2e-6)


@pytest.mark.parametrize("elevation", [90.0, 40.0, -20.0])
def test_ambient_a_tenth_and_diffuse_a_half(elevation: float) -> None:
    """G9: (0.1 + 0.5 · n·l) times the colour, on a flat surface in a light of intensity 1."""
    material = material_of_heights(
        1.0, base_color=Map(np.ones((1, 1, 3), np.float32), False, "white")
    )
    options = {"lights": [basrelief.directional(30.0, elevation)], "camera": Orbit(elevation=70.0)}
    # within the 16-bit precision of normals from heights
    tinted = {"surface_parameters": {"base_color": (1.0, 0.5, 0.25)}}
    frame = basrelief.render(material, preset="gamedev", **options, **tinted, **SMALL)
    cosine = max(0.0, np.sin(np.radians(elevation)))
    expected = np.array([1.0, 0.5, 0.25]) * (0.1 + 0.5 * cosine)
    assert frame.color[frame.hit][:, :3] == pytest.approx(
        np.tile(expected, (frame.hit.sum(), 1)), abs=1e-5
    )


def test_the_lamp_of_gamedev_has_no_attenuation() -> None:
    """Its light has intensity 1 and no attenuation."""
    _, scene = drawn("gamedev")
    (lamp,) = scene.lights
    assert (lamp.kind, lamp.falloff, lamp.color) == (POINT, 0.0, Vec3(1.0))


# --- reading --------------------------------------------------------------------------------------


def test_presets_choose_the_channels_of_maps(tmp_path: Path) -> None:
    """Heights in G, or in A or else R; normals in A and G, or else as stored."""
    noise = np.random.default_rng(6).integers(0, 255, (6, 6, 4), np.uint8)
    solid = noise.copy()
    solid[..., 3] = 255
    write_data(tmp_path / "four_Height.png", noise)
    write_data(tmp_path / "solid_Height.png", solid)
    write_data(tmp_path / "three_Height.png", noise[..., :3].copy())
    for file, name, channel in (
        ("four", "catlike", 1), ("four", "wikibooks", 3), ("solid", "wikibooks", 0),
        ("three", "halliwell-stock", 0),
    ):  # fmt: skip
        material = basrelief.load(height=tmp_path / f"{file}_Height.png", **preset(name).maps)
        assert material.height is not None
        assert (material.height.pixels[..., 0] == noise[..., channel]).all()
    for pixels, x in ((noise, 3), (solid, 0)):
        write_data(tmp_path / "n.png", pixels)
        found = basrelief.load(normal=tmp_path / "n.png", **preset("wikibooks").maps)
        assert found.normal is not None
        assert (found.normal.pixels[..., 0] == pixels[..., x]).all()
        assert (found.height is None) or x == 0


def test_maps_of_samples(tmp_path: Path) -> None:
    grass = basrelief.load("sample:grass").base_color
    assert grass is not None
    noise = basrelief.load("sample:noise", **preset("habrador").maps)
    assert noise.base_color is not None
    assert (noise.base_color.pixels == grass.pixels).all()
    folder = write_heights(tmp_path / "hill", np.zeros((8, 8, 1), np.uint16))
    found = basrelief.load(folder, base_color="sample:grass")
    assert found.base_color is not None
    assert found.name == "hill"
    assert "base_color from sample:grass: requested" in map(str, found.notes)
    assert basrelief.load(height="sample:grass").name == "grass"
    message = error_message(lambda: basrelief.load(folder, metallic="sample:grass"))
    assert message.startswith("sample:grass has no metallic map")


# --- explicit options override --------------------------------------------------------------------


def test_options_win_over_a_preset() -> None:
    obj, scene = drawn(
        "gamedev", scale=0.3, settings={"max_steps": 50}, shading={"diffuse": 0.9},
        shading_model="ggx", lights=[basrelief.directional()], camera=Orbit(10.0),
    )  # fmt: skip
    assert (obj.scale, obj.resolved.settings.min_steps, obj.resolved.settings.max_steps) == (
        0.3,
        4,
        50,
    )
    assert (scene.shading.diffuse, scene.shading.ambient) == (np.float32(0.9), Vec3(0.1))
    assert (scene.shading_model, scene.camera) == ("ggx", Orbit(10.0))
    assert [each.kind for each in scene.lights] == [DIRECTIONAL]
    # another technique keeps the settings it shares
    obj, _ = drawn("gamedev", technique="relief")
    assert (obj.resolved.settings.min_steps, obj.resolved.settings.max_steps) == (4, 20)
    obj, _ = drawn("gamedev", technique="steep")
    assert (obj.resolved.technique.name, obj.resolved.settings.steps) == ("steep", 10)
    obj, _ = drawn("habrador", surface="standard", tilings={"normal": Tiling((3.0, 3.0))})
    assert (obj.surface, obj.resolved.surface_parameters.normal_strength) == ("standard", 0.0)
    assert {*obj.tilings} == {"base_color", "normal"}
    # None stands for the material's own
    assert drawn("gamedev", scale=None)[0].scale is None


# --- the unit of lengths --------------------------------------------------------------------------

SHAPE_UNIT = """
[object]
lengths = "shape"
technique = "fixed_length"
tiling = [4, 2]
scale = 0.1
settings = { step_length = 0.01 }
"""


def command_scene(*arguments_of_command: str, **options: Any) -> Scene:
    """The scene of a command line with options of `scene_options` as texts."""
    return arguments.scene(
        material_of_heights(), preset=preset("wikibooks"), settings=arguments_of_command, **options
    )


@pytest.mark.parametrize(
    ("options", "tiles"),
    [
        ({}, (1.0, 1.0)),
        ({"shape": "sphere"}, (4.0, 3.0)),
        ({"shape": "cylinder"}, (3.0, 1.5)),
        ({"tiling": (4.0, -2.0)}, (4.0, 2.0)),
        ({"shape": "box", "tiling": (0.5, 3.0)}, (0.5, 3.0)),
    ],
)
def test_explicit_lengths_are_in_the_unit_of_the_preset(options, tiles) -> None:
    """A length of the shape is tiles times as many of a tile, whoever states it; the ratio of both
    limits is that of the tilings."""
    repeated = {"scale": 0.01, "settings": {"max_offset": 0.01}}
    texts = {name: "x".join(map(str, x)) if name == "tiling" else x for name, x in options.items()}
    for obj in (
        drawn("wikibooks", **options)[0],
        drawn("wikibooks", **options, **repeated)[0],
        drawn("wikibooks", **options, scale=0.01, settings=Offset(max_offset=0.01))[0],
        command_scene(**texts).objects[0],
        command_scene("max_offset=0.01", scale=0.01, **texts).objects[0],
    ):
        settings = obj.resolved.settings
        assert obj.scale == pytest.approx(0.01 * tiles[0])
        assert settings.max_offset == pytest.approx(0.01 * tiles[0])
        assert settings.max_offset_ratio == pytest.approx(tiles[1] / tiles[0])
    obj = command_scene("max_offset_ratio=2", scale=0.02, technique="offset", **texts).objects[0]
    assert obj.scale == pytest.approx(0.02 * tiles[0])
    assert obj.resolved.settings.max_offset_ratio == pytest.approx(2.0 * tiles[1] / tiles[0])
    # of another technique too
    obj = command_scene("step_length=0.02", technique="fixed_length", **texts).objects[0]
    assert obj.resolved.settings.step_length == pytest.approx(0.02 * tiles[0])
    # of another preset they are those of a tile
    obj, _ = drawn("catlike", scale=0.01, settings={"max_offset": 0.01}, **options)
    assert (obj.scale, obj.resolved.settings.max_offset) == (0.01, np.float32(0.01))


@pytest.mark.parametrize("tiling", [(1.0, 1.0), (4.0, 2.0), (0.5, 3.0)])
def test_explicit_offsets_in_closed_form(tiling: tuple[float, float]) -> None:
    """0.1 · (h − ½) · xy ÷ z in the coordinates of the mesh, at most 0.02, whatever the tiling."""
    own = {"scale": 0.1, "settings": {"max_offset": 0.02}, "tiling": tiling}
    shift, view = displayed_shift("wikibooks", 0.8, **own)
    expected = to_texture(0.1 * 0.3 * view[:, :2] / view[:, 2:])
    assert (np.abs(expected) > 0.02).any(axis=0).all()
    assert (np.abs(expected) < 0.02).any(axis=0).all()
    assert shift == pytest.approx(np.clip(expected, -0.02, 0.02), abs=3e-6)


def test_a_clamp_may_be_longer_than_a_tile() -> None:
    """Half a shape is two of its tiles."""
    own = {"scale": 1.0, "settings": {"max_offset": 0.5}, "tiling": (4.0, 4.0)}
    shift, view = displayed_shift("wikibooks", 0.0, **own, reference_height=1.0)
    expected = np.clip(to_texture(-1.0 * view[:, :2] / view[:, 2:]), -0.5, 0.5)
    assert (np.abs(expected) > 0.25).any(axis=0).all()
    assert shift == pytest.approx(expected, abs=1e-5)


def test_files_with_lengths_of_the_shape(tmp_path: Path) -> None:
    """As the library's; `--depth` and `--tile` are metres of a tile all the same."""
    (tmp_path / "mine.toml").write_text(SHAPE_UNIT)
    mine = preset(tmp_path / "mine.toml")
    material = material_of_heights()
    for options, scale, step in (
        ({}, 0.4, 0.04), ({"scale": 0.2}, 0.8, 0.04), ({"tiling": (2.0, 2.0)}, 0.2, 0.02),
        ({"settings": {"step_length": 0.03}}, 0.4, 0.12),
    ):  # fmt: skip
        (obj,) = mine.scene(material, **options).resolved
        assert (obj.scale, obj.settings.step_length) == pytest.approx((scale, step))
    measured = replace(material, depth=0.1, tile=1.0)
    (obj,) = arguments.scene(measured, preset=mine, measured=True).resolved
    assert (obj.scale, obj.settings.step_length) == pytest.approx((0.1, 0.04))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scale": 4.0}, "scale, in widths of the shape, is 4: give a number from 0 to 2.5"),
        ({"scale": -1.0}, "scale, in widths of the shape, is -1: give a number from 0 to 2.5"),
        ({"settings": {"max_offset": 100.0}},
         "max_offset, in widths of the shape, is 100: give a number from 0 to 64"),
        ({"scale": "deep"}, "scale is 'deep': give a number"),
        ({"settings": {"max_offset": "far"}}, "max_offset is a number, not 'far'"),
        ({"tiling": (0.0, 1.0)}, "tiling (0.0, 1.0): give finite numbers other than 0"),
        ({"tiling": 3.0}, "tiling is 3.0: give two numbers"),
        ({"shape": "ring"}, "shape is one of plane, box, sphere, cylinder, not 'ring'"),
    ],
)  # fmt: skip
def test_lengths_out_of_range_are_refused_in_the_unit_of_the_preset(options, message) -> None:
    assert error_message(lambda: drawn("wikibooks", **{"tiling": (4.0, 2.0), **options})) == message


def test_what_a_recipe_prints_has_the_lengths_of_tiles() -> None:
    """Texts name no preset, so their lengths are those of a tile."""
    scene = preset("wikibooks").scene(
        basrelief.load("sample:bricks"), shape="sphere", scale=0.02, settings={"max_offset": 0.03}
    )
    recipe = Recipe(scene, {"size": SMALL["size"], "samples": 1})
    assert "--scale 0.08 " in recipe.command
    assert "--set max_offset=0.12 " in recipe.command
    wanted = basrelief.render(scene, **SMALL).color
    namespace: dict[str, Any] = {}
    exec(
        recipe.python.replace("import basrelief; ", "frame = "), {"basrelief": basrelief}, namespace
    )
    assert (namespace["frame"].color == wanted).all()
    again = recipe.preset("mine").scene(scene.objects[0].material)
    assert (basrelief.render(again, **SMALL).color == wanted).all()


def test_presets_of_objects_and_scenes_are_refused() -> None:
    obj = Object(material_of_heights())
    for what in (obj, Scene((obj,))):
        message = error_message(lambda what=what: basrelief.render(what, preset="gamedev", **SMALL))
        assert "preset: already set by the" in message
    assert "no option 'colour'; there are alpha, " in error_message(
        lambda: drawn("gamedev", colour=1)
    )


def test_on_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    small = ("--size", "24x18", "--samples", "1", "--device", "cpu")
    assert "bricks-parallax_occlusion-" in done("render", "sample:bricks", "--preset", "gamedev",
                                                *small)  # fmt: skip
    Path("mine.toml").write_text('[object]\ntechnique = "steep"\nscale = 0.2\n')
    assert "bricks-steep-" in done("render", "sample:bricks", "--preset", "mine.toml", *small)
    assert "bricks-offset-" in done(
        "render", "sample:bricks", "--preset", "mine.toml", "--technique", "offset", *small
    )
    line = refused("render", "sample:bricks", "--preset", "mine", *small)
    assert line.startswith("no preset is called 'mine'; use one of catlike, ")
    assert line.endswith(", wikibooks, or a .toml file")
    # an explicit depth overrides the preset's scale
    done("render", "sample:bricks", "--preset", "gamedev", "--depth", "0.2", "--tile", "1", *small,
         "-o", "a.tif", "--bits", "32")  # fmt: skip
    expected = basrelief.render("sample:bricks", preset="gamedev", scale=0.2, **SMALL).color
    found = basrelief.images.read_picture("a.tif").pixels
    assert found == pytest.approx(expected[..., : found.shape[2]])


def test_a_preset_scrolls_its_film() -> None:
    from basrelief.cli.arguments import motions_from
    from basrelief.scene.motion import Lighting, Orbiting, Scrolling

    assert motions_from([], 9, preset("habrador")) == (Scrolling(0.25, 0.0),)
    assert motions_from(["light"], 9, preset("habrador")) == (Lighting(),)
    assert motions_from([], 9, preset("gamedev")) == (Orbiting(),)
    frames = basrelief.frames("sample:bricks", [Orbiting()], count=2, preset="gamedev", **SMALL)
    assert len(list(frames)) == 2


# --- user-defined files ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message_part"),
    [
        ("about = 3", "about is 3: give a text"),
        ("nothing = 1", "no key 'nothing'; there are name, about, source, maps, object, scene"),
        ("object = 3", "object is 3: make it a table, [object]"),
        ("[object]\nscal = 1", "object has no key 'scal'; it has shape, technique"),
        ("[object]\nscale = 'deep'", "object.scale is 'deep': give a number"),
        ("[object]\nscale = true", "object.scale is True: give a number"),
        ("[object]\nscale = 20", "scale is 20: give a number from 0 to 10"),
        ("[object]\nscale = nan", "scale is nan: give a number from 0 to 10"),
        ("[object]\nscale = 1e999", "scale is inf: give a number from 0 to 10"),
        ("[object]\ntechnique = 'leap'", "no technique is called 'leap'; use one of flat"),
        ("[object]\ntechnique = 'my.py:bump'", "my.py: there is no such file"),
        ("[object]\nheights = 'soft'", "heights is one of sharp, smooth, mip, not 'soft'"),
        ("[object]\nlengths = 'm'", "object.lengths is one of tile, shape, not 'm'"),
        ("[object]\nsurface = 'sea'", "surface is one of standard, landscape, not 'sea'"),
        ("[object]\ntiling = 2", "object.tiling is 2: give two numbers, as [1, 2]"),
        ("[object]\nfade = [3, 1]", "fade 3 to 1: give two distances, the nearer first"),
        ("[object.settings]\nstep = 3", "relief has no setting 'step'; it has min_steps"),
        ("[object.settings]\nmax_steps = 'many'", "object.settings.max_steps is 'many': give a"),
        ("[object.settings]\nmax_steps = 0", "max_steps is 0: give a number from 1 to 4096"),
        ("[object.settings]\nmax_steps = 2.5", "max_steps is a whole number, not 2.5"),
        (
            "[object.surface_parameters]\nbase_color = [1, 2]",
            "object.surface_parameters.base_color is (1, 2): give a num",
        ),
        ("[object.tilings.height]\ntiles = [1, 2]", "the map of a tiling is one of base_color"),
        ("[object.tilings.normal]\ntile = [1, 2]", "object.tilings.normal has no key 'tile'"),
        ("[object.layer]\ntiles = [1, 2]", "object.layer needs a material: a path, or sample:"),
        ("[maps]\nheight_channel = 'x'", "height_channel is one of auto, r, g, b, a"),
        ("[maps]\nstretch_height = 1", "maps.stretch_height is 1: give true or false"),
        ("[scene]\nshadows = 3", "scene.shadows is 3: give a text"),
        ("[scene]\nfog_mode = 'thick'", "fog_mode is one of none, linear"),
        ("[scene]\nbackground = 'red'", "scene.background is 'red': give three numbers"),
        ("[scene.camera]\nazimut = 3", "scene.camera has no key 'azimut'; it has azimuth"),
        ("[scene.camera]\ndistance = -1", "a camera at distance -1"),
        ("[[scene.lights]]\nkind = 'lamp'", "scene.lights: give each a kind: directional, point"),
        ("[[scene.lights]]\nkind = 'point'", "scene.lights (point): give it a position"),
        ("[scene.lights]\nkind = 'point'", "scene.lights is a table: give tables, each [[scene"),
        ("[scene.shading]\nambient = -1", "ambient is -1: give a number from 0"),
        ("[motion]\nscroll = 1", "motion.scroll is 1: give two numbers"),
        ("[object\nscale = 1", "is not TOML: "),
        ("[object]\nscale = 2024-01-01", "object.scale is datetime.date(2024, 1, 1): give a text"),
    ],
)
def test_invalid_files_are_refused_in_one_line(
    text: str, message_part: str, tmp_path: Path
) -> None:
    """File, key, what to do."""
    path = tmp_path / "mine.toml"
    path.write_text(text)
    message = error_message(lambda: preset(path))
    assert message.startswith(f"{path}: ")
    assert message_part in message


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    assert error_message(lambda: preset(path)) == f"{path}: there is no such file; check the name"
    path.write_bytes(b"about = '\xff'")
    assert "is not TOML: not UTF-8" in error_message(lambda: preset(path))
    path.unlink()
    path.mkdir()
    assert "cannot be read" in error_message(lambda: preset(path))
    assert "is a folder" in error_message(lambda: Preset("a").save(path))
    assert "a preset is a .toml file" in error_message(lambda: Preset("a").save(tmp_path / "a.txt"))
    assert "does not exist" in error_message(lambda: Preset("a").save(tmp_path / "no" / "a.toml"))


def test_paths_are_from_the_folder_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Paths in a file are relative to its folder, whatever the working directory."""
    home = tmp_path / "home"
    home.mkdir()
    write_data(home / "moss.png", np.full((8, 8, 3), 90, np.uint8))
    (home / "my.py").write_text(OWN)
    (home / "mine.toml").write_text(
        '[maps]\nbase_color = "moss.png"\n[object]\ntechnique = "my.py:half"\n'
        '[object.layer]\nmaterial = "moss.png"\n'
    )
    monkeypatch.chdir(tmp_path)
    write_heights(tmp_path / "hill", np.zeros((8, 8, 1), np.uint16))
    made = preset("home/mine.toml")
    material = basrelief.load("hill", **made.maps)
    assert material.base_color is not None
    scene = made.scene(material)
    assert scene.objects[0].resolved.technique.name == "half"
    assert scene.objects[0].layer is not None


OWN = """
from basrelief.lang import HeightField
from basrelief.techniques import Hit, Nothing, Ray, hit_at, technique

@technique()
def half(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    return hit_at(ray, 0.5, True, 0)
"""


def test_presets_are_immutable() -> None:
    made = preset("gamedev")
    with pytest.raises(TypeError):
        made.values["object"]["scale"] = 3.0  # type: ignore[index]
    tables: dict[str, Any] = {"object": {"scale": 0.1}}
    copied = Preset("a", values=tables)
    tables["object"]["scale"] = 3.0
    assert copied.values["object"]["scale"] == 0.1


# --- written and read back ------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_each_preset_survives_saving(name: str, tmp_path: Path) -> None:
    made = preset(name)
    saved = made.save(tmp_path / "other.toml")
    assert saved == tmp_path / "other.toml"
    assert preset(saved) == made


def test_numbers_of_numpy_and_shaders_become_python_numbers(tmp_path: Path) -> None:
    made = Preset(
        "tuned",
        values={
            "object": {"scale": np.float32(0.1), "settings": {"max_steps": np.int64(7)},
                       "tiling": np.array([1.0, 2.0])},
            "scene": {"shading": {"ambient": Vec3(0.1, 0.2, 0.3)}},
        },
    )  # fmt: skip
    back = preset(made.save(tmp_path / "tuned.toml"))
    assert back == made
    assert isinstance(back.values["object"]["settings"]["max_steps"], int)
    assert back.scene(material_of_heights()).shading.ambient == Vec3(0.1, 0.2, 0.3)


NUMBERS = st.floats(0.0, 1.0)
TEXTS = st.text(st.characters(exclude_categories=("Cs",)), max_size=20)
PRESET_VALUES = st.fixed_dictionaries(
    {},
    optional={
        "object": st.fixed_dictionaries(
            {"technique": st.just("relief")},
            optional={
                "scale": NUMBERS,
                "reference_height": NUMBERS,
                "projection": st.sampled_from(["full", "biased", "limited"]),
                "fade": st.tuples(st.floats(0, 1), st.floats(2, 3)),
                "settings": st.fixed_dictionaries(
                    {}, optional={"min_steps": st.integers(1, 64), "search_steps": st.just(3)}
                ),
                "tilings": st.dictionaries(
                    st.sampled_from(["normal", "base_color"]),
                    st.fixed_dictionaries({"tiles": st.tuples(st.just(2), st.floats(1, 9))}),
                ),
            },
        ),
        "scene": st.fixed_dictionaries(
            {},
            optional={
                "shadows": st.sampled_from(["none", "hard"]),
                "shading": st.fixed_dictionaries({"ambient": st.tuples(*[NUMBERS] * 3)}),
                "lights": st.lists(
                    st.fixed_dictionaries(
                        {"kind": st.just("point"), "position": st.tuples(*[NUMBERS] * 3)}
                    ),
                    max_size=3,
                ),
            },
        ),
        "maps": st.fixed_dictionaries({"stretch_height": st.booleans()}),
    },
)


@given(TEXTS, TEXTS, PRESET_VALUES)
@examples(max_examples=60)
def test_any_preset_survives_saving(
    tmp_path_factory: pytest.TempPathFactory, about: str, source: str, values: dict[str, Any]
) -> None:
    made = Preset("any", about, source, values)
    assert preset(made.save(tmp_path_factory.getbasetemp() / "any.toml")) == made


SAVED = """\
name = "mine"
about = "Bricks in two lines:\\nthe second."

[object]
technique = "relief"
scale = 0.1

[object.settings]
max_steps = 7

[scene]
shadows = "hard"

[[scene.lights]]
kind = "point"
position = [
    1.0,
    2.0,
    3.0,
]
"""


def test_a_saved_preset_has_its_tables_in_their_order() -> None:
    """Texts come first, then tables in their order, with each number on its own line."""
    made = Preset(
        "mine",
        "Bricks in two lines:\nthe second.",
        values={
            "object": {"technique": "relief", "settings": {"max_steps": 7}, "scale": 0.1},
            "scene": {
                "lights": [{"kind": "point", "position": (1.0, 2.0, 3.0)}],
                "shadows": "hard",
            },
        },
    )
    assert made.to_toml() == SAVED


def test_techniques_of_presets_are_those_of_the_library() -> None:
    for name in NAMES:
        obj = preset(name).values["object"]
        assert technique_named(obj["technique"]).name == obj["technique"]


def test_the_example_of_the_page(tmp_path: Path) -> None:
    page = (REPOSITORY / "docs" / "presets.md").read_text()
    path = tmp_path / "mine.toml"
    path.write_text(page.partition("```toml\n")[2].partition("```")[0])
    scene = preset(path).scene(material_of_heights())
    assert scene.objects[0].tilings == {"base_color": Tiling((2, 2))}
    assert scene.camera == Orbit(20, 25)
    for name in NAMES:
        assert f"| `{name}` |" in page


def test_the_public_names_of_presets_exist() -> None:
    from basrelief.scene import presets

    assert all(hasattr(presets, name) for name in presets.__all__)
