"""Techniques, run as plain Python on surfaces whose hit is known in closed form.

A function replaces the reads of the height field and records their positions; the ray's height at
a position is computed from the ray.
"""

from __future__ import annotations

import contextlib
import importlib
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Mat3, Texture, Vec2, Vec3, bound, shader
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.lang.types import leaf_values
from basrelief.scene import LookAt, Object
from basrelief.shading.intersection import Intersection, Placement
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.relief import (
    ReliefHit,
    ReliefParameters,
    offset_per_height,
    relief_ray,
    trace_relief,
)
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.shapes import FAR, ShapeRay
from basrelief.shading.tangent_frame import TangentFrame
from basrelief.shading.variant import Variant
from basrelief.techniques import (
    TECHNIQUES,
    Hit,
    Nothing,
    Ray,
    contact,
    displace,
    fixed_length,
    flat,
    offset,
    offset_limited,
    parallax_occlusion,
    projection,
    relief,
    secant,
    steep,
    texel,
)
from basrelief.techniques.height import Smoothing
from basrelief.techniques.march import (
    MAX_READS,
    FixedLength,
    LastStep,
    March,
    Relief,
    Steps,
    chord,
    step_count,
    steps_by_angle,
)
from basrelief.techniques.offset import Offset
from basrelief.techniques.ray import at, t_at
from basrelief.techniques.refine import Contact, Secant
from basrelief.techniques.technique import Settings
from helpers.rays import flat_ray
from helpers.synthetic import drawn, uniform_material

Surface = Callable[[float, float], float]
"""A height for every u and v, in float64."""

ROUNDING = 3e-6
"""Rounding error of float32 in texture coordinates and heights near 1."""

MODULES = [
    importlib.import_module(f"basrelief.techniques.{name}")
    for name in ("march", "offset", "refine")
]
EMPTY = HeightField([np.zeros((1, 1))])
UNBAKED = Texture([np.zeros((1, 1, 4), np.uint16)])


@contextlib.contextmanager
def surface(form: Surface) -> Iterator[list[tuple[float, float]]]:
    """Context in which techniques read a closed form; yields the list of positions read."""
    places: list[tuple[float, float]] = []

    def read(field: HeightField, ray: Ray, t: float) -> np.float32:
        uv = at(ray, t)
        places.append((float(uv.x), float(uv.y)))
        return np.float32(form(float(uv.x), float(uv.y)))

    with pytest.MonkeyPatch.context() as patch:
        for module in MODULES:
            patch.setattr(module, "height_under", read)
        yield places


def ray_of(
    uv=(0.31, 0.64), travel=(-0.25, 0.125), reference_height: float = 1.0, cosine: float = 0.5
) -> Ray:
    return flat_ray(uv, travel, reference_height, cosine)


def traced(technique, form: Surface, ray: Ray, settings) -> tuple[Hit, list[float]]:
    """The hit, and the ray's height at each position read."""
    with surface(form) as places:
        hit = technique(EMPTY, ray, settings)
    assert hit.reads == len(places)
    return hit, [height_on(ray, place) for place in places]


def height_on(ray: Ray, place) -> float:
    """The ray's height at a position on it."""
    travel = np.array([*ray.travel], np.float64)
    moved = np.array(place) - np.array([*ray.uv], np.float64)
    t = moved @ travel / (travel @ travel)
    np.testing.assert_allclose(moved, travel * t, atol=1e-6)
    return float(1.0 - t)


def position_at(ray: Ray, height: float) -> np.ndarray:
    """The texture coordinates of the ray at a height, in float64."""
    uv, travel = (np.array([*v], np.float64) for v in (ray.uv, ray.travel))
    return uv + travel * (1.0 - height)


def assert_ends(hit: Hit, ray: Ray, height: float, tolerance: float = ROUNDING) -> None:
    """Assert that the hit is the point of the ray at a height."""
    assert hit.t == pytest.approx(1.0 - height, abs=tolerance)
    assert hit.height == pytest.approx(height, abs=tolerance)
    length = max(abs(float(component)) for component in ray.travel)
    wanted = position_at(ray, height)
    np.testing.assert_allclose([*hit.uv], wanted, atol=tolerance * max(length, 1.0) + ROUNDING)


def constant_surface(height: float) -> Surface:
    return lambda u, v: height


def all_techniques(steps: int = 10):
    """Techniques that are tested here, with settings that take `steps` steps."""
    return [
        pytest.param(technique, settings, id=technique.name)
        for technique, settings in (
            (flat, Nothing()),
            (offset, Offset()),
            (offset_limited, Offset()),
            (steep, Steps(steps)),
            (parallax_occlusion, March(steps, steps)),
            (relief, Relief(steps, steps, 12)),
            (secant, Secant(steps, steps, 3)),
            (contact, Contact(steps, steps)),
            (fixed_length, FixedLength(400, 0.01)),
        )
    ]


MARCHES_TO_BASE = [
    (parallax_occlusion, lambda n: March(n, n)),
    (relief, lambda n: Relief(n, n, 0)),
    (secant, lambda n: Secant(n, n, 0)),
]
MARCHING = [
    pytest.param(steep, Steps, id="steep"),
    *(pytest.param(technique, steps, id=technique.name) for technique, steps in MARCHES_TO_BASE),
]


