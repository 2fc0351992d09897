"""Textures: mip levels are area averages, codes keep their bits, colours are averaged linearly."""

from __future__ import annotations

import gc
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.baking.levels import halved
from basrelief.engine import choose_device
from basrelief.images import srgb_decode
from basrelief.material import Map, Material, sample
from basrelief.rendering import textures
from basrelief.rendering.programs import available_maps, resources_of
from basrelief.scene import Layer, Object
from basrelief.techniques import BOUNDS, CONE_MAP
from basrelief.techniques.cone_bake import cone_of
from basrelief.techniques.cone_bake_windows import next_windows
from basrelief.techniques.normal_bake import normals
from helpers.engines import RecordingEngine

UNIT = 65535
CPU = choose_device("cpu")


def map_of(values, dtype=np.float32, srgb: bool = False) -> Map:
    values = np.asarray(values).astype(dtype)
    return Map(values if values.ndim == 3 else values[:, :, None], srgb, "made up")


def overlap(count: int) -> np.ndarray:
    """Weights of `count` texels in the texels of the next level, (half, count), float64."""
    half = max(count // 2, 1)
    wide = count / half
    starts = np.arange(half)[:, None] * wide
    texels = np.arange(count)[None, :]
    covered = np.minimum(texels + 1, starts + wide) - np.maximum(texels, starts)
    return np.maximum(covered, 0.0) / wide


# --- levels ---------------------------------------------------------------------------------------


def test_an_even_level_is_the_mean_of_four() -> None:
    level = np.array([[0, 4, 1, 3], [8, 0, 5, 7]], np.float32)
    assert halved(level).tolist() == [[3.0, 4.0]]


def test_an_odd_level_shares_the_texel_in_the_middle() -> None:
    """Three texels become one; five become two, of 2½ each."""
    assert halved(np.array([[3, 6, 12]], np.float32)).tolist() == [[7.0]]
    row = halved(np.array([[10, 20, 40, 80, 160]], np.float32))
    np.testing.assert_allclose(row, [[(10 + 20 + 20) / 2.5, (20 + 80 + 160) / 2.5]], rtol=1e-6)


@given(st.integers(1, 13), st.integers(1, 13), st.integers(0, 2**32 - 1), st.booleans())
def test_levels_are_area_averages_and_keep_the_mean(rows, columns, seed, colored) -> None:
    shape = (rows, columns, 4) if colored else (rows, columns)
    level = np.random.default_rng(seed).random(shape).astype(np.float32)
    made = halved(level)
    expected = np.einsum("ir,jc,rc...->ij...", overlap(rows), overlap(columns), level.astype(float))
    assert made.dtype == np.float32
    np.testing.assert_allclose(made, expected, atol=1e-6)
    np.testing.assert_allclose(made.mean(axis=(0, 1)), level.mean(axis=(0, 1)), atol=2e-6)


@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_the_last_mip_level_is_the_mean(rows, columns, seed) -> None:
    values = np.random.default_rng(seed).random((rows, columns))
    field = textures.height_field(Material("made up", height=map_of(values)), "wrap")
    assert field is not None
    for finer, coarser in zip(field.levels, field.levels[1:], strict=False):
        assert coarser.shape == tuple(max(n // 2, 1) for n in finer.shape)
    assert field.levels[-1].shape == (1, 1)
    assert field.levels[-1][0, 0] == pytest.approx(values.mean(), abs=3e-6)


# --- heights --------------------------------------------------------------------------------------


def test_heights_of_16_bits_are_kept_exactly() -> None:
    codes = np.arange(65536).reshape(128, 512)
    field = textures.height_field(Material("made up", height=map_of(codes, np.uint16)), "clamp")
    assert field is not None
    finest = field.levels[0]
    assert finest.dtype == np.float32
    assert np.unique(finest).size == 65536
    assert np.array_equal(np.rint(finest.astype(np.float64) * UNIT), codes)
    np.testing.assert_array_equal(finest, (codes / UNIT).astype(np.float32))


def test_heights_of_8_bits_reach_from_0_to_1_and_floats_stay() -> None:
    eight = textures.height_field(Material("x", height=map_of([[0, 51, 255]], np.uint8)), "wrap")
    floats = textures.height_field(Material("x", height=map_of([[0.125, 1 / 3]])), "wrap")
    assert eight is not None
    assert floats is not None
    assert eight.levels[0].tolist() == [[0.0, np.float32(0.2), 1.0]]
    assert floats.levels[0].tolist() == [[0.125, np.float32(1 / 3)]]


def test_heights_are_never_decoded_from_srgb() -> None:
    """C1: linear data, black low and white high; half grey is half the height."""
    field = textures.height_field(Material("x", height=map_of([[0, 128, 255]], np.uint8)), "wrap")
    assert field is not None
    np.testing.assert_allclose(field.levels[0], [[0.0, 128 / 255, 1.0]], atol=1e-7)


def test_missing_maps_have_no_texture() -> None:
    empty = Material("nothing")
    assert textures.height_field(empty, "wrap") is None
    assert textures.base_color(empty, "wrap") is None
    assert textures.normal(empty, "wrap", 0.1, CPU) is None
    assert textures.response(empty, "wrap") is None
    assert textures.emission(empty, "wrap") is None


# --- colours --------------------------------------------------------------------------------------


def test_colours_are_linear_when_averaged() -> None:
    """Black and white squares average to half the light, not to the code 127."""
    board = np.indices((2, 4)).sum(axis=0) % 2 * 255
    color = map_of(np.repeat(board[:, :, None], 3, 2), np.uint8, srgb=True)
    texture = textures.base_color(Material("x", base_color=color), "wrap")
    assert texture is not None
    assert np.unique(texture.levels[0][:, :, :3]).tolist() == [0, UNIT]
    np.testing.assert_allclose(texture.levels[1][:, :, :3] / UNIT, 0.5, atol=1e-4)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_colours_are_decoded_from_srgb_only_where_they_are_srgb(dtype) -> None:
    most = np.iinfo(dtype).max
    codes = np.array([[[0.1, 0.5, 0.9]]]) * most
    shares = codes.astype(dtype) / most
    for srgb, expected in ((True, srgb_decode(shares)), (False, shares)):
        texture = textures.base_color(Material("x", base_color=map_of(codes, dtype, srgb)), "wrap")
        assert texture is not None
        np.testing.assert_allclose(texture.levels[0][:, :, :3] / UNIT, expected, atol=0.6 / UNIT)


def test_opacity_is_the_fourth_channel_at_the_colours_size() -> None:
    color = map_of(np.full((2, 4, 3), 0.25))
    opaque = textures.base_color(Material("x", base_color=color), "wrap")
    assert opaque is not None
    assert all((level[:, :, 3] == UNIT).all() for level in opaque.levels)
    cut = textures.base_color(
        Material("x", base_color=color, opacity=map_of([[1, 0, 0.5, 1], [0, 0, 1, 1]])), "wrap"
    )
    assert cut is not None
    expected = [[1, 0, 0.5, 1], [0, 0, 1, 1]]
    np.testing.assert_allclose(cut.levels[0][:, :, 3] / UNIT, expected, atol=1e-4)


def test_opacity_finer_than_the_colour_keeps_its_texels() -> None:
    """A single colour with a cut-out."""
    hole = np.ones((4, 6))
    hole[1, 2] = 0.0
    material = Material("x", base_color=map_of(np.full((1, 1, 3), 0.25)), opacity=map_of(hole))
    texture = textures.base_color(material, "wrap")
    assert texture is not None
    np.testing.assert_array_equal(texture.levels[0][:, :, 3], hole * UNIT)
    np.testing.assert_allclose(texture.levels[0][:, :, :3] / UNIT, 0.25, atol=1e-4)


def test_opacity_without_a_colour_still_counts() -> None:
    material = Material("x", opacity=map_of([[1.0, 0.0]]))
    texture = textures.base_color(material, "wrap")
    assert texture is not None
    np.testing.assert_array_equal(texture.levels[0][:, :, 3], [[UNIT, 0]])


def test_emission_brighter_than_1_is_a_share_of_its_brightest() -> None:
    light = np.zeros((1, 2, 3))
    light[0, 0], light[0, 1] = (5.0, 2.5, 0.0), (1.0, 0.5, 0.25)
    material = Material("x", emission=map_of(light))
    texture = textures.emission(material, "wrap")
    assert texture is not None
    assert textures.emission_scale(material) == 5.0
    np.testing.assert_allclose(texture.levels[0][:, :, :3] / UNIT * 5.0, light, atol=1e-4)
    assert textures.emission_scale(Material("dark")) == 1.0


# --- data -----------------------------------------------------------------------------------------


def test_the_response_packs_maps_of_different_sizes() -> None:
    """Occlusion, roughness, metallic in that order, at the size of the largest."""
    rough = np.array([[0.2, 0.6]])
    material = Material(
        "x",
        occlusion=map_of(np.linspace(0, 1, 8).reshape(2, 4)),
        roughness=map_of(rough),
        metallic=map_of([[1.0]]),
    )
    texture = textures.response(material, "wrap")
    assert texture is not None
    first = texture.levels[0] / UNIT
    assert first.shape == (2, 4, 4)
    np.testing.assert_allclose(first[:, :, 0], np.linspace(0, 1, 8).reshape(2, 4), atol=1e-4)
    # bilinear between centres and around the edge
    expected = [0.75 * 0.2 + 0.25 * 0.6, 0.75 * 0.2 + 0.25 * 0.6, 0.25 * 0.2 + 0.75 * 0.6, 0.5]
    np.testing.assert_allclose(first[:, :, 1], [expected, expected], atol=1e-4)
    np.testing.assert_allclose(first[:, :, 2], 1.0, atol=1e-4)


def test_missing_channels_of_the_response_get_defaults() -> None:
    """Defaults as in `response_of`: not occluded, fairly rough, not metallic."""
    texture = textures.response(Material("x", occlusion=map_of([[0.5]])), "wrap")
    assert texture is not None
    np.testing.assert_allclose(texture.levels[0][0, 0, :3] / UNIT, [0.5, 0.8, 0.0], atol=1e-4)
    texture = textures.response(Material("x", metallic=map_of([[0.5]])), "wrap")
    assert texture is not None
    np.testing.assert_allclose(texture.levels[0][0, 0, :3] / UNIT, [1.0, 0.8, 0.5], atol=1e-4)


# --- normals from heights -------------------------------------------------------------------------


def normals_from(heights, scale: float, edge: str = "clamp") -> np.ndarray:
    material = Material("x", height=map_of(heights))
    texture = textures.normal(material, edge, scale, CPU)  # type: ignore[arg-type]
    assert texture is not None
    return texture.levels[0][:, :, :3].astype(np.float64) / UNIT * 2 - 1


@pytest.mark.parametrize(("rise_u", "rise_v"), [(0.5, 0.0), (-0.3, 0.0), (0.0, 0.4), (0.2, -0.5)])
def test_normals_lean_away_from_the_rise(rise_u, rise_v) -> None:
    """x opposes the rise along u; y follows the rise along v, since green is up."""
    columns, rows, scale = 12, 12, 0.3
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    made = normals_from(0.5 + rise_u * (u - 0.5) + rise_v * (v - 0.5), scale)[1:-1, 1:-1]
    expected = np.array([-rise_u * scale, rise_v * scale, 1.0])
    expected /= np.linalg.norm(expected)
    np.testing.assert_allclose(made, np.broadcast_to(expected, made.shape), atol=1e-4)


def test_normals_of_a_wide_map_have_square_texels() -> None:
    """A rise of h from row to row is a slope of h · scale · columns."""
    columns, rows, scale = 16, 4, 0.2
    heights = np.repeat(np.linspace(0.2, 0.5, rows)[:, None], columns, 1)
    made = normals_from(heights, scale)[1:-1]
    slope = 0.1 * scale * columns
    np.testing.assert_allclose(made[:, :, 1] / made[:, :, 2], slope, atol=1e-3)


def test_normals_at_the_edge_follow_the_edge_policy() -> None:
    heights = np.array([[0.0, 0.1, 0.4, 0.9]])
    wrapped, count = normals_from(heights, 0.5, "wrap"), normals_from(heights, 0.5, "clamp")
    slope = lambda n: -n[0, :, 0] / n[0, :, 2] / (0.5 * 4)  # noqa: E731
    np.testing.assert_allclose(slope(wrapped), [-0.4, 0.2, 0.4, -0.2], atol=1e-3)
    np.testing.assert_allclose(slope(count), [0.05, 0.2, 0.4, 0.25], atol=1e-3)


def test_normals_of_a_sample_are_those_of_its_heights() -> None:
    """The sample's normal map comes from independent code."""
    bricks = sample("bricks", (48, 64))
    assert bricks.height is not None
    assert bricks.normal is not None
    assert bricks.scale is not None
    made = normals_from(bricks.height.linear()[:, :, 0], bricks.scale, "wrap")
    np.testing.assert_allclose(made, bricks.normal.linear() * 2 - 1, atol=2e-3)


def test_a_normal_map_comes_before_heights() -> None:
    given_map = map_of(np.full((2, 2, 3), [0.5, 0.5, 1.0]))
    material = Material("x", height=map_of([[0, 1], [1, 0]]), normal=given_map)
    texture = textures.normal(material, "wrap", 0.3, CPU)
    assert texture is not None
    np.testing.assert_allclose(texture.levels[0][:, :, :3] / UNIT, given_map.pixels, atol=1e-4)


def test_without_depth_heights_have_no_normals() -> None:
    assert textures.normal(Material("x", height=map_of([[0, 1]])), "wrap", 0.0, CPU) is None


# --- caching --------------------------------------------------------------------------------------


def test_textures_are_cached_while_their_map_exists() -> None:
    material = Material("x", height=map_of([[0, 1]]))
    field = textures.height_field(material, "wrap")
    assert textures.height_field(material, "wrap") is field
    assert textures.height_field(material, "clamp") is not field
    normal = textures.normal(material, "wrap", 0.1, CPU)
    assert textures.normal(material, "wrap", 0.1, CPU) is normal
    assert textures.normal(material, "wrap", 0.2, CPU) is not normal
    assert textures.bake_texture(material, "wrap", BOUNDS, CPU) is textures.bake_texture(
        material, "wrap", BOUNDS, CPU
    )
    count = len(textures._cache)
    del material, field, normal
    gc.collect()
    assert len(textures._cache) < count


def test_bakes_are_cached_per_engine() -> None:
    material = Material("x", height=map_of([[0.2, 1.0, 0.4], [0.5, 0.1, 0.9]]))
    other = RecordingEngine()
    for _ in range(2):
        for engine in (CPU, other):
            textures.bake_texture(material, "wrap", CONE_MAP, engine)
    assert set(other.entries) == {*CONE_MAP.programs} - {next_windows}
    assert other.entries.count(cone_of) == 1
    textures.normal(material, "wrap", 0.1, CPU)
    assert normals not in other.entries
    textures.normal(material, "wrap", 0.1, other)
    assert normals in other.entries


def test_available_maps_are_found_without_baking() -> None:
    """Available maps are those in the values of the object's program."""
    heights, other = map_of([[0.2, 1.0], [0.5, 0.1]]), map_of([[0.5]])
    bare, high = Material("bare"), Material("high", height=heights)
    full = Material(
        "full", height=heights, normal=map_of([[[0.5, 0.5, 1.0]]]), opacity=other, metallic=other,
        emission=map_of([[[0.1, 0.2, 0.3]]]),
    )  # fmt: skip
    for material, layer, options in itertools.product(
        (bare, high, full),
        (None, bare, high, full),
        ({}, {"technique": "exact"}, {"technique": "texel"}, {"scale": 0.0}),
    ):
        if material is bare and "technique" in options:
            continue
        obj = Object(material, layer=layer and Layer(layer), **options)
        there = {f"maps_{name}" for name, has in available_maps(obj.resolved).items() if has}
        assert there == set(resources_of(obj.resolved, CPU)) - {"field", "baked"}
    assert available_maps(Object(high, technique="texel").resolved)["normal"] is False
    assert available_maps(Object(full, technique="texel").resolved)["normal"] is True
