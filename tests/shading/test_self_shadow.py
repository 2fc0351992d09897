"""Self-shadow against geometry: the extent of a wall's shadow, and no code when it is off."""

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


def ray_to_light(uv: Vec2, height: float, rise: Vec2) -> Ray:
    """The ray to a light from a height; rising through the whole range moves uv by `rise`."""
    climb = 1.0 - height
    return Ray(uv=uv, travel=rise * climb, height=height, drop=-climb, cosine=1.0)


@pytest.mark.parametrize("rise", [-0.1, -0.25, -0.4])
@pytest.mark.parametrize("height", [0.0, 0.3])
def test_the_shadow_of_a_wall_ends_where_the_light_passes_over_it(rise, height):
    """The shadow of a wall of height 1 is |rise| long at height 0, shorter above."""
    reach = 0.5 - rise * (1.0 - height)
    texel = 1.0 / COLUMNS
    for u, lit in ((reach - 1.5 * texel, 0.0), (reach + 1.5 * texel, 1.0)):
        ray = ray_to_light(Vec2(u, 0.5), height, Vec2(rise, 0.0))
        assert hard_visibility(wall(), ray, FINE).visibility == lit


def test_the_side_towards_the_light_is_lit():
    ray = ray_to_light(Vec2(0.6, 0.5), 0.0, Vec2(0.25, 0.0))
    assert hard_visibility(wall(), ray, FINE).visibility == 1.0
    assert soft_visibility(wall(), ray, FINE).visibility == 1.0


def test_a_soft_shadow_is_darkest_at_the_wall():
    settings = Shadowing(shadow_steps=64, shadow_softness=2.0, shadow_offset=0.0)
    shares = [
        float(
            soft_visibility(
                wall(), ray_to_light(Vec2(u, 0.5), 0.0, Vec2(-0.4, 0.0)), settings
            ).visibility
        )
        for u in (0.52, 0.6, 0.7, 0.8, 0.88, 0.95)
    ]
    assert shares == sorted(shares)
    assert shares[0] < 0.05
    assert shares[-1] == 1.0


def test_reads_are_counted_and_bounded():
    free = ray_to_light(Vec2(0.9, 0.5), 0.0, Vec2(0.05, 0.0))
    assert hard_visibility(wall(), free, Shadowing(shadow_steps=9)).reads == 9
    blocked = ray_to_light(Vec2(0.51, 0.5), 0.0, Vec2(-0.4, 0.0))
    assert hard_visibility(wall(), blocked, Shadowing(shadow_steps=9)).reads == 1


# --- the samples of a ray, one by one -------------------------------------------------------------

START = 0.2
ALONG = Vec2(0.4, -0.3)
"""The ray rises from 0.2 to 1 and moves by (0.32, −0.24): four steps of 0.2 and (0.08, −0.06)."""
LEFT = Vec2(0.15, 0.85)


def posts(tops: dict[int, float]) -> HeightField:
    """Height 0 with posts around some of the four samples of the ray."""
    columns, rows = 100, 50
    heights = np.zeros((rows, columns), np.float32)
    for k, top in tops.items():
        u, v = 0.15 + 0.08 * k, 0.85 - 0.06 * k
        column, row = round(u * columns), round(v * rows)
        heights[row - 1 : row + 2, column - 2 : column + 3] = top
    return HeightField([heights], "clamp")


def visibility_of(kind, tops: dict[int, float], field=posts, **settings):
    """Visibility and reads of the ray past posts; by default 4 steps, softness 2, offset 0.05."""
    usual = {"shadow_steps": 4, "shadow_softness": 2.0, "shadow_offset": 0.05}
    ray = ray_to_light(LEFT, START, ALONG)
    return kind(field(tops), ray, Shadowing(**{**usual, **settings}))


