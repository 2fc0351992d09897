"""Bakes against closed forms and brute force in float64, at odd, 1-pixel and non-square sizes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from basrelief import baking
from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.material import sample

EDGES = ("wrap", "clamp")
MOST = 65535
sizes = st.tuples(st.integers(1, 11), st.integers(1, 11))


def rough(shape: tuple[int, int], seed: int) -> np.ndarray:
    """Random heights with flat parts and spikes."""
    random = np.random.default_rng(seed)
    heights = random.random(shape) ** random.integers(1, 5)
    return np.where(random.random(shape) < 0.3, 0.25, heights).astype(np.float32)


def surface(heights: np.ndarray, x: np.ndarray, y: np.ndarray, edge: str) -> np.ndarray:
    """Bilinear surface in float64, at (x, y) in texels from the first texel centre."""
    rows, columns = heights.shape
    heights = heights.astype(float)
    left, up = np.floor(x), np.floor(y)

    def at(i, j):
        i, j = i.astype(int), j.astype(int)
        if edge == "wrap":
            return heights[j % rows, i % columns]
        return heights[np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)]

    a, b = x - left, y - up
    top = at(left, up) * (1 - a) + at(left + 1, up) * a
    return top * (1 - b) + (at(left, up + 1) * (1 - a) + at(left + 1, up + 1) * a) * b


def steepest_slopes(heights: np.ndarray, edge: str, k: int, count: int, reach: float, step=1 / 8):
    """Largest slope from every texel along a direction, in heights per texel, by brute force."""
    angle = 2 * math.pi * k / count
    dx, dy = round(math.cos(angle), 12), -round(math.sin(angle), 12)
    y, x = np.indices(heights.shape).astype(float)
    best = np.zeros(heights.shape)
    # a tiny step for the slope at the texel itself, then all cell walls and points between
    walls = [n / abs(d) for d in (dx, dy) if d for n in range(1, int(reach) + 1)]
    for s in [1e-6, *(w for w in walls if w <= reach), *np.arange(step, reach, step)]:
        rise = surface(heights, x + dx * s, y + dy * s, edge) - heights
        best = np.maximum(best, np.where(rise > 1e-12, rise / s, 0.0))
    return best


def sine(tangent):
    return tangent / np.sqrt(1 + tangent * tangent)


# --- horizons -------------------------------------------------------------------------------------


def assert_horizon(
    heights: np.ndarray, edge: str, count: int, k: int, reach: float, device="cpu"
) -> None:
    scale = 0.4
    rise = scale * heights.shape[1]
    stored = baking.horizon_map(heights, edge, scale, count, device)[:, :, k] / MOST
    expected = steepest_slopes(heights, edge, k, count, reach)
    least = sine(np.maximum(expected - 1e-6, 0) * rise)
    assert (stored >= least).all(), f"too low by {(least - stored).max()}"
    # brute force misses the peaks of parabolas; a truncated line may add what could rise beyond
    far = (heights.max() - heights) / reach
    most = sine(np.maximum(expected * 1.03 + 2e-3, far) * rise) + 2 / MOST
    assert (stored <= most).all(), f"too high by {(stored - most).max()}"


@settings(max_examples=25)
@given(sizes, st.sampled_from(EDGES), st.integers(0, 7), st.integers(0, 1000))
def test_horizons_are_never_too_low(shape, edge, k, seed) -> None:
    repeats = math.lcm(*shape) * 1.5
    assert_horizon(rough(shape, seed), edge, 8, k, min(repeats, 8 * max(shape)) + 1)


@pytest.mark.gpu
@settings(max_examples=20)
@given(sizes, st.sampled_from(EDGES), st.integers(0, 7), st.integers(0, 1000))
@example((1, 1), "wrap", 0, 1)
@example((1, 11), "clamp", 4, 1)
@example((9, 1), "wrap", 2, 1)
def test_horizons_of_a_gpu_are_never_too_low(shape, edge, k, seed) -> None:
    reach = min(math.lcm(*shape) * 1.5, 8 * max(shape)) + 1
    assert_horizon(rough(shape, seed), edge, 8, k, reach, choose_device("gpu"))


@settings(max_examples=10)
@given(sizes, st.sampled_from(EDGES), st.integers(0, 11), st.integers(0, 1000))
def test_horizons_in_oblique_directions_are_never_too_low(shape, edge, k, seed) -> None:
    assert_horizon(rough(shape, seed), edge, 12, k, 8.0 * max(shape))


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("k", [0, 3, 6])
def test_skipped_blocks_hide_nothing(edge: str, k: int) -> None:
    """Posts on a map of several large blocks, with sides that are not multiples of a block."""
    heights = rough((71, 133), 5) * np.float32(0.1)
    random = np.random.default_rng(9)
    heights[random.integers(0, 71, 9), random.integers(0, 133, 9)] = random.random(9)
    rise = 0.4 * 133
    stored = baking.horizon_map(heights, edge, 0.4)[:, :, k] / MOST
    expected = steepest_slopes(heights, edge, k, 8, 290.0, step=1000.0)
    assert (stored >= sine(np.maximum(expected - 1e-6, 0) * rise)).all()


def test_the_horizon_of_a_wall() -> None:
    """atan(height · scale ÷ distance) towards the wall, 0 away from it; direction 2 is up."""
    rows, columns, scale, wall = 32, 48, 0.2, 20
    heights = np.zeros((rows, columns), np.float32)
    heights[:, wall] = 0.75
    made = baking.horizon_map(heights, "clamp", scale)
    away = np.arange(1, 21)
    angle = np.arctan(0.75 * scale * columns / away)
    towards = made[5, wall - away, 0]
    np.testing.assert_allclose(towards, np.sin(angle) * MOST, atol=2)
    assert (made[:, :wall, 4] == 0).all()
    np.testing.assert_allclose(made[5, wall + away, 4], np.sin(angle) * MOST, atol=2)
    diagonal = np.sin(np.arctan(0.75 * scale * columns / (away * math.sqrt(2))))
    np.testing.assert_allclose(made[31, wall - away[:9], 1], diagonal[:9] * MOST, atol=2)
    lying = baking.horizon_map(heights.T, "clamp", scale)
    up = np.arctan(0.75 * scale * rows / away)
    np.testing.assert_allclose(lying[wall + away, 5, 2], np.sin(up) * MOST, atol=2)
    assert (lying[wall + 1 :, :, 6] == 0).all()


@pytest.mark.parametrize("edge", EDGES)
def test_flat_heights_have_no_horizon_and_no_occlusion(edge: str) -> None:
    for shape in ((1, 1), (3, 70), (7, 1)):
        flat = np.full(shape, 0.3, np.float32)
        assert (baking.horizon_map(flat, edge, 0.5, 12) == 0).all()
        np.testing.assert_allclose(baking.ambient_occlusion(flat, edge, 0.5), 1.0, atol=1e-6)
        assert (baking.normal_map(flat, edge, 0.5) == [0, 0, 1]).all()


def test_the_horizon_of_a_ramp() -> None:
    ramp = np.repeat(np.linspace(0, 1, 40, dtype=np.float32)[None], 9, 0)
    made = baking.horizon_map(ramp, "clamp", 0.25)
    slope = 0.25 * 40 / 39
    np.testing.assert_allclose(made[:, 1:-1, 0], sine(slope) * MOST, atol=3)
    assert (made[:, :, 4] == 0).all()


# --- ambient occlusion -------------------------------------------------------------------------


def disc(side: int, radius: float) -> np.ndarray:
    y, x = np.indices((side, side)) - side // 2
    return np.hypot(x, y) / radius


def test_occlusion_in_the_middle_of_a_round_pit() -> None:
    """cos² of the elevation of the rim."""
    side, radius, scale = 81, 30.0, 0.25
    heights = (disc(side, radius) >= 1).astype(np.float32)
    occlusion = baking.ambient_occlusion(heights, "clamp", scale, 64)[side // 2, side // 2]
    depth = scale * side
    assert occlusion == pytest.approx(radius**2 / (radius**2 + depth**2), abs=0.015)


def test_occlusion_is_constant_in_a_spherical_bowl() -> None:
    """1 − depth ÷ 2R at every point of a bowl in a sphere of radius R."""
    side, rim, depth = 121, 50.0, 20.0
    sphere = (rim**2 + depth**2) / (2 * depth)
    away = np.minimum(disc(side, 1.0), rim)
    raised = depth - sphere + (sphere - np.sqrt(sphere**2 - away**2))
    heights = ((raised - raised.min()) / np.ptp(raised)).astype(np.float32)
    occlusion = baking.ambient_occlusion(heights, "clamp", depth / side, 32)
    inside = disc(side, rim) < 0.8
    np.testing.assert_allclose(occlusion[inside], 1 - depth / (2 * sphere), atol=0.015)


def test_occlusion_of_a_slope() -> None:
    """(1 + cos) ÷ 2 for an infinite slope: in the middle of a long ramp."""
    ramp = np.repeat(np.linspace(0, 1, 200, dtype=np.float32)[None], 3, 0)
    occlusion = baking.ambient_occlusion(ramp, "clamp", 0.5, 64)[1, 100]
    tilt = math.atan(0.5 * 200 / 199)
    assert occlusion == pytest.approx((1 + math.cos(tilt)) / 2, abs=0.005)


# --- normals and heights --------------------------------------------------------------------------


@settings(max_examples=30)
@given(sizes, st.sampled_from(EDGES), st.integers(0, 1000))
def test_heights_from_normals_give_these_normals(shape, edge, seed) -> None:
    normals = baking.normal_map(rough(shape, seed), edge, 0.1)
    integrated = baking.height_map(normals, edge)
    again = baking.normal_map(integrated.heights, edge, integrated.scale)
    np.testing.assert_allclose(again, normals, atol=3e-3)
    assert integrated.residual < 0.2


@pytest.mark.parametrize("edge", EDGES)
def test_heights_are_recovered_from_their_normals(edge: str) -> None:
    gravel = sample("gravel", (96, 128))
    heights = gravel.height.linear()[:, :, 0]
    integrated = baking.height_map(baking.normal_map(heights, edge, gravel.scale), edge)
    height_range = float(np.ptp(heights))
    expected = (heights - heights.min()) / height_range
    assert integrated.scale == pytest.approx(gravel.scale * height_range, rel=0.01)
    np.testing.assert_allclose(integrated.heights, expected, atol=0.01)


def test_the_residual_of_a_swirl() -> None:
    y, x = (np.indices((32, 48)) - 16) / 32
    swirl = np.stack([y, x, np.ones_like(x)], -1)
    integrated = baking.height_map(swirl / np.linalg.norm(swirl, axis=2)[..., None], "clamp")
    assert integrated.residual > 5
    assert integrated.heights.shape == (32, 48)


def test_flat_normals_give_flat_heights() -> None:
    integrated = baking.height_map(np.broadcast_to(np.float32([0, 0, 1]), (5, 3, 3)), "wrap")
    assert (integrated.heights == 0).all()
    assert (integrated.scale, integrated.residual) == (0.0, 0.0)


def test_the_normals_of_a_scan_give_its_heights(rock058: Path) -> None:
    import basrelief

    rock = basrelief.load(rock058)
    integrated = baking.height_map(rock.normal.linear() * 2 - 1, "wrap")
    heights = rock.height.linear()[:, :, 0]
    assert np.corrcoef(integrated.heights.ravel(), heights.ravel())[0, 1] > 0.97


# --- both engines, and bad input ------------------------------------------------------------------


@pytest.mark.gpu
@pytest.mark.parametrize("edge", EDGES)
def test_engines_bake_equal_tables(edge: str) -> None:
    heights = sample("gravel", (40, 72)).height.linear()[:, :, 0]
    gpu = choose_device("gpu")
    difference = baking.normal_map(heights, edge, 0.1) - baking.normal_map(heights, edge, 0.1, gpu)
    assert np.abs(difference).max() < 1e-6
    ours = baking.horizon_map(heights, edge, 0.1).astype(int)
    assert np.abs(ours - baking.horizon_map(heights, edge, 0.1, 8, gpu)).max() <= 2
    occlusion = baking.ambient_occlusion(heights, edge, 0.1)
    np.testing.assert_allclose(
        baking.ambient_occlusion(heights, edge, 0.1, 16, gpu), occlusion, atol=1e-4
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros((2, 2, 1)), "wrap", 0.1), "rows, columns"),
        ((np.zeros((0, 2)), "wrap", 0.1), "rows, columns"),
        ((np.full((2, 2), 1.5), "wrap", 0.1), "within 0 to 1"),
        ((np.full((2, 2), np.nan), "wrap", 0.1), "finite"),
        ((np.zeros((2, 2)), "clip", 0.1), "wrap or clamp, not clip"),
        ((np.zeros((2, 2)), "wrap", -1.0), "not -1"),
        ((np.zeros((2, 2)), "wrap", math.inf), "not inf"),
    ],
)
@pytest.mark.parametrize("bake", [baking.normal_map, baking.horizon_map, baking.ambient_occlusion])
def test_invalid_arguments_are_refused(bake, arguments, message: str) -> None:
    with pytest.raises(InputError, match=message):
        bake(*arguments)


def test_invalid_normals_are_refused() -> None:
    for normals, edge, message in (
        (np.zeros((2, 2)), "wrap", "rows, columns, 3"),
        (np.full((2, 2, 3), np.inf), "wrap", "infinite"),
        (np.zeros((2, 2, 3)), "clip", "not clip"),
    ):
        with pytest.raises(InputError, match=message):
            baking.height_map(normals, edge)
    with pytest.raises(InputError, match="at least one direction"):
        baking.horizon_map(np.zeros((2, 2)), "wrap", 0.1, 0)
