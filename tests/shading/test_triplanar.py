"""Triplanar colour: projected along three axes of tangent space, by the height on steep slopes."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import program_of
from basrelief.scene import LookAt, Object, Orbit, Scene, Tiling, directional
from basrelief.shading.brdf import Shading
from helpers.agreement import assert_engines_agree
from helpers.synthetic import bilinear, drawn, map_of, noise

SLANTED = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.3)
FRONT = LookAt((0.0, 0.0, 9.0), orthographic_height=0.5)
UNLIT = {"lights": (), "shading": Shading(ambient=(1.0, 1.0, 1.0))}
STEPS = {"min_steps": 64, "max_steps": 64}
COLORS = noise(4, (32, 32))


def relief(values, colors=COLORS, **options) -> Object:
    material = Material("made up", height=map_of(values), base_color=map_of(colors))
    options = {"mapping": "triplanar", "technique": "parallax_occlusion", **options}
    return Object(material, settings=STEPS, edge="clamp", transform=np.eye(4), **options)


def rendered(*args, camera=FRONT, scene=UNLIT, **options) -> Frame:
    frame = drawn(relief(*args, **options), camera=camera, **scene)
    assert frame.hit.all()
    return frame


def test_on_a_level_relief_triplanar_equals_planar() -> None:
    """H7: bit for bit."""
    level = np.full((32, 32), 0.4)
    three, one = (
        rendered(level, scale=0.3, camera=SLANTED, mapping=kind) for kind in ("triplanar", "planar")
    )
    np.testing.assert_array_equal(three.color, one.color)


def weights(slope_u: float, slope_v: float, aspect: float = 1.0) -> np.ndarray:
    """Blend weights for a relief that rises by given tile widths over a tile along u and v."""
    normal = np.array([-slope_u, slope_v * aspect, 1.0])
    fourth = (normal / np.linalg.norm(normal)) ** 4
    return fourth / fourth.sum()


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("scale", [0.5, 1.5, 4.0])
@pytest.mark.parametrize("tiling", [(1.0, 1.0), (1.0, 0.5)])
def test_on_a_ramp_the_colour_is_read_by_height(axis: int, scale: float, tiling) -> None:
    """H7: the colour is as dense up the slope as across it; blended by the fourth power of the
    normal, in float64."""
    ramp = np.arange(32)[None, :] / 31 if axis == 0 else np.arange(32)[:, None] / 31
    ramp = np.broadcast_to(ramp, (32, 32))
    frame = rendered(ramp, scale=scale, tiling=tiling)
    uv = frame.uv.astype(np.float64)
    deep = bilinear(ramp, uv, "clamp")[..., 0] * scale
    rise = 32 / 31 * scale
    aspect = tiling[1] / tiling[0]
    x, y, z = weights(*((rise, 0.0) if axis == 0 else (0.0, rise)), aspect)
    clamped = [np.clip(place, 0.0, 1.0) for place in (
        uv,
        np.stack([deep, uv[..., 1]], -1),
        np.stack([uv[..., 0], 1.0 - deep * aspect], -1),
    )]  # fmt: skip
    planar, beside, above = (bilinear(COLORS, place, "clamp") for place in clamped)
    # within the ramp; its ends are level
    ours = (np.abs(uv - 0.5) < 0.5 - 1 / 32).all(-1)
    assert ours.mean() > 0.3
    wanted = planar * z + beside * x + above * y
    np.testing.assert_allclose(frame.color[ours][:, :3], wanted[ours], atol=6e-3)


def test_stripes_are_not_stretched_on_a_steep_slope() -> None:
    """Ten stripes a tile: a slope four tiles high shows forty, with planar mapping ten."""
    u = (np.arange(200) + 0.5) / 200
    stripes = np.broadcast_to(0.5 + 0.4 * np.cos(2 * np.pi * 10 * u)[None, :, None], (200, 200, 3))
    ramp = np.broadcast_to(np.arange(200)[None, :] / 199, (200, 200))

    def crossings(mapping: str) -> int:
        material = Material("m", height=map_of(ramp), base_color=map_of(stripes))
        slope = Object(
            material, mapping=mapping, technique="parallax_occlusion", settings=STEPS,
            scale=4.0, transform=np.eye(4),
        )  # fmt: skip
        camera = LookAt((0.0, 0.0, 9.0), orthographic_height=0.5)
        line = drawn(slope, camera=camera, size=(400, 200), **UNLIT).color[100, :, 0]
        above = line[4:-4] > 0.5
        return int((above[1:] != above[:-1]).sum())

    assert abs(crossings("planar") - 2 * 10) <= 2
    assert abs(crossings("triplanar") - 2 * 40) <= 3


def test_a_uniform_colour_and_the_normals_are_unchanged() -> None:
    """The weights add up to 1; lighting equals that of the planar mapping."""
    one = np.full((32, 32, 3), (0.2, 0.5, 0.8))
    rough = noise(9, (32, 32), 1)
    lit = {"lights": (directional(-40.0, 30.0), directional(70.0, 60.0))}
    for scene in (UNLIT, lit):
        three, planar = (
            rendered(rough, one, scale=1.5, camera=SLANTED, scene=scene, mapping=kind)
            for kind in ("triplanar", "planar")
        )
        np.testing.assert_allclose(three.color, planar.color, atol=2e-6)
        np.testing.assert_array_equal(three.uv, planar.uv)


def test_a_planar_mapping_has_no_code_of_triplanar() -> None:
    material = sample("tiles", 16)
    planar, three = (
        print_wgsl(program_of(Object(material, mapping=kind).resolved).module, "wrap")
        for kind in ("planar", "triplanar")
    )
    for word in ("fn triplanar(", "height_field_normal", "gradient_at"):
        assert word not in planar
        assert word in three


@pytest.mark.gpu
def test_cpu_and_gpu_agree() -> None:
    rock = Object(
        sample("cobbles", 64), mapping="triplanar", scale=0.4, settings={"search_steps": 8},
        tilings={"base_color": Tiling((2.0, -3.0))},
    )  # fmt: skip
    assert_engines_agree(Scene((rock,), Orbit(20.0, 50.0, 1.8)), 64)
