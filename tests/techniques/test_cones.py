"""Cone maps, no height inside a cone at any size, and the techniques that step by them."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from basrelief import baking
from basrelief.baking.tables import bake_function
from basrelief.engine import choose_device
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Texture, Vec2, shader, struct
from basrelief.lang.program import Program
from basrelief.material import sample
from basrelief.measure.oracle import intersect_height_field
from basrelief.techniques import cone, displace, relaxed_cone
from basrelief.techniques.cone import Cones, RelaxedCones
from basrelief.techniques.cone_bake import MIN_SLOPE, SLOPE_ROUNDING
from basrelief.techniques.ray import Ray
from basrelief.techniques.technique import Settings
from helpers.rays import LATE, Fan, flat_ray, maps, scattered

WIDENED = 1.42
"""Factor by which a cone may be too steep: a window counts as far as its nearest texel."""


@struct
class TracedRay:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    height: float
    found: bool
    reads: int


@shader
def traced(
    at: IVec2, fan: Fan, field: HeightField, baked: Texture, settings: Settings
) -> TracedRay:
    """A random ray, traced by the bound technique."""
    n = (at.y * 8192 + at.x) * 4 + fan.seed * 7919
    uv = Vec2(scattered(n), scattered(n + 1))
    travel = (Vec2(scattered(n + 2), scattered(n + 3)) * 2.0 - 1.0) * fan.reach
    hit = displace(field, baked, Ray(uv, travel, 1.0, 1.0, 0.5), settings)
    return TracedRay(uv, travel, hit.height, hit.found, hit.reads)


@pytest.fixture(scope="module")
def cpu() -> CpuEngine:
    return CpuEngine()


# --- the bake -------------------------------------------------------------------------------------


def slopes_of(baked: np.ndarray) -> np.ndarray:
    """The slopes of stored cones, in height ranges per texel."""
    return 65535.0 / baked[:, :, 0].astype(float) - 1.0


def surface(heights: np.ndarray, x: np.ndarray, y: np.ndarray, edge: str) -> np.ndarray:
    """The bilinear surface at positions in texels from the first texel's centre, in float64."""
    rows, columns = heights.shape
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = x - i, y - j

    def inside(k: np.ndarray, count: int) -> np.ndarray:
        return k % count if edge == "wrap" else np.clip(k, 0, count - 1)

    h = heights.astype(float)
    upper = (
        h[inside(j, rows), inside(i, columns)] * (1 - a)
        + h[inside(j, rows), inside(i + 1, columns)] * a
    )
    lower = (
        h[inside(j + 1, rows), inside(i, columns)] * (1 - a)
        + h[inside(j + 1, rows), inside(i + 1, columns)] * a
    )
    return upper * (1 - b) + lower * b


def steepest_up(
    heights: np.ndarray, cell: tuple[int, int], edge: str, random: np.random.Generator
) -> float:
    """The steepest slope from points of a cell to points all around, sampled in float64."""
    rows, columns = heights.shape
    fine = np.linspace(0, 1, 5)
    px, py = (p.ravel() for p in np.meshgrid(cell[1] + fine, cell[0] + fine))
    across = np.arange(cell[1] - columns - 1, cell[1] + columns + 2, 0.25)
    down = np.arange(cell[0] - rows - 1, cell[0] + rows + 2, 0.25)
    qx, qy = (q.ravel() for q in np.meshgrid(across, down))
    qx = np.concatenate([qx, random.uniform(across[0], across[-1], 500)])
    qy = np.concatenate([qy, random.uniform(down[0], down[-1], 500)])
    rise = surface(heights, qx, qy, edge) - surface(heights, px, py, edge)[:, None]
    away = np.sqrt((qx - px[:, None]) ** 2 + (qy - py[:, None]) ** 2)
    return float((rise / np.maximum(away, 1e-3)).max())


def assert_no_height_is_inside_a_cone(
    rows, columns, edge, seed, levels, smooth, device="cpu"
) -> None:
    """Assert that no slope from some cells exceeds that of their cones."""
    random = np.random.default_rng(seed)
    drawn = random.random((rows, columns))
    if smooth:
        # a few peaks far from each other, so that distant ones matter
        drawn = drawn**8
    heights = (np.rint(drawn * levels) / levels).astype(np.float32)
    baked = baking.cone_map(heights, edge, device)
    assert baked.shape == (rows, columns, 4)
    assert baked.dtype == np.uint16
    slopes = slopes_of(baked)
    for _ in range(4):
        cell = int(random.integers(0, rows)), int(random.integers(0, columns))
        assert steepest_up(heights, cell, edge, random) <= slopes[cell] + 1e-9


