"""Rays that are segments, that rise or that are bent, against the oracle."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from basrelief import baking
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Texture, Vec2, shader, struct
from basrelief.lang.program import Program
from basrelief.measure.oracle import intersect_height_field
from basrelief.techniques import Nothing, cone, displace, exact, relaxed_cone, texel
from basrelief.techniques.cone import Cones, RelaxedCones
from basrelief.techniques.march import (
    FixedLength,
    March,
    Relief,
    Steps,
    fixed_length,
    parallax_occlusion,
    relief,
    steep,
)
from basrelief.techniques.offset import Offset, offset
from basrelief.techniques.ray import Hit, Ray, at, height_at, max_descent, t_at
from basrelief.techniques.refine import Contact, Secant, contact, secant
from basrelief.techniques.technique import Settings
from helpers.rays import LATE, flat_ray, maps, scattered

BLUR = 6e-7
"""Difference of heights that float32 does not resolve along a bent ray."""
BENDS = (-1.5, -0.2, 0.0, 0.2, 1.5)


# --- the segment ----------------------------------------------------------------------------------


@pytest.mark.parametrize("bend", BENDS)
def test_a_bent_ray_is_a_quarter_of_its_bend_lower_in_the_middle(bend: float) -> None:
    ray = Ray(Vec2(0.25, 0.5), Vec2(0.5, -0.25), 0.75, 0.5, 0.5, bend=bend)
    assert [*at(ray, 0.5)] == [0.5, 0.375]
    assert (float(height_at(ray, 0.0)), float(height_at(ray, 1.0))) == (0.75, 0.25)
    assert float(height_at(ray, 0.5)) == pytest.approx(0.5 - bend / 4, abs=1e-7)


@pytest.mark.parametrize("bend", BENDS)
@pytest.mark.parametrize("drop", [-0.5, 0.0, 1.0])
def test_max_descent_bounds_the_slope_of_the_rest_of_the_ray(bend: float, drop: float) -> None:
    ray = Ray(Vec2(0.0), Vec2(1.0), 1.0, drop, 0.5, bend=bend)
    t = np.linspace(0.0, 1.0, 101)
    height = 1.0 - drop * t - bend * t * (1 - t)
    falls = -np.diff(height) / np.diff(t)
    for k in range(100):
        most = float(max_descent(ray, t[k]))
        assert falls[k:].max() <= most + 1e-5
    assert falls.max() == pytest.approx(float(max_descent(ray, 0.0)), abs=0.05)


def test_t_at_inverts_height_at() -> None:
    ray = flat_ray((0.1, 0.2), (0.5, 0.25), reference_height=0.25)
    for height in (-0.5, 0.0, 0.25, 1.0, 1.5):
        assert float(height_at(ray, t_at(ray, height))) == pytest.approx(height, abs=1e-7)
    level = Ray(Vec2(0.0), Vec2(1.0), 0.5, 0.0, 0.5)
    assert np.isfinite(t_at(level, 0.25))


# --- the first hit against the oracle -------------------------------------------------------------


@struct
class Segments:
    """Random rays: travel up to `reach` tiles along each axis, start and end at any height, bend
    between 0 and `bend`."""

    reach: float
    bend: float
    seed: int


@struct
class TracedRay:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    height: float
    drop: float
    bend: float
    hit_uv: Vec2
    t: float
    found: bool


@shader
def traced(
    at: IVec2, rays: Segments, field: HeightField, baked: Texture, settings: Settings
) -> TracedRay:
    """A random ray, traced by the bound technique."""
    n = (at.y * 8192 + at.x) * 7 + rays.seed * 7919
    uv = Vec2(scattered(n), scattered(n + 1))
    travel = (Vec2(scattered(n + 2), scattered(n + 3)) * 2.0 - 1.0) * rays.reach
    # more often near the top, where rays pass the most features
    height = 1.0 - scattered(n + 4) * scattered(n + 4)
    drop = height - scattered(n + 5)
    ray = Ray(uv, travel, height, drop, 0.5, bend=rays.bend * scattered(n + 6), share=0.5)
    hit = displace(field, baked, ray, settings)
    return TracedRay(uv, travel, height, drop, ray.bend, hit.uv, hit.t, hit.found)


def planes_of(
    engine: Any, technique: Any, settings: Any, heights, edge: str, rays: Segments,
    size: tuple[int, int] = (128, 96),
) -> dict[str, np.ndarray]:  # fmt: skip
    """The fields of traced rays by name, as flat arrays, floats in float64."""
    heights = np.asarray(heights, np.float32)
    arguments = {
        "rays": rays,
        "field": HeightField([heights], edge, "columns" if technique is texel else "sharp"),
        "settings": settings,
    }
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        arguments["baked"] = Texture([make[technique](heights, edge)], edge)
    program = Program(traced, {displace: technique}, edge, arguments["field"].filter)
    made = {name: plane.ravel() for name, plane in engine.run(program, arguments, size).items()}
    return {name: plane if name == "found" else plane.astype(float) for name, plane in made.items()}


def first_hits(rays: dict[str, np.ndarray], which: Any, heights: np.ndarray, edge: str) -> Any:
    """First hits of some rays, by the oracle."""
    pairs = (
        np.stack([rays[f"{name}.x"], rays[f"{name}.y"]], -1)[which] for name in ("uv", "travel")
    )
    falls = {name: rays[name][which] for name in ("height", "drop", "bend")}
    return intersect_height_field(heights, *pairs, edge, **falls)


def assert_exact(rays: dict[str, np.ndarray], heights, edge: str) -> int:
    """Assert that no ray is late and that hits are the first; return the number of hits."""
    heights = np.asarray(heights, np.float32).astype(float)
    wanted = first_hits(rays, slice(None), heights, edge)
    texels = np.hypot(
        *(rays[f"travel.{c}"] * n for c, n in zip("xy", heights.shape[::-1], strict=True))
    )
    found = rays["found"] != 0
    error = (rays["t"] - wanted.t) * texels
    off = np.flatnonzero((np.abs(error) > LATE) | (found != wanted.found))
    # the others pass or hit a crest that is within rounding of the ray
    lower = first_hits(rays, off, np.maximum(heights - BLUR, 0.0), edge)
    higher = first_hits(rays, off, np.minimum(heights + BLUR, 1.0), edge)
    t, margin = rays["t"][off], 2 * LATE / np.maximum(texels[off], 1.0)
    blurred = (t <= lower.t + margin) & (t >= higher.t - margin)
    assert blurred.all(), f"{(~blurred).sum()} of {len(t)}, worst {np.abs(error).max():.3f} texels"
    assert len(off) <= 5e-4 * len(found)
    assert (rays["t"][~found] == 1.0).all()
    return int(found.sum())


@pytest.fixture(scope="module")
def cpu() -> CpuEngine:
    return CpuEngine()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", maps())
def test_exact_is_never_late_on_a_segment(cpu, name, edge) -> None:
    """B1 for bends of both signs, with and without a hit."""
    for bend in BENDS:
        for reach in (0.05, 1.0):
            rays = planes_of(cpu, exact, Nothing(), maps()[name], edge, Segments(reach, bend, 3))
            hits = assert_exact(rays, maps()[name], edge)
            assert 0 < hits < len(rays["t"])


@pytest.mark.parametrize("name", ["odd noise", "posts", "bricks", "seams"])
def test_cone_is_never_late_on_a_segment(cpu, name) -> None:
    for bend in BENDS:
        rays = planes_of(cpu, cone, Cones(4096), maps()[name], "wrap", Segments(0.7, bend, 4))
        assert_exact(rays, maps()[name], "wrap")


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["odd noise", "posts", "bricks"])
def test_exact_is_never_late_on_a_segment_on_the_gpu(name) -> None:
    from basrelief.engine.gpu import GpuEngine

    for bend in BENDS:
        rays = planes_of(
            GpuEngine(), exact, Nothing(), maps()[name], "wrap", Segments(0.7, bend, 5), (96, 64)
        )
        assert_exact(rays, maps()[name], "wrap")


@pytest.mark.parametrize("bend", BENDS)
def test_texel_hits_the_first_column(cpu, bend: float) -> None:
    """Checked at many positions: the ray is in no column before its hit."""
    heights = np.asarray(maps()["odd noise"], np.float32)
    rays = planes_of(cpu, texel, Nothing(), heights, "wrap", Segments(0.4, bend, 6), (24, 16))
    t = np.linspace(0.0, 1.0, 4001)
    for k, t_hit in enumerate(rays["t"]):
        x, y = (
            np.floor((rays[f"uv.{c}"][k] + rays[f"travel.{c}"][k] * t) * n).astype(int) % n
            for c, n in zip("xy", heights.shape[::-1], strict=True)
        )
        height = rays["height"][k] - rays["drop"][k] * t - rays["bend"][k] * t * (1 - t)
        over = height - heights[y, x]
        assert (over[t < t_hit - 1e-5] > -1e-5).all()
        if rays["found"][k]:
            # shortly after its hit the ray is inside a column
            assert (over[(t >= t_hit) & (t < t_hit + 0.02)] < 1e-4).any() or t_hit > 0.999
        else:
            assert t_hit == 1.0
            end = [rays[f"uv.{c}"][k] + rays[f"travel.{c}"][k] for c in "xy"]
            texels = (np.array([rays["hit_uv.x"][k], rays["hit_uv.y"][k]]) - end) * heights.shape[
                ::-1
            ]
            assert np.abs(texels).max() < 0.02


# --- closed forms ---------------------------------------------------------------------------------

PARABOLAS = [
    (0.9, 0.45, 0.0),
    (0.9, 0.2, 1.2),
    (0.9, 0.2, -1.2),
    (0.55, -0.3, 0.9),
    (0.7, -0.2, -0.5),
    (1.2, 0.9, 0.6),
]
"""Height, drop and bend; the last begins above all heights."""


def exact_hit(heights: np.ndarray, ray: Ray) -> Hit:
    """The hit of `exact` on a clamped map."""
    heights = np.asarray(heights, np.float32)
    baked = Texture([baking.bounds(heights, "clamp")], "clamp")
    return exact(HeightField([heights], "clamp"), baked, ray, Nothing())


def assert_first(hit: Hit, over: np.ndarray, t: np.ndarray) -> None:
    """Assert that the hit is the first position at which the ray is not above the closed form."""
    below = over <= 0.0
    assert bool(hit.found) == below.any()
    assert float(hit.t) == pytest.approx(t[np.argmax(below)] if below.any() else 1.0, abs=5e-6)


@pytest.mark.parametrize(("height", "drop", "bend"), PARABOLAS)
@pytest.mark.parametrize("along", [0.3, -0.3])
def test_exact_on_bent_rays_equals_closed_forms(height, drop, bend, along: float) -> None:
    """A plane at ½; a ramp of 0.2 + 0.6 u; a step that rises by 0.7 between two texel centres."""
    t = np.linspace(0.0, 1.0, 1_000_001)
    path = height - drop * t - bend * t * (1 - t)
    u = 0.45 + along * t
    ramp = np.tile(0.2 + 0.6 * (np.arange(64) + 0.5) / 64, (9, 1))
    step = np.full((4, 16), 0.1)
    step[:, 8:] = 0.8
    forms = (
        (np.full((6, 5), 0.5), np.full_like(t, 0.5)),
        (ramp, 0.2 + 0.6 * u),
        (step, np.interp(u, [7.5 / 16, 8.5 / 16], [0.1, 0.8])),
    )
    ray = Ray(Vec2(0.45, 0.5), Vec2(along, 0.0), height, drop, 0.5, bend=bend)
    for heights, surface in forms:
        assert_first(exact_hit(heights, ray), path - surface, t)


# --- a ray cut into segments ----------------------------------------------------------------------


CASES = [
    pytest.param(steep, Steps(48), id="steep"),
    pytest.param(parallax_occlusion, March(48, 48), id="parallax_occlusion"),
    pytest.param(relief, Relief(48, 48, 8), id="relief"),
    pytest.param(secant, Secant(48, 48, 4), id="secant"),
    pytest.param(contact, Contact(24, 24), id="contact"),
    pytest.param(fixed_length, FixedLength(4096, 0.005), id="fixed_length"),
    pytest.param(relaxed_cone, RelaxedCones(200, 10), id="relaxed_cone"),
    pytest.param(exact, Nothing(), id="exact"),
    pytest.param(cone, Cones(500), id="cone"),
]
CUTS = (0.0, 0.25, 0.625, 1.0)


def trace_parts(technique: Any, settings: Any, heights: np.ndarray, ray: Ray) -> tuple[Hit, float]:
    """The hit of a ray that is traced as consecutive segments, and its t on the whole ray."""
    arguments: list[Any] = [HeightField([heights], "clamp")]
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        arguments.append(Texture([make[technique](heights, "clamp")], "clamp"))
    start = 0.0
    for start, end in itertools.pairwise(CUTS):
        length = end - start
        part = Ray(
            at(ray, start), ray.travel * length, 1.0 - start, length, ray.cosine, share=length,
            scale=0.2,
        )  # fmt: skip
        hit = technique(*arguments, part, settings)
        if hit.found or float(hit.t) < 1.0:
            break
    return hit, start + length * float(hit.t)


@pytest.mark.parametrize(("technique", "settings"), CASES)
def test_consecutive_segments_have_the_hit_of_the_whole_ray(technique, settings) -> None:
    """The hill must not be passed at a border between segments."""
    y, x = np.mgrid[0:32, 0:48]
    heights = (0.1 + 0.8 * np.exp(-(((x - 24) / 8) ** 2) - ((y - 14) / 9) ** 2)).astype(np.float32)
    for u in np.linspace(0.05, 0.6, 12):
        ray = flat_ray((u, 0.4), (0.5, 0.1), cosine=0.5)
        wanted = intersect_height_field(heights, [[u, 0.4]], [[0.5, 0.1]], "clamp").t[0]
        hit, t = trace_parts(technique, settings, heights, ray)
        assert hit.found
        # steep is exact to a step of the march, the others to a fine step or better
        within = {steep: 1 / 40}.get(technique, 4e-3)
        assert t == pytest.approx(wanted, abs=within)


@pytest.mark.parametrize("share", [0.5, 1.0])
@pytest.mark.parametrize(("technique", "settings"), CASES)
def test_a_segment_above_the_surface_ends_without_a_hit(technique, settings, share: float) -> None:
    """No hit and t = 1, so that the next segment is traced."""
    heights = np.full((16, 16), 0.25, np.float32)
    field = [HeightField([heights])]
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        field.append(Texture([make[technique](heights, "wrap")]))
    ray = Ray(Vec2(0.3, 0.4), Vec2(0.2, 0.1), 1.0, 0.5, 0.5, bend=-0.5, share=share, scale=0.2)
    hit = technique(*field, ray, settings)
    assert (bool(hit.found), float(hit.t)) == (False, 1.0)
    assert float(hit.height) == 0.5


TO_BASE = [case for case in CASES if case.id in (
    "parallax_occlusion", "relief", "secant", "contact", "fixed_length",
)]  # fmt: skip
"""Marches that end at the base where nothing is above it."""


@pytest.mark.parametrize("bend", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("end", [0.0, -0.15])
@pytest.mark.parametrize(("technique", "settings"), TO_BASE)
def test_a_segment_that_ends_at_the_base_or_below_hits_it(technique, settings, end, bend) -> None:
    """At the root of 0.4 − drop · t − bend · t (1 − t), on a map of zeros."""
    heights = np.zeros((16, 16), np.float32)
    ray = Ray(Vec2(0.3, 0.4), Vec2(0.2, 0.1), 0.4, 0.4 - end, 0.5, bend=bend, share=0.5, scale=0.2)
    hit = technique(HeightField([heights]), ray, settings)
    roots = np.roots([bend, end - 0.4 - bend, 0.4])
    wanted = min(root.real for root in roots if 0.0 < root.real <= 1.0 + 1e-12)
    assert hit.found
    # a bent ray does not follow the chord of a step
    within = {relief: 1 / 24 / 2**8, contact: 1 / 12 / 24}.get(technique, abs(bend) / 1000)
    assert float(hit.t) == pytest.approx(wanted, abs=within + 1e-5)


@pytest.mark.parametrize("share", [0.5, 0.26, 1.0])
@pytest.mark.parametrize(("technique", "settings"), CASES)
def test_a_segment_that_ends_just_above_the_base_does_not_hit_it(
    technique, settings, share: float
) -> None:
    heights = np.zeros((16, 16), np.float32)
    field: list[Any] = [HeightField([heights])]
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        field.append(Texture([make[technique](heights, "wrap")]))
    ray = Ray(Vec2(0.3, 0.4), Vec2(0.2, 0.1), 1.0, 0.999, 0.5, share=share, scale=0.2)
    hit = technique(*field, ray, settings)
    assert (bool(hit.found), float(hit.t)) == (False, 1.0)


def test_a_ray_out_of_steps_ends_before_t_1() -> None:
    heights = np.zeros((64, 64), np.float32)
    heights[:, ::8] = 0.9
    field, baked = HeightField([heights]), Texture([baking.cone_map(heights, "wrap")])
    hit = cone(field, baked, flat_ray((0.3, 0.4), (0.9, 0.5)), Cones(1))
    assert not hit.found
    assert 0.0 < float(hit.t) < 1.0


def test_a_segment_takes_its_share_of_the_steps_plus_one() -> None:
    heights = np.zeros((4, 4), np.float32)
    assert steep(HeightField([heights]), flat_ray((0.1, 0.2), (0.3, 0.0)), Steps(20)).reads == 20
    for share, steps in ((1.0, 21), (0.5, 11), (0.26, 7), (0.001, 2)):
        ray = Ray(Vec2(0.1, 0.2), Vec2(0.3, 0.0), 1.0, 0.5, 0.5, share=share)
        assert steep(HeightField([heights]), ray, Steps(20)).reads == steps


def test_an_offset_reads_at_the_intersection_with_the_polygon() -> None:
    heights = np.full((4, 4), 0.75, np.float32)
    hit = offset(
        HeightField([heights]), flat_ray((0.5, 0.5), (-0.2, 0.1), reference_height=0.5), Offset()
    )
    np.testing.assert_allclose([*hit.uv], [0.55, 0.475], atol=1e-6)
    assert float(hit.t) == 0.25
