"""Self-shadow against geometry: where the shadow of a wall ends, and what it costs when off."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import HeightField, Vec2, bound
from basrelief.lang.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene, directional
from basrelief.shading.self_shadow import Shadowing, ShadowRay, hard, soft
from basrelief.techniques import edge
from basrelief.techniques.height import sharp, surface_height

COLUMNS = 128
FINE = Shadowing(shadow_steps=256, shadow_offset=0.0)


def wall() -> HeightField:
    """Height 1 left of the middle, 0 right of it."""
    heights = np.zeros((3, COLUMNS), np.float32)
    heights[:, : COLUMNS // 2] = 1.0
    return HeightField([heights], "clamp")


@pytest.mark.parametrize("rise", [-0.1, -0.25, -0.4])
@pytest.mark.parametrize("height", [0.0, 0.3])
def test_the_shadow_of_a_wall_ends_where_the_light_passes_over_it(rise, height):
    """A light that is met after moving by `rise` while rising by 1 clears a wall of height 1."""
    reach = 0.5 - rise * (1.0 - height)
    texel = 1.0 / COLUMNS
    with bound({edge.in_tile: edge.clamp, surface_height: sharp}):
        for u, lit in ((reach - 1.5 * texel, 0.0), (reach + 1.5 * texel, 1.0)):
            ray = ShadowRay(Vec2(u, 0.5), height, Vec2(rise, 0.0))
            assert hard(wall(), ray, FINE).share == lit


def test_on_the_far_side_a_wall_casts_nothing():
    with bound({edge.in_tile: edge.clamp, surface_height: sharp}):
        ray = ShadowRay(Vec2(0.6, 0.5), 0.0, Vec2(0.25, 0.0))
        assert hard(wall(), ray, FINE).share == 1.0
        assert soft(wall(), ray, FINE).share == 1.0


def test_a_soft_shadow_is_darkest_at_the_wall():
    settings = Shadowing(shadow_steps=64, shadow_softness=2.0, shadow_offset=0.0)
    with bound({edge.in_tile: edge.clamp, surface_height: sharp}):
        shares = [
            float(soft(wall(), ShadowRay(Vec2(u, 0.5), 0.0, Vec2(-0.4, 0.0)), settings).share)
            for u in (0.52, 0.6, 0.7, 0.8, 0.88, 0.95)
        ]
    assert shares == sorted(shares)
    assert shares[0] < 0.05
    assert shares[-1] == 1.0


def test_reads_are_counted_and_bounded():
    with bound({edge.in_tile: edge.clamp, surface_height: sharp}):
        free = ShadowRay(Vec2(0.9, 0.5), 0.0, Vec2(0.05, 0.0))
        assert hard(wall(), free, Shadowing(shadow_steps=9)).reads == 9
        blocked = ShadowRay(Vec2(0.51, 0.5), 0.0, Vec2(-0.4, 0.0))
        assert hard(wall(), blocked, Shadowing(shadow_steps=9)).reads == 1


def picture(shadows: str, azimuth: float, engine: str = "cpu"):
    """A wall seen from straight above, lit from one side."""
    heights = np.zeros((32, 64, 1), np.float32)
    heights[:, 24:32] = 1.0
    material = Material("wall", height=Map(heights, False, "wall"), normal=flat_normals())
    thing = Object(material, scale=0.1, edge="clamp", technique="relief")
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=1.0)
    scene = Scene((thing,), camera, (directional(azimuth, 30.0),), shadows=shadows)
    return render(scene, size=(128, 64), samples=1, engine=engine).color[32, :, 0]


def flat_normals() -> Map:
    return Map(np.full((1, 1, 3), (128, 128, 255), np.uint8), False, "flat")


@pytest.mark.parametrize("engine", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_shadows_fall_away_from_the_light(engine):
    """Lit from the right, the left of the wall is dark for cot 30° of its height; and reversed."""
    plain = picture("none", 90.0, engine)
    for azimuth in (90.0, -90.0):
        dark = picture("hard", azimuth, engine) < 0.6 * plain
        columns = np.flatnonzero(dark)
        # the plane is one unit wide and half as high: 128 pixels show two units
        length = 0.1 / np.tan(np.radians(30.0)) * 64
        assert abs(len(columns) - length) <= 3
        side = columns.mean() - (32 + 28 * 64 / 64)
        assert (side < 0) == (azimuth > 0)


def test_a_program_without_shadows_has_none_in_it():
    thing = Object(sample("bricks", 16))
    without = print_wgsl(program_of(thing).module, "wrap")
    within = print_wgsl(program_of(thing, Scene((thing,), shadows="soft")).module, "wrap")
    for word in ("self_shadowed", "ShadowRay", "shadow_steps"):
        assert word not in without
        assert word in within


@pytest.mark.parametrize("technique", ["offset", "offset_limited", "steep", "relief"])
def test_no_technique_shadows_what_nothing_stands_over(technique):
    """A gentle dome, lit steeply: where the view ray ended below it, there is still no shadow."""
    along = np.linspace(0.0, np.pi, 48)
    dome = 0.2 + 0.6 * np.outer(np.sin(along), np.sin(along))
    heights = Map(dome.astype(np.float32)[:, :, None], False, "dome")
    material = Material("dome", height=heights, normal=flat_normals())
    thing = Object(material, scale=0.05, technique=technique, edge="clamp")
    lights = (directional(30.0, 75.0),)
    with_, without = (
        render(Scene((thing,), lights=lights, shadows=kind), size=(96, 64), samples=1, engine="cpu")
        for kind in ("hard", "none")
    )
    np.testing.assert_array_equal(with_.color, without.color)