def test_every_technique_is_tested_here() -> None:
    """Except those with a bake, in `test_exact.py` and `test_cones.py`, and `texel`, which hits
    columns."""
    tested_elsewhere = {texel, *(t for t in TECHNIQUES.values() if t.bake is not None)}
    assert {p.values[0] for p in all_techniques()} == set(TECHNIQUES.values()) - tested_elsewhere


# --- the ray --------------------------------------------------------------------------------------


@pytest.mark.parametrize("reference_height", [0.0, 0.5, 1.0])
def test_the_reference_height_is_the_height_on_the_polygon(reference_height: float) -> None:
    ray = ray_of(uv=(0.25, 0.5), travel=(-0.5, 0.25), reference_height=reference_height)
    assert [*at(ray, t_at(ray, reference_height))] == [0.25, 0.5]
    np.testing.assert_allclose(
        [*at(ray, 0.0)], [0.25 + 0.5 * (1 - reference_height), 0.5 - 0.25 * (1 - reference_height)]
    )
    np.testing.assert_allclose(
        [*at(ray, 1.0)], [0.25 - 0.5 * reference_height, 0.5 + 0.25 * reference_height]
    )


@pytest.mark.parametrize(("technique", "steps"), MARCHING)
@pytest.mark.parametrize("reference_height", [0.0, 0.5, 1.0])
def test_marches_start_at_the_top_for_every_reference_height(
    technique, steps, reference_height
) -> None:
    """H6: for a reference height below 1 the start is before the polygon."""
    ray = ray_of(reference_height=reference_height)
    with surface(constant_surface(1.0)) as places:
        hit = technique(EMPTY, ray, steps(8))
    assert len(places) == 1
    np.testing.assert_allclose(places[0], position_at(ray, 1.0), atol=ROUNDING)
    assert_ends(hit, ray, 1.0)


# --- constant height ------------------------------------------------------------------------------


@given(
    st.integers(1, 10),
    st.sampled_from([0.0, 0.5, 1.0]),
    st.tuples(st.floats(-0.7, 0.7), st.floats(-0.7, 0.7)),
)
def test_every_technique_finds_a_plane(tenths: int, reference_height: float, travel) -> None:
    """At the height of each of ten layers; `steep` stops on it, `flat` stays on the polygon."""
    height = tenths / 10
    assume(max(map(abs, travel)) > 0.01)
    ray = ray_of(travel=travel, reference_height=reference_height)
    for technique, settings in ((p.values[0], p.values[1]) for p in all_techniques(10)):
        # just above the layer, so that rounding cannot put it below
        hit, _ = traced(technique, constant_surface(height + 1e-5), ray, settings)
        if technique is flat:
            assert_ends(hit, ray, reference_height)
            assert hit.reads == 0
        else:
            assert_ends(hit, ray, height, 1e-4)
        assert hit.found


@given(st.floats(0, 1), st.integers(1, 40))
def test_steep_stops_at_the_first_layer_below_the_surface(height: float, steps: int) -> None:
    layers = [1 - k / steps for k in range(steps)]
    assume(all(abs(layer - height) > 1e-6 for layer in layers))
    below = [layer for layer in layers if layer <= height]
    ray = ray_of()
    hit, read = traced(steep, constant_surface(height), ray, Steps(steps))
    assert_ends(hit, ray, below[0] if below else layers[-1])
    assert hit.found == bool(below)
    assert hit.reads == len(layers) - len(below) + bool(below)
    np.testing.assert_allclose(read, layers[: hit.reads], atol=ROUNDING * 10)


@given(st.floats(0, 1), st.integers(1, 60), st.integers(0, 16))
def test_relief_ends_within_its_last_halving(height: float, steps: int, halvings: int) -> None:
    ray = ray_of()
    hit, _ = traced(relief, constant_surface(height), ray, Relief(steps, steps, halvings))
    assert hit.found
    assert abs(float(hit.height) - height) <= 1 / steps / 2**halvings + ROUNDING


# --- the march ------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 7, 10, 49, 100])
def test_steep_reads_at_one_less_k_nths_and_ends_at_the_last(count) -> None:
    """C11: no hit on a surface at height 0; N reads, and the last position remains."""
    ray = ray_of(reference_height=0.5)
    hit, read = traced(steep, constant_surface(0.0), ray, Steps(count))
    np.testing.assert_allclose(read, [1 - k / count for k in range(count)], atol=1e-5)
    assert hit.reads == count
    assert not hit.found
    assert_ends(hit, ray, 1 / count)


@pytest.mark.parametrize("count", [1, 2, 7, 10, 49, 100])
@pytest.mark.parametrize(
    ("technique", "steps", "reads_base"),
    [(technique, steps, technique is parallax_occlusion) for technique, steps in MARCHES_TO_BASE],
)
def test_the_base_is_under_every_surface(technique, steps, reads_base: bool, count) -> None:
    """A surface at height 0 is hit at t = 1 exactly, which rounding of N · 1/N must not miss: with
    a read there, or without."""
    ray = ray_of(reference_height=0.5)
    hit, read = traced(technique, constant_surface(0.0), ray, steps(count))
    np.testing.assert_allclose(read, [1 - k / count for k in range(count + reads_base)], atol=1e-5)
    assert (hit.found, float(hit.t), float(hit.height)) == (True, 1.0, 0.0)


