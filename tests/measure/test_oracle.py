"""The oracle against closed forms, and against a brute search along each ray."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basrelief.measure.oracle import first_hits


def bilinear(heights, uv, edge: str) -> np.ndarray:
    """The surface's height at places (n, 2)."""
    rows, columns = heights.shape
    x, y = (uv * [columns, rows] - 0.5).T
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)

    def at(i, j):
        if edge == "wrap":
            return heights[j % rows, i % columns]
        return heights[np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)]

    u, v = x - i, y - j
    upper = at(i, j) * (1 - u) + at(i + 1, j) * u
    lower = at(i, j + 1) * (1 - u) + at(i + 1, j + 1) * u
    return upper * (1 - v) + lower * v


def brute(heights, uv, fall, edge: str, count: int = 40001) -> np.ndarray:
    """The first of many places along each ray that is not above the surface, then halved."""
    found = []
    for start, way in zip(uv, fall, strict=True):
        t = np.linspace(0.0, 1.0, count)
        clear = (1.0 - t) - bilinear(heights, start + way * t[:, None], edge)
        k = int(np.argmax(clear <= 0.0)) if (clear <= 0.0).any() else count - 1
        low, high = t[max(k - 1, 0)], t[k]
        for _ in range(60 if k else 0):
            middle = (low + high) / 2
            above = (1 - middle) > bilinear(heights, (start + way * middle)[None], edge)[0]
            low, high = (middle, high) if above else (low, middle)
        found.append(high)
    return np.array(found)


def rays(seed: int, count: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.random((count, 2)), random.uniform(-reach, reach, (count, 2))


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_a_plane_is_met_at_its_height(edge) -> None:
    uv, fall = rays(1, 50, 3.0)
    hits = first_hits(np.full((5, 7), 0.375), uv, fall, edge)
    np.testing.assert_allclose(hits.t, 0.625, atol=1e-15)
    np.testing.assert_allclose(hits.uv, uv + fall * 0.625, atol=1e-14)
    np.testing.assert_allclose(hits.height, 0.375, atol=1e-15)


def test_a_ramp_is_met_where_two_lines_cross() -> None:
    columns = 64
    u = (np.arange(columns) + 0.5) / columns
    ramp = np.tile(0.2 + 0.6 * u, (9, 1))
    uv = np.array([[0.1, 0.5], [0.6, 0.2], [0.8, 0.5]])
    fall = np.array([[0.3, 0.0], [-0.4, 0.3], [0.05, 0.1]])
    # 1 − t = 0.2 + 0.6 (u + fall t)
    wanted = (0.8 - 0.6 * uv[:, 0]) / (1 + 0.6 * fall[:, 0])
    hits = first_hits(ramp, uv, fall, "clamp")
    np.testing.assert_allclose(hits.t, wanted, atol=1e-14)


def test_a_step_is_met_on_the_slope_between_two_texels() -> None:
    heights = np.zeros((4, 16))
    heights[:, 8:] = 1.0
    # centres of texels 7 and 8 at 7.5/16 and 8.5/16: between them the height rises by 16 a tile
    hits = first_hits(heights, [[0.25, 0.5]], [[0.5, 0.0]], "clamp")
    t = (1 + 16 * (7.5 / 16 - 0.25)) / (1 + 16 * 0.5)
    np.testing.assert_allclose(hits.t, t, atol=1e-14)


def test_straight_down_the_height_is_read() -> None:
    heights = np.random.default_rng(2).random((7, 11))
    uv = np.random.default_rng(3).random((200, 2)) * 3 - 1
    for edge in ("wrap", "clamp"):
        hits = first_hits(heights, uv, np.zeros((200, 2)), edge)
        np.testing.assert_allclose(hits.height, bilinear(heights, uv, edge), atol=1e-12)


def test_a_saddle_hides_what_both_walls_of_a_cell_do_not() -> None:
    """Along a cell's diagonal a saddle rises and falls again between walls that are both lower."""
    heights = np.array([[0.0, 1.0], [1.0, 0.0]])
    # from corner to corner of the one cell: h = 2 s (1 − s), which is ½ in the middle
    uv, fall = np.array([[0.25, 0.25]]), np.array([[0.5, 0.5]])
    t = first_hits(heights, uv - fall * 0.8, fall * 1.6, "clamp").t
    # the ray is at s = (t · 1.6 − 0.8); 1 − t = 2 s (1 − s)
    s = t * 1.6 - 0.8
    np.testing.assert_allclose(1 - t, 2 * s * (1 - s), atol=1e-12)
    assert 0.0 < s[0] < 1.0
    np.testing.assert_allclose(t, brute(heights, uv - fall * 0.8, fall * 1.6, "clamp"), atol=1e-9)


def test_cones_and_waves_are_met_where_the_search_meets_them() -> None:
    y, x = np.mgrid[0:48, 0:64]
    cone = np.clip(1 - np.hypot(x - 30, y - 20) / 18, 0, 1)
    wave = 0.5 + 0.5 * np.sin(2 * np.pi * x / 64 * 3) * np.cos(2 * np.pi * y / 48 * 2)
    for heights in (cone, wave):
        uv, fall = rays(4, 60, 0.8)
        got = first_hits(heights, uv, fall).t
        np.testing.assert_allclose(got, brute(heights, uv, fall, "wrap"), atol=2e-5)


@settings(max_examples=60)
@given(
    st.integers(1, 9), st.integers(1, 9), st.integers(0, 10_000),
    st.sampled_from(["wrap", "clamp"]), st.sampled_from([0.0, 0.1, 2.0]),
)  # fmt: skip
def test_on_noise_nothing_is_met_before_or_after_the_brute_search(h, w, seed, edge, reach) -> None:
    """The search may step over a crest that the oracle meets, never the other way round."""
    random = np.random.default_rng(seed)
    heights = random.random((h, w))
    uv, fall = rays(seed, 12, reach)
    hits = first_hits(heights, uv, fall, edge)
    late = brute(heights, uv, fall, edge, 4001)
    assert (hits.t <= late + 1e-9).all()
    surface = bilinear(heights, hits.uv, edge)
    np.testing.assert_allclose(np.minimum(hits.height - surface, 0.0), 0.0, atol=1e-6)
    # it is on the surface, or at the bottom
    assert ((np.abs(hits.height - surface) < 1e-6) | (hits.t == 1.0)).all()


def test_axis_parallel_rays_along_texel_centres_end() -> None:
    heights = np.random.default_rng(5).random((6, 6)) * 0.5
    centres = (np.arange(6) + 0.5) / 6
    uv = np.stack(np.meshgrid(centres, centres), -1).reshape(-1, 2)
    for way in ([1, 0], [0, -1], [-1, -1]):
        fall = np.broadcast_to(np.array(way, float), uv.shape)
        got = first_hits(heights, uv, fall).t
        np.testing.assert_allclose(got, brute(heights, uv, fall, "wrap"), atol=1e-4)


def test_what_is_no_height_map_is_refused() -> None:
    for heights in ([[0.5, 1.5]], [[np.nan]]):
        with pytest.raises(ValueError):
            first_hits(heights, [[0, 0]], [[0, 0]])
    with pytest.raises(ValueError):
        first_hits([[0.5]], [[0, np.inf]], [[0, 0]])
