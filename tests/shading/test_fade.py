"""A relief that fades with distance: full nearby, flat far away, cheaper in between."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Orbit, Scene, directional, placed
from basrelief.shading.relief import ReliefParameters, faded_relief
from basrelief.shading.variant import Variant
from helpers.agreement import assert_engines_agree
from helpers.synthetic import drawn, map_of, on_plane, uniform_material

STEPS = {"min_steps": 8, "max_steps": 8}
HEIGHT, SCALE = 0.5, 0.3
ALONG = LookAt((0.0, -3.2, 1.2), up=(0.0, 0.0, 1.0), field_of_view=40.0)
"""A view along a plane four units long, at distances from 1.6 to 5."""
NEAR, FAR = 2.4, 4.0


def test_the_shader_halves_the_depth_in_the_middle() -> None:
    deep, fades = ReliefParameters(0.4, 0.7, 0.42, NEAR, FAR), Variant(fades=True)
    for distance, remaining in ((0.0, 1.0), (2.4, 1.0), (3.2, 0.5), (4.0, 0.0), (90.0, 0.0)):
        found = faded_relief(deep, np.float32(distance), fades)
        assert float(found.scale) == pytest.approx(0.4 * remaining, abs=1e-6)
        assert (found.reference_height, found.bias) == (deep.reference_height, deep.bias)
    assert faded_relief(deep, np.float32(4.0), fades).scale == 0.0


@pytest.mark.parametrize("reference_height", [0.0, 1.0])
def test_the_shift_shrinks_from_near_to_far(reference_height: float) -> None:
    """G10: on a constant height the shift falls linearly; beyond FAR nothing is read."""
    obj = Object(
        uniform_material(height=HEIGHT),
        technique="parallax_occlusion",
        settings=STEPS,
        scale=SCALE,
        reference_height=reference_height,
        fade=(NEAR, FAR),
        transform=placed(scale=(4.0, 4.0, 1.0)),
    )
    frame = drawn(obj, camera=ALONG)
    plane_uv, distance = on_plane(ALONG)
    remaining = np.clip((FAR - distance) / (FAR - NEAR), 0.0, 1.0)
    # where each ray meets the plane of the faded relief
    _, distance_below = on_plane(ALONG, -1.0)
    deeper = (reference_height - HEIGHT) * SCALE * remaining * (distance_below - distance)
    ours = frame.hit & (np.abs(plane_uv - 0.5).max(-1) < 1.99)
    for part in (distance < NEAR, (distance > NEAR) & (distance < FAR), distance > FAR):
        assert (ours & part).sum() > 100
    np.testing.assert_allclose(frame.distance[ours], (distance + deeper)[ours], rtol=2e-4)
    # in object space x and y are a quarter of the world's; the height range is 0.3 of a tile
    polygon = (plane_uv - 0.5) / 4.0 + 0.5
    slope = (on_plane(ALONG, -1.0)[0] - plane_uv) / 4.0
    moved = polygon + slope * ((reference_height - HEIGHT) * SCALE * remaining)[..., None]
    np.testing.assert_allclose(frame.uv[ours], moved[ours], atol=2e-4)
    gone = ours & (distance >= FAR * 1.0001)
    assert frame.reads[gone].max() == 0
    assert frame.reads[ours & (distance < FAR * 0.999)].min() > 0


def test_shadows_fade_too() -> None:
    """Halfway between near and far a wall's shadow is half as long; beyond far there is none."""
    heights = np.zeros((8, 64, 1))
    heights[:, 24:32] = 1.0
    material = Material(
        "wall", height=map_of(heights), normal=map_of(np.full((1, 1, 3), (0.5, 0.5, 1.0)))
    )
    camera = LookAt((0.0, 0.0, 2.0), orthographic_height=0.5)
    light = directional(-60.0, 0.0)

    def columns(fade) -> tuple[int, int]:
        """Number of dark pixels across the shadow, and the most reads of a pixel."""
        obj = Object(
            material, technique="offset", reference_height=1.0, scale=0.1, edge="clamp", fade=fade,
            transform=np.eye(4),
        )  # fmt: skip
        frames = [
            drawn(obj, camera=camera, size=(192, 96), lights=(light,), shadows=shadows,
                  shadowing={"max_shadow_steps": 256, "shadow_offset": 0.0})
            for shadows in ("hard", "none")
        ]  # fmt: skip
        dark = frames[0].color[48, :, 0] < 0.7 * frames[1].color[48, :, 0]
        return int(dark.sum()), int(frames[0].reads.max())

    # 192 pixels to a unit; the light falls at 30 degrees
    length = 0.1 * np.tan(np.radians(60.0)) * 192
    whole, half, none = columns((2.5, 3.0)), columns((1.0, 3.0)), columns((1.0, 1.5))
    assert abs(whole[0] - length) <= 4
    assert abs(half[0] - length / 2) <= 4
    assert none == (0, 0)


def test_the_cost_falls_with_distance() -> None:
    """G10: proportional to the covered part of the picture; 0 where the relief is flat."""
    obj = Object(sample("bricks", 32), technique="steep", settings={"steps": 10}, fade=(3.0, 5.0))
    costs, covered = [], []
    for distance in (1.5, 2.9, 4.2, 7.0):
        scene = Scene((obj,), Orbit(20.0, 40.0, distance))
        frame = render(scene, size=(96, 54), samples=1, device="cpu")
        costs.append(frame.reads.mean())
        covered.append(frame.hit.mean())
    assert all(more > 1.5 * less for more, less in pairwise(costs))
    assert costs[-1] == 0.0
    assert covered[-1] > 0.01
    # where the relief does not fade, a pixel's cost is constant
    assert costs[0] / covered[0] == pytest.approx(costs[1] / covered[1], rel=0.1)


def test_a_program_without_fading_has_no_code_for_it() -> None:
    material = sample("tiles", 16)
    texts = [
        print_wgsl(program_of(Object(material, fade=fade).resolved).module, "wrap")
        for fade in (None, (1.0, 2.0))
    ]
    assert ["relief_.fade_near" in text for text in texts] == [False, True]


@pytest.mark.gpu
@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion", "relief"])
def test_cpu_and_gpu_agree(technique: str) -> None:
    obj = Object(sample("bricks", 64), technique=technique, fade=(1.2, 2.0))
    assert_engines_agree(Scene((obj,), Orbit(20.0, 30.0, 1.6), shadows="soft"), 64)
