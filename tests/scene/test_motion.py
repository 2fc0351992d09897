"""Motions change what they describe, by the right amount, and nothing else."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from basrelief.errors import InputError
from basrelief.material import Map, Material, hole, sample
from basrelief.scene import LookAt, Object, Orbit, Scene, directional, placed, point, rotated, spot
from basrelief.scene.motion import (
    MOTIONS,
    Lighting,
    Moment,
    Opening,
    Orbiting,
    Scrolling,
    apply_motions,
)

SIZE = (64, 36)
HEIGHTS = np.array([[0.2, 0.9, 0.4], [0.6, 0.1, 0.5]], np.float32)[:, :, None]
BUMPY = Material("made up", height=Map(HEIGHTS, False, "made up"))


def scene(camera: Orbit | LookAt | None = None, lights: Any = None, **options: Any) -> Scene:
    base = Scene((Object(BUMPY, **options),), camera=camera or Orbit())
    return base if lights is None else replace(base, lights=lights)


def at(share: float, seconds: float = 0.0, size: tuple[int, int] = SIZE) -> Moment:
    return Moment(share, seconds, size)


def is_close(actual: Any, expected: Any) -> bool:
    return bool(np.abs(np.subtract([*actual], [*expected])).max() < 1e-6)


# --- orbit ----------------------------------------------------------------------------------------


def test_a_quarter_of_the_film_is_a_quarter_of_the_circle() -> None:
    camera = Orbiting()(scene(Orbit(25.0, 30.0, 2.5, (0.1, 0.2, 0.3))), at(0.25)).camera
    assert camera == Orbit(115.0, 30.0, 2.5, (0.1, 0.2, 0.3))


def test_turns_and_the_other_way_round() -> None:
    assert Orbiting(2.0)(scene(Orbit(10.0)), at(0.25)).camera.azimuth == 190.0
    assert Orbiting(-0.5)(scene(Orbit(10.0)), at(0.5)).camera.azimuth == -80.0


@pytest.mark.parametrize("size", [(64, 36), (36, 64), (300, 20)])
@pytest.mark.parametrize("shape", ["plane", "box", "sphere", "cylinder"])
def test_the_distance_is_the_same_all_the_way(shape: str, size: tuple[int, int]) -> None:
    start = scene(shape=shape)
    distances = {Orbiting()(start, at(k / 7, size=size)).camera.distance for k in range(7)}
    assert len(distances) == 1
    assert None not in distances


@examples(max_examples=60)
@given(
    elevation=st.floats(-89.0, 89.0),
    view=st.floats(5.0, 120.0),
    size=st.tuples(st.integers(8, 400), st.integers(8, 400)),
    shape=st.sampled_from(["plane", "box", "sphere", "cylinder"]),
    stretch=st.tuples(*[st.floats(0.2, 3.0)] * 3),
    position=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    orthographic=st.booleans(),
)
def test_the_distance_is_the_largest_on_the_way_round(
    elevation: float,
    view: float,
    size: tuple[int, int],
    shape: str,
    stretch: tuple[float, float, float],
    position: tuple[float, float, float],
    orthographic: bool,
) -> None:
    """The maximum of `framing` over whole degrees is close to it, and never larger."""
    lens = {"orthographic_height": 1.5} if orthographic else {"field_of_view": view}
    camera = Orbit(0.0, elevation, None, (0.1, -0.2, 0.05), **lens)
    points = (
        scene(shape=shape, transform=placed(position, stretch))
        .objects[0]
        .resolved.bounding_points()
    )
    all_round = camera.framing_all_azimuths(points, size).distance
    each = [
        replace(camera, azimuth=float(azimuth)).framing(points, size).distance
        for azimuth in range(360)
    ]
    assert all_round is not None
    assert max(each) <= all_round + 1e-5 * abs(all_round)
    assert max(each) == pytest.approx(all_round, rel=2e-3)


@pytest.mark.parametrize("shape", ["plane", "box", "sphere", "cylinder"])
def test_the_object_stays_in_the_frame(shape: str) -> None:
    """All bounding points lie within the picture, and some near its border."""
    width, height = SIZE
    start = scene(shape=shape)
    furthest = 0.0
    for k in range(90):
        now = Orbiting()(start, at(k / 90))
        camera = now.shader_camera(SIZE)
        place, right, down, forward = (
            np.array([*v], np.float64)
            for v in (camera.position, camera.right, camera.down, camera.forward)
        )
        away = start.objects[0].resolved.bounding_points() - place
        depth = away @ forward
        x = away @ right / (right @ right) / depth / (width / 2)
        y = away @ down / (down @ down) / depth / (height / 2)
        furthest = max(furthest, float(np.abs([x, y]).max()))
    assert furthest < 1.0
    assert furthest == pytest.approx(0.92, abs=0.005)


def test_a_look_at_camera_rotates_around_its_target() -> None:
    start = scene(LookAt((0.5, 1.0, 2.5), (0.5, 0.25, 0.5)))
    camera = Orbiting()(start, at(0.25)).camera
    assert is_close(camera.position, (2.5, 1.0, 0.5))
    assert camera.target == (0.5, 0.25, 0.5)
    assert is_close(camera.up, (0.0, 1.0, 0.0))


def test_look_at_and_orbit_rotate_equally() -> None:
    """Both shader cameras are equal at any fraction of a turn."""
    start = Orbit(0.0, 40.0, 2.0, (0.1, 0.2, 0.3))
    stood = LookAt(tuple(map(float, start.camera(SIZE).position)), start.target)
    for share in (0.0, 0.1, 0.6):
        a = Orbiting()(scene(start), at(share)).shader_camera(SIZE)
        b = Orbiting()(scene(stood), at(share)).shader_camera(SIZE)
        for name in ("position", "corner", "right", "down", "forward"):
            assert is_close(getattr(a, name), getattr(b, name))


def test_a_vertical_view_rotates_the_picture() -> None:
    start = scene(LookAt((0.0, 2.0, 0.0)))
    assert is_close(Orbiting()(start, at(0.0)).camera.up_direction, (0.0, 0.0, -1.0))
    assert is_close(Orbiting()(start, at(0.25)).camera.up_direction, (-1.0, 0.0, 0.0))


# --- light ----------------------------------------------------------------------------------------


def test_the_first_light_rotates() -> None:
    lights = (directional(-50.0, 35.0, (1.0, 0.5, 0.2), 2.0), directional(80.0, 20.0))
    now = Lighting()(scene(lights=lights), at(0.25))
    expected = directional(40.0, 35.0, (1.0, 0.5, 0.2), 2.0)
    assert is_close(now.lights[0].direction, expected.direction)
    assert is_close(now.lights[0].color, expected.color)
    assert now.lights[1] is lights[1]


def test_a_point_light_rotates_around_the_cameras_target() -> None:
    start = scene(Orbit(target=(0.5, 0.0, 0.0)), (point((0.5, 2.0, 1.0)),))
    assert is_close(Lighting()(start, at(0.25)).lights[0].position, (1.5, 2.0, 0.0))
    assert is_close(Lighting(-1.0)(start, at(0.25)).lights[0].position, (-0.5, 2.0, 0.0))


def test_a_spot_light_rotates_with_its_cone() -> None:
    start = scene(
        Orbit(target=(0.5, 0.0, 0.0)), (spot((0.5, 2.0, 1.0), (0.5, 0.0, 0.0), angle=20),)
    )
    now = Lighting()(start, at(0.25)).lights[0]
    expected = spot((1.5, 2.0, 0.0), (0.5, 0.0, 0.0), angle=20)
    for name in ("position", "direction"):
        assert is_close(getattr(now, name), getattr(expected, name))
    assert (now.cos_inner, now.cos_outer) == (expected.cos_inner, expected.cos_outer)


def test_a_scene_without_lights_is_refused() -> None:
    with pytest.raises(InputError, match="the scene has none"):
        Lighting()(scene(lights=()), at(0.5))


# --- scroll ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("edge", ["wrap", "clip"])
def test_maps_scroll_by_a_quarter_of_the_shape_a_second(edge: Any) -> None:
    """A quarter of the shape's own coordinate is a quarter of all its tiles."""
    start = scene(tiling=(3.0, 2.0), shift=(0.1, 0.2), edge=edge)
    shift = Scrolling()(start, at(0.9, seconds=1.0)).objects[0].shift
    assert shift == pytest.approx((0.1 + 0.25 * 3.0, 0.2))
    shift = Scrolling(-0.05, 0.1)(start, at(0.9, seconds=3.0)).objects[0].shift
    assert shift == pytest.approx((0.1 - 0.15 * 3.0, 0.2 + 0.3 * 2.0))