@pytest.mark.parametrize(("technique", "steps"), MARCHING)
def test_a_march_stops_at_its_hit(technique, steps) -> None:
    hit, read = traced(technique, constant_surface(0.66), ray_of(), steps(10))
    np.testing.assert_allclose(read, [1.0, 0.9, 0.8, 0.7, 0.6], atol=1e-5)
    assert hit.reads == 5


def test_by_default_steep_takes_ten_steps() -> None:
    assert Steps().steps == 10


@pytest.mark.parametrize("count", [0, -3, MAX_READS + 1, 2**31 - 1])
def test_the_steps_of_a_march_are_clamped_to_1_and_max_reads(count: int) -> None:
    hit, _ = traced(steep, constant_surface(0.0), ray_of(), Steps(count))
    assert hit.reads == (1 if count < 1 else MAX_READS)


@pytest.mark.parametrize(("technique", "steps"), MARCHING)
def test_few_steps_miss_a_thin_ridge_and_many_hit_it(technique, steps) -> None:
    def ridge(u: float, v: float) -> float:
        return 0.8 if abs(u - 0.47) < 0.01 else 0.0

    # the ray crosses the ridge at height 0.4
    ray = ray_of(uv=(0.77, 0.5), travel=(-0.5, 0.1))
    few, _ = traced(technique, ridge, ray, steps(4))
    many, _ = traced(technique, ridge, ray, steps(64))
    # the base is hit instead
    assert_ends(few, ray, 0.25 if technique is steep else 0.0)
    assert few.found == (technique is not steep)
    assert many.found
    assert float(many.height) == pytest.approx(0.4, abs=0.04)


@pytest.mark.parametrize(
    ("technique", "within"),
    [
        ("parallax_occlusion", 0.0), ("secant", 0.0), ("exact", 0.0), ("cone", 0.0),
        ("fixed_length", 0.0), ("relief", 1 / 15 / 2**5), ("contact", 1 / 7 / 7),
    ],
)  # fmt: skip
def test_the_ground_of_an_empty_map_is_at_the_full_depth(technique: str, within: float) -> None:
    """Zeros at 45° and scale 0.1: the ray travels 0.1 tiles and is 0.1 · √2 long. `relief` and
    `contact`, of 15 and 7 steps, are within their last interval."""
    camera = LookAt((0.5, 0.0, 0.5), up=(0.0, 0.0, 1.0), orthographic_height=0.4)
    frame, polygon = (
        drawn(
            Object(uniform_material(height=0.0), technique=name, scale=0.1, transform=np.eye(4)),
            camera=camera,
        )
        for name in (technique, "flat")
    )
    assert frame.hit.all()
    shift = frame.uv.astype(np.float64) - polygon.uv
    np.testing.assert_allclose(shift[..., 0], -0.1, atol=0.1 * within + 2e-6)
    np.testing.assert_allclose(shift[..., 1], 0.0, atol=2e-6)
    np.testing.assert_allclose(
        frame.distance - polygon.distance, 0.1 * math.sqrt(2), atol=0.15 * within + 2e-6
    )


# --- ramps ----------------------------------------------------------------------------------------


@st.composite
def ramps(draw):
    """A ramp h = c + a·u + b·v, a ray, the height of its hit, and the slope along the ray."""
    slope_u, slope_v = (draw(st.floats(-1.5, 1.5)) for _ in range(2))
    uv, travel = (tuple(draw(st.floats(-0.6, 0.6)) for _ in range(2)) for _ in range(2))
    assume(max(map(abs, travel)) > 0.05)
    reference_height = draw(st.sampled_from([0.0, 0.5, 1.0]))
    height = draw(st.floats(0.02, 0.95))
    ray = ray_of(uv, travel, reference_height)
    u, v = position_at(ray, height)

    def ramp(x: float, y: float) -> float:
        return height + slope_u * (x - u) + slope_v * (y - v)

    # rise of the surface while the ray falls by 1; above −1 there is one hit
    rising = slope_u * float(ray.travel.x) + slope_v * float(ray.travel.y)
    assume(rising > -0.9)
    return ramp, ray, height, rising


@given(ramps(), st.integers(10, 50))
def test_parallax_occlusion_is_exact_on_a_ramp(ramp, steps: int) -> None:
    """C12, G6: the chord of a ramp is the ramp itself, for any number of steps."""
    form, ray, height, _ = ramp
    hit, _ = traced(parallax_occlusion, form, ray, March(steps, steps))
    assert hit.found
    assert_ends(hit, ray, height, 5e-5)


@given(ramps(), st.integers(50, 90))
def test_steep_is_less_than_a_step_below_a_ramp(ramp, steps: int) -> None:
    form, ray, height, _ = ramp
    hit, _ = traced(steep, form, ray, Steps(steps))
    assert hit.found
    assert height - 1 / steps - 1e-4 <= float(hit.height) <= height + 1e-4
    assert_ends(hit, ray, float(hit.height))


@given(ramps(), st.integers(10, 50), st.integers(0, 12))
def test_relief_is_within_its_last_halving_of_a_ramp(ramp, steps: int, halvings: int) -> None:
    form, ray, height, _ = ramp
    hit, _ = traced(relief, form, ray, Relief(steps, steps, halvings))
    assert hit.found
    assert abs(float(hit.height) - height) <= 1 / steps / 2**halvings + 1e-4
    assert_ends(hit, ray, float(hit.height))


