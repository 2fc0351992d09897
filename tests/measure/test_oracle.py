"""The oracle against closed forms, and against a brute-force search along each ray."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basrelief.measure import oracle
from basrelief.measure.oracle import intersect_height_field


def bilinear(heights, uv, edge: str) -> np.ndarray:
    """Heights of the bilinear surface at uv, (n, 2)."""
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


def brute_force(heights, uv, travel, edge: str, count: int = 40001) -> np.ndarray:
    """The first of many points along each ray that is not above the surface, then bisection."""
    hits = []
    for start, moved in zip(uv, travel, strict=True):
        t = np.linspace(0.0, 1.0, count)
        clear = (1.0 - t) - bilinear(heights, start + moved * t[:, None], edge)
        k = int(np.argmax(clear <= 0.0)) if (clear <= 0.0).any() else count - 1
        low, high = t[max(k - 1, 0)], t[k]
        for _ in range(60 if k else 0):
            middle = (low + high) / 2
            above = (1 - middle) > bilinear(heights, (start + moved * middle)[None], edge)[0]
            low, high = (middle, high) if above else (low, middle)
        hits.append(high)
    return np.array(hits)


def rays(seed: int, count: int, reach: float) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.random((count, 2)), random.uniform(-reach, reach, (count, 2))


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_the_hit_on_a_plane_has_its_height(edge) -> None:
    uv, travel = rays(1, 50, 3.0)
    hits = intersect_height_field(np.full((5, 7), 0.375), uv, travel, edge)
    np.testing.assert_allclose(hits.t, 0.625, atol=1e-15)
    np.testing.assert_allclose(hits.uv, uv + travel * 0.625, atol=1e-14)
    np.testing.assert_allclose(hits.height, 0.375, atol=1e-15)


def test_the_hit_on_a_ramp_is_where_two_lines_cross() -> None:
    columns = 64
    u = (np.arange(columns) + 0.5) / columns
    ramp = np.tile(0.2 + 0.6 * u, (9, 1))
    uv = np.array([[0.1, 0.5], [0.6, 0.2], [0.8, 0.5]])
    travel = np.array([[0.3, 0.0], [-0.4, 0.3], [0.05, 0.1]])
    # 1 − t = 0.2 + 0.6 (u + travel t)
    expected = (0.8 - 0.6 * uv[:, 0]) / (1 + 0.6 * travel[:, 0])
    hits = intersect_height_field(ramp, uv, travel, "clamp")
    np.testing.assert_allclose(hits.t, expected, atol=1e-14)


def test_the_hit_on_a_step_is_on_the_slope_between_two_texels() -> None:
    heights = np.zeros((4, 16))
    heights[:, 8:] = 1.0
    # centres of texels 7 and 8 at 7.5/16 and 8.5/16: between them the height rises by 16 a tile
    hits = intersect_height_field(heights, [[0.25, 0.5]], [[0.5, 0.0]], "clamp")
    t = (1 + 16 * (7.5 / 16 - 0.25)) / (1 + 16 * 0.5)
    np.testing.assert_allclose(hits.t, t, atol=1e-14)


def test_the_hit_of_a_vertical_ray_has_the_height_below() -> None:
    heights = np.random.default_rng(2).random((7, 11))
    uv = np.random.default_rng(3).random((200, 2)) * 3 - 1
    for edge in ("wrap", "clamp"):
        hits = intersect_height_field(heights, uv, np.zeros((200, 2)), edge)
        np.testing.assert_allclose(hits.height, bilinear(heights, uv, edge), atol=1e-12)


def test_a_saddle_is_hit_inside_its_cell() -> None:
    """Along a cell's diagonal a saddle rises above both walls."""
    heights = np.array([[0.0, 1.0], [1.0, 0.0]])
    # from corner to corner of the one cell: h = 2 s (1 − s), which is ½ in the middle
    uv, travel = np.array([[0.25, 0.25]]), np.array([[0.5, 0.5]])
    t = intersect_height_field(heights, uv - travel * 0.8, travel * 1.6, "clamp").t
    # the ray is at s = (t · 1.6 − 0.8); 1 − t = 2 s (1 − s)
    s = t * 1.6 - 0.8
    np.testing.assert_allclose(1 - t, 2 * s * (1 - s), atol=1e-12)
    assert 0.0 < s[0] < 1.0
    np.testing.assert_allclose(
        t, brute_force(heights, uv - travel * 0.8, travel * 1.6, "clamp"), atol=1e-9
    )


