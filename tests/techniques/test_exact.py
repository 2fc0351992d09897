"""`exact` against the oracle: no ray ends more than 0.05 texel late, on any map, at any angle.

A ray may pass a crest that is within a few units in the last place of its height.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pytest

from basrelief import baking
from basrelief.baking.levels import levels_of
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Texture, Vec2, shader, struct
from basrelief.lang.program import Program
from basrelief.material import sample
from basrelief.measure.oracle import intersect_height_field
from basrelief.rendering.render import render
from basrelief.scene import Object, Orbit, Scene
from basrelief.techniques import Nothing, exact
from basrelief.techniques.ray import Ray
from helpers.agreement import assert_engines_agree
from helpers.rays import LATE, Fan, flat_ray, maps, scattered

BLUR = 4e-7
"""Difference of heights that float32 does not resolve: some units in the last place of 1."""


@struct
class TracedRay:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    height: float
    reads: int


@shader
def traced(at: IVec2, fan: Fan, field: HeightField, baked: Texture) -> TracedRay:
    """A random ray, traced by `exact`."""
    n = (at.y * 8192 + at.x) * 4 + fan.seed * 7919
    uv = Vec2(scattered(n), scattered(n + 1))
    travel = (Vec2(scattered(n + 2), scattered(n + 3)) * 2.0 - 1.0) * fan.reach
    hit = exact(field, baked, Ray(uv, travel, 1.0, 1.0, 0.5), Nothing())
    return TracedRay(uv, travel, hit.height, hit.reads)


def rays(engine: Any, heights, edge: str, reach: float, size=(128, 128), seed: int = 0):
    """Start, travel, height of the hit, and reads of every ray, as flat arrays."""
    field = HeightField([heights], edge)
    baked = Texture([baking.bounds(np.asarray(heights, np.float32), edge)], edge)
    values = {"fan": Fan(reach, seed), "field": field, "baked": baked}
    planes = engine.run(Program(traced, edge=edge), values, size)
    uv = np.stack([planes["uv.x"], planes["uv.y"]], -1).reshape(-1, 2).astype(float)
    travel = np.stack([planes["travel.x"], planes["travel.y"]], -1).reshape(-1, 2).astype(float)
    return uv, travel, planes["height"].ravel().astype(float), planes["reads"].ravel()


def assert_exact(engine: Any, heights, edge: str, reach: float, **more: Any) -> None:
    heights = np.asarray(heights, np.float32)
    uv, travel, height, _ = rays(engine, heights, edge, reach, **more)
    wanted = intersect_height_field(heights, uv, travel, edge)
    texels = np.linalg.norm(travel * heights.shape[::-1], axis=1)
    error = ((1.0 - height) - wanted.t) * texels
    missed = np.flatnonzero(np.abs(error) > LATE)
    # the others must pass a crest that rises above the ray by less than float32 resolves
    lowered = np.maximum(heights.astype(float) - BLUR, 0.0)
    passed = intersect_height_field(lowered, uv[missed], travel[missed], edge)
    blurred = np.abs(((1.0 - height[missed]) - passed.t) * texels[missed]) <= 2 * LATE
    assert blurred.all(), f"{(~blurred).sum()} of {len(height)}, worst {error.max():.3f} texels"
    assert len(missed) <= 1e-4 * len(height)


@pytest.fixture(scope="module")
def cpu() -> CpuEngine:
    return CpuEngine()


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", maps())
def test_no_ray_is_late(cpu, name, edge) -> None:
    """B1: rays from a few texels to several tiles long."""
    for reach in (0.02, 0.3, 3.0):
        assert_exact(cpu, maps()[name], edge, reach)


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["odd noise", "posts", "bricks", "seams"])
def test_no_ray_is_late_on_the_gpu(name) -> None:
    from basrelief.engine.gpu import GpuEngine

    for edge in ("wrap", "clamp"):
        assert_exact(GpuEngine(), maps()[name], edge, 0.7, size=(96, 64))


def test_rays_along_the_axes_and_straight_down(cpu) -> None:
    """With one or both components of the travel 0."""
    heights = np.asarray(maps()["odd noise"], np.float32)
    field, baked = HeightField([heights]), Texture([baking.bounds(heights, "wrap")])
    random = np.random.default_rng(1)
    for travel in ([0, 0], [0.7, 0], [0, -0.4], [-0.3, 0], [1e-30, 0.2], [0.25, 0.25]):
        uv = random.random(2)
        hit = exact(field, baked, flat_ray(uv, travel), Nothing())
        at = np.array([*Vec2(*uv)], float), np.array([*Vec2(*travel)], float)
        wanted = intersect_height_field(heights, [at[0]], [at[1]])
        assert float(hit.height) == pytest.approx(wanted.height[0], abs=2e-5)


@pytest.mark.parametrize("travel", [(-0.0, -0.0), (-0.0, 0.3), (-0.3, -0.0), (0.2, -0.0)])
def test_the_sign_of_a_zero_travel_does_not_matter(travel) -> None:
    """A negative zero does not send the ray sideways through all cells."""
    heights = np.asarray(maps()["odd noise"], np.float32)
    field, baked = HeightField([heights]), Texture([baking.bounds(heights, "wrap")])
    hit = exact(field, baked, flat_ray((0.31, 0.64), travel), Nothing())
    uv = [float(np.float32(0.31)), float(np.float32(0.64))]
    wanted = intersect_height_field(heights, [uv], [[float(np.float32(f)) for f in travel]])
    assert float(hit.height) == pytest.approx(wanted.height[0], abs=2e-5)
    assert hit.reads < 80
    assert hit.found


def test_a_ray_that_runs_out_of_steps_has_no_hit(monkeypatch) -> None:
    module = importlib.import_module("basrelief.techniques.exact")
    monkeypatch.setattr(module, "MAX_STEPS", 2)
    heights = np.zeros((64, 64), np.float32)
    field, baked = HeightField([heights]), Texture([baking.bounds(heights, "wrap")])
    hit = exact(field, baked, flat_ray((0.3, 0.6), (5.0, 1.0), cosine=0.1), Nothing())
    assert not hit.found
    assert 0.0 < hit.height < 1.0


def test_empty_space_is_skipped() -> None:
    """Above a low plain a ray reads only a few bounds and one cell."""
    heights = np.full((64, 64), 0.2, np.float32)
    _, _, height, reads = rays(CpuEngine(), heights, "wrap", 0.5)
    np.testing.assert_allclose(height, 0.2, atol=1e-5)
    assert reads.mean() < 9


def test_exact_draws_the_picture_of_a_very_fine_march() -> None:
    material = sample("cobbles", 128)
    size = (96, 54)
    found = render(Object(material, technique="exact", scale=0.1), size=size, samples=1)
    fine = {"min_steps": 2048, "max_steps": 2048, "search_steps": 10}
    march = render(
        Object(material, technique="relief", settings=fine, scale=0.1), size=size, samples=1
    )
    error = np.abs(found.uv - march.uv).max(-1)[found.hit] * 128
    assert (error < LATE).mean() > 0.999
    assert found.reads.mean() < 0.05 * march.reads.mean()


@pytest.mark.parametrize("shape", [(48, 48), (37, 53), (64, 16)])
def test_exact_is_exact_on_every_mip_level(shape) -> None:
    """B1: with heights "mip" the surface is the level at the ray's lod."""
    random = np.random.default_rng(5)
    heights = random.random(shape).astype(np.float32)
    levels = levels_of(heights)
    field = HeightField(levels, filter="mip")
    baked = Texture([baking.bounds(heights, "wrap", all_levels=True)])
    uv = random.random((12, 2)).astype(np.float32)
    travel = (random.random((12, 2)) - 0.5).astype(np.float32)
    for level, of_level in enumerate(levels):
        wanted = intersect_height_field(of_level, uv, travel).height
        for k in range(12):
            ray = Ray(Vec2(*uv[k]), Vec2(*travel[k]), 1.0, 1.0, 0.5, lod=float(level))
            hit = exact(field, baked, ray, Nothing())
            assert float(hit.height) == pytest.approx(wanted[k], abs=2e-5)


def test_the_mip_level_follows_the_footprint() -> None:
    """Pictures with "sharp" and "mip" differ by less than half a tile from afar, and are equal from
    nearby."""
    material = sample("gravel", 64)
    far, near = Orbit(20.0, 40.0, 14.0), Orbit(20.0, 60.0, 0.4)
    for camera, equal in ((far, False), (near, True)):
        sharp, mip = (
            render(Object(material, technique="exact", heights=kind, scale=0.1),
                   size=(64, 36), samples=1, camera=camera)
            for kind in ("sharp", "mip")
        )  # fmt: skip
        assert np.allclose(sharp.uv, mip.uv, atol=1e-5) == equal
        both = sharp.hit & mip.hit
        assert np.abs(sharp.uv - mip.uv)[both].max() < 0.5
    assert mip.hit.mean() > 0.5


@pytest.mark.gpu
def test_engines_agree_on_each_level() -> None:
    scene = Scene(
        (Object(sample("gravel", 256), technique="exact", heights="mip", scale=0.1),),
        Orbit(30.0, 30.0, 2.0),
    )
    assert_engines_agree(scene, 256, size=(64, 36))
