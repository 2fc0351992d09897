"""Fog against its closed forms, at the distance of the hit."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import Vec3
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import sample
from basrelief.rendering.programs import program_of
from basrelief.scene import LookAt, Object, Orbit, Scene, rotated
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog, linear_fog
from helpers.agreement import assert_engines_agree
from helpers.synthetic import drawn, on_plane, uniform_material

FOG = {
    "fog_color": (0.2, 0.5, 0.9),
    "fog_density": 0.45,
    "fog_start": 1.5,
    "fog_end": 3.0,
}
CAMERA = LookAt((0.2, -1.9, 0.9), up=(0.0, 0.0, 1.0), field_of_view=30.0)
OWN = 0.7
UNLIT = {"lights": (), "shading": Shading(ambient=(1.0, 1.0, 1.0))}

FORMS = {
    "linear": lambda d: np.clip((3.0 - d) / 1.5, 0.0, 1.0),
    "exponential": lambda d: np.exp(-0.45 * d),
    "exponential_squared": lambda d: np.exp(-((0.45 * d) ** 2)),
}


def sunken() -> Object:
    """A relief 0.6 below its polygon, so that the two distances differ."""
    settings = {"min_steps": 8, "max_steps": 8}
    material = uniform_material(OWN, height=0.25)
    return Object(
        material, technique="parallax_occlusion", settings=settings, scale=0.8, transform=np.eye(4)
    )


@pytest.mark.parametrize("fog", FORMS)
def test_fog_attenuates_by_the_distance_of_the_hit(fog: str) -> None:
    """C21."""
    background = (0.9, 0.1, 0.0)
    frame = drawn(sunken(), camera=CAMERA, fog_mode=fog, fog=FOG, background=background, **UNLIT)
    _, distance = on_plane(CAMERA, -0.6)
    _, polygon = on_plane(CAMERA)
    transmittance = FORMS[fog](distance)[..., None]
    wanted = OWN * transmittance + np.array(FOG["fog_color"]) * (1.0 - transmittance)
    hit = frame.hit
    assert 0.2 < hit.mean() < 0.9
    np.testing.assert_allclose(frame.color[hit][:, :3], wanted[hit], atol=2e-4)
    # fog at the polygon's distance would differ visibly
    assert np.abs(FORMS[fog](polygon) - FORMS[fog](distance))[hit].max() > 0.05
    # the background has no distance and gets no fog
    np.testing.assert_array_equal(
        frame.color[~hit], np.broadcast_to(np.float32([*background, 1.0]), frame.color[~hit].shape)
    )


def test_linear_fog_is_zero_before_its_start_and_full_after_its_end() -> None:
    near, far = (
        drawn(sunken(), camera=CAMERA, fog_mode="linear", fog=fog, **UNLIT)
        for fog in (
            {**FOG, "fog_start": 50.0, "fog_end": 51.0},
            {**FOG, "fog_start": 0.0, "fog_end": 0.0},
        )
    )
    np.testing.assert_allclose(near.color[near.hit][:, :3], OWN, atol=1e-5)
    for channel, value in enumerate(FOG["fog_color"]):
        np.testing.assert_allclose(far.color[far.hit][:, channel], value, atol=1e-6)


def test_linear_fog_of_no_length_is_a_step() -> None:
    """No fog before the distance, full fog behind it."""
    fog = Fog(fog_color=Vec3(0.2, 0.5, 0.9), fog_start=2.0, fog_end=2.0)
    own = Vec3(0.7, 0.1, 0.4)
    for distance, wanted in ((1.9, own), (1.999, own), (2.001, fog.fog_color)):
        np.testing.assert_allclose([*linear_fog(own, distance, fog)], [*wanted], atol=1e-6)


def test_a_program_without_fog_has_no_code_for_it() -> None:
    obj = Object(sample("tiles", 16))

    def text(fog: str) -> str:
        program = program_of(obj.resolved, Scene((obj,), fog_mode=fog))
        return print_wgsl(program.module, program.edge)

    clear, thick = text("none"), text("exponential")
    for word in ("fn exponential_fog(", "fog_color"):
        assert word not in clear
        assert word in thick
    assert "fn exponential_squared(" not in thick


@pytest.mark.gpu
@pytest.mark.parametrize("fog", FORMS)
def test_cpu_and_gpu_agree(fog: str) -> None:
    obj = Object(sample("bricks", 64), transform=rotated("x", -90.0))
    scene = Scene((obj,), Orbit(20.0, 25.0, 1.7), fog_mode=fog, fog={**FOG, "fog_start": 1.0})
    assert_engines_agree(scene, 64)
