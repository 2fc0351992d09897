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
SINE = float(np.sqrt(0.5))
"""The sine of the lights' elevation, 45 degrees."""
FINE = Shadowing(max_shadow_steps=256, shadow_offset=0.0)


def wall() -> HeightField:
    """Height 1 left of the middle, 0 right of it."""
    heights = np.zeros((3, COLUMNS), np.float32)
    heights[:, : COLUMNS // 2] = 1.0
    return HeightField([heights], "clamp")


def ray_to_light(uv: Vec2, height: float, rise: Vec2) -> Ray:
    """The ray to a light from a height; rising through the whole range moves uv by `rise`."""
    climb = 1.0 - height
    return Ray(uv=uv, travel=rise * climb, height=height, drop=-climb, cosine=SINE)


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


def test_a_soft_shadow_grows_lighter_away_from_the_wall():
    settings = Shadowing(max_shadow_steps=256, light_angle=20.0, shadow_offset=0.0)
    shares = [
        float(
            soft_visibility(
                wall(), ray_to_light(Vec2(u, 0.5), 0.0, Vec2(-0.4, 0.0)), settings
            ).visibility
        )
        for u in (0.52, 0.6, 0.7, 0.8, 0.88, 0.95, 0.99)
    ]
    assert shares == sorted(shares)
    assert shares[0] < 0.05
    assert 0.05 < shares[4] < 0.5 < shares[5] < 0.95
    assert shares[-1] > 0.8


@pytest.mark.parametrize("u", [0.7, 0.8, 0.85, 0.9, 0.95])
@pytest.mark.parametrize("elevation", [20.0, 45.0, 70.0])
def test_the_penumbra_of_a_wall_is_that_of_a_disc(u: float, elevation: float) -> None:
    """The visible part of the disc above the top edge of a wall, which is sharp and level."""
    rise, angle = -0.4, 15.0
    # the height range that gives the ray this rise over the map
    height_range = -rise * np.tan(np.radians(elevation))
    ray = Ray(Vec2(u, 0.5), Vec2(rise, 0.0), 0.0, -1.0, cosine=np.sin(np.radians(elevation)))
    found = soft_visibility(
        wall(), ray, Shadowing(max_shadow_steps=4096, light_angle=angle, shadow_offset=0.0)
    )
    # the bilinear top edge lies half a texel before the middle
    to_edge = u - 0.5 + 0.5 / COLUMNS
    edge = np.degrees(np.arctan2(height_range, to_edge)) - elevation
    x = np.clip(edge / (0.5 * angle), -1.0, 1.0)
    above = np.linspace(x, 1.0, 20001)
    wanted = 2.0 / np.pi * np.trapezoid(np.sqrt(np.maximum(1.0 - above**2, 0.0)), above)
    assert found.visibility == pytest.approx(wanted, abs=0.06)


def test_steps_follow_the_texels():
    """The ray passes over 6.4 of 128 texels."""
    free = ray_to_light(Vec2(0.9, 0.5), 0.0, Vec2(0.05, 0.0))
    for most, reads in ((1, 1), (5, 5), (7, 7), (9, 7), (4096, 7)):
        assert hard_visibility(wall(), free, Shadowing(max_shadow_steps=most)).reads == reads
    # a soft shadow needs the ray to the lower rim, 6.4 · tan 45° ÷ tan 40° = 7.6 texels long
    for most, reads in ((5, 5), (8, 8), (9, 8)):
        settings = Shadowing(max_shadow_steps=most, light_angle=10.0)
        assert soft_visibility(wall(), free, settings).reads == reads
    blocked = ray_to_light(Vec2(0.51, 0.5), 0.0, Vec2(-0.4, 0.0))
    assert hard_visibility(wall(), blocked, Shadowing()).reads == 1


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
    """Visibility and reads of the ray past posts; by default 4 steps, 30 degrees, offset 0.05."""
    usual = {"max_shadow_steps": 4, "light_angle": 30.0, "shadow_offset": 0.05}
    ray = ray_to_light(LEFT, START, ALONG)
    return kind(field(tops), ray, Shadowing(**{**usual, **settings}))


def part_of_disc(above_by_t: float, angle: float) -> float:
    """The visible part of a light at 45 degrees, for a height above the ray ÷ t of a blocker; the
    ray climbs 0.8."""
    edge = above_by_t * 0.5 / 0.8 / np.radians(angle / 2.0)
    # the area of a disc above a chord
    half = np.arccos(np.clip(edge, -1.0, 1.0))
    return float((half - np.sin(half) * np.cos(half)) / np.pi)


def rim_end(angle: float) -> float:
    """The t at which the ray to the lower rim of a light at 45 degrees leaves the relief."""
    return float(min(1.0 / np.tan(np.radians(45.0 - angle / 2.0)), 4.0))


@pytest.mark.parametrize("angle", [2.0, 10.0, 30.0, 40.0])
@pytest.mark.parametrize(
    "tops",
    [
        {},
        {1: 0.45},
        {2: 0.62},
        {3: 0.9},
        {4: 1.0},
        # a low post nearby can cover more than a higher one further on, and the reverse
        {1: 0.49, 3: 0.9},
        {1: 0.35, 3: 1.0},
        {1: 1.0},
    ],
)
def test_a_soft_shadow_is_the_covered_part_of_a_disc(tops: dict[int, float], angle: float) -> None:
    """Of four samples, the last where the ray to the lower rim leaves the relief."""
    step = rim_end(angle) / 4.0
    heights = np.zeros((50, 100), np.float32)
    for k, top in tops.items():
        column, row = round(100 * (0.15 + 0.32 * k * step)), round(50 * (0.85 - 0.24 * k * step))
        heights[row - 1 : row + 2, column - 2 : column + 3] = top
    found = visibility_of(
        soft_visibility, tops, lambda _: HeightField([heights], "clamp"), light_angle=angle
    )
    steepest = max(
        (tops.get(k, 0.0) - START - 0.8 * k * step - 0.05) / (k * step) for k in range(1, 5)
    )
    assert found.visibility == pytest.approx(part_of_disc(steepest, angle), abs=2e-5)
    assert found.reads == 4


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
    field = HeightField([np.zeros((2, 2), np.float32)], "wrap")
    ray = ray_to_light(LEFT, 0.0, Vec2(5000.0, 0.0))
    for steps, reads in ((-3, 1), (0, 1), (1, 1), (4096, 4096), (5000, 4096)):
        assert kind(field, ray, Shadowing(max_shadow_steps=steps)).reads == reads


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
    "tops",
    [
        {},
        {1: 0.3},
        {2: 0.4},
        {3: 0.72},
        {5: 1.0},
        # one of several covers most
        {2: 0.4, 5: 1.0},
        {2: 0.33, 3: 0.72},
        # the column of the start does not count
        {0: 1.0},
    ],
)
def test_a_soft_shadow_of_columns_is_the_covered_part_of_a_disc(tops) -> None:
    """Evaluated where the ray enters each column, for any number of steps."""
    along = np.arange(60) * 0.1 + 0.05
    entries = np.sort(np.concatenate([along / 0.32, along / 0.24]))
    for angle in (5.0, 20.0, 40.0):
        reached = entries[entries < rim_end(angle)]
        heights = np.array([tops.get(k, START) for k in range(1, len(reached) + 1)])
        steepest = max((heights - START - 0.8 * reached - 0.05) / reached)
        found = visibility_of(
            soft_visibility_on_columns, tops, columns_along_ray, light_angle=angle,
            max_shadow_steps=1,
        )  # fmt: skip
        assert found.visibility == pytest.approx(part_of_disc(steepest, angle), abs=2e-5)
    # the search ends once the light is hidden
    dark = visibility_of(soft_visibility_on_columns, {2: 1.0}, columns_along_ray)
    assert (dark.visibility, dark.reads) == (pytest.approx(0.0, abs=1e-6), 2)


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
    for word in ("self_shadow_visibility", "LightVisibility", "max_shadow_steps"):
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