def test_whole_tiles_are_dropped_for_repeating_maps() -> None:
    shift = Scrolling()(scene(tiling=(1.0, 1.0)), at(0.5, seconds=4e4 + 1.0)).objects[0].shift
    assert shift == pytest.approx((0.25, 0.0))
    clamped = Scrolling()(scene(tiling=(1.0, 1.0), edge="clamp"), at(0.5, seconds=9.0)).objects[0]
    assert clamped.shift == pytest.approx((2.25, 0.0))


# --- all ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", MOTIONS)
def test_a_film_begins_with_the_initial_scene(name: str) -> None:
    camera = Orbit(25.0, 30.0, 2.5)
    start = scene(camera, shift=(0.3, 0.6))
    now = MOTIONS[name]()(start, at(0.0))
    assert now.camera == camera
    assert now.objects[0].shift == (0.3, 0.6)
    assert is_close(now.lights[0].direction, start.lights[0].direction)


# --- opening --------------------------------------------------------------------------------------


def test_a_hole_opens_and_closes_again() -> None:
    """L7: closed at the ends of the film, widest in the middle, symmetrical in time."""
    ground = sample("cracks", 32)
    start = Scene((Object(ground, scale=0.3), Object(BUMPY)))
    shares = [0.0, 0.2, 0.5, 0.8, 1.0]
    drawn = [Opening()(start, at(share)).resolved[0].material for share in shares]
    heights = [material.height.linear() for material in drawn]
    assert (heights[0] == 1.0).all()
    assert (heights[4] == 1.0).all()
    expected = hole(ground, sample("dust", 32), 1.0).height.linear()
    np.testing.assert_array_equal(heights[2], expected)
    assert expected.min() < 0.1
    np.testing.assert_allclose(heights[1], heights[3], atol=2e-5)
    assert (heights[1] <= heights[0]).all()
    assert (heights[2] <= heights[1]).all()
    assert start.objects[0].material is ground
    assert Opening()(start, at(0.5)).objects[1] is start.objects[1]