@settings(max_examples=60, deadline=None)
@given(
    st.integers(1, 23), st.integers(1, 23), st.sampled_from(["wrap", "clamp"]),
    st.integers(0, 10_000), st.sampled_from([1, 4, 255, 65535]), st.booleans(),
)  # fmt: skip
def test_no_height_is_inside_a_cone(rows, columns, edge, seed, levels, smooth) -> None:
    """From no point of a cell, at any size and bit depth, for both kinds of edges."""
    assert_no_height_is_inside_a_cone(rows, columns, edge, seed, levels, smooth)


@pytest.mark.gpu
@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 23), st.integers(1, 23), st.sampled_from(["wrap", "clamp"]),
    st.integers(0, 10_000), st.sampled_from([1, 4, 255, 65535]), st.booleans(),
)  # fmt: skip
@example(1, 1, "clamp", 0, 65535, False)
@example(1, 23, "wrap", 1, 65535, True)
@example(19, 1, "clamp", 2, 65535, False)
def test_no_height_is_inside_a_cone_baked_on_a_gpu(
    rows, columns, edge, seed, levels, smooth
) -> None:
    gpu = choose_device("gpu")
    assert_no_height_is_inside_a_cone(rows, columns, edge, seed, levels, smooth, gpu)


def test_the_margin_covers_the_rounding_that_webgpu_allows() -> None:
    """Every code is rounded to a cone that is narrow enough, with the largest errors WGSL allows.

    Of 1 ÷ (1 + slope): 2.5 units in the last place by division, half of one by addition. Of the
    slope: more by its own division and square root, and 1e-7 of the rise by 16-bit windows.
    """
    codes = np.arange(1.0, 65536.0)
    # the smallest slope for which a cone of that code is too wide
    true = (65535.0 / codes - 1.0) * (1.0 + 1e-9) + 1e-9
    slope = np.maximum(true * (1.0 - 1e-6) - 1e-7, 1e-10)
    below = 1.0 + slope * (1.0 + SLOPE_ROUNDING) + MIN_SLOPE
    below -= np.spacing(below.astype(np.float32)) / 2.0
    quotient = 65535.0 / below
    quotient += 2.5 * np.spacing(quotient.astype(np.float32))
    assert (np.floor(quotient) < codes).all()


def test_the_smallest_slope_is_not_a_half_space() -> None:
    """One 16-bit code, 300 texels away: a slope that float32 loses when added to 1."""
    heights = np.full((1, 700), 32768 / 65535, np.float32)
    heights[0, 350] = 32769 / 65535
    for make in (baking.cone_map, baking.relaxed_cone_map):
        slopes = slopes_of(make(heights, "clamp"))[0, :350]
        assert (slopes * (350 - np.arange(350)) >= 1 / 65536).all()
        # and the cone is not narrower than the next code
        assert slopes[:300].max() < 1.6e-5


def test_a_flat_map_has_half_spaces() -> None:
    for edge in ("wrap", "clamp"):
        for height in (0.0, 0.3, 1.0):
            assert (
                baking.cone_map(np.full((5, 9), height, np.float32), edge)[:, :, 0] == 65535
            ).all()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_cones_around_a_spike_touch_its_tip(edge) -> None:
    """From the near side of a cell k texels away, the tip is 1 high at distance k."""
    heights = np.zeros((96, 128), np.float32)
    heights[50, 60] = 1.0
    slopes = slopes_of(baking.cone_map(heights, edge))
    for k in (1, 2, 3, 5, 8, 17, 40):
        for cell in ((50, 60 + k), (49, 60 - k - 1), (50 + k, 60), (50 - k - 1, 59)):
            assert 1.0 / k <= slopes[cell] <= WIDENED / k
    # diagonally the nearest corner counts
    assert 1.0 / np.hypot(20, 30) <= slopes[70, 90] <= WIDENED / np.hypot(20, 30)
    # the cells at the tip have the slope of their own surface
    assert slopes[50, 60] == pytest.approx(np.sqrt(2.0), rel=1e-3)


def test_the_cones_of_a_ramp_have_its_slope() -> None:
    heights = np.tile(np.linspace(0, 1, 101, dtype=np.float32), (70, 1))
    slopes = slopes_of(baking.cone_map(heights, "clamp"))
    assert (slopes[:, :-1] >= 0.01).all()
    assert (slopes[:, :-1] <= 0.01 * WIDENED).all()


