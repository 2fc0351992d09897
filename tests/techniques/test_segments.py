"""Rays that are only a part of the way, that rise, or that are bent, against the oracle."""

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
"""Heights that float32 cannot tell apart along a bent ray: some units in the last place of 1."""
BENDS = (-1.5, -0.2, 0.0, 0.2, 1.5)


# --- the segment ----------------------------------------------------------------------------------


@pytest.mark.parametrize("bend", BENDS)
def test_a_bent_ray_hangs_lower_by_a_quarter_of_its_bend(bend: float) -> None:
    ray = Ray(Vec2(0.25, 0.5), Vec2(0.5, -0.25), 0.75, 0.5, 0.5, bend=bend)
    assert [*at(ray, 0.5)] == [0.5, 0.375]
    assert (float(height_at(ray, 0.0)), float(height_at(ray, 1.0))) == (0.75, 0.25)
    assert float(height_at(ray, 0.5)) == pytest.approx(0.5 - bend / 4, abs=1e-7)


@pytest.mark.parametrize("bend", BENDS)
@pytest.mark.parametrize("drop", [-0.5, 0.0, 1.0])
def test_from_nowhere_on_it_falls_faster_than_it_may(bend: float, drop: float) -> None:
    ray = Ray(Vec2(0.0), Vec2(1.0), 1.0, drop, 0.5, bend=bend)
    t = np.linspace(0.0, 1.0, 101)
    height = 1.0 - drop * t - bend * t * (1 - t)
    falls = -np.diff(height) / np.diff(t)
    for k in range(100):
        most = float(max_descent(ray, t[k]))
        assert falls[k:].max() <= most + 1e-5
    assert falls.max() == pytest.approx(float(max_descent(ray, 0.0)), abs=0.05)


def test_a_height_is_where_it_says() -> None:
    ray = flat_ray((0.1, 0.2), (0.5, 0.25), reference_height=0.25)
    for height in (-0.5, 0.0, 0.25, 1.0, 1.5):
        assert float(height_at(ray, t_at(ray, height))) == pytest.approx(height, abs=1e-7)
    level = Ray(Vec2(0.0), Vec2(1.0), 0.5, 0.0, 0.5)
    assert np.isfinite(t_at(level, 0.25))


# --- the first hit, proven ------------------------------------------------------------------------


@struct
class Segments:
    """Rays that start anywhere and run any way, each component up to `reach` tiles; they begin and
    end at any height, and are bent by up to `bend`, or by none at all if that is 0."""

    reach: float
    bend: float
    seed: int


@struct
class Traced:
    """A ray and where it ends."""

    uv: Vec2
    travel: Vec2
    height: float
    drop: float
    bend: float
    ended: Vec2
    t: float
    found: bool


@shader
def traced(
    at: IVec2, rays: Segments, field: HeightField, baked: Texture, settings: Settings
) -> Traced:
    """One ray of many."""
    n = (at.y * 8192 + at.x) * 7 + rays.seed * 7919
    uv = Vec2(scattered(n), scattered(n + 1))
    travel = (Vec2(scattered(n + 2), scattered(n + 3)) * 2.0 - 1.0) * rays.reach
    # near the tops, where there is most to pass by, as often as not
    height = 1.0 - scattered(n + 4) * scattered(n + 4)
    drop = height - scattered(n + 5)
    ray = Ray(uv, travel, height, drop, 0.5, bend=rays.bend * scattered(n + 6), share=0.5)
    hit = displace(field, baked, ray, settings)
    return Traced(uv, travel, height, drop, ray.bend, hit.uv, hit.t, hit.found)


def planes_of(
    engine: Any, technique: Any, settings: Any, heights, edge: str, rays: Segments,
    size: tuple[int, int] = (128, 96),
) -> dict[str, np.ndarray]:  # fmt: skip
    """Rays by name, flat, in float64, `t` and `found` among them."""
    heights = np.asarray(heights, np.float32)
    given = {
        "rays": rays,
        "field": HeightField([heights], edge, "columns" if technique is texel else "sharp"),
        "settings": settings,
    }
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        given["baked"] = Texture([make[technique](heights, edge)], edge)
    program = Program(traced, {displace: technique}, edge, given["field"].filter)
    made = {name: plane.ravel() for name, plane in engine.run(program, given, size).items()}
    return {name: plane if name == "found" else plane.astype(float) for name, plane in made.items()}