def test_a_hole_needs_heights_and_no_opening_to_open() -> None:
    with pytest.raises(InputError, match="needs a height map"):
        Opening()(Scene((Object(sample("grid", 8)),)), at(0.5))
    opened = Object(sample("cracks", 8), opening=0.5)
    with pytest.raises(
        InputError, match=r"replaces the opening 0\.5 of the first object; omit one"
    ):
        Opening()(Scene((opened,)), at(0.5))


def test_motions_combine_and_keep_the_scene() -> None:
    start = scene(Orbit(10.0), transform=rotated("x", 20.0))
    now = apply_motions(start, [Orbiting(), Scrolling(), Lighting()], at(0.5, 1.0))
    assert now.camera.azimuth == 190.0
    assert now.objects[0].shift == (0.25, 0.0)
    assert now.lights[0].direction != start.lights[0].direction
    assert start.camera == Orbit(10.0)
    assert start.objects[0].shift == (0.0, 0.0)
    assert now.objects[0].transform is start.objects[0].transform
    assert apply_motions(start, [], at(0.5)) is start


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e9])
@pytest.mark.parametrize("name", MOTIONS)
def test_numbers_out_of_range(name: str, bad: float) -> None:
    field = next(iter(MOTIONS[name].__dataclass_fields__))
    with pytest.raises(InputError, match=f"{field} is"):
        MOTIONS[name](**{field: bad})
