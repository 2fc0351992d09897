"""Primary rays against closed forms and finite differences of float64 rays."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basrelief.errors import InputError
from basrelief.lang import Vec2
from basrelief.lang.frontend import analyse
from basrelief.scene.cameras import look_at, orbit
from basrelief.shading.camera import Camera, primary_ray

SIZE = (48, 20)
PERSPECTIVE = {"size": SIZE, "field_of_view": 50.0}
ORTHOGRAPHIC = {"size": SIZE, "orthographic_height": 3.0}


def a(vector):
    return np.array([*vector], np.float64)


def ray_at(camera, x, y):
    return primary_ray(camera, Vec2(x, y))


def reference_ray(camera, x, y):
    """Origin and unit direction in float64, from the camera's fields."""
    spanned = a(camera.corner) + a(camera.right) * x + a(camera.down) * y
    if camera.perspective == 1.0:
        return a(camera.position), spanned / np.linalg.norm(spanned)
    return a(camera.position) + spanned, a(camera.forward)


def test_the_shader_is_in_the_subset():
    assert analyse(primary_ray).entry.name == "primary_ray"


def test_a_camera_on_z_sees_x_to_the_right_and_y_upwards():
    camera = look_at((0, 0, 4), (0, 0, 0), **PERSPECTIVE)
    middle = a(ray_at(camera, 24, 10).direction)
    right = a(ray_at(camera, 25, 10).direction)
    below = a(ray_at(camera, 24, 11).direction)
    np.testing.assert_allclose(middle, (0, 0, -1), atol=1e-6)
    assert right[0] > 0.01
    assert right[1] == pytest.approx(0, abs=1e-6)
    assert below[1] < -0.01
    assert below[0] == pytest.approx(0, abs=1e-6)


def test_the_field_of_view_is_vertical_and_pixels_are_square():
    camera = look_at((1, 2, 3), (4, -1, 2), **PERSPECTIVE)
    forward = a(ray_at(camera, 24, 10).direction)
    top = a(ray_at(camera, 24, 0).direction)
    side = a(ray_at(camera, 48, 10).direction)
    assert math.degrees(math.acos(forward @ top)) == pytest.approx(25, abs=1e-3)
    half_width = math.tan(math.radians(25)) * 48 / 20
    assert math.acos(forward @ side) == pytest.approx(math.atan(half_width), abs=1e-5)


def test_perspective_rays_leave_one_point():
    ray = ray_at(look_at((1, 2, 3), (0, 0, 0), **PERSPECTIVE), 7.5, 3.5)
    assert a(ray.origin).tolist() == [1, 2, 3]
    assert a(ray.origin_dx).tolist() == [0, 0, 0]
    assert a(ray.origin_dy).tolist() == [0, 0, 0]


def test_orthographic_rays_are_parallel_and_one_pixel_apart():
    camera = look_at((0, 0, 4), (0, 0, 0), **ORTHOGRAPHIC)
    pixel = 3.0 / 20
    ray = ray_at(camera, 0, 0)
    np.testing.assert_allclose(a(ray.origin), (-24 * pixel, 1.5, 4), atol=1e-6)
    np.testing.assert_allclose(a(ray_at(camera, 48, 20).origin), (24 * pixel, -1.5, 4), atol=1e-6)
    np.testing.assert_allclose(a(ray.origin_dx), (pixel, 0, 0), atol=1e-7)
    np.testing.assert_allclose(a(ray.origin_dy), (0, -pixel, 0), atol=1e-7)
    for place in ((0, 0), (48, 3)):
        ray = ray_at(camera, *place)
        np.testing.assert_allclose(a(ray.direction), (0, 0, -1), atol=1e-6)
        assert a(ray.direction_dx).tolist() == [0, 0, 0]
        assert a(ray.direction_dy).tolist() == [0, 0, 0]


@pytest.mark.parametrize("projection", [PERSPECTIVE, ORTHOGRAPHIC])
@given(
    x=st.floats(0, 48),
    y=st.floats(0, 20),
    azimuth=st.floats(-180, 180),
    elevation=st.floats(-90, 90),
)
@settings(max_examples=60)
def test_the_ray_and_its_derivatives_are_those_of_a_float64_camera(
    projection, x, y, azimuth, elevation
):
    camera = orbit((0.3, -0.2, 0.1), 5, azimuth, elevation, **projection)
    x, y = float(np.float32(x)), float(np.float32(y))
    ray = ray_at(camera, x, y)
    origin, direction = reference_ray(camera, x, y)
    np.testing.assert_allclose(a(ray.origin), origin, atol=2e-6)
    np.testing.assert_allclose(a(ray.direction), direction, atol=1e-6)
    step = 1e-4
    for (dx, dy), of_origin, of_direction in (
        ((step, 0), ray.origin_dx, ray.direction_dx),
        ((0, step), ray.origin_dy, ray.direction_dy),
    ):
        after = reference_ray(camera, x + dx, y + dy)
        before = reference_ray(camera, x - dx, y - dy)
        np.testing.assert_allclose(
            a(of_origin), (after[0] - before[0]) / (2 * step), rtol=1e-4, atol=1e-7
        )
        np.testing.assert_allclose(
            a(of_direction), (after[1] - before[1]) / (2 * step), rtol=1e-4, atol=1e-7
        )