def firsts(rays: dict[str, np.ndarray], which: Any, heights: np.ndarray, edge: str) -> Any:
    """The oracle's first hits of some of the rays."""
    pairs = (
        np.stack([rays[f"{name}.x"], rays[f"{name}.y"]], -1)[which] for name in ("uv", "travel")
    )
    falls = {name: rays[name][which] for name in ("height", "drop", "bend")}
    return intersect_height_field(heights, *pairs, edge, **falls)


def assert_exact(rays: dict[str, np.ndarray], heights, edge: str) -> int:
    """No ray is late, and those that say so have found the first hit; returns how many have."""
    heights = np.asarray(heights, np.float32).astype(float)
    wanted = firsts(rays, slice(None), heights, edge)
    texels = np.hypot(
        *(rays[f"travel.{c}"] * n for c, n in zip("xy", heights.shape[::-1], strict=True))
    )
    found = rays["found"] != 0
    apart = (rays["t"] - wanted.t) * texels
    off = np.flatnonzero((np.abs(apart) > LATE) | (found != wanted.found))
    # what is left is a crest that only just rises above the ray, or only just does not
    lower = firsts(rays, off, np.maximum(heights - BLUR, 0.0), edge)
    higher = firsts(rays, off, np.minimum(heights + BLUR, 1.0), edge)
    t, room = rays["t"][off], 2 * LATE / np.maximum(texels[off], 1.0)
    blurred = (t <= lower.t + room) & (t >= higher.t - room)
    assert blurred.all(), f"{(~blurred).sum()} of {len(t)}, worst {np.abs(apart).max():.3f} texels"
    assert len(off) <= 5e-4 * len(found)
    assert (rays["t"][~found] == 1.0).all()
    return int(found.sum())


@pytest.fixture(scope="module")
def cpu() -> CpuEngine:
    return CpuEngine()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", maps())