@pytest.mark.parametrize(
    ("tops", "darkest"),
    [
        # height of the post above ray and offset, times the remaining part of the ray
        ({1: 0.7}, (0.7 - 0.4 - 0.05) * 0.75),
        ({2: 0.9}, (0.9 - 0.6 - 0.05) * 0.5),
        ({3: 1.0}, (1.0 - 0.8 - 0.05) * 0.25),
        # the sample at the top of the range has no weight
        ({4: 1.0}, 0.0),
        # a low post nearby can count more than a higher one further on
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
    """A post at the second of four samples, where the ray has height 0.6."""
    for top, visible, reads in ((0.599, 1.0, 4), (0.601, 0.0, 2)):
        found = visibility_of(hard_visibility, {2: top + offset}, shadow_offset=offset)
        assert (found.visibility, found.reads) == (visible, reads)


def test_a_grazed_point_is_lit() -> None:
    """A surface exactly as high as the ray at a sample, with values exact in float32."""
    heights = np.zeros((3, 8), np.float32)
    heights[:, 4:] = 0.5
    ray = ray_to_light(Vec2(0.4375, 0.5), 0.0, Vec2(0.25, 0.0))
    grazing = hard_visibility(HeightField([heights], "clamp"), ray, Shadowing(2, shadow_offset=0.0))
    assert grazing.visibility == 1.0
    heights[:, 4:] = 0.501
    higher = hard_visibility(HeightField([heights], "clamp"), ray, Shadowing(2, shadow_offset=0.0))
    assert higher.visibility == 0.0


@pytest.mark.parametrize("kind", [hard_visibility, soft_visibility])
def test_steps_are_clamped_to_1_and_4096(kind) -> None:
    for steps, reads in ((-3, 1), (0, 1), (1, 1), (4096, 4096), (5000, 4096)):
        assert visibility_of(kind, {}, shadow_steps=steps).reads == reads


# --- columns, one by one --------------------------------------------------------------------------

COLUMN_ENTRIES = [
    ((8, 1), 0.0),
    ((8, 2), 0.05 / 0.32),
    ((7, 2), 0.05 / 0.24),
    ((7, 3), 0.15 / 0.32),
    ((6, 3), 0.15 / 0.24),
    ((6, 4), 0.25 / 0.32),
    ((5, 4), 0.25 / 0.24),
]
"""Row and column of each texel, a tenth wide, that the same ray crosses, and the ray's t where it
enters. The ray ends before the last."""


def columns_along_ray(tops: dict[int, float]) -> HeightField:
    """Columns of the ray's start height, with other heights for some that it crosses."""
    heights = np.full((10, 10), START, np.float32)
    for k, top in tops.items():
        heights[COLUMN_ENTRIES[k][0]] = top
    return HeightField([heights], "clamp")


@pytest.mark.parametrize(
    ("tops", "darkest"),
    [
        ({}, None),
        ({1: 0.6}, 1),
        ({2: 0.7}, 2),
        ({3: 0.9}, 3),
        ({5: 1.0}, 5),
        # proximity counts more
        ({2: 0.6, 5: 1.0}, 2),
        ({2: 0.45, 3: 0.8}, 3),
        # neither the column of the start nor one beyond the ray's end counts
        ({0: 1.0, 6: 1.0}, None),
        # within the offset
        ({1: 0.36, 3: 0.61}, None),
    ],
)
def test_a_soft_shadow_of_columns_is_weighted_by_proximity(tops, darkest) -> None:
    """Evaluated where the ray enters each column, for any number of steps."""
    weighted = 0.0
    if darkest is not None:
        entered = COLUMN_ENTRIES[darkest][1]
        weighted = (tops[darkest] - START - 0.8 * entered - 0.05) * (1.0 - entered)
        assert weighted > 0.01
    for softness in (0.0, 0.5, 2.0):
        found = visibility_of(
            soft_visibility_on_columns,
            tops,
            columns_along_ray,
            shadow_softness=softness,
            shadow_steps=1,
        )
        assert found.visibility == pytest.approx(1.0 - softness * weighted, abs=1e-6)
        assert found.reads == 6
    # the march ends once visibility is 0
    dark = visibility_of(soft_visibility_on_columns, tops, columns_along_ray, shadow_softness=64.0)
    assert (dark.visibility, dark.reads) == ((1.0, 6) if darkest is None else (0.0, min(tops)))


@pytest.mark.parametrize("offset", [0.0, 0.05, 0.15])
def test_a_hard_shadow_of_columns_needs_more_than_the_offset(offset: float) -> None:
    """The ray enters the third column at a height of 0.2 + 0.8 · 0.46875 = 0.575."""
    for top, visible, reads in ((0.5749, 1.0, 6), (0.5751, 0.0, 3)):
        found = visibility_of(
            hard_visibility_on_columns, {3: top + offset}, columns_along_ray, shadow_offset=offset
        )
        assert (found.visibility, found.reads) == (visible, reads)


def test_the_last_column_before_the_top_counts() -> None:
    """The ray crosses texel borders at t = 0.92 and 0.96; at 0.96 it is 0.04 below a top."""
    heights = np.zeros((2, 4), np.float32)
    heights[1, 1] = 1.0
    ray = ray_to_light(Vec2(0.25 - 0.92 * 0.2, 0.5 - 0.96 * 0.3), 0.0, Vec2(0.2, 0.3))
    for offset, visible in ((0.035, 0.0), (0.045, 1.0)):
        settings = Shadowing(shadow_offset=offset)
        assert (
            hard_visibility_on_columns(HeightField([heights], "clamp"), ray, settings).visibility
            == visible
        )


def wall_row(shadows: str, azimuth: float, device: str = "cpu"):
    """The middle row of a picture of a wall from above, lit from one side."""
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
    """Light from the right darkens cot 30° of the wall's height on its left, and vice versa."""
    plain = wall_row("none", 90.0, device)
    for azimuth in (90.0, -90.0):
        dark = wall_row("hard", azimuth, device) < 0.6 * plain
        columns = np.flatnonzero(dark)
        # 128 pixels show two units
        length = 0.1 / np.tan(np.radians(30.0)) * 64
        assert abs(len(columns) - length) <= 3
        side = columns.mean() - (32 + 28 * 64 / 64)
        assert (side < 0) == (azimuth > 0)


def test_a_program_without_shadows_has_no_code_for_them():
    obj = Object(sample("bricks", 16))
    without = print_wgsl(program_of(obj.resolved).module, "wrap")
    within = print_wgsl(program_of(obj.resolved, Scene((obj,), shadows="soft")).module, "wrap")
    for word in ("self_shadow_visibility", "LightVisibility", "shadow_steps"):
        assert word not in without
        assert word in within


@pytest.mark.parametrize("technique", ["offset", "offset_limited", "steep", "relief"])
def test_a_gentle_dome_casts_no_shadow_on_itself(technique):
    """Lit steeply, also where an approximate view ray ended below the surface."""
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