def test_cones_are_on_average_at_most_40_percent_too_steep() -> None:
    """Mean ratio of baked to exact slopes for gravel."""
    heights = sample("gravel", (200, 256)).height.linear()[:36, :48, 0]
    random = np.random.default_rng(3)
    slopes = slopes_of(baking.cone_map(heights, "clamp"))
    cells = [(int(random.integers(0, 36)), int(random.integers(0, 48))) for _ in range(40)]
    ratios = [slopes[c] / steepest_up(heights, c, "clamp", random) for c in cells]
    assert min(ratios) >= 1.0
    assert np.mean(ratios) < 1.4


def assert_no_far_side_is_inside_a_relaxed_cone(
    rows, columns, edge, seed, levels, device="cpu"
) -> None:
    """Assert it for the corners of some cells; no relaxed cone is narrower than the exact one."""
    random = np.random.default_rng(seed)
    heights = (random.integers(0, levels + 1, (rows, columns)) / levels).astype(np.float32)
    baked = baking.relaxed_cone_map(heights, edge, device)
    assert (baked >= baking.cone_map(heights, edge, device)).all()
    slopes = slopes_of(baked)

    def at(j: Any, i: Any) -> Any:
        texel = (j % rows, i % columns)
        if edge == "clamp":
            texel = np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)
        return heights[texel].astype(float)

    y, x = (d.ravel() for d in np.mgrid[-rows : rows + 1, -columns : columns + 1])
    y, x = y[(x != 0) | (y != 0)], x[(x != 0) | (y != 0)]
    away = np.hypot(x, y)
    for _ in range(6):
        j, i = int(random.integers(0, rows)), int(random.integers(0, columns))
        own = at(j + y, i + x)
        on_u = at(j + y, i + x + np.sign(x)) - own
        on_v = at(j + y + np.sign(y), i + x) - own
        falls = (np.abs(x) * on_u + np.abs(y) * on_v) / away < -2e-6
        rise = (own - at(j, i)) / away
        steepest = rise[falls].max(initial=0.0)
        assert steepest <= slopes[j, i] + 1e-9
        assert steepest <= slopes[j - 1, i - 1] + 1e-9 or (edge == "clamp" and min(i, j) == 0)


@settings(max_examples=40, deadline=None)
@given(
    st.integers(1, 19), st.integers(1, 19), st.sampled_from(["wrap", "clamp"]),
    st.integers(0, 10_000), st.sampled_from([1, 4, 255, 65535]),
)  # fmt: skip
def test_no_far_side_is_inside_a_relaxed_cone(rows, columns, edge, seed, levels) -> None:
    """Seen from the corners of a cell; no relaxed cone is narrower than the exact one."""
    assert_no_far_side_is_inside_a_relaxed_cone(rows, columns, edge, seed, levels)


@pytest.mark.gpu
@settings(max_examples=15, deadline=None)
@given(
    st.integers(1, 19), st.integers(1, 19), st.sampled_from(["wrap", "clamp"]),
    st.integers(0, 10_000), st.sampled_from([1, 4, 255, 65535]),
)  # fmt: skip
@example(1, 1, "clamp", 0, 65535)
@example(1, 19, "wrap", 1, 65535)
@example(17, 1, "clamp", 2, 65535)
def test_no_far_side_is_inside_a_relaxed_cone_baked_on_a_gpu(
    rows, columns, edge, seed, levels
) -> None:
    gpu = choose_device("gpu")
    assert_no_far_side_is_inside_a_relaxed_cone(rows, columns, edge, seed, levels, gpu)


def test_a_relaxed_cone_extends_through_a_slope_to_its_crest() -> None:
    """In front of a ridge 20 texels long, the slope is that to the crest, not to the foot."""
    heights = np.zeros((40, 160), np.float32)
    heights[:, 80:101] = np.linspace(0, 1, 21)
    heights[:, 100:121] = np.linspace(1, 0, 21)
    relaxed, close = (
        slopes_of(make(heights, "clamp"))[20] for make in (baking.relaxed_cone_map, baking.cone_map)
    )
    for k in (70, 79, 85):
        assert 1.0 - heights[20, k] <= relaxed[k] * (100 - k) * 1.0001
        assert relaxed[k] <= WIDENED * (1.0 - heights[20, k]) / (100 - k - 1)
    # on the ridge the line to the crest has the slope of the ridge; before it, far less
    assert relaxed[79] == pytest.approx(close[79], rel=0.5)


# --- stepping -------------------------------------------------------------------------------------


@functools.cache
def baked_of(engine: Any, bake: Any, name: str, edge: str) -> np.ndarray:
    return bake_function(bake)(np.asarray(maps()[name], np.float32), edge, engine)