def test_exact_is_never_late_on_a_segment(cpu, name, edge) -> None:
    """B1 for bends of both signs; what misses is told from what is met."""
    for bend in BENDS:
        for reach in (0.05, 1.0):
            rays = planes_of(cpu, exact, Nothing(), maps()[name], edge, Segments(reach, bend, 3))
            met = assert_exact(rays, maps()[name], edge)
            assert 0 < met < len(rays["t"])


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
def test_of_boxes_the_first_is_met(cpu, bend: float) -> None:
    """Against many places along each ray: at none before is it within a box."""
    heights = np.asarray(maps()["odd noise"], np.float32)
    rays = planes_of(cpu, texel, Nothing(), heights, "wrap", Segments(0.4, bend, 6), (24, 16))
    t = np.linspace(0.0, 1.0, 4001)
    for k, met in enumerate(rays["t"]):
        x, y = (
            np.floor((rays[f"uv.{c}"][k] + rays[f"travel.{c}"][k] * t) * n).astype(int) % n
            for c, n in zip("xy", heights.shape[::-1], strict=True)
        )
        height = rays["height"][k] - rays["drop"][k] * t - rays["bend"][k] * t * (1 - t)
        over = height - heights[y, x]
        assert (over[t < met - 1e-5] > -1e-5).all()
        if rays["found"][k]:
            # somewhere within the next box or two it is
            assert (over[(t >= met) & (t < met + 0.02)] < 1e-4).any() or met > 0.999
        else:
            assert met == 1.0
            end = [rays[f"uv.{c}"][k] + rays[f"travel.{c}"][k] for c in "xy"]
            texels = (np.array([rays["ended.x"][k], rays["ended.y"][k]]) - end) * heights.shape[
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


def proven(heights: np.ndarray, ray: Ray) -> Hit:
    """Where `exact` ends on a map whose border goes on."""
    heights = np.asarray(heights, np.float32)
    baked = Texture([baking.bounds(heights, "clamp")], "clamp")
    return exact(HeightField([heights], "clamp"), baked, ray, Nothing())


def assert_first(hit: Hit, over: np.ndarray, t: np.ndarray) -> None:
    """The hit is the first of many places at which the ray is not above the closed form."""
    below = over <= 0.0
    assert bool(hit.found) == below.any()
    assert float(hit.t) == pytest.approx(t[np.argmax(below)] if below.any() else 1.0, abs=5e-6)


@pytest.mark.parametrize(("height", "drop", "bend"), PARABOLAS)
@pytest.mark.parametrize("along", [0.3, -0.3])
def test_exact_meets_closed_forms_by_parabolas(height, drop, bend, along: float) -> None:
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
        assert_first(proven(heights, ray), path - surface, t)


# --- the parts of a way ---------------------------------------------------------------------------


WAYS = [
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


def followed(technique: Any, settings: Any, heights: np.ndarray, ray: Ray) -> tuple[Hit, float]:
    """Where a ray ends, and the t of the whole way, when it is cut into parts that go on."""
    given: list[Any] = [HeightField([heights], "clamp")]
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        given.append(Texture([make[technique](heights, "clamp")], "clamp"))
    start = 0.0
    for start, end in itertools.pairwise(CUTS):
        length = end - start
        part = Ray(
            at(ray, start), ray.travel * length, 1.0 - start, length, ray.cosine, share=length,
            scale=0.2,
        )  # fmt: skip
        hit = technique(*given, part, settings)
        if hit.found or float(hit.t) < 1.0:
            break
    return hit, start + length * float(hit.t)


@pytest.mark.parametrize(("technique", "settings"), WAYS)
def test_parts_that_go_on_end_where_the_whole_way_does(technique, settings) -> None:
    """A hill, whose first hit the parts must not pass between them."""
    y, x = np.mgrid[0:32, 0:48]
    heights = (0.1 + 0.8 * np.exp(-(((x - 24) / 8) ** 2) - ((y - 14) / 9) ** 2)).astype(np.float32)
    for u in np.linspace(0.05, 0.6, 12):
        ray = flat_ray((u, 0.4), (0.5, 0.1), cosine=0.5)
        wanted = intersect_height_field(heights, [[u, 0.4]], [[0.5, 0.1]], "clamp").t[0]
        hit, t = followed(technique, settings, heights, ray)
        assert hit.found
        # a step of a march, a fine one of contact; more exact where it is cut or proven
        within = {steep: 1 / 40}.get(technique, 4e-3)
        assert t == pytest.approx(wanted, abs=within)


@pytest.mark.parametrize("share", [0.5, 1.0])
@pytest.mark.parametrize(("technique", "settings"), WAYS)
def test_what_is_above_all_goes_on(technique, settings, share: float) -> None:
    """Not found, and t = 1; a ray that ran out of steps has t < 1, and stays."""
    heights = np.full((16, 16), 0.25, np.float32)
    field = [HeightField([heights])]
    if technique.bake is not None:
        make = {exact: baking.bounds, cone: baking.cone_map, relaxed_cone: baking.relaxed_cone_map}
        field.append(Texture([make[technique](heights, "wrap")]))
    ray = Ray(Vec2(0.3, 0.4), Vec2(0.2, 0.1), 1.0, 0.5, 0.5, bend=-0.5, share=share, scale=0.2)
    hit = technique(*field, ray, settings)
    assert (bool(hit.found), float(hit.t)) == (False, 1.0)
    assert float(hit.height) == 0.5


def test_out_of_steps_it_stays() -> None:
    heights = np.zeros((64, 64), np.float32)
    heights[:, ::8] = 0.9
    field, baked = HeightField([heights]), Texture([baking.cone_map(heights, "wrap")])
    hit = cone(field, baked, flat_ray((0.3, 0.4), (0.9, 0.5)), Cones(1))
    assert not hit.found
    assert 0.0 < float(hit.t) < 1.0


def test_a_part_takes_its_share_of_the_steps_and_one_more_at_its_end() -> None:
    heights = np.zeros((4, 4), np.float32)
    assert steep(HeightField([heights]), flat_ray((0.1, 0.2), (0.3, 0.0)), Steps(20)).reads == 20
    for share, steps in ((1.0, 21), (0.5, 11), (0.26, 7), (0.001, 2)):
        ray = Ray(Vec2(0.1, 0.2), Vec2(0.3, 0.0), 1.0, 0.5, 0.5, share=share)
        assert steep(HeightField([heights]), ray, Steps(20)).reads == steps


def test_an_offset_reads_where_the_ray_meets_the_polygon() -> None:
    heights = np.full((4, 4), 0.75, np.float32)
    hit = offset(
        HeightField([heights]), flat_ray((0.5, 0.5), (-0.2, 0.1), reference_height=0.5), Offset()
    )
    np.testing.assert_allclose([*hit.uv], [0.55, 0.475], atol=1e-6)
    assert float(hit.t) == 0.25
