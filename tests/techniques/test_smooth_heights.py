"""Heights from lower levels of the map, against the stated formula in float64."""

from __future__ import annotations

import math

import numpy as np
import pytest

from basrelief.lang import HeightField, Vec2
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.programs import program_of
from basrelief.scene import LookAt, Object, Orbit, Scene
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.relief import height_lod
from basrelief.techniques.height import LOWER_LEVELS, Smoothing, smooth
from helpers.agreement import assert_engines_agree
from helpers.synthetic import bilinear, drawn, map_of, on_plane, uniform_material

SHAPES = [(16, 24), (8, 12), (4, 6), (2, 3), (1, 1)]
LEVELS = [
    np.random.default_rng(k).random(shape).astype(np.float32) for k, shape in enumerate(SHAPES)
]
"""Levels with unrelated values, so that a read shows its level."""
FIELD = HeightField(LEVELS, "wrap")


def between(uv, lod: float) -> float:
    """The height from the two levels around a level of detail, in float64."""
    finer = math.floor(lod)
    values = [
        bilinear(LEVELS[min(max(k, 0), len(LEVELS) - 1)], np.array(uv))[0]
        for k in (finer, finer + 1)
    ]
    return float(values[0] + (values[1] - values[0]) * (lod - finer))


@pytest.mark.parametrize("lod", [0.0, 0.3, 1.0, 1.75, 2.5, 4.0, 9.0])
@pytest.mark.parametrize("fade", [0.0, 1.0, 4.0, 64.0])
def test_heights_are_mixed_with_a_lower_level_by_their_difference(lod, fade) -> None:
    """H4: mix(seen, lower, saturate(|seen − lower| · fade))."""
    for uv in ((0.13, 0.41), (0.77, 0.02), (-0.3, 1.6)):
        seen, lower = between(uv, lod), between(uv, lod + LOWER_LEVELS)
        share = min(abs(seen - lower) * fade, 1.0)
        wanted = seen + (lower - seen) * share
        found = smooth(FIELD, Vec2(*uv), np.float32(lod), np.float32(fade))
        assert float(found) == pytest.approx(wanted, abs=2e-5)


@pytest.mark.parametrize(
    ("dx", "dy", "texels"),
    [((1 / 24, 0.0), (0.0, 0.0), 1.0), ((0.0, 0.25), (0.01, 0.0), 4.0),
     ((1 / 12, 0.125), (0.0, 1e-3), math.hypot(2, 2)), ((1e-4, 0.0), (0.0, 1e-4), 1.0),
     ((0.0, 0.0), (0.0, 0.0), 1.0)],
)  # fmt: skip
@pytest.mark.parametrize("bias", [0.0, 1.5])
def test_the_lod_is_that_of_the_footprint_plus_the_bias(dx, dy, texels: float, bias: float) -> None:
    """H4: log2 of the longer side of the footprint in texels, at least 0, plus the bias."""
    footprint = Footprint(Vec2(*dx), Vec2(*dy))
    found = height_lod(FIELD.with_filter("smooth"), footprint, Smoothing(mip_bias=bias))
    assert float(found) == pytest.approx(math.log2(texels) + bias, abs=1e-5)


SLANTED = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), field_of_view=30.0)
STEPS = {"min_steps": 16, "max_steps": 16}


def relief(material: Material, **options) -> Object:
    options = {"technique": "parallax_occlusion", "settings": STEPS, **options}
    return Object(
        material, **{"scale": 0.2, "reference_height": 1.0, "transform": np.eye(4), **options}
    )


def test_a_constant_height_is_unchanged() -> None:
    material = uniform_material(height=0.5)
    level = Material("level", height=map_of(np.full((16, 16), 0.5)))
    for each in (material, level):
        smooth_, sharp = (
            drawn(relief(each, heights=kind), camera=SLANTED) for kind in ("smooth", "sharp")
        )
        np.testing.assert_allclose(smooth_.uv, sharp.uv, atol=1e-6)


def test_the_finest_level_is_read_nearby() -> None:
    """Equal to sharp heights bit for bit, for pixels smaller than a texel without bias or fade."""
    near = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.2)
    obj = {"heights": "smooth", "smoothing": {"mip_bias": 0.0, "mip_fade": 0.0}}
    material = Material("rough", height=map_of(LEVELS[0]))
    smooth_, sharp = (drawn(relief(material, **o), camera=near) for o in (obj, {}))
    np.testing.assert_array_equal(smooth_.uv, sharp.uv)
    np.testing.assert_array_equal(smooth_.distance, sharp.distance)
    # with a bias they differ
    other = drawn(relief(material, heights="smooth"), camera=near)
    assert np.abs(other.uv - sharp.uv).max() > 0.01


def test_far_away_a_checker_is_its_mean() -> None:
    """Details finer than a pixel scatter uv with sharp heights, but not with smooth ones."""
    checker = Material("checker", height=map_of((np.indices((64, 64)).sum(0) % 2).astype(float)))
    far = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=3.2)
    wanted, _ = on_plane(far, -0.1)
    spread = {}
    for kind in ("smooth", "sharp"):
        obj = relief(checker, technique="offset", settings={}, heights=kind)
        frame = drawn(obj, camera=far)
        assert frame.hit.mean() > 0.03
        # level 1: half the range below the polygon
        spread[kind] = np.abs(frame.uv - wanted)[frame.hit].max()
    assert spread["smooth"] < 2e-4
    assert spread["sharp"] > 0.02


def test_self_shadow_reads_smooth_heights() -> None:
    """A field that is rough when sharp and level when smooth casts no shadow."""
    checker = Material("checker", height=map_of((np.indices((64, 64)).sum(0) % 2).astype(float)),
                       normal=map_of(np.full((1, 1, 3), (0.5, 0.5, 1.0))))  # fmt: skip
    far = LookAt((0.0, 0.0, 2.0), orthographic_height=3.2)

    def dark(kind: str) -> bool:
        obj = relief(checker, technique="offset", settings={}, heights=kind)
        shaded, free = (
            drawn(obj, camera=far, shadows=shadows).color for shadows in ("hard", "none")
        )
        return bool(np.abs(shaded - free).max() > 0.05)

    assert dark("sharp")
    assert not dark("smooth")


def test_sharp_heights_have_no_code_for_smooth_heights() -> None:
    material = sample("tiles", 16)
    sharp, smooth_ = (
        print_wgsl(program_of(Object(material, heights=kind).resolved).module, "wrap")
        for kind in ("sharp", "smooth")
    )
    for word in ("lod_height", "level_height", "smoothing.mip_bias"):
        assert word not in sharp
        assert word in smooth_


@pytest.mark.gpu
@pytest.mark.parametrize("technique", ["parallax_occlusion", "relief"])
def test_cpu_and_gpu_agree(technique: str) -> None:
    obj = Object(sample("gravel", 64), technique=technique, heights="smooth", scale=0.1)
    assert_engines_agree(Scene((obj,), Orbit(20.0, 30.0, 1.8), shadows="soft"), 64)