@given(ramps())
def test_an_offset_reads_the_height_at_the_polygon(ramp) -> None:
    form, ray, _, _ = ramp
    hit, _ = traced(offset, form, ray, Offset())
    start = position_at(ray, float(ray.reference_height))
    first = form(*start)
    moved = np.clip(
        np.array([*ray.travel], np.float64) * (float(ray.reference_height) - first), -1, 1
    )
    np.testing.assert_allclose([*hit.uv], start + moved, atol=1e-5)
    assert hit.reads == 1


def test_the_hit_on_a_height_field_equals_that_on_its_closed_form() -> None:
    """A ramp along u and v, stored in a map that is not square."""
    columns, rows = 48, 20
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    field = HeightField([0.5 + 0.6 * (u - 0.5) - 0.3 * (v - 0.5)], "clamp")
    ray = ray_of(uv=(0.6, 0.55), travel=(0.15, -0.2), reference_height=0.5)
    # 0.5 + 0.6 (u − ½) − 0.3 (v − ½) = h with (u, v) = (0.6 + 0.15 d, 0.55 − 0.2 d), d = 0.5 − h
    d = (0.5 - (0.5 + 0.6 * 0.1 - 0.3 * 0.05)) / (1 + 0.6 * 0.15 + 0.3 * 0.2)
    hit = parallax_occlusion(field, ray, March(10, 10))
    assert_ends(hit, ray, 0.5 - d, 1e-5)


# --- a step ---------------------------------------------------------------------------------------


def cliff(u: float, v: float) -> float:
    """High on the left, low on the right."""
    return 0.9 if u < 0.5 else 0.125


def test_a_ray_towards_the_cliff_hits_its_wall() -> None:
    """It crosses u = ½ at height 0.6, between the wall's foot and top."""
    ray = ray_of(uv=(0.7, 0.4), travel=(-0.5, 0.25))
    hit, _ = traced(relief, cliff, ray, Relief(16, 16, 10))
    assert hit.found
    assert_ends(hit, ray, 0.6, 1 / 16 / 2**10 + 1e-5)
    stopped, _ = traced(steep, cliff, ray, Steps(16))
    assert_ends(stopped, ray, 0.5625)
    # the chord between (0.625, surface 0.125) and (0.5625, surface 0.9): ½ ÷ (½ + 0.3375) down
    cut, _ = traced(parallax_occlusion, cliff, ray, March(16, 16))
    assert_ends(cut, ray, 0.625 - 0.0625 * 0.5 / (0.5 + 0.3375), 1e-5)


def test_a_ray_away_from_the_cliff_hits_the_ground_behind_it() -> None:
    ray = ray_of(uv=(0.45, 0.4), travel=(0.5, 0.25))
    hit, _ = traced(relief, cliff, ray, Relief(64, 64, 10))
    assert_ends(hit, ray, 0.125, 1e-4)
    assert float(hit.uv.x) == pytest.approx(0.45 + 0.5 * 0.875, abs=1e-4)


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2), st.floats(0, 1))
def test_interpolation_factors_stay_within_the_step(high, ground, before, low, step) -> None:
    """The chord's hit lies between the last two layers for every surface."""
    t = chord(LastStep(1.0 - high + step, high - step - low, 1.0 - high, high - before, step, 2))
    assert high - step - 1e-5 <= 1.0 - float(t) <= high + 1e-5


# --- the binary search ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("height", "wanted"),
    [
        (0.6, [1.0, 0.5, 0.75, 0.625, 0.5625, 0.59375]),
        (0.55, [1.0, 0.5, 0.75, 0.625, 0.5625, 0.53125]),
        (0.8, [1.0, 0.5, 0.75, 0.875, 0.8125, 0.78125]),
    ],
)
def test_the_search_halves_the_range(height: float, wanted: list[float]) -> None:
    """C13: the last step is from 1 to ½; then its middle is read, then the middle of a half, …"""
    hit, read = traced(relief, constant_surface(height), ray_of(), Relief(2, 2, 4))
    assert read == pytest.approx(wanted, abs=1e-5)
    assert hit.reads == 6


TOP_HITS = [
    pytest.param(relief, Relief(4, 4, 5), id="relief"),
    pytest.param(secant, Secant(4, 4, 5), id="secant"),
    pytest.param(contact, Contact(4, 4), id="contact"),
]


@pytest.mark.parametrize(("technique", "settings"), TOP_HITS)
def test_a_hit_on_the_first_read_is_at_the_top(technique, settings) -> None:
    """It has no layer above the surface before it, so no step to search."""
    hit, read = traced(technique, constant_surface(1.0), ray_of(), settings)
    assert read == [1.0]
    assert_ends(hit, ray_of(), 1.0)
    assert hit.found


@pytest.mark.parametrize(
    ("height", "wanted"),
    [(0.0, [0.125, 0.0625, 0.03125]), (0.1, [0.125, 0.0625, 0.09375]), (0.2, [0.125, 0.1875])],
)
def test_below_the_last_layer_relief_halves_the_step_to_the_base(height, wanted) -> None:
    """Four layers, the last at ¼: the middle of ¼ … 0 is read next."""
    hit, read = traced(relief, constant_surface(height), ray_of(), Relief(4, 4, len(wanted)))
    assert read == pytest.approx([1.0, 0.75, 0.5, 0.25, *wanted], abs=1e-6)
    assert hit.found
    assert abs(float(hit.height) - height) <= 0.25 / 2 ** len(wanted) + ROUNDING