def test_hits_on_cones_and_waves_equal_the_brute_force() -> None:
    y, x = np.mgrid[0:48, 0:64]
    cone = np.clip(1 - np.hypot(x - 30, y - 20) / 18, 0, 1)
    wave = 0.5 + 0.5 * np.sin(2 * np.pi * x / 64 * 3) * np.cos(2 * np.pi * y / 48 * 2)
    for heights in (cone, wave):
        uv, travel = rays(4, 60, 0.8)
        t = intersect_height_field(heights, uv, travel).t
        np.testing.assert_allclose(t, brute_force(heights, uv, travel, "wrap"), atol=2e-5)


@settings(max_examples=60)
@given(
    st.integers(1, 9), st.integers(1, 9), st.integers(0, 10_000),
    st.sampled_from(["wrap", "clamp"]), st.sampled_from([0.0, 0.1, 2.0]),
)  # fmt: skip
def test_hits_on_noise_equal_the_brute_force(h, w, seed, edge, reach) -> None:
    """The search may step over a crest that the oracle hits, never the other way round."""
    random = np.random.default_rng(seed)
    heights = random.random((h, w))
    uv, travel = rays(seed, 12, reach)
    hits = intersect_height_field(heights, uv, travel, edge)
    late = brute_force(heights, uv, travel, edge, 4001)
    assert (hits.t <= late + 1e-9).all()
    surface = bilinear(heights, hits.uv, edge)
    np.testing.assert_allclose(np.minimum(hits.height - surface, 0.0), 0.0, atol=1e-6)
    # the hit is on the surface, or at the bottom
    assert ((np.abs(hits.height - surface) < 1e-6) | (hits.t == 1.0)).all()


def test_axis_parallel_rays_along_texel_centres_end() -> None:
    heights = np.random.default_rng(5).random((6, 6)) * 0.5
    centres = (np.arange(6) + 0.5) / 6
    uv = np.stack(np.meshgrid(centres, centres), -1).reshape(-1, 2)
    for direction in ([1, 0], [0, -1], [-1, -1]):
        travel = np.broadcast_to(np.array(direction, float), uv.shape)
        t = intersect_height_field(heights, uv, travel).t
        np.testing.assert_allclose(t, brute_force(heights, uv, travel, "wrap"), atol=1e-4)


def test_invalid_height_maps_and_rays_are_refused() -> None:
    for heights in ([[0.5, 1.5]], [[np.nan]]):
        with pytest.raises(ValueError):
            intersect_height_field(heights, [[0, 0]], [[0, 0]])
    with pytest.raises(ValueError):
        intersect_height_field([[0.5]], [[0, np.inf]], [[0, 0]])


@settings(max_examples=60)
@given(
    st.integers(1, 9), st.integers(1, 9), st.integers(0, 10_000),
    st.sampled_from(["wrap", "clamp"]), st.sampled_from([0.0, 0.1, 2.0, 1e4]),
    st.sampled_from([0.0, 0.01, 2.0]),
)  # fmt: skip
def test_cells_below_a_ray_and_chunks_change_no_hit(h, w, seed, edge, start, bend) -> None:
    """Bit for bit the hits of a traversal that solves the quadratic of every cell, all at once."""
    random = np.random.default_rng(seed)
    heights = random.random((h, w)) ** 3
    uv, travel = rays(seed, 50, 2.0)
    travel[:5], travel[5:10, 0], travel[10:15, 1] = 0.0, 0.0, -0.0
    coefficients = {
        "height": random.uniform(0.5, 1.2, 50),
        "drop": random.uniform(-0.5, 1.0, 50),
        "bend": random.uniform(-bend, bend, 50),
    }
    hits = intersect_height_field(heights, uv + start, travel, edge, **coefficients)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(oracle, "_CHUNK", 7)
        chunked = intersect_height_field(heights, uv + start, travel, edge, **coefficients)
        patch.setattr(oracle, "_TEXELS_A_RAY", 0)
        solved = intersect_height_field(heights, uv + start, travel, edge, **coefficients)
    for other in (chunked, solved):
        for name, values in vars(hits).items():
            assert values.tobytes() == getattr(other, name).tobytes()


# --- segments: parts of a ray, rising and bent ones --------------------------------------------


def ray_height(t, height: float, drop: float, bend: float):
    return height - drop * t - bend * t * (1 - t)


def first_root(a: float, b: float, c: float) -> float | None:
    """The smallest root within 0 to 1 of a t² + b t + c, in closed form."""
    roots = np.roots([a, b, c])
    within = sorted(r.real for r in roots if abs(r.imag) < 1e-12 and 0.0 <= r.real <= 1.0)
    return within[0] if within else None


PARABOLAS = [
    (1.0, 1.0, 0.0),
    (0.9, 0.45, 0.0),
    (0.9, 0.2, 1.2),
    (0.9, 0.2, -1.2),
    (0.55, -0.3, 0.9),
    (0.7, -0.2, -0.5),
    (0.6, 0.0, 1.0),
]


