"""Loading of materials: names, conventions, preferences, channels, directions and errors.

Pictures are small, not square and not symmetrical, so that mirrored or swapped axes show.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from basrelief.errors import InputError
from basrelief.images import write_data, write_picture
from basrelief.material import MAPS, Map, Material, Note, describe, load, report, sample
from basrelief.material.conventions import Part, parse_name, parse_names
from basrelief.material.evidence import slope_correlation
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Scene

HEIGHT, WIDTH = 24, 40


def hills(height: int = HEIGHT, width: int = WIDTH) -> np.ndarray:
    """Heights 0 to 1, (h, w), without any symmetry."""
    y, x = np.mgrid[:height, :width]
    u, v = (x + 0.5) / width, (y + 0.5) / height
    waves = np.sin(2 * np.pi * (2 * u + v)) + np.sin(2 * np.pi * (u - 3 * v) + 1) * 0.7
    waves = waves + np.exp(-40 * ((u - 0.3) ** 2 + (v - 0.7) ** 2)) * 2
    return (waves - waves.min()) / (waves.max() - waves.min())


def normals_of(heights: np.ndarray, green_up: bool = True) -> np.ndarray:
    """Normals of heights by an independent formula, stored 0 to 1."""
    down, right = np.gradient(heights * 8)
    y = down if green_up else -down  # up in the picture is against the rows
    normal = np.stack([-right, y, np.ones_like(right)], 2)
    return normal / np.linalg.norm(normal, axis=2, keepdims=True) * 0.5 + 0.5


def eight(values: np.ndarray) -> np.ndarray:
    values = values if values.ndim == 3 else values[:, :, None]
    return np.rint(values * 255).astype(np.uint8)


def sixteen(values: np.ndarray) -> np.ndarray:
    values = values if values.ndim == 3 else values[:, :, None]
    return np.rint(values * 65535).astype(np.uint16)


def flat(*channels: int, height: int = HEIGHT, width: int = WIDTH) -> np.ndarray:
    return np.full((height, width, len(channels)), channels, np.uint8)


def write_picture_file(folder: Path, name: str, pixels: np.ndarray | None = None) -> Path:
    """Write a picture file, by default of grey heights."""
    return write_data(folder / name, eight(hills()) if pixels is None else pixels)


def has_note(material: Material, *words: str) -> bool:
    """Whether a single note contains all the words."""
    return any(all(word in str(note) for word in words) for note in material.notes)


# --- names


NAMES = {
    "Rock058_1K-JPG_Color": "base_color",
    "Rock058_1K-JPG_NormalGL": "normal gl",
    "Rock058_1K-JPG_NormalDX": "normal dx",
    "Rock058_1K-JPG_Displacement": "height",
    "Rock058_1K-JPG_AmbientOcclusion": "occlusion",
    "Rock058_1K-JPG_Roughness": "roughness",
    "Rock058_1K-JPG_Metalness": "metallic",
    "Rock058_1K-JPG_Opacity": "opacity",
    "Rock058_1K-JPG_Emission": "emission",
    "Rock058": None,
    "rough_wood_diff_1k": "base_color",
    "rough_wood_nor_gl_1k": "normal gl",
    "rough_wood_nor_dx_4k": "normal dx",
    "rough_wood_disp_1k": "height",
    "rough_wood_rough_1k": "roughness",
    "rough_wood_ao_1k": "occlusion",
    "rough_wood_metal_1k": "metallic",
    "rough_wood_arm_1k": "occlusion:r roughness:g metallic:b",
    "rough_wood_spec_1k": "",
    "wall_basecolor": "base_color",
    "wall_ambientocclusion": "occlusion",
    "wall_Base_Color": "base_color",
    "wall_emissive": "emission",
    "wall_Height": "height",
    "Brick_Albedo": "base_color",
    "Brick_MainTex": "base_color",
    "Brick_ParallaxMap": "height",
    "Brick_OcclusionMap": "occlusion",
    "Brick_EmissionMap": "emission",
    "Brick_MetallicGlossMap": "metallic:r -roughness:a",
    "Brick_MetallicSmoothness": "metallic:r -roughness:a",
    "Brick_MaskMap": "metallic:r occlusion:g -roughness:a",
    "Brick_Mask": None,
    "Brick_AlbedoTransparency": "base_color opacity:a",
    "old.col": "base_color",
    "old nrm": "normal",
    "old-dis": "height",
    "old_depth": "-height",
    "old_DEPTH_2048": "-height",
    "old_height_inv": "-height",
    "old_inv_height": "-height",
    "old_cavitydepth": "-height",
    "old_gloss": "-roughness",
    "old_mtl": "metallic",
    "old_bump": "height",
    "old_normal_height": "normal height:a",
    "old_nh": "normal height:a",
    "old_normal-OpenGL": "normal gl",
    "old_normal_directx": "normal dx",
    "old_normal_d3d": "normal dx",
    "old_normalogl_2048x1024": "normal gl",
    "old_ORM": "occlusion:r roughness:g metallic:b",
    "old_RMA": "roughness:r metallic:g occlusion:b",
    "old_MRAO": "metallic:r roughness:g occlusion:b",
    "old_metallicRoughness": "roughness:g metallic:b",
    "T_Rock_N": "normal",
    "T_Rock_BC": "base_color",
    "vitamin_d": None,
    "color_preview": "",
    "": None,
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("case", [str, str.lower, str.upper])
def test_names_identify_maps(name: str, case: type) -> None:
    meaning = parse_name(case(name)).meaning
    result = None
    if meaning is not None:
        parts = (
            "-" * part.inverted + part.map + f":{part.channel}" * bool(part.channel)
            for part in meaning.parts
        )
        result = " ".join([*parts, *([meaning.green] if meaning.green else [])])
    assert result == NAMES[name]


@pytest.mark.parametrize("name", ["wood_2048_color", "wood_2K-PNG_color", "wood_512x256_color"])
def test_sizes_and_formats_are_not_part_of_the_name(name: str) -> None:
    assert parse_name(name).prefix == ("wood",)


def test_shared_words_name_the_material() -> None:
    names = parse_names(["rusty_metal", "rusty_metal_normal", "rusty_metal_metal"])
    assert names["rusty_metal"].meaning is None
    assert names["rusty_metal_metal"].meaning == parse_name("metal").meaning
    assert names["rusty_metal_metal"].prefix == ("rusty", "metal")


@pytest.mark.parametrize(
    "stems",
    [
        ("wall_normal_gl", "wall_normal_dx"),
        ("height_1k", "height_2k"),
        ("height", "height_preview"),
    ],
)
def test_shared_words_that_identify_the_map_count(stems: tuple[str, ...]) -> None:
    meaning = parse_names(stems)[stems[0]].meaning
    assert meaning is not None
    assert meaning.parts[0].map in ("normal", "height")


@given(st.text(max_size=40))
def test_any_text_can_be_a_name(text: str) -> None:
    name = parse_name(text)
    assert len(name.prefix) <= len(name.words)


@given(
    st.sampled_from(["Color", "NormalGL", "Displacement", "rough", "ao", "Metalness"]),
    st.sampled_from(["_", "-", " ", "."]),
    st.sampled_from(["", "1K", "2k", "4096", "1024x1024", "16bit"]),
    st.sampled_from(["", "JPG", "png"]),
    st.text("abcdxyzQW", max_size=8).filter(lambda text: parse_name(text).meaning is None),
)
def test_sizes_and_formats_do_not_matter(
    kind: str, joint: str, size: str, file_format: str, name: str
) -> None:
    whole = joint.join(each for each in (name, size, file_format, kind) if each)
    other = joint.join(each for each in (name, kind, file_format, size) if each)
    assert parse_name(whole).meaning == parse_name(other).meaning == parse_name(kind).meaning


# --- loading a folder


def test_every_map_of_a_folder_is_loaded(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(200, 100, 50))
    write_picture_file(tmp_path, "a_normal.png", eight(normals_of(hills())))
    for name in ("height", "ao", "roughness", "metallic", "opacity", "detail_mask", "dust_mask"):
        write_picture_file(tmp_path, f"a_{name}.png")
    write_picture_file(tmp_path, "a_emission.png", flat(9, 8, 7))
    material = load(tmp_path, depth=0.1, tile=2.0)
    assert {kind: each.channels for kind, each in material.maps()} == {
        kind: map.channels for kind, map in MAPS.items()
    }
    assert [kind for kind, each in material.maps() if each.srgb] == ["base_color", "emission"]
    assert material.name == tmp_path.name
    assert material.scale == pytest.approx(0.05)
    assert (material.depth, material.tile) == (0.1, 2.0)


def test_values_and_orientation_are_preserved(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_height.png", sixteen(hills()))
    write_picture_file(tmp_path, "a_color.png", flat(188, 255, 0))
    material = load(tmp_path)
    assert material.height is not None
    assert material.base_color is not None
    assert material.height.pixels.dtype == np.uint16
    assert (material.height.width, material.height.height) == (WIDTH, HEIGHT)
    assert material.height.linear()[:, :, 0] == pytest.approx(hills(), abs=1e-5)
    assert material.base_color.linear()[3, 5] == pytest.approx([0.5029, 1, 0], abs=1e-4)


def test_float_colours_are_linear(tmp_path: Path) -> None:
    light = np.full((HEIGHT, WIDTH, 3), 0.25, np.float32)
    write_picture(tmp_path / "a_color.exr", light, bits=32)
    material = load(tmp_path)
    assert material.base_color is not None
    assert not material.base_color.srgb
    assert (material.base_color.linear() == 0.25).all()


def test_exr_colours_are_divided_by_their_alpha(tmp_path: Path) -> None:
    light = np.full((HEIGHT, WIDTH, 4), 0.5, np.float32)
    light[:, ::2, 3] = 0.25
    write_picture(tmp_path / "a_color.exr", light, bits=32)
    material = load(tmp_path)
    assert material.base_color is not None
    assert material.opacity is not None
    assert (material.base_color.linear() == 0.5).all()
    assert material.opacity.linear()[0, :2, 0].tolist() == [0.25, 0.5]


def test_missing_heights_are_noted(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    material = load(tmp_path)
    assert material.height is None
    assert material.height_range is None
    assert has_note(material, "no height map")


def test_grey_colours_and_coloured_heights_work(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_color.png")
    write_picture_file(
        tmp_path, "a_height.png", np.concatenate([flat(1), eight(hills()), flat(2)], 2)
    )
    material = load(tmp_path)
    assert material.base_color is not None
    assert material.height is not None
    assert (material.base_color.pixels == eight(hills())).all()
    assert (material.height.pixels == eight(hills())).all()
    assert has_note(material, "height from a_height.png (G)", "green, the default")


@pytest.mark.parametrize(
    ("channel", "value"), [("r", 10), ("g", 20), ("b", 30), ("a", 40), ("luminance", 18.596)]
)
def test_the_height_channel_is_a_choice(tmp_path: Path, channel: str, value: float) -> None:
    file = write_picture_file(tmp_path, "a_height.png", flat(10, 20, 30, 40))
    material = load(height=file, height_channel=channel)  # type: ignore[arg-type]
    assert material.height is not None
    assert material.height.linear() * 255 == pytest.approx(value, abs=1e-3)


def test_grey_with_alpha_is_read_as_grey(tmp_path: Path) -> None:
    grey = np.concatenate([eight(hills()), flat(7)], 2)
    material = load(height=write_picture_file(tmp_path, "a_height.png", grey))
    assert material.height is not None
    assert (material.height.pixels == eight(hills())).all()


def test_packed_maps_are_split(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_diff.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_arm.png", flat(10, 20, 30))
    material = load(tmp_path)
    found = {kind: int(each.pixels[0, 0, 0]) for kind, each in material.maps()}
    assert found == {"base_color": 1, "occlusion": 10, "roughness": 20, "metallic": 30}
    assert has_note(material, "roughness from a_arm.png (G)", "packed")


def test_smoothness_becomes_roughness(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_albedo.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_MetallicSmoothness.png", flat(10, 20, 30, 55))
    material = load(tmp_path)
    assert material.metallic is not None
    assert material.roughness is not None
    assert material.metallic.pixels[0, 0].tolist() == [10]
    assert material.roughness.pixels[0, 0].tolist() == [200]
    assert has_note(material, "1 − a_MetallicSmoothness.png (A)", "gloss")


def test_packed_without_its_channel_is_refused(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_MetallicSmoothness.png", flat(10, 20, 30))
    with pytest.raises(InputError, match=r"a_MetallicSmoothness\.png: has no alpha"):
        load(tmp_path)


def test_a_varying_alpha_of_the_colour_is_opacity(tmp_path: Path) -> None:
    color = np.concatenate([flat(1, 2, 3), eight(hills())], 2)
    write_picture_file(tmp_path, "a_color.png", color)
    material = load(tmp_path)
    assert material.opacity is not None
    assert (material.opacity.pixels == eight(hills())).all()


@pytest.mark.parametrize("alpha", [255, 0])
def test_a_constant_alpha_is_ignored(tmp_path: Path, alpha: int) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3, alpha))
    assert load(tmp_path).opacity is None


def test_heights_in_the_alpha_of_the_normals(tmp_path: Path) -> None:
    both = np.concatenate([eight(normals_of(hills())), eight(hills())], 2)
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_normal.png", both)
    material = load(tmp_path)
    assert material.height is not None
    assert material.normal is not None
    assert (material.height.pixels == eight(hills())).all()
    assert (material.normal.pixels == eight(normals_of(hills()))).all()
    assert has_note(material, "height from a_normal.png (A)", "varies")
    inverted = load(tmp_path, height_polarity="depth").height
    assert inverted is not None
    assert (inverted.pixels == 255 - eight(hills())).all()
    write_picture_file(tmp_path, "a_height.png", flat(9))
    assert has_note(load(tmp_path), "ignored a_normal.png (A)")


def test_a_name_for_normal_and_height(tmp_path: Path) -> None:
    write_picture_file(
        tmp_path, "a_nh.png", np.concatenate([eight(normals_of(hills())), eight(hills())], 2)
    )
    material = load(tmp_path)
    assert material.height is not None
    assert (material.height.pixels == eight(hills())).all()


@pytest.mark.parametrize(
    ("packing", "pixels"), [("ag", (0, 60, 0, 200)), ("rg", (200, 60, 9, 9)), ("rg", (200, 60))]
)
def test_two_channel_normals_get_z_reconstructed(
    tmp_path: Path, packing: str, pixels: tuple[int, ...]
) -> None:
    file = write_picture_file(tmp_path, "a_normal.png", flat(*pixels))
    material = load(normal=file, normal_packing=packing)  # type: ignore[arg-type]
    assert material.normal is not None
    assert material.normal.pixels[0, 0, :2].tolist() == [200, 60]
    length = np.linalg.norm(material.normal.linear() * 2 - 1, axis=2)
    assert length == pytest.approx(1, abs=0.005)
    assert material.height is None


def test_signed_float_normals_are_mapped_to_unit_range(tmp_path: Path) -> None:
    normal = (normals_of(hills()) * 2 - 1).astype(np.float32)
    material = load(normal=write_picture_file(tmp_path, "a_normal.exr", normal))
    assert material.normal is not None
    assert material.normal.pixels == pytest.approx(normals_of(hills()), abs=1e-6)


# --- directions


@pytest.mark.parametrize("size", [(HEIGHT, WIDTH), (2 * HEIGHT, 2 * WIDTH), (600, 1000)])
def test_slopes_reveal_polarity_and_green(size: tuple[int, int]) -> None:
    heights, normal = sixteen(hills(*size)), eight(normals_of(hills()))
    found = slope_correlation(heights, normal)
    assert found is not None
    assert found.x > 0.8
    assert found.y > 0.8
    assert not found.green_is_down
    assert not found.heights_are_depths
    down = slope_correlation(heights, eight(normals_of(hills(), green_up=False)))
    assert down is not None
    assert down.green_is_down
    assert not down.heights_are_depths
    deep = slope_correlation(65535 - heights, normal)
    assert deep is not None
    assert deep.heights_are_depths
    assert not deep.green_is_down


def test_unrelated_or_constant_maps_reveal_nothing() -> None:
    noise = np.random.default_rng(0).integers(0, 255, (HEIGHT, WIDTH, 1), np.uint8)
    found = slope_correlation(noise, eight(normals_of(hills())))
    assert found is not None
    assert not found.is_significant
    assert slope_correlation(flat(5), eight(normals_of(hills()))) is None
    assert slope_correlation(noise[:1, :1], eight(normals_of(hills()))) is None


@pytest.mark.parametrize(
    ("name", "stored_up", "convention", "loaded_up", "because"),
    [
        ("normal", True, "auto", True, "confirmed by the heights"),
        ("normal", False, "auto", True, "DX by comparison with the heights"),
        ("normal_gl", True, "auto", True, "GL by its name"),
        ("normal_dx", False, "auto", True, "DX by its name"),
        ("normal_gl", False, "auto", False, "heights contradict"),
        ("normal", True, "dx", False, "requested: DX"),
        ("normal_dx", True, "gl", True, "requested: GL"),
    ],
)
def test_green_is_converted_to_up(
    tmp_path: Path, name: str, stored_up: bool, convention: str, loaded_up: bool, because: str
) -> None:
    write_picture_file(tmp_path, "a_height.png")
    write_picture_file(tmp_path, f"a_{name}.png", eight(normals_of(hills(), green_up=stored_up)))
    material = load(tmp_path, normal_convention=convention)  # type: ignore[arg-type]
    assert material.normal is not None
    expected = normals_of(hills(), green_up=loaded_up)
    assert material.normal.linear() == pytest.approx(expected, abs=0.003)
    assert has_note(material, "normals with green", because)


def test_green_is_up_by_default_without_heights(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_normal.png", eight(normals_of(hills(), green_up=False)))
    material = load(tmp_path)
    assert material.normal is not None
    assert (material.normal.pixels == eight(normals_of(hills(), green_up=False))).all()


@pytest.mark.parametrize(
    ("name", "polarity", "inverted"),
    [
        ("height", "auto", False),
        ("depth", "auto", True),
        ("height", "depth", True),
        ("depth", "height", False),
    ],
)
def test_depths_become_heights(tmp_path: Path, name: str, polarity: str, inverted: bool) -> None:
    write_picture_file(tmp_path, f"a_{name}.png", sixteen(hills()))
    material = load(tmp_path, height_polarity=polarity)  # type: ignore[arg-type]
    assert material.height is not None
    expected = 65535 - sixteen(hills()) if inverted else sixteen(hills())
    assert (material.height.pixels == expected).all()


def test_normals_reveal_depths(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_disp.png", 255 - eight(hills()))
    write_picture_file(tmp_path, "a_normal.png", eight(normals_of(hills())))
    material = load(tmp_path)
    assert material.height is not None
    assert material.normal is not None
    assert (material.height.pixels == eight(hills())).all()
    assert (material.normal.pixels == eight(normals_of(hills()))).all()
    assert has_note(material, "white is deep", "comparison with the normals")


# --- the range of heights


def test_a_partly_used_range_is_noted_and_stretched(tmp_path: Path) -> None:
    narrow = sixteen(0.3 + 0.3 * hills())
    write_picture_file(tmp_path, "a_height.png", narrow)
    material = load(tmp_path)
    assert material.height is not None
    assert (material.height.pixels == narrow).all()
    assert material.height_range == pytest.approx((0.3, 0.6), abs=1e-4)
    assert has_note(material, "30 % of the range", "0.3 to 0.6", "stretch_height")
    full = load(tmp_path, stretch_height=True)
    assert full.height is not None
    assert full.height_range == (0, 1)
    assert full.height.linear()[:, :, 0] == pytest.approx(hills(), abs=1e-4)


def test_a_full_range_is_not_noted(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_height.png")
    assert not has_note(load(tmp_path), "range")


def test_float_heights_beyond_the_range_are_stretched(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_height.exr", (hills() * 5 - 2).astype(np.float32)[:, :, None])
    material = load(tmp_path)
    assert material.height is not None
    assert material.height_range == (0, 1)
    assert material.height.linear()[:, :, 0] == pytest.approx(hills(), abs=1e-5)
    assert has_note(material, "heights stretched", "-2 to 3")


@pytest.mark.parametrize("value", [0, 77, 255])
def test_a_flat_height_map_works(tmp_path: Path, value: int) -> None:
    write_picture_file(tmp_path, "a_height.png", flat(value))
    assert has_note(load(tmp_path, stretch_height=True), "heights are constant")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("stretch", [False, True])
def test_heights_that_are_not_finite_are_refused(tmp_path: Path, bad: float, stretch: bool) -> None:
    heights = hills().astype(np.float32)[:, :, None]
    heights[3, 4] = bad
    write_picture_file(tmp_path, "a_height.exr", heights)
    with pytest.raises(InputError, match=r"a_height\.exr: 1 of its texels are NaN or infinite"):
        load(tmp_path, stretch_height=stretch)


# --- several files for one map


@pytest.mark.parametrize(
    ("better", "worse"),
    [
        (("a_height_1.png", sixteen(hills())), ("a_height_2.png", eight(hills()))),
        (
            ("a_height_2.exr", hills().astype(np.float32)[:, :, None]),
            ("a_height_1.png", sixteen(hills())),
        ),
        (("a_height_2k.png", eight(hills(48, 80))), ("a_height_1k.png", eight(hills()))),
        (("a_height.png", eight(hills())), ("a_bump.png", sixteen(hills()))),
        (("a_height.png", eight(hills())), ("a_depth.png", sixteen(hills()))),
        (("a_normal_gl.png", eight(normals_of(hills()))), ("a_normal_dx.png", flat(1, 2, 3))),
        (("a_normal_gl.png", eight(normals_of(hills()))), ("a_normal.png", flat(1, 2, 3))),
        (("a_normal.png", eight(normals_of(hills()))), ("a_normal_dx.png", flat(1, 2, 3))),
        (("a_albedo.png", flat(1, 2, 3)), ("a_diffuse.png", flat(3, 2, 1))),
        (("a_roughness.png", flat(1)), ("a_gloss.png", flat(3))),
        (("a_roughness.png", flat(1)), ("a_ORM.png", flat(3, 3, 3))),
    ],
)
def test_the_preferred_file_is_chosen(
    tmp_path: Path, better: tuple[str, np.ndarray], worse: tuple[str, np.ndarray]
) -> None:
    write_picture_file(tmp_path, *worse)
    write_picture_file(tmp_path, *better)
    material = load(tmp_path)
    assert better[0] in {each.source for _, each in material.maps()}
    assert has_note(material, f"{better[0]} before {worse[0]}")


def test_lossless_comes_before_lossy(tmp_path: Path) -> None:
    write_picture(tmp_path / "a_height.jpg", np.zeros((HEIGHT, WIDTH, 3), np.float32))
    write_picture_file(tmp_path, "a_height.png")
    material = load(tmp_path)
    assert material.height is not None
    assert material.height.source == "a_height.png"
    assert has_note(material, "a_height.png before a_height.jpg", "lossless")


def test_dx_is_chosen_on_request(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_normal_gl.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_normal_dx.png", flat(1, 200, 3))
    material = load(tmp_path, normal_convention="dx")
    assert material.normal is not None
    assert material.normal.pixels[0, 0].tolist() == [1, 55, 3]


def test_a_tie_is_an_error(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_height.png", flat(1))
    write_picture_file(tmp_path, "a_displacement.png", flat(2))
    with pytest.raises(
        InputError, match=r"a_displacement\.png and a_height\.png both fit .*--height FILE"
    ):
        load(tmp_path)
    material = load(tmp_path, height=tmp_path / "a_height.png")
    assert material.height is not None
    assert material.height.pixels[0, 0, 0] == 1


def test_a_picture_selects_one_of_two_sets(tmp_path: Path) -> None:
    for name, value in (("stone", 10), ("wood", 20)):
        write_picture_file(tmp_path, f"{name}_color.png", flat(value, 0, 0))
        write_picture_file(tmp_path, f"{name}_height.png", flat(value))
    with pytest.raises(InputError, match="one picture of the set"):
        load(tmp_path)
    material = load(tmp_path / "wood_color.png")
    assert material.height is not None
    assert material.base_color is not None
    assert material.name == "wood"
    assert material.height.pixels[0, 0, 0] == material.base_color.pixels[0, 0, 0] == 20


# --- one picture, explicit files, other files


def test_one_picture_is_a_base_colour(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "holiday.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "other_height.png")
    material = load(tmp_path / "holiday.png")
    assert [kind for kind, _ in material.maps()] == ["base_color"]
    assert has_note(material, "holiday.png used as base_color")


def test_one_picture_loads_its_set(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "bricks2.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "bricks2_disp.png")
    write_picture_file(tmp_path, "bricks3_normal.png", flat(1, 2, 3))
    material = load(tmp_path / "bricks2.png")
    assert [kind for kind, _ in material.maps()] == ["base_color", "height"]
    assert has_note(material, "bricks2_disp.png loaded too")


def test_a_picture_without_a_map_in_its_name_is_the_colour_of_its_folder(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "bricks2.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "bricks2_disp.png")
    material = load(tmp_path)
    assert material.base_color is not None
    assert material.base_color.source == "bricks2.png"


def test_explicit_files_override_names(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_height.png", flat(50))
    mine = write_picture_file(tmp_path, "my_own.png", flat(60))
    material = load(tmp_path, height=mine)
    assert material.height is not None
    assert material.height.pixels[0, 0, 0] == 60


def test_a_folder_names_the_map_of_its_material(tmp_path: Path) -> None:
    wall, other = tmp_path / "wall", tmp_path / "other"
    for folder, value in ((wall, 50), (other, 60)):
        folder.mkdir()
        write_picture_file(folder, "a_color.png", flat(value, 2, 3))
        write_picture_file(folder, "a_depth.png", flat(value))
    material = load(wall, height=other, dust=other)
    assert material.base_color is not None
    assert material.height is not None
    assert material.dust is not None
    assert material.base_color.pixels[0, 0, 0] == 50
    # a depth by its name
    assert material.height.pixels[0, 0, 0] == 255 - 60
    assert material.dust is not material.height
    assert (material.dust.pixels == material.height.pixels).all()
    assert has_note(material, f"dust from {other}")
    with pytest.raises(InputError, match="other has no roughness map; choose another sample"):
        load(wall, roughness=other)


def test_dust_is_that_of_a_file_or_a_sample(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "moon_dust.png", flat(1, 2, 3))
    # the word is a part of many names of materials
    assert [kind for kind, _ in load(tmp_path).maps()] == ["base_color"]
    thick = write_picture_file(tmp_path / "..", "thick.png", flat(77))
    material = load(tmp_path, dust=thick)
    assert material.dust is not None
    assert material.dust.pixels[0, 0, 0] == 77
    material = load(tmp_path, dust="sample:dust")
    assert material.dust is not None
    assert (material.dust.pixels == load("sample:dust").height.pixels).all()  # type: ignore[union-attr]


def test_maps_load_without_a_folder(tmp_path: Path) -> None:
    packed = write_picture_file(tmp_path, "a_arm.png", flat(10, 20, 30))
    gloss = write_picture_file(tmp_path, "a_gloss.png", flat(55))
    material = load(roughness=gloss, metallic=packed)
    assert material.roughness is not None
    assert material.metallic is not None
    assert material.roughness.pixels[0, 0, 0] == 200
    assert material.metallic.pixels[0, 0, 0] == 30


def test_other_files_are_ignored(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_color_preview.png", flat(9, 9, 9))
    write_picture_file(tmp_path, ".a_height.png")
    for name in ("readme.txt", "a.blend", "a.mtlx", "a_height.txt"):
        (tmp_path / name).write_text("no picture")
    material = load(tmp_path)
    assert [kind for kind, _ in material.maps()] == ["base_color"]
    assert has_note(material, "ignored a_color_preview.png")


def test_the_only_subfolder_is_searched(tmp_path: Path) -> None:
    (tmp_path / "textures").mkdir()
    (tmp_path / "a.blend").write_text("")
    write_picture_file(tmp_path / "textures", "a_height.png")
    material = load(tmp_path)
    assert material.height is not None
    assert has_note(material, "searched textures")


@pytest.mark.parametrize("grey", [True, False])
def test_bump_maps_are_classified_by_their_colours(tmp_path: Path, grey: bool) -> None:
    grey_heights = eight(hills()).repeat(3, 2)
    write_picture_file(
        tmp_path, "Brick_BumpMap.png", grey_heights if grey else eight(normals_of(hills()))
    )
    assert [kind for kind, _ in load(tmp_path).maps()] == ["height" if grey else "normal"]


def test_samples_load_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    # at the default size, which other tests reduce
    monkeypatch.setattr(sys.modules["basrelief.material.loading"], "sample", sample)
    material = load("sample:bricks", tile=3.0)
    assert (material.name, material.tile) == ("bricks", 3.0)
    assert material.height is not None
    assert (material.height.pixels == sample("bricks").height.pixels).all()  # type: ignore[union-attr]


def test_the_scanned_rock_is_recognised(rock058: Path) -> None:
    material = load(rock058)
    kinds = ["base_color", "normal", "height", "occlusion", "roughness"]
    assert [kind for kind, _ in material.maps()] == kinds
    assert material.height is not None
    assert material.normal is not None
    found = slope_correlation(material.height.pixels, material.normal.pixels)
    assert found is not None
    assert min(found.x, found.y) > 0.8


# --- errors


def test_nothing_to_load_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to load"):
        load()
    with pytest.raises(InputError, match="no such file or folder"):
        load(tmp_path / "none")
    with pytest.raises(InputError, match="no picture in this folder"):
        load(tmp_path)
    (tmp_path / "readme.txt").write_text("")
    with pytest.raises(InputError, match="no picture in this folder"):
        load(tmp_path)
    with pytest.raises(InputError, match="no sample 'x'; choose one of bricks"):
        load("sample:x")
    with pytest.raises(InputError, match="no such file or folder"):
        load("x" * 5000)


def test_names_without_maps_are_refused(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "one.png")
    write_picture_file(tmp_path, "two.png")
    with pytest.raises(InputError, match=r"identifies a map \(one\.png, two\.png\)"):
        load(tmp_path)


def test_damaged_maps_are_named(tmp_path: Path) -> None:
    file = write_picture_file(tmp_path, "a_height.png")
    file.write_bytes(file.read_bytes()[:-30])
    with pytest.raises(InputError, match=r"a_height\.png: the picture is damaged"):
        load(tmp_path)


@pytest.mark.parametrize(
    "option", ["normal_convention", "height_polarity", "height_channel", "normal_packing"]
)
def test_unknown_options_are_refused(tmp_path: Path, option: str) -> None:
    write_picture_file(tmp_path, "a_height.png")
    with pytest.raises(InputError, match=f"{option} is one of .*'up'"):
        load(tmp_path, **{option: "up"})  # type: ignore[arg-type]


@pytest.mark.parametrize("metres", [0, -1, np.nan, np.inf])
@pytest.mark.parametrize("which", ["depth", "tile"])
def test_lengths_are_above_zero(metres: float, which: str) -> None:
    with pytest.raises(InputError, match=f"{which} is a length above 0"):
        load("sample:tiles", **{which: metres})  # type: ignore[arg-type]


def test_one_channel_is_not_a_normal_map(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_normal.png")
    with pytest.raises(InputError, match=r"1 channels make no normal map.*--height FILE"):
        load(tmp_path)


@pytest.mark.parametrize("size", [(24, 24), (40, 24), (24, 42), (240, 240)])
def test_other_proportions_are_refused(tmp_path: Path, size: tuple[int, int]) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_height.png", eight(hills(*size)))
    with pytest.raises(InputError, match=rf"a_height\.png: .*{size[1]}×{size[0]}.*40×24"):
        load(tmp_path)


@pytest.mark.parametrize("size", [(12, 20), (48, 80), (3, 5), (11, 19), (120, 201), (1, 1)])
def test_other_sizes_work(tmp_path: Path, size: tuple[int, int]) -> None:
    write_picture_file(tmp_path, "a_color.png", flat(1, 2, 3))
    write_picture_file(tmp_path, "a_height.png", flat(7, height=size[0], width=size[1]))
    assert load(tmp_path).height is not None


# --- Map and Material by themselves


def test_maps_of_another_kind_are_refused() -> None:
    for pixels in (
        np.zeros((2, 2), np.uint8),
        np.zeros((2, 0, 1), np.uint8),
        np.zeros((2, 2, 1), np.float64),
    ):
        with pytest.raises(InputError, match="mine: a map is"):
            Map(pixels, False, "mine")


def test_channels_are_counted() -> None:
    with pytest.raises(InputError, match="mine: the normal map has 1 channels, not 3"):
        Material("m", normal=Map(flat(1), False, "mine"))


def test_heights_stay_within_the_range() -> None:
    with pytest.raises(InputError, match="heights reach from -1 to 2"):
        Material("m", height=Map(np.array([[[-1], [2]]], np.float32), False, "mine"))


@pytest.mark.parametrize(
    ("dtype", "srgb", "stored", "linear"),
    [
        (np.uint8, False, 51, 0.2),
        (np.uint16, False, 13107, 0.2),
        (np.float32, False, 0.2, 0.2),
        (np.uint8, True, 10, 10 / 255 / 12.92),
        (np.uint16, True, 65535, 1),
        (np.float32, True, 1, 1),
    ],
)
def test_linear_values(dtype: type, srgb: bool, stored: float, linear: float) -> None:
    values = Map(np.full((2, 3, 1), stored, dtype), srgb, "mine").linear()
    assert values.dtype == np.float32
    assert values.shape == (2, 3, 1)
    assert values == pytest.approx(linear, rel=1e-6)


def test_scale_needs_both_lengths() -> None:
    assert Material("m", depth=0.1).scale is None
    assert Material("m", tile=0.1).scale is None
    assert Material("m", depth=0.1, tile=0.4).scale == pytest.approx(0.25)


def test_describe_and_report(tmp_path: Path) -> None:
    write_picture_file(tmp_path, "a_height.png", sixteen(hills()))
    material = load(tmp_path, depth=0.01, tile=0.5)
    result = json.loads(json.dumps(describe(material)))
    assert set(result["maps"]) == set(MAPS)
    assert result["maps"]["height"] == {
        "source": "a_height.png",
        "width": WIDTH,
        "height": HEIGHT,
        "channels": 1,
        "bits": 16,
        "srgb": False,
        "range": [0.0, 1.0],
    }
    assert result["maps"]["normal"] is None
    assert result["scale"] == pytest.approx(0.02)
    assert {"what": "white is high", "why": "the default"} in result["decisions"]
    text = report(material)
    assert "a_height.png  40×24  16 bit  linear  0 to 1" in text
    assert "scale 0.02" in text
    assert str(Note("white is high", "the default")) in text


def test_report_of_a_material_without_maps() -> None:
    assert "without base color" in report(Material("empty"))


def test_parts_compare_by_value() -> None:
    assert Part("height") == Part("height", "", False)


# --- fuzz


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    names=st.lists(
        st.tuples(
            st.sampled_from(["", "a", "Rock", "metal_normal", "Ж"]),
            st.sampled_from([*NAMES, "normal", "height", "depth", "color", "gloss", "bump"]),
            st.sampled_from([1, 2, 3, 4]),
            st.sampled_from([(1, 1), (4, 6), (8, 12), (6, 4)]),
            st.booleans(),
        ),
        min_size=1,
        max_size=5,
    ),
    options=st.fixed_dictionaries(
        {},
        optional={
            "normal_convention": st.sampled_from(["gl", "dx", "x"]),
            "height_polarity": st.sampled_from(["height", "depth"]),
            "height_channel": st.sampled_from(["r", "b", "a", "luminance"]),
            "normal_packing": st.sampled_from(["ag", "rg"]),
            "stretch_height": st.booleans(),
            "depth": st.floats(),
        },
    ),
)
def test_any_folder_gives_a_material_or_one_clear_line(
    tmp_path_factory: pytest.TempPathFactory, names: list, options: dict
) -> None:
    folder = tmp_path_factory.mktemp("set")
    random = np.random.default_rng(0)
    for prefix, name, channels, size, deep in names:
        most, dtype = (65535, np.uint16) if deep else (255, np.uint8)
        pixels = random.integers(0, most, (*size, channels), dtype)
        write_data(folder / f"{prefix}_{name}.png", pixels)
    trouble = ""
    try:
        material = load(folder, **options)
    except InputError as error:
        trouble = str(error)
    else:
        assert list(material.maps())
        json.dumps(describe(material))
    assert "\n" not in trouble


@pytest.mark.parametrize("technique", ["relief", "parallax_occlusion"])
def test_rendered_pictures_are_not_loaded_as_maps(tmp_path: Path, technique: str) -> None:
    """`render` names its pictures so that `load` does not read one as heights."""
    write_picture_file(tmp_path, "wall_color.png", flat(90, 80, 70))
    write_picture_file(tmp_path, f"wall-{technique}-basrelief.png", flat(9, 9, 9))
    assert load(tmp_path).height is None


# --- numbers in place of maps


@pytest.mark.parametrize("number", [0.25, "0.25", np.float32(0.25)])
def test_a_number_is_a_map_with_one_value(tmp_path: Path, number) -> None:
    write_picture_file(tmp_path, "wall_color.png", flat(90, 80, 70))
    write_picture_file(tmp_path, "wall_height.png", flat(9, 9, 9))
    material = load(tmp_path, height=number, roughness=number)
    assert material.height is not None
    assert material.roughness is not None
    for each in (material.height, material.roughness):
        assert (each.pixels.shape, float(each.pixels[0, 0, 0])) == ((1, 1, 1), 0.25)
    assert "height 0.25: requested" in map(str, material.notes)
    assert material.base_color is not None
    assert load(height=1).name == "plain"


@pytest.mark.parametrize(
    ("maps", "message"),
    [
        ({"height": 2.0}, "height is 2: give a number from 0 to 1, or a file"),
        ({"height": "-0.5"}, "height is -0.5: give a number from 0 to 1, or a file"),
        ({"opacity": float("nan")}, "opacity is nan: give a number from 0 to 1, or a file"),
        ({"normal": "0.5"}, "normal is 0.5: give a file; a number is for maps of one channel"),
        ({"height": True}, "height is True: give a file, or a number"),
        ({"roughness": [0.5]}, "roughness is [0.5]: give a file, or a number"),
    ],
)
def test_other_numbers_are_refused(maps: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as refused:
        load("sample:bricks", **maps)
    assert str(refused.value) == message


def test_a_height_of_1_shifts_a_picture_along_the_view() -> None:
    """C6: catlike's first step, V.xy · scale everywhere, without a height map."""
    material = load("sample:bricks", height=1.0)
    obj = Object(
        material, technique="offset_limited", reference_height=0.0, scale=0.2, transform=np.eye(4),
        tiling=(1.0, 1.0),
    )  # fmt: skip
    camera = LookAt((0.8, -1.1, 1.6), orthographic_height=0.3)
    view = np.array([0.8, -1.1, 1.6]) / np.linalg.norm([0.8, -1.1, 1.6])
    shifted, still = (
        render(Scene((each,), camera), size=(9, 7), samples=1, device="cpu")
        for each in (obj, replace(obj, technique="flat"))
    )
    wanted = np.broadcast_to(view[:2] * [1.0, -1.0] * 0.2, shifted.uv.shape)
    np.testing.assert_allclose(shifted.uv - still.uv, wanted, atol=1e-5)


def test_unused_options_of_a_sample_are_noted() -> None:
    material = load("sample:bricks", height_polarity="depth", stretch_height=True)
    (note,) = [n for n in material.notes if n.what.startswith("no use for")]
    assert "height_polarity, stretch_height" in note.what
    assert not any(n.what.startswith("no use for") for n in load("sample:bricks").notes)