def test_the_search_starts_in_the_middle_of_the_last_step() -> None:
    hit, read = traced(relief, constant_surface(0.7), ray_of(), Relief(4, 4, 3))
    assert read == pytest.approx([1.0, 0.75, 0.5, 0.625, 0.6875, 0.71875], abs=1e-5)
    assert float(hit.height) in (pytest.approx(0.703125, abs=0.017), 0.71875)


def test_without_a_search_relief_is_steep() -> None:
    """`relief` does not interpolate: 0 halvings leave the layer itself."""
    hit, _ = traced(relief, constant_surface(0.66), ray_of(), Relief(10, 10, 0))
    assert_ends(hit, ray_of(), 0.6)


# --- regula falsi ---------------------------------------------------------------------------------


@given(ramps(), st.integers(10, 50), st.integers(0, 6))
def test_secant_is_exact_on_a_ramp(ramp, steps: int, cuts: int) -> None:
    form, ray, height, _ = ramp
    # the step to the base has no chord before the first cut
    assume(cuts > 0 or height > 1 / steps)
    hit, _ = traced(secant, form, ray, Secant(steps, steps, cuts))
    assert hit.found
    assert_ends(hit, ray, height, 5e-5)


def test_the_first_split_reads_where_the_chord_crosses_the_ray() -> None:
    """h = u²: layers at ½ (surface 0.16) and ¼ (0.36)."""
    ray = ray_of(uv=(0.0, 0.5), travel=(0.8, 0.0))
    hit, read = traced(secant, lambda u, v: u * u, ray, Secant(4, 4, 1))
    over, under = 0.5 - 0.4**2, 0.6**2 - 0.25
    first = 0.5 - 0.25 * over / (over + under)
    assert read == pytest.approx([1.0, 0.75, 0.5, 0.25, first], abs=1e-6)
    assert hit.reads == 5


@pytest.mark.parametrize(("cuts", "within"), [(0, 2e-2), (1, 3e-3), (2, 3e-4), (4, 2e-6)])
def test_secant_converges_on_a_sine(cuts: int, within: float) -> None:
    """h = ½ + 0.4 sin 2πu along a ray whose hit is found in float64 by bisection."""

    def sine(u: float, v: float) -> float:
        return 0.5 + 0.4 * math.sin(2 * math.pi * u)

    for start in np.linspace(0.0, 1.0, 23):
        ray = ray_of(uv=(start, 0.5), travel=(0.2, 0.0))
        height = first_height(sine, ray)
        hit, _ = traced(secant, sine, ray, Secant(16, 16, cuts))
        assert hit.found
        assert float(hit.height) == pytest.approx(height, abs=within)


def first_height(form: Surface, ray: Ray, layers: int = 4096) -> float:
    """Height of the first hit on a closed form, by a fine march and bisection."""
    high, low = 1.0, 0.0
    for k in range(1, layers + 1):
        low = 1.0 - k / layers
        if low <= form(*position_at(ray, low)):
            break
        high = low
    for _ in range(60):
        middle = (high + low) / 2
        high, low = (high, middle) if middle <= form(*position_at(ray, middle)) else (middle, low)
    return low


def test_secant_at_a_wall_uses_the_illinois_rule() -> None:
    """The wall is at height 0.6 in the step from 0.625 to 0.5625; without the Illinois rule six
    splits, all from above, would leave 0.6147."""
    ray = ray_of(uv=(0.7, 0.4), travel=(-0.5, 0.25))
    errors = []
    for cuts in (2, 6, 12):
        hit, _ = traced(secant, cliff, ray, Secant(16, 16, cuts))
        errors.append(abs(float(hit.height) - 0.6))
    assert errors[1] < 2e-3
    assert errors[2] < 1e-4


@pytest.mark.parametrize("height", [0.0, 0.1, 0.2])
def test_below_the_last_layer_secant_first_cuts_at_the_base(height: float) -> None:
    """Four layers, the last at ¼; the read at 0 gives the chord, which is the surface."""
    hit, read = traced(secant, constant_surface(height), ray_of(), Secant(4, 4, 2))
    assert read == pytest.approx([1.0, 0.75, 0.5, 0.25, 0.0, height], abs=1e-6)
    assert_ends(hit, ray_of(), height)
    assert (hit.found, hit.reads) == (True, 6)


# --- contact refinement ---------------------------------------------------------------------------


def test_contact_refines_the_last_layer_in_finer_ones() -> None:
    """Five layers: 1, 0.8, 0.6, then 0.4 is below 0.53; then from 0.6 in steps of 0.04."""
    hit, read = traced(contact, constant_surface(0.53), ray_of(), Contact(5, 5))
    assert read == pytest.approx([1.0, 0.8, 0.6, 0.4, 0.56, 0.52], abs=1e-6)
    assert_ends(hit, ray_of(), 0.52)
    assert (hit.found, hit.reads) == (True, 6)


def test_contact_does_not_read_its_coarse_layer_again() -> None:
    hit, read = traced(contact, constant_surface(0.41), ray_of(), Contact(5, 5))
    assert read == pytest.approx([1.0, 0.8, 0.6, 0.4, 0.56, 0.52, 0.48, 0.44], abs=1e-6)
    assert_ends(hit, ray_of(), 0.4)
    assert hit.reads == 8


