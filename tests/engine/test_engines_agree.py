"""The CPU against the GPU and plain Python, and determinism of each engine."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang.types import leaf_values
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import program_of, values_of
from basrelief.rendering.render import render
from basrelief.scene import SHAPES, Object, Orbit, Scene, directional, point, spot
from basrelief.shading.pixel import Pixel
from basrelief.techniques import TECHNIQUES
from helpers import agreement
from helpers.agreement import COLOR_TOLERANCE, color_difference
from helpers.plain_python import pixel_in_python

SIZE = (160, 90)
TEXELS = 96
RELIEFS = ("bricks", "cobbles", "gravel", "tiles", "terrain")


@functools.cache
def cpu() -> CpuEngine:
    return CpuEngine()


@functools.cache
def gpu() -> Any:
    from basrelief.engine.gpu import GpuEngine

    return GpuEngine()


@functools.cache
def material(name: str, texels: int = TEXELS) -> Material:
    return sample(name, texels)


def drawn(scene: Scene, engine: Any, size: tuple[int, int] = SIZE, samples: int = 1) -> Frame:
    return render(scene, size=size, samples=samples, device=engine)


def assert_agree(one: Frame, other: Frame) -> None:
    agreement.assert_agree(one, other, TEXELS)


@pytest.mark.gpu
@pytest.mark.parametrize("name", RELIEFS)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("technique", TECHNIQUES)
def test_cpu_and_gpu_agree(technique: str, shape: str, name: str) -> None:
    scene = Scene((Object(material(name), shape=shape, technique=technique),))
    assert_agree(drawn(scene, cpu()), drawn(scene, gpu()))


@pytest.mark.gpu
@pytest.mark.parametrize("technique", TECHNIQUES)
def test_engines_agree_at_a_grazing_angle_with_other_options(technique: str) -> None:
    obj = Object(
        material("cobbles"),
        technique=technique,
        projection="biased",
        reference_height=0.25,
        scale=0.15,
        edge="clip",
        tiling=(1.25, -0.9),
        shift=(0.0, 0.95),
    )
    lights = (
        directional(80.0, 30.0),
        point((0.2, 0.3, 0.1)),
        spot((-0.4, 0.5, 0.3), softness=0.8),
    )
    scene = Scene((obj,), camera=Orbit(-70.0, 18.0, 1.4), lights=lights, shading_model="phong")
    assert_agree(drawn(scene, cpu()), drawn(scene, gpu()))


def test_the_comparison_can_fail() -> None:
    """With coordinates off by a tenth of a texel, and with a brighter picture."""
    frame = drawn(Scene((Object(material("bricks"), technique="flat"),)), cpu())
    assert_agree(frame, frame)
    moved = Frame(
        frame.color,
        frame.distance,
        frame.uv + np.float32(0.1 / TEXELS),
        frame.hit,
        frame.reads,
        "x",
    )
    with pytest.raises(AssertionError, match=r"within 0\.05\s+pixel"):
        assert_agree(frame, moved)
    brighter = Frame(
        frame.color * np.float32(1.1), frame.distance, frame.uv, frame.hit, frame.reads, "x"
    )
    with pytest.raises(AssertionError, match=r"within 2\.0\s+pixel"):
        assert_agree(frame, brighter)


# --- plain Python ---------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion", "relief"])
def test_python_computes_the_same_pixel_as_the_cpu(technique: str, shape: str) -> None:
    """The whole pixel, bit for bit."""
    assert_python_agrees(
        Scene((Object(material("cobbles", 32), shape=shape, technique=technique),))
    )


@pytest.mark.parametrize("heights", ["smooth", "mip", "columns"])
def test_python_reads_heights_as_the_cpu_does(heights: str) -> None:
    kind = {"technique": "texel"} if heights == "columns" else {"heights": heights}
    obj = Object(material("gravel", 32), scale=0.3, tiling=(3.0, 3.0), **kind)
    assert_python_agrees(Scene((obj,), shadows="soft"))


def assert_python_agrees(scene: Scene) -> None:
    obj = scene.objects[0]
    program, values = (
        program_of(obj.resolved, scene),
        values_of(obj.resolved, scene, (40, 24), cpu()),
    )
    planes = cpu().run(program, values, (40, 24))
    for x, y in [(20, 12), (15, 9), (24, 14), (0, 0)]:
        expected = pixel_in_python(program, values, x, y)
        actual = [planes[name][y, x] for name, _ in program.planes]
        assert actual == [*leaf_values(expected, Pixel)]
    assert planes["hit"][12, 20]


# --- the same bytes -------------------------------------------------------------------------------


def scene_of_two() -> Scene:
    """A plane and a sphere that intersect."""
    floor = Object(material("bricks", 64), technique="parallax_occlusion", scale=0.1)
    ball = Object(material("gravel", 64), shape="sphere", technique="relief")
    return Scene((floor, ball), camera=Orbit(30.0, 35.0, 2.5))


def as_bytes(frame: Frame) -> bytes:
    parts = (frame.color, frame.distance, frame.uv, frame.hit, frame.reads)
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)


SMALL = [(1, 1), (5, 3), (67, 19)]


@pytest.mark.parametrize("size", SMALL, ids=str)
def test_the_cpu_gives_the_same_bytes_for_all_lanes_and_threads(size: tuple[int, int]) -> None:
    expected = as_bytes(drawn(scene_of_two(), cpu(), size, samples=2))
    for lanes, threads in ((4, 1), (8, 2), (16, 3), (8, 1)):
        engine = CpuEngine(lanes, threads)
        actual = as_bytes(drawn(scene_of_two(), engine, size, samples=2))
        assert actual == expected, f"{lanes} lanes and {threads} threads differ"


@pytest.mark.gpu
@pytest.mark.parametrize("size", SMALL, ids=str)
def test_the_gpu_gives_the_same_bytes_again(size: tuple[int, int]) -> None:
    once, again = (as_bytes(drawn(scene_of_two(), gpu(), size, samples=2)) for _ in range(2))
    assert once == again


@pytest.mark.gpu
@pytest.mark.parametrize("size", SMALL, ids=str)
def test_small_pictures_agree(size: tuple[int, int]) -> None:
    """A single pixel, and pictures smaller than a group of lanes."""
    one, other = (drawn(scene_of_two(), engine, size) for engine in (cpu(), gpu()))
    assert one.color.shape == other.color.shape == (size[1], size[0], 4)
    np.testing.assert_array_equal(one.hit, other.hit)
    assert np.quantile(color_difference(one, other), 0.98) <= COLOR_TOLERANCE


def test_a_pixel_is_the_same_in_a_picture_of_rows_and_alone() -> None:
    """A smaller size computes the same pixels as a larger one, with the same camera."""
    obj = Object(material("bricks", 64), technique="relief")
    scene = Scene((obj,))
    program, values = program_of(obj.resolved), values_of(obj.resolved, scene, (67, 19), cpu())
    whole = cpu().run(program, values, (67, 19))
    part = cpu().run(program, values, (5, 3))
    for name in whole:
        np.testing.assert_array_equal(whole[name][:3, :5], part[name])
