"""Noise over stretched texels: none on level ground, grain along slopes, none far away."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import program_of
from basrelief.scene import LookAt, Object, Orbit, Scene, Tiling
from basrelief.shading.brdf import Shading
from basrelief.shading.stretch_noise import random_value
from helpers.agreement import assert_engines_agree
from helpers.synthetic import drawn, map_of, noise

FRONT = LookAt((0.0, 0.0, 9.0), orthographic_height=0.5)
UNLIT = {"lights": (), "shading": Shading(ambient=(1.0, 1.0, 1.0))}
STEPS = {"min_steps": 64, "max_steps": 64}
RAMP = np.broadcast_to(np.arange(512)[None, :] / 511, (512, 512))
GREY = np.full((512, 512, 3), 0.5)


def slope(scale: float, mapping: str = "noise", colors=GREY, values=RAMP, **options) -> Object:
    material = Material("slope", height=map_of(values), base_color=map_of(colors))
    options = {"technique": "parallax_occlusion", "transform": np.eye(4), **options}
    return Object(material, mapping=mapping, settings=STEPS, scale=scale, **options)


def rendered(obj: Object, camera=FRONT, **options) -> Frame:
    return drawn(obj, camera=camera, size=(200, 200), **options, **UNLIT)


def shade(scale: float, **options) -> np.ndarray:
    """Brightness at the middle of a slope, away from the tile's border."""
    return rendered(slope(scale, **options)).color[20:-20, 20:-20, 0]


def test_level_ground_has_no_noise() -> None:
    """H7: bit for bit."""
    level, colors = np.full((64, 64), 0.4), noise(4, (64, 64))
    camera = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.3)
    grainy, plain = (
        rendered(slope(0.3, mapping, colors, level), camera) for mapping in ("noise", "planar")
    )
    np.testing.assert_array_equal(grainy.color, plain.color)
    np.testing.assert_array_equal(grainy.uv, plain.uv)


def test_the_noise_grows_with_the_slope_and_keeps_the_brightness() -> None:
    spreads = [float(shade(scale).std()) for scale in (0.3, 1.0, 3.0)]
    assert 0.0 < spreads[0] < spreads[1] < spreads[2]
    # its logarithm by 1 − n.z²
    steep = [1.0 - 1.0 / (1.0 + (512 / 511 * scale) ** 2) for scale in (0.3, 3.0)]
    logarithms = [float(np.log(shade(scale)).std()) for scale in (0.3, 3.0)]
    assert logarithms[1] / logarithms[0] == pytest.approx(steep[1] / steep[0], rel=0.3)
    assert shade(3.0).mean() == pytest.approx(0.5, rel=0.1)


def test_the_noise_varies_up_a_slope_whose_colour_is_a_streak() -> None:
    """A slope four tiles high shows one texel over many pixels: planar it is a smooth streak."""
    stripes = np.broadcast_to(0.5 + 0.1 * np.cos(np.arange(512))[:, None, None], (512, 512, 3))
    camera = LookAt((-9.0, 0.0, 2.0), up=(0.0, 0.0, 1.0), orthographic_height=0.6)

    def changes(mapping: str) -> float:
        obj = slope(2.0, mapping, stripes, reference_height=1.0)
        seen = rendered(obj, camera)
        return float(np.abs(np.diff(seen.color[..., 0], axis=0))[seen.hit[1:]].mean())

    assert changes("noise") > 4.0 * changes("planar")


@pytest.mark.parametrize("axis", [0, 1])
def test_the_noise_repeats_with_the_tile(axis: int) -> None:
    shift = (1.0, 0.0) if axis == 0 else (0.0, 1.0)
    waves = noise(3, (64, 64), 1)
    one = rendered(slope(1.0, values=waves)).color
    next_tile = rendered(slope(1.0, values=waves, shift=shift)).color
    np.testing.assert_allclose(one, next_tile, atol=2e-4)


def test_grains_smaller_than_a_pixel_are_left_out() -> None:
    far = LookAt((0.0, 0.0, 9.0), orthographic_height=0.9)
    waves = noise(5, (64, 64), 1)
    for tiles, is_noisy in ((1.0, True), (200.0, False)):
        tiling = {"tilings": {"base_color": Tiling((tiles, tiles))}}
        grainy, plain = (
            rendered(slope(1.0, mapping, values=waves, **tiling), far).color
            for mapping in ("noise", "planar")
        )
        assert bool(np.abs(grainy - plain).max() > 0.02) is is_noisy


@pytest.mark.parametrize(
    ("texels", "is_noisy"), [((1, 1), False), ((1, 64), False), ((8, 8), True), ((16, 256), True)]
)
def test_small_maps_keep_their_brightness(texels: tuple[int, int], is_noisy: bool) -> None:
    """Octaves of less than two grains are left out, and none repeats another."""
    waves = noise(3, (texels[0] * 8, texels[1] * 8), 1)
    colors = np.full((*texels, 3), 0.5)
    grainy = rendered(slope(1.0, colors=colors, values=waves, edge="clamp")).color[..., 0]
    assert grainy.mean() == pytest.approx(0.5, rel=0.3)
    assert grainy.max() < 2.5
    assert bool(np.ptp(grainy) > 0.05) is is_noisy


def test_random_values_fill_their_range_without_a_pattern() -> None:
    values = np.array(
        [[[random_value(x, y, z) for x in range(24)] for y in range(24)] for z in range(4)]
    )
    assert (np.abs(values) <= 1.0).all()
    assert abs(values.mean()) < 0.05
    assert values.std() == pytest.approx(1 / np.sqrt(3), abs=0.02)
    centred = values - values.mean()
    for axis in range(3):
        again = np.roll(centred, 1, axis)
        assert abs((centred * again).mean()) < 0.03


def test_a_planar_mapping_has_no_code_of_the_noise() -> None:
    material = sample("tiles", 16)
    planar, grainy = (
        print_wgsl(program_of(Object(material, mapping=kind).resolved).module, "wrap")
        for kind in ("planar", "noise")
    )
    for word in ("stretch_noise", "height_field_normal"):
        assert word not in planar
        assert word in grainy


@pytest.mark.gpu
def test_cpu_and_gpu_agree() -> None:
    rock = Object(
        sample("cobbles", 64), mapping="noise", scale=0.4, settings={"search_steps": 8},
        tilings={"base_color": Tiling((2.0, -3.0))},
    )  # fmt: skip
    assert_engines_agree(Scene((rock,), Orbit(20.0, 50.0, 1.8)), 64)