@given(ramps(), st.integers(10, 40))
def test_contact_is_within_a_fine_step_of_a_ramp(ramp, steps: int) -> None:
    form, ray, height, _ = ramp
    hit, _ = traced(contact, form, ray, Contact(steps, steps))
    assert hit.found
    assert height - 1 / steps**2 - 1e-4 <= float(hit.height) <= height + 1e-4
    assert hit.reads <= 2 * steps
    assert_ends(hit, ray, float(hit.height))


@pytest.mark.parametrize(
    ("height", "fine", "end"),
    [(0.0, [0.1875, 0.125, 0.0625], 0.0), (0.15, [0.1875, 0.125], 0.125)],
)
def test_below_the_last_layer_contact_refines_the_step_to_the_base(height, fine, end) -> None:
    """Four layers, the last at ¼, and the base; then from ¼ in steps of 1/16: 2 N reads at most."""
    hit, read = traced(contact, constant_surface(height), ray_of(), Contact(4, 4))
    assert read == pytest.approx([1.0, 0.75, 0.5, 0.25, 0.0, *fine], abs=1e-6)
    assert_ends(hit, ray_of(), end)
    assert (hit.found, hit.reads) == (True, 5 + len(fine))


@pytest.mark.parametrize(("technique", "record"), [(secant, Secant), (contact, Contact)])
def test_secant_and_contact_find_a_wall(technique, record) -> None:
    """`contact` is within 1/256 of the wall with 16 + 16 reads; `steep` would need 256."""
    ray = ray_of(uv=(0.7, 0.4), travel=(-0.5, 0.25))
    hit, _ = traced(technique, cliff, ray, record(16, 16))
    assert hit.found
    assert float(hit.height) == pytest.approx(0.6, abs=1 / 16 / 4)
    fine, _ = traced(contact, cliff, ray, Contact(16, 16))
    assert 0.6 - 1 / 256 <= float(fine.height) <= 0.6 + 1e-6


# --- the number of steps --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cosine", "steps"),
    [(1.0, 4), (0.5, 12), (0.25, 16), (0.0, 20), (1.0000001, 4), (-0.3, 20), (2.0, 4)],
)
def test_steps_follow_the_angle(cosine: float, steps: int) -> None:
    """G4: lerp(max, min, V·N), clamped to 4 … 20."""
    assert steps_by_angle(ray_of(cosine=cosine), 4, 20) == steps
    hit, _ = traced(parallax_occlusion, constant_surface(0.0), ray_of(cosine=cosine), March(4, 20))
    assert hit.reads == steps + 1


@given(st.floats(-1, 2), st.integers(1, 60), st.integers(1, 60))
def test_steps_stay_within_least_and_most(cosine: float, least: int, most: int) -> None:
    steps = steps_by_angle(ray_of(cosine=cosine), least, most)
    assert min(least, most) <= steps <= max(least, most)


def test_relief_takes_its_steps_by_the_angle_and_then_searches() -> None:
    """H2."""
    for cosine, steps in ((1.0, 8), (0.0, 32), (0.5, 20)):
        ray = ray_of(cosine=cosine)
        hit, _ = traced(relief, constant_surface(1.0 / steps + 0.001), ray, Relief(8, 32, 5))
        assert hit.reads == steps + 5


def field_of_size(columns: int, rows: int) -> HeightField:
    return HeightField([np.zeros((rows, columns), np.float32)])


@pytest.mark.parametrize(
    ("columns", "rows", "travel", "per_texel", "steps"),
    [
        (256, 256, (0.5, 0.0), 1.0, 128),
        (256, 64, (0.0, 0.5), 1.0, 32),
        (256, 64, (-0.5, 0.0), 1.0, 128),
        (256, 64, (0.25, -0.75), 1.0, 80),  # 64 and 48 texels: a diagonal of 80
        (256, 256, (0.5, 0.0), 0.5, 64),
        (256, 256, (0.5, 0.0), 2.0, 256),
    ],
)
def test_steps_by_texels_equal_the_texels_crossed(columns, rows, travel, per_texel, steps) -> None:
    """G8: half of a map of 256 texels takes 128 steps."""
    field = field_of_size(columns, rows)
    settings = March(4, 20, per_texel)
    assert step_count(field, ray_of(travel=travel), settings) == steps
    hit = parallax_occlusion(field, ray_of(travel=travel), settings)
    assert hit.reads == steps + 1


# --- one read: offsets ----------------------------------------------------------------------------

VIEWS = [
    (0.0, 0.0, 1.0),
    (0.6, 0.0, 0.8),
    (-0.36, 0.48, 0.8),
    (0.64, -0.6, 0.48),
    (0.8, 0.36, 0.48),
]


def relief_ray_of(
    view, kind: str, scale: float, reference_height: float = 0.5, bias=0.42, aspect=1.0
) -> Ray:
    """The ray that `relief_ray` makes of a view vector in tangent space."""
    parameters = ReliefParameters(scale, reference_height, bias)
    return relief_ray(
        intersection_of(view, aspect), parameters, scale, 0.0, 0.0, Variant(projection=kind)
    )