@functools.cache
def first_hits(name: str, edge: str, rays: bytes) -> np.ndarray:
    """t of the first hits of rays, (n, 4) of start and travel in float32, by the oracle."""
    each = np.frombuffer(rays, np.float32).reshape(-1, 4).astype(float)
    heights = np.asarray(maps()[name], np.float32)
    return intersect_height_field(heights, each[:, :2], each[:, 2:], edge).t


def overshoot_of_rays(
    engine: Any, technique: Any, values: Any, name: str, edge: str, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Overshoot of random rays in texels, whether each is a hit, and the reads."""
    heights = np.asarray(maps()[name], np.float32)
    baked = baked_of(engine, technique.bake, name, edge)
    program = Program(traced, {displace: technique}, edge)
    inputs = {
        "fan": Fan(reach, 0),
        "field": HeightField([heights], edge),
        "baked": Texture([baked], edge),
        "settings": values,
    }
    planes = engine.run(program, inputs, (96, 64))
    rays = np.stack([planes[part] for part in ("uv.x", "uv.y", "travel.x", "travel.y")], -1)
    texels = np.linalg.norm(rays[:, :, 2:].astype(float) * heights.shape[::-1], axis=-1).ravel()
    wanted = first_hits(name, edge, rays.tobytes())
    overshoot = ((1.0 - planes["height"].ravel().astype(float)) - wanted) * texels
    return overshoot, planes["found"].ravel() != 0, planes["reads"].ravel()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", maps())
def test_cone_passes_no_hit(cpu, name, edge) -> None:
    """A hit is the first one; a ray that runs out of steps ends before it."""
    for reach in (0.02, 0.3, 3.0):
        for steps in (1, 8, 2048):
            overshoot, found, reads = overshoot_of_rays(cpu, cone, Cones(steps), name, edge, reach)
            assert overshoot.max() < LATE
            assert (np.abs(overshoot[found]) < LATE).all()
            assert reads.max() <= 2 * steps
            if steps == 2048:
                assert found.all()


def test_cone_without_enough_steps_has_no_hit(cpu) -> None:
    overshoot, found, reads = overshoot_of_rays(cpu, cone, Cones(4), "gravel", "wrap", 0.5)
    assert 0.05 < found.mean() < 0.95
    assert (overshoot[~found] < -LATE).mean() > 0.9
    assert reads[~found].min() == 8


@pytest.mark.parametrize(("name", "most"), [
    ("gravel", 0.0), ("bricks", 0.0), ("odd noise", 0.001), ("posts", 0.001), ("saddles", 0.004),
])  # fmt: skip
def test_relaxed_cone_seldom_passes_a_hit(cpu, name, most) -> None:
    """At most the given share of rays end more than half a texel behind the first hit."""
    for reach in (0.3, 1.0):
        steps = RelaxedCones(64, 12)
        overshoot, found, reads = overshoot_of_rays(cpu, relaxed_cone, steps, name, "wrap", reach)
        assert (overshoot > 0.5).mean() <= most
        assert (np.abs(overshoot[found]) < LATE).mean() > 0.99
        assert found.mean() > 0.25
        assert reads.max() <= 1 + 2 * 64 + 12


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["odd noise", "bricks", "seams"])
def test_engines_bake_and_step_equally(cpu, name) -> None:
    from basrelief.engine.gpu import GpuEngine

    gpu = GpuEngine()
    for edge in ("wrap", "clamp"):
        for technique in (cone, relaxed_cone):
            one, other = (
                baked_of(engine, technique.bake, name, edge).astype(int) for engine in (cpu, gpu)
            )
            # rounding may decide whether a surface falls, on which relaxed cones depend
            different = np.abs(one - other) > 1
            assert different.mean() <= (1e-4 if technique is relaxed_cone else 0.0)
        overshoot, found, _ = overshoot_of_rays(gpu, cone, Cones(2048), name, edge, 0.7)
        assert np.abs(overshoot).max() < LATE
        assert found.all()


def test_cone_runs_in_plain_python() -> None:
    heights = np.asarray(maps()["odd noise"], np.float32)
    field, baked = HeightField([heights]), Texture([baking.cone_map(heights, "wrap")])
    uv, travel = np.array([[0.31, 0.64]], np.float32), np.array([[0.4, -0.2]], np.float32)
    hit = cone(field, baked, flat_ray(uv[0], travel[0]), Cones(64))
    assert float(hit.height) == pytest.approx(
        intersect_height_field(heights, uv, travel).height[0], abs=2e-5
    )
