"""Self-shadow against geometry: where the shadow of a wall ends, and what it costs when off."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import HeightField, Vec2
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene, directional
from basrelief.shading.self_shadow import (
    Shadowing,
    hard_visibility,
    hard_visibility_on_columns,
    soft_visibility,
    soft_visibility_on_columns,
)
from basrelief.techniques import Ray

COLUMNS = 128
FINE = Shadowing(shadow_steps=256, shadow_offset=0.0)


def wall() -> HeightField:
    """Height 1 left of the middle, 0 right of it."""
    heights = np.zeros((3, COLUMNS), np.float32)
    heights[:, : COLUMNS // 2] = 1.0
    return HeightField([heights], "clamp")


def to_light(uv: Vec2, height: float, rise: Vec2) -> Ray:
    """The way to a light from a height: rising through the whole range it would move by `rise`."""
    climb = 1.0 - height
    return Ray(uv=uv, travel=rise * climb, height=height, drop=-climb, cosine=1.0)


@pytest.mark.parametrize("rise", [-0.1, -0.25, -0.4])
@pytest.mark.parametrize("height", [0.0, 0.3])
def test_the_shadow_of_a_wall_ends_where_the_light_passes_over_it(rise, height):
    """A light that is met after moving by `rise` while rising by 1 clears a wall of height 1."""
    reach = 0.5 - rise * (1.0 - height)
    texel = 1.0 / COLUMNS
    for u, lit in ((reach - 1.5 * texel, 0.0), (reach + 1.5 * texel, 1.0)):
        ray = to_light(Vec2(u, 0.5), height, Vec2(rise, 0.0))
        assert hard_visibility(wall(), ray, FINE).visibility == lit


def test_on_the_far_side_a_wall_casts_nothing():
    ray = to_light(Vec2(0.6, 0.5), 0.0, Vec2(0.25, 0.0))
    assert hard_visibility(wall(), ray, FINE).visibility == 1.0
    assert soft_visibility(wall(), ray, FINE).visibility == 1.0


def test_a_soft_shadow_is_darkest_at_the_wall():
    settings = Shadowing(shadow_steps=64, shadow_softness=2.0, shadow_offset=0.0)
    shares = [
        float(
            soft_visibility(
                wall(), to_light(Vec2(u, 0.5), 0.0, Vec2(-0.4, 0.0)), settings
            ).visibility
        )
        for u in (0.52, 0.6, 0.7, 0.8, 0.88, 0.95)
    ]
    assert shares == sorted(shares)
    assert shares[0] < 0.05
    assert shares[-1] == 1.0


def test_reads_are_counted_and_bounded():
    free = to_light(Vec2(0.9, 0.5), 0.0, Vec2(0.05, 0.0))
    assert hard_visibility(wall(), free, Shadowing(shadow_steps=9)).reads == 9
    blocked = to_light(Vec2(0.51, 0.5), 0.0, Vec2(-0.4, 0.0))
    assert hard_visibility(wall(), blocked, Shadowing(shadow_steps=9)).reads == 1


# --- the samples of a ray, one by one -------------------------------------------------------------

START = 0.2
ALONG = Vec2(0.4, -0.3)
"""The ray rises from 0.2 to 1 and moves by (0.32, −0.24): four steps of 0.2 and (0.08, −0.06)."""
LEFT = Vec2(0.15, 0.85)


def posts(tops: dict[int, float]) -> HeightField:
    """Height 0, but a post around the k-th of the four samples of the ray."""
    columns, rows = 100, 50
    heights = np.zeros((rows, columns), np.float32)
    for k, top in tops.items():
        u, v = 0.15 + 0.08 * k, 0.85 - 0.06 * k
        column, row = round(u * columns), round(v * rows)
        heights[row - 1 : row + 2, column - 2 : column + 3] = top
    return HeightField([heights], "clamp")


def visibility_of(kind, tops: dict[int, float], field=posts, **settings):
    """The visibility, and the reads, of a ray past posts: 4 steps, softness 2, offset 0.05."""
    usual = {"shadow_steps": 4, "shadow_softness": 2.0, "shadow_offset": 0.05}
    ray = to_light(LEFT, START, ALONG)
    return kind(field(tops), ray, Shadowing(**{**usual, **settings}))


@pytest.mark.parametrize(
    ("tops", "darkest"),
    [
        # how far the post stands above the ray and the offset, times the share that is left
        ({1: 0.7}, (0.7 - 0.4 - 0.05) * 0.75),
        ({2: 0.9}, (0.9 - 0.6 - 0.05) * 0.5),
        ({3: 1.0}, (1.0 - 0.8 - 0.05) * 0.25),
        # the sample at the top of the range has no weight
        ({4: 1.0}, 0.0),
        # a low post near by counts more than one further on that stands higher above the ray
        ({1: 0.56, 3: 1.0}, 0.11 * 0.75),
        ({1: 0.47, 3: 1.0}, 0.15 * 0.25),
        # within the offset, and below the ray
        ({1: 0.44, 2: 0.64}, 0.0),
        ({1: 0.3, 2: 0.5}, 0.0),
    ],
)
def test_a_soft_shadow_is_weighted_by_proximity(tops, darkest: float) -> None:
    """The visibility is 1 − softness · max of (height above the ray − offset) · (1 − k ÷ steps)."""
    for softness in (0.0, 0.5, 2.0, 4.0):
        found = visibility_of(soft_visibility, tops, shadow_softness=softness)
        assert found.visibility == pytest.approx(1.0 - softness * darkest, abs=1e-6)
        assert found.reads == 4
    # never below 0
    assert visibility_of(soft_visibility, tops, shadow_softness=64.0).visibility == (
        0.0 if darkest else 1.0
    )


@pytest.mark.parametrize("offset", [0.0, 0.05, 0.15, 0.29])
def test_a_hard_shadow_needs_more_than_the_offset(offset: float) -> None:
    """A post at the second of four samples, where the ray is at 0.6."""
    for top, visible, reads in ((0.599, 1.0, 4), (0.601, 0.0, 2)):
        found = visibility_of(hard_visibility, {2: top + offset}, shadow_offset=offset)
        assert (found.visibility, found.reads) == (visible, reads)


def test_what_light_only_grazes_is_lit() -> None:
    """A step of exactly the height that the ray has there: numbers that float32 holds."""
    heights = np.zeros((3, 8), np.float32)
    heights[:, 4:] = 0.5
    ray = to_light(Vec2(0.4375, 0.5), 0.0, Vec2(0.25, 0.0))
    grazing = hard_visibility(HeightField([heights], "clamp"), ray, Shadowing(2, shadow_offset=0.0))
    assert grazing.visibility == 1.0
    heights[:, 4:] = 0.501
    higher = hard_visibility(HeightField([heights], "clamp"), ray, Shadowing(2, shadow_offset=0.0))
    assert higher.visibility == 0.0


@pytest.mark.parametrize("kind", [hard_visibility, soft_visibility])
def test_steps_are_held_to_what_a_light_may_take(kind) -> None:
    for steps, reads in ((-3, 1), (0, 1), (1, 1), (4096, 4096), (5000, 4096)):
        assert visibility_of(kind, {}, shadow_steps=steps).reads == reads


# --- boxes, one by one ----------------------------------------------------------------------------

BOXES = [
    ((8, 1), 0.0),
    ((8, 2), 0.05 / 0.32),
    ((7, 2), 0.05 / 0.24),
    ((7, 3), 0.15 / 0.32),
    ((6, 3), 0.15 / 0.24),
    ((6, 4), 0.25 / 0.32),
    ((5, 4), 0.25 / 0.24),
]
"""Rows and columns of the boxes, a tenth wide, that the same ray passes over; the share of its way
at which it enters each. It ends before the last."""


def boxes(tops: dict[int, float]) -> HeightField:
    """Boxes of the height at which the ray starts, but for some of those that it passes over."""
    heights = np.full((10, 10), START, np.float32)
    for k, top in tops.items():
        heights[BOXES[k][0]] = top
    return HeightField([heights], "clamp")


@pytest.mark.parametrize(
    ("tops", "darkest"),
    [
        ({}, None),
        ({1: 0.6}, 1),
        ({2: 0.7}, 2),
        ({3: 0.9}, 3),
        ({5: 1.0}, 5),
        # what is near counts more
        ({2: 0.6, 5: 1.0}, 2),
        ({2: 0.45, 3: 0.8}, 3),
        # neither the box that the ray leaves nor one beyond its end counts
        ({0: 1.0, 6: 1.0}, None),
        # within the offset
        ({1: 0.36, 3: 0.61}, None),
    ],
)
def test_a_soft_shadow_of_boxes_is_weighted_by_proximity(tops, darkest) -> None:
    """As of samples, but each box where the ray comes to it, however many steps are asked for."""
    weighted = 0.0
    if darkest is not None:
        entered = BOXES[darkest][1]
        weighted = (tops[darkest] - START - 0.8 * entered - 0.05) * (1.0 - entered)
        assert weighted > 0.01
    for softness in (0.0, 0.5, 2.0):
        found = visibility_of(
            soft_visibility_on_columns, tops, boxes, shadow_softness=softness, shadow_steps=1
        )
        assert found.visibility == pytest.approx(1.0 - softness * weighted, abs=1e-6)
        assert found.reads == 6
    # once it is dark nothing further is read
    dark = visibility_of(soft_visibility_on_columns, tops, boxes, shadow_softness=64.0)
    assert (dark.visibility, dark.reads) == ((1.0, 6) if darkest is None else (0.0, min(tops)))


@pytest.mark.parametrize("offset", [0.0, 0.05, 0.15])
def test_a_hard_shadow_of_boxes_needs_more_than_the_offset(offset: float) -> None:
    """By the third box, which the ray enters at a height of 0.2 + 0.8 · 0.46875 = 0.575."""
    for top, visible, reads in ((0.5749, 1.0, 6), (0.5751, 0.0, 3)):
        found = visibility_of(
            hard_visibility_on_columns, {3: top + offset}, boxes, shadow_offset=offset
        )
        assert (found.visibility, found.reads) == (visible, reads)


def test_the_last_box_before_the_top_counts() -> None:
    """A wall is crossed at 0.92 of the way, another at 0.96, where the ray is 0.04 below a top."""
    heights = np.zeros((2, 4), np.float32)
    heights[1, 1] = 1.0
    ray = to_light(Vec2(0.25 - 0.92 * 0.2, 0.5 - 0.96 * 0.3), 0.0, Vec2(0.2, 0.3))
    for offset, visible in ((0.035, 0.0), (0.045, 1.0)):
        settings = Shadowing(shadow_offset=offset)
        assert (
            hard_visibility_on_columns(HeightField([heights], "clamp"), ray, settings).visibility
            == visible
        )


def picture(shadows: str, azimuth: float, device: str = "cpu"):
    """A wall seen from straight above, lit from one side."""
    heights = np.zeros((32, 64, 1), np.float32)
    heights[:, 24:32] = 1.0
    material = Material("wall", height=Map(heights, False, "wall"), normal=flat_normals())
    obj = Object(material, scale=0.1, edge="clamp", technique="relief")
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=1.0)
    scene = Scene((obj,), camera, (directional(azimuth, 30.0),), shadows=shadows)
    return render(scene, size=(128, 64), samples=1, device=device).color[32, :, 0]


def flat_normals() -> Map:
    return Map(np.full((1, 1, 3), (128, 128, 255), np.uint8), False, "flat")


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_shadows_fall_away_from_the_light(device):
    """Lit from the right, the left of the wall is dark for cot 30° of its height; and reversed."""
    plain = picture("none", 90.0, device)
    for azimuth in (90.0, -90.0):
        dark = picture("hard", azimuth, device) < 0.6 * plain
        columns = np.flatnonzero(dark)
        # the plane is one unit wide and half as high: 128 pixels show two units
        length = 0.1 / np.tan(np.radians(30.0)) * 64
        assert abs(len(columns) - length) <= 3
        side = columns.mean() - (32 + 28 * 64 / 64)
        assert (side < 0) == (azimuth > 0)


def test_a_program_without_shadows_has_none_in_it():
    obj = Object(sample("bricks", 16))
    without = print_wgsl(program_of(obj.resolved).module, "wrap")
    within = print_wgsl(program_of(obj.resolved, Scene((obj,), shadows="soft")).module, "wrap")
    for word in ("self_shadow_visibility", "LightVisibility", "shadow_steps"):
        assert word not in without
        assert word in within


@pytest.mark.parametrize("technique", ["offset", "offset_limited", "steep", "relief"])
def test_no_technique_shadows_what_nothing_stands_over(technique):
    """A gentle dome, lit steeply: where the view ray ended below it, there is still no shadow."""
    along = np.linspace(0.0, np.pi, 48)
    dome = 0.2 + 0.6 * np.outer(np.sin(along), np.sin(along))
    heights = Map(dome.astype(np.float32)[:, :, None], False, "dome")
    material = Material("dome", height=heights, normal=flat_normals())
    obj = Object(material, scale=0.05, technique=technique, edge="clamp")
    lights = (directional(30.0, 75.0),)
    with_, without = (
        render(Scene((obj,), lights=lights, shadows=kind), size=(96, 64), samples=1, device="cpu")
        for kind in ("hard", "none")
    )
    np.testing.assert_array_equal(with_.color, without.color)