def intersection_of(view, aspect: float = 1.0) -> Intersection:
    up, u = Vec3(0, 0, 1), Vec3(1, 0, 0)
    frame = TangentFrame(u, Vec3(0, 1, 0), up, 1.0, 1 / aspect, 0.0)
    return Intersection(
        True, 2.0, FAR, Vec2(0.31, 0.64), frame, Vec3(*view), ShapeRay(up, -up), 1.0
    )


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("height", [0.0, 0.3, 0.5, 1.0])
def test_the_offset_is_that_of_kaneko(view, height: float) -> None:
    """W1, W2, C7: maximum height · (h − ½) · V.xy ÷ V.z; v runs against y."""
    most = 0.05
    ray = relief_ray_of(view, "full", most)
    hit, _ = trace_level(offset, height, ray, Offset())
    x, y, z = view
    wanted = np.array([0.31, 0.64]) + most * (height - 0.5) * np.array([x, -y]) / z
    np.testing.assert_allclose([*hit.uv], wanted, atol=1e-6)


def trace_level(technique, height: float, ray: Ray, settings) -> tuple[Hit, int]:
    with surface(constant_surface(height)) as places:
        hit = technique(EMPTY, ray, settings)
    return hit, len(places)


@pytest.mark.parametrize("view", VIEWS[1:])
def test_a_high_texel_moves_towards_the_viewer_in_the_picture(view) -> None:
    """A high texel is seen nearer to the viewer, so uv moves towards the viewer."""
    ray = relief_ray_of(view, "full", 0.1)
    high, _ = trace_level(offset, 1.0, ray, Offset())
    low, _ = trace_level(offset, 0.0, ray, Offset())
    middle, _ = trace_level(offset, 0.5, ray, Offset())
    toward = np.array([view[0], -view[1]])
    start = np.array([0.31, 0.64])
    assert (np.array([*high.uv]) - start) @ toward > 0
    assert (np.array([*low.uv]) - start) @ toward < 0
    np.testing.assert_allclose([*middle.uv], start, atol=1e-7)


@pytest.mark.parametrize("most", [0.0, 0.01, 0.02, 1.0])
def test_each_component_of_the_offset_is_clamped(most: float) -> None:
    """W3: u and v are clamped to ±most separately; unclamped they are (0.03, −0.015)."""
    ray = ray_of(uv=(0.5, 0.5), travel=(-0.06, 0.03), reference_height=0.5)
    for height, sign in ((1.0, 1), (0.0, -1)):
        hit, _ = trace_level(offset, height, ray, Offset(most))
        wanted = np.clip(sign * np.array([0.03, -0.015]), -most, most)
        np.testing.assert_allclose(np.array([*hit.uv]) - 0.5, wanted, atol=1e-7)


@pytest.mark.parametrize("view", VIEWS)
def test_projections(view) -> None:
    """C6, C8: divided by V.z, by V.z + bias, and not divided."""
    x, y, z = view
    v = Vec3(*view)
    np.testing.assert_allclose([*projection.full(v, 0.42)], [x / z, y / z], rtol=1e-6)
    np.testing.assert_allclose([*projection.limited(v, 0.42)], [x, y], rtol=1e-6)
    for bias in (-0.1, 0.0, 0.1, 0.42, 3.0):
        wanted = [x / (z + bias), y / (z + bias)]
        np.testing.assert_allclose([*projection.biased(v, bias)], wanted, rtol=1e-6)


@pytest.mark.parametrize("bias", [-0.6, -0.7, -1.0])
def test_a_negative_bias_never_reverses_the_ray(bias: float) -> None:
    """At V.z + bias of 0 or less the offset is that of a grazing ray, towards the viewer."""
    wanted = np.array([0.64, -0.48]) / projection.MIN_COSINE
    np.testing.assert_allclose(
        [*projection.biased(Vec3(0.64, -0.48, 0.6), bias)], wanted, rtol=1e-6
    )


@given(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.01, 1)), st.floats(0.1, 10))
def test_only_a_biased_projection_needs_a_unit_vector(view, times: float) -> None:
    """W1."""
    once, more = Vec3(*view), Vec3(*(c * times for c in view))
    np.testing.assert_allclose(
        [*projection.full(more, 0.0)], [*projection.full(once, 0.0)], rtol=1e-5, atol=1e-7
    )
    unbiased = projection.biased(once, 0.0)
    np.testing.assert_allclose([*unbiased], [*projection.full(once, 0.0)], rtol=1e-6, atol=1e-7)
    assume(abs(times - 1) > 0.1 and max(abs(view[0]), abs(view[1])) > 0.01)
    assert projection.biased(more, 0.42) != projection.biased(once, 0.42)


def test_the_limited_projection_does_not_divide() -> None:
    """C6, in the code that runs on the GPU."""

    @shader
    def entry(at: IVec2, relief: ReliefParameters, variant: Variant) -> Ray:
        travel = offset_per_height(Vec3(float(at.x), 0.0, 1.0), relief.bias, variant)
        return Ray(travel, travel, 1.0, 1.0, 1.0)

    def body(kind) -> str:
        text = print_wgsl(Program(entry, variant=Variant(projection=kind)).module, "wrap")
        return text.split(f"fn {kind}(")[1].split("\n}")[0]

    assert "/" in body("full").replace("//", "")
    assert "/" not in body("limited").replace("//", "")