@pytest.mark.parametrize(("height", "drop", "bend"), PARABOLAS)
def test_the_hit_of_a_parabola_on_a_plane(height: float, drop: float, bend: float) -> None:
    """height − drop t − bend t (1 − t) = ½."""
    expected = first_root(bend, -drop - bend, height - 0.5)
    uv, travel = rays(11, 20, 2.0)
    hits = intersect_height_field(
        np.full((6, 5), 0.5), uv, travel, height=height, drop=drop, bend=bend
    )
    assert (hits.found == (expected is not None)).all()
    np.testing.assert_allclose(hits.t, 1.0 if expected is None else expected, atol=1e-9)
    np.testing.assert_allclose(hits.height, ray_height(hits.t, height, drop, bend), atol=1e-15)


@pytest.mark.parametrize(("height", "drop", "bend"), PARABOLAS)
@pytest.mark.parametrize("along", [0.3, -0.3])
def test_the_hit_of_a_parabola_on_a_ramp(
    height: float, drop: float, bend: float, along: float
) -> None:
    """… = 0.2 + 0.6 (u + travel t)."""
    columns = 64
    ramp = np.tile(0.2 + 0.6 * (np.arange(columns) + 0.5) / columns, (9, 1))
    for u in (0.35, 0.5, 0.65):
        hits = intersect_height_field(
            ramp, [[u, 0.5]], [[along, 0.1]], "clamp", height=height, drop=drop, bend=bend
        )
        over = height - 0.2 - 0.6 * u
        expected = 0.0 if over <= 0.0 else first_root(bend, -drop - bend - 0.6 * along, over)
        assert hits.found[0] == (expected is not None)
        np.testing.assert_allclose(hits.t[0], 1.0 if expected is None else expected, atol=1e-9)


@pytest.mark.parametrize(("height", "drop", "bend"), PARABOLAS)
def test_the_hit_of_a_parabola_on_a_step(height: float, drop: float, bend: float) -> None:
    """Low to the left of u = 7.5 ÷ 16, high to the right of 8.5 ÷ 16, a slope of 16 between."""
    heights = np.full((4, 16), 0.1)
    heights[:, 8:] = 0.8
    hits = intersect_height_field(
        heights, [[0.25, 0.5]], [[0.5, 0.0]], "clamp", height=height, drop=drop, bend=bend
    )

    def surface(t):
        return np.interp(0.25 + 0.5 * t, [7.5 / 16, 8.5 / 16], [0.1, 0.8])

    t = np.linspace(0.0, 1.0, 2_000_001)
    below = ray_height(t, height, drop, bend) <= surface(t)
    assert hits.found[0] == below.any()
    np.testing.assert_allclose(hits.t[0], t[np.argmax(below)] if below.any() else 1.0, atol=1e-6)


def test_consecutive_segments_have_the_hit_of_the_whole_ray() -> None:
    """Of three segments, each continues where the previous one has no hit."""
    heights = np.random.default_rng(6).random((23, 31)) * 0.7
    uv, travel = rays(12, 300, 0.8)
    whole = intersect_height_field(heights, uv, travel)
    t, found = np.ones(len(uv)), np.zeros(len(uv), bool)
    for start in (0.0, 0.25, 0.6):
        length = {0.0: 0.25, 0.25: 0.35, 0.6: 0.4}[start]
        part = intersect_height_field(
            heights, uv + travel * start, travel * length, height=1.0 - start, drop=length
        )
        first = part.found & ~found
        t[first], found = start + length * part.t[first], found | part.found
    np.testing.assert_allclose(t, whole.t, atol=1e-12)


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.sampled_from([0.1, 2.0]), st.floats(-1.5, 1.5))
def test_hits_of_bent_rays_on_noise_equal_the_brute_force(
    seed: int, reach: float, bend: float
) -> None:
    random = np.random.default_rng(seed)
    heights = random.random((7, 9)) * 0.8
    uv, travel = rays(seed, 12, reach)
    height, drop = random.uniform(0.5, 1.0, 12), random.uniform(-0.5, 1.0, 12)
    hits = intersect_height_field(heights, uv, travel, height=height, drop=drop, bend=bend)
    t = np.linspace(0.0, 1.0, 20001)
    for k in range(12):
        clear = ray_height(t, height[k], drop[k], bend) - bilinear(
            heights, uv[k] + travel[k] * t[:, None], "wrap"
        )
        late = t[np.argmax(clear <= 0.0)] if (clear <= 0.0).any() else 1.0
        assert hits.t[k] <= late + 1e-9
        if hits.found[k] and hits.t[k] > 0.0:
            surface = bilinear(heights, hits.uv[k : k + 1], "wrap")[0]
            assert abs(hits.height[k] - surface) < 1e-6