def test_the_derivatives_reach_the_neighbouring_pixels():
    camera = orbit((0, 0, 0), 3, 33, 21, size=(1920, 1080), field_of_view=60)
    here = ray_at(camera, 300.5, 200.5)
    for there, change in (
        (ray_at(camera, 301.5, 200.5), here.direction_dx),
        (ray_at(camera, 300.5, 201.5), here.direction_dy),
    ):
        moved = a(there.direction) - a(here.direction)
        np.testing.assert_allclose(moved, a(change), atol=1e-6)
        assert np.linalg.norm(moved) > 4e-4


@pytest.mark.parametrize("projection", [PERSPECTIVE, ORTHOGRAPHIC])
@pytest.mark.parametrize(
    ("azimuth", "elevation", "backward", "right", "up"),
    [
        (0, 0, (0, 0, 1), (1, 0, 0), (0, 1, 0)),
        (90, 0, (1, 0, 0), (0, 0, -1), (0, 1, 0)),
        (180, 0, (0, 0, -1), (-1, 0, 0), (0, 1, 0)),
        (0, 90, (0, 1, 0), (1, 0, 0), (0, 0, -1)),
        (0, -90, (0, -1, 0), (1, 0, 0), (0, 0, 1)),
        (90, 30, (math.sqrt(0.75), 0.5, 0), (0, 0, -1), (-0.5, math.sqrt(0.75), 0)),
    ],
)
def test_an_orbit_camera_stands_at_its_angles(projection, azimuth, elevation, backward, right, up):
    target = np.array((1.0, -2.0, 0.5))
    camera = orbit(target, 4, azimuth, elevation, **projection)
    np.testing.assert_allclose(a(camera.position), target + 4 * np.array(backward), atol=1e-6)
    np.testing.assert_allclose(a(camera.forward), -np.array(backward), atol=1e-6)
    unit = np.linalg.norm(a(camera.right))
    np.testing.assert_allclose(a(camera.right) / unit, right, atol=1e-6)
    np.testing.assert_allclose(a(camera.down) / unit, -np.array(up), atol=1e-6)


def test_a_picture_of_one_pixel_looks_at_the_target():
    camera = look_at((3, 0, 4), (0, 0, 0), size=(1, 1), field_of_view=90)
    np.testing.assert_allclose(a(ray_at(camera, 0.5, 0.5).direction), (-0.6, 0, -0.8), atol=1e-6)


def test_the_fields_are_float32():
    camera = look_at((0.1, 0.2, 0.3), (0, 0, 0), **PERSPECTIVE)
    assert isinstance(camera, Camera)
    assert isinstance(camera.position.x, np.float32)
    assert camera.perspective == 1.0
    assert look_at((0.1, 0.2, 0.3), (0, 0, 0), **ORTHOGRAPHIC).perspective == 0.0


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"position": (0, 0, 0)}, "same point"),
        ({"up": (0, 0, 2)}, "parallel to the view"),
        ({"up": (0, 0, 0)}, "no length"),
        ({"position": (0, math.nan, 1)}, "position"),
        ({"target": (0, 1)}, "target"),
        ({"size": (0, 4)}, "0 × 4"),
        ({"field_of_view": None}, "either"),
        ({"orthographic_height": 2.0}, "either"),
        ({"field_of_view": 180.0}, "180"),
        ({"field_of_view": None, "orthographic_height": -1.0}, "-1"),
    ],
)
def test_an_invalid_camera_is_refused(changed, message):
    right = {"position": (0, 0, 3), "target": (0, 0, 0), "size": (4, 3), "field_of_view": 40.0}
    look_at(**right)
    with pytest.raises(InputError, match=message):
        look_at(**{**right, **changed})


def test_an_orbit_at_no_distance_is_refused():
    with pytest.raises(InputError, match="distance 0"):
        orbit((0, 0, 0), 0, 0, 0, **PERSPECTIVE)