@pytest.mark.parametrize("view", [(1.0, 0.0, 0.0), (0.6, 0.8, 0.0), (0.6, 0.8, -1e-7)])
@pytest.mark.parametrize("kind", ["full", "biased", "limited"])
def test_the_ray_of_a_view_along_the_surface_is_finite(view, kind: str) -> None:
    ray = relief_ray_of(view, kind, 0.1, bias=0.0)
    assert np.isfinite([*ray.travel]).all()


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("scale", [0.1, 0.4])
def test_the_limit_is_the_length_of_the_view_on_the_surface(view, scale: float) -> None:
    """G3, G7: length(V.xy) ÷ V.z × height scale, against the view."""
    ray = relief_ray_of(view, "full", scale, reference_height=1.0)
    x, y, z = view
    assert math.hypot(*ray.travel) == pytest.approx(math.hypot(x, y) / z * scale, abs=1e-6)
    assert float(ray.travel.x) * x <= 0
    assert -float(ray.travel.y) * y <= 0


@pytest.mark.parametrize("aspect", [0.25, 1.0, 2.0])
def test_the_travel_along_v_is_scaled_by_the_aspect(aspect: float) -> None:
    """W4: the lower the tile, the more of v a move across it takes."""
    ray = relief_ray_of((0.36, 0.48, 0.8), "full", 0.1, aspect=aspect)
    np.testing.assert_allclose(
        [*ray.travel], [-0.1 * 0.36 / 0.8, 0.1 * 0.48 / 0.8 * aspect], rtol=1e-6
    )


def relief_hit(
    technique, settings, view, relief: ReliefParameters, kind: str = "full"
) -> ReliefHit:
    """The hit of a view vector on a relief, by `trace_relief`."""
    variant = Variant(displaced=True, projection=kind)
    place = Placement(
        Vec3(0.0), Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)), Vec2(1.0), Vec2(0.0), 1.0
    )
    small = Footprint(Vec2(0.0), Vec2(0.0))
    with bound({displace: technique}):
        return trace_relief(
            EMPTY, UNBAKED, intersection_of(view), small, place, relief, Smoothing(), settings,
            Shadowing(), variant,
        )  # fmt: skip


@pytest.mark.parametrize(("technique", "settings"), all_techniques(20))
@pytest.mark.parametrize(
    ("kind", "bias"),
    [("full", 0.42), ("biased", -0.15), ("biased", 0.0), ("biased", 0.42), ("limited", 0.42)],
)
@pytest.mark.parametrize("view", VIEWS)
def test_the_projection_comes_before_every_technique(technique, settings, kind, bias, view) -> None:
    """C9: on height 0.7 every technique ends at scale · (0.7 − reference height) along the
    projected view."""
    x, y, z = view
    travel = {"full": 1 / z, "limited": 1.0, "biased": 1 / (z + bias)}[kind]
    reference_height = technique.reference_height
    with surface(constant_surface(0.7)):
        end = relief_hit(
            technique, settings, view, ReliefParameters(0.1, reference_height, bias), kind
        )
    height = reference_height if technique is flat else 0.7
    wanted = np.array([0.31, 0.64]) + 0.1 * (height - reference_height) * np.array([x, -y]) * travel
    np.testing.assert_allclose([*end.uv], wanted, atol=2e-5)
    # the depth is that of the height, along the true ray
    assert float(end.distance) == pytest.approx(
        2.0 + (reference_height - height) * 0.1 / z, abs=2e-5
    )


def test_default_projections_and_reference_heights() -> None:
    assert (offset.projection, offset_limited.projection) == ("full", "limited")
    assert (offset.reference_height, offset_limited.reference_height) == (0.5, 0.5)
    assert {t.reference_height for t in (steep, parallax_occlusion, relief)} == {1.0}
    assert {t.projection for t in (steep, parallax_occlusion, relief)} == {"full"}


@pytest.mark.parametrize(("technique", "settings"), all_techniques())
def test_scale_0_reads_no_height(technique, settings) -> None:
    """C2."""
    with surface(constant_surface(0.7)) as places:
        end = relief_hit(technique, settings, VIEWS[3], ReliefParameters(0.0, 0.5, 0.42))
    assert places == []
    assert end.reads == 0
    assert end.distance == 2.0
    np.testing.assert_allclose([*end.uv], [0.31, 0.64], atol=1e-7)


# --- on the CPU -----------------------------------------------------------------------------------


@shader
def tracing(at: IVec2, field: HeightField, baked: Texture, settings: Settings) -> Hit:
    """A different ray for each pixel."""
    x = float(at.x) * 0.11 - 1.3
    y = float(at.y) * 0.17 - 0.9
    travel = Vec2(y, x) * 0.21
    uv = Vec2(x * 0.37, y * 0.53) - travel * 0.3
    ray = Ray(uv, travel, 1.0, 1.0, 0.5 + x * 0.25, reference_height=0.7)
    return displace(field, baked, ray, settings)


@pytest.mark.parametrize(("technique", "settings"), all_techniques(9))
def test_the_cpu_computes_the_same_bits_as_python(technique, settings) -> None:
    field = HeightField([np.random.default_rng(7).random((11, 17)) ** 2], "wrap")
    bindings = {displace: technique}
    program = Program(tracing, bindings, "wrap")
    planes = CpuEngine().run(program, {"field": field, "settings": settings}, (23, 11))
    for x, y in [(0, 0), (22, 10), (11, 3), (4, 9), (17, 6), (15, 5)]:
        with bound(bindings):
            one = tracing(IVec2(x, y), field, UNBAKED, settings)
        got = [planes[name][y, x] for name, _ in program.planes]
        assert got == [*leaf_values(one, Hit)]
