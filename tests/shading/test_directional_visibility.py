"""Directional occlusion: the occlusion map combined with the height and N · L."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.lang import Vec3
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.programs import program_of
from basrelief.scene import LookAt, Object, Orbit, Scene, directional
from basrelief.shading.brdf import Shading, ShadingPoint
from basrelief.shading.pixel import directional_visibility
from helpers.agreement import assert_engines_agree
from helpers.synthetic import drawn, map_of, matte, uniform_material

UNITS = st.floats(0.0, 1.0, width=32)


def visibility(occlusion: float, height: float, cosine: float, strength: float = 1.0) -> float:
    """Visibility of a light at an angle to the normal, by `directional_visibility`."""
    up = Vec3(0.0, 0.0, 1.0)
    black = Vec3(0.0)
    point = ShadingPoint(black, up, up, Vec3(1.0), 0.5, 0.0, occlusion, black, black, 1.0)
    cosine = min(cosine, 1.0)
    towards = Vec3(np.sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine)
    return float(
        directional_visibility(
            point, np.float32(height), towards, Shading(directional_occlusion=strength)
        )
    )


@given(UNITS, UNITS, st.floats(-1.0, 1.0), UNITS)
def test_directional_visibility_equals_its_formula(
    occlusion: float, height: float, cosine: float, strength: float
) -> None:
    """H5: from occlusion × height for light along the surface to 1 for light along the normal."""
    up = max(cosine, 0.0)
    wanted = 1.0 - strength * (1.0 - (occlusion * height * (1.0 - up) + up))
    assert visibility(occlusion, height, cosine, strength) == pytest.approx(wanted, abs=2e-6)


@given(UNITS, UNITS)
def test_unoccluded_points_and_light_along_the_normal_are_unchanged(
    one: float, strength: float
) -> None:
    assert visibility(1.0, 1.0, one, strength) == pytest.approx(1.0, abs=1e-6)
    assert visibility(one, 0.5, 1.0, strength) == pytest.approx(1.0, abs=1e-6)


@given(st.lists(UNITS, min_size=2, max_size=2), UNITS, UNITS)
def test_visibility_grows_with_occlusion_height_and_cosine(pair, one: float, other: float) -> None:
    low, high = sorted(pair)
    assert visibility(low, one, other) <= visibility(high, one, other) + 1e-6
    assert visibility(one, low, other) <= visibility(one, high, other) + 1e-6
    assert visibility(one, other, low) <= visibility(one, other, high) + 1e-6


FRONT = LookAt((0.0, 0.0, 3.0), orthographic_height=0.8)
MATTE = Shading(ambient=(0.0, 0.0, 0.0))
STEPS = {"min_steps": 8, "max_steps": 8}


def lit(occlusion: str, light, height: float = 0.5, shading=MATTE, **options) -> np.ndarray:
    material = uniform_material(0.6, height=height, occlusion=map_of(np.full((1, 1), 0.4)))
    options = {"technique": "parallax_occlusion", "settings": STEPS, **options}
    obj = Object(material, transform=np.eye(4), **options)
    frame = drawn(
        matte(obj), camera=FRONT, size=(8, 8), lights=(light,), shading_model="phong",
        shading=shading, occlusion_kind=occlusion,
    )  # fmt: skip
    assert frame.hit.all()
    return frame.color[:, :, :3]


@pytest.mark.parametrize("elevation", [0.0, 30.0, 60.0, 80.0])
def test_lights_are_occluded_by_height_and_angle(elevation: float) -> None:
    """H5 in a picture: with the height of the hit and the normal of the relief."""
    light = directional(0.0, elevation)
    cosine = np.cos(np.radians(elevation))
    np.testing.assert_allclose(lit("ambient", light), 0.6 * cosine, atol=1e-4)
    for height in (0.25, 0.5, 1.0):
        share = 0.4 * height * (1.0 - cosine) + cosine
        wanted = 0.6 * cosine * share
        np.testing.assert_allclose(lit("directional", light, height), wanted, atol=1e-4)


def test_strength_0_occludes_ambient_light_alone() -> None:
    light = directional(50.0, 20.0)
    none = Shading(ambient=(0.3, 0.3, 0.3), directional_occlusion=0.0)
    np.testing.assert_array_equal(
        lit("directional", light, shading=none), lit("ambient", light, shading=none)
    )


def test_a_height_below_0_counts_as_0() -> None:
    """A march of fixed step length may end there; visibility is never negative."""
    assert visibility(0.5, -3.0, 0.1) == pytest.approx(0.1, abs=1e-6)


def test_a_program_with_ambient_occlusion_has_no_code_for_directional() -> None:
    obj = Object(sample("tiles", 16))
    texts = [
        print_wgsl(program_of(obj.resolved, Scene((obj,), occlusion_kind=kind)).module, "wrap")
        for kind in ("ambient", "directional")
    ]
    assert ["directional_visibility" in text for text in texts] == [False, True]


@pytest.mark.gpu
def test_cpu_and_gpu_agree() -> None:
    material: Material = sample("cobbles", 64)
    scene = Scene((Object(material),), Orbit(40.0, 35.0, 1.6), occlusion_kind="directional")
    assert_engines_agree(scene, 64)
