"""Footprints against differences between neighbouring pixels in float64, and mip levels."""

from __future__ import annotations

import math

import numpy as np
import pytest

from basrelief.lang import IVec2, Mat3, Vec2, Vec3
from basrelief.lang.frontend import analyse
from basrelief.scene.cameras import look_at
from basrelief.shading import pixel as pixels
from basrelief.shading.camera import primary_ray
from basrelief.shading.intersection import Placement, footprint_at, intersect
from basrelief.shading.ray_differentials import Footprint, level_of_detail, transferred
from basrelief.shading.variant import Variant
from helpers.plain_python import pixel_in_python

SIZE = (40, 22)
CAMERAS = {
    "perspective": {"size": SIZE, "field_of_view": 40.0},
    "orthographic": {"size": SIZE, "orthographic_height": 1.3},
}
EYE, TARGET = (0.7, -0.9, 1.6), (0.1, 0.05, 0.0)
TURN = np.array([[0.8, -0.36, 0.48], [0.6, 0.48, -0.64], [0.0, 0.8, 0.6]])
TRANSFORM = TURN @ np.diag([1.3, 0.7, 0.4])
ORIGIN = np.array([0.2, -0.1, 0.3])


def a(vector) -> np.ndarray:
    return np.array([*vector], np.float64)


def mat3(matrix: np.ndarray) -> Mat3:
    return Mat3(*(Vec3(*matrix[:, k]) for k in range(3)))


def placement(tiling=(1.0, 1.0), shift=(0.0, 0.0), matrix=None, origin=(0.0, 0.0, 0.0)):
    matrix = np.eye(3) if matrix is None else matrix
    inverse = np.linalg.inv(matrix)
    return Placement(Vec3(*origin), mat3(inverse), Vec2(*tiling), Vec2(*shift), 1.0)


def ray_through(camera, x: float, y: float) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction in float64, from the camera's fields."""
    spanned = a(camera.corner) + a(camera.right) * x + a(camera.down) * y
    if camera.perspective == 1.0:
        return a(camera.position), spanned
    return a(camera.position) + spanned, a(camera.forward)


def uv_of_plane(camera, x, y, matrix, origin, tiling, shift) -> np.ndarray:
    """Texture coordinates of the plane at a position of the picture, in float64."""
    start, direction = ray_through(camera, x, y)
    inverse = np.linalg.inv(matrix)
    start, direction = inverse @ (start - origin), inverse @ direction
    point = start - direction * (start[2] / direction[2])
    return np.array([0.5 + point[0], 0.5 - point[1]]) * tiling + shift


@pytest.mark.parametrize(
    "function", [transferred, footprint_at, level_of_detail], ids=lambda function: function.name
)
def test_the_shaders_are_in_the_subset(function) -> None:
    assert analyse(function).entry.name == function.name


@pytest.mark.parametrize("lens", CAMERAS)
@pytest.mark.parametrize("placed", ["as it is", "turned and stretched"])
@pytest.mark.parametrize("tiling", [(1, 1), (3, -2)])
def test_the_footprint_is_the_difference_between_neighbouring_pixels(lens, placed, tiling) -> None:
    matrix, origin = (np.eye(3), np.zeros(3)) if placed == "as it is" else (TRANSFORM, ORIGIN)
    eye = matrix @ EYE + origin
    camera = look_at(list(eye), list(matrix @ TARGET + origin), **CAMERAS[lens])
    shift = np.array([0.25, -0.5])
    found = 0
    for x, y in [(20, 11), (15, 8), (24, 14), (21.5, 6.5), (17, 12)]:
        placed_at = placement(tiling, shift, matrix, tuple(origin))
        ray = primary_ray(camera, Vec2(x, y))
        intersection = intersect(ray, placed_at, Variant())
        if not intersection.found:
            continue
        found += 1
        footprint = footprint_at(ray, placed_at, intersection, intersection.distance)

        def uv(x, y):
            return uv_of_plane(camera, x, y, matrix, origin, np.array(tiling), shift)

        step = 1e-3
        dx = (uv(x + step, y) - uv(x - step, y)) / (2 * step)
        dy = (uv(x, y + step) - uv(x, y - step)) / (2 * step)
        np.testing.assert_allclose(a(intersection.uv), uv(x, y), atol=1e-5)
        size = max(np.abs(dx).max(), np.abs(dy).max())
        np.testing.assert_allclose(a(footprint.dx), dx, atol=2e-4 * size)
        np.testing.assert_allclose(a(footprint.dy), dy, atol=2e-4 * size)
    assert found >= 3


@pytest.mark.parametrize("name", ["box", "sphere", "cylinder"])
def test_the_footprint_on_solids_is_the_difference_of_the_shaders_uv(name) -> None:
    """Within 2 % of the shader's uv half a pixel to each side, as the surface is curved."""
    camera = look_at((1.2, 1.0, 2.0), (0, 0, 0), size=(400, 300), field_of_view=40.0)
    where = placement((3.0, -2.0), (0.0, 0.0), TRANSFORM)

    def intersection_at(x, y):
        return intersect(primary_ray(camera, Vec2(x, y)), where, Variant(shape=name))

    for x, y in [(200.5, 150.5), (190, 160), (215, 140)]:
        middle = intersection_at(x, y)
        assert middle.found
        ray = primary_ray(camera, Vec2(x, y))
        footprint = footprint_at(ray, where, middle, middle.distance)
        dx = a(intersection_at(x + 0.5, y).uv) - a(intersection_at(x - 0.5, y).uv)
        dy = a(intersection_at(x, y + 0.5).uv) - a(intersection_at(x, y - 0.5).uv)
        size = max(np.abs(dx).max(), np.abs(dy).max())
        np.testing.assert_allclose(a(footprint.dx), dx, atol=0.02 * size)
        np.testing.assert_allclose(a(footprint.dy), dy, atol=0.02 * size)


def test_the_footprint_of_a_ray_in_the_plane_is_finite() -> None:
    moved = transferred(1.0, Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, 0.001), Vec3(0, 0, 0.001))
    assert np.isfinite(a(moved)).all()


@pytest.mark.parametrize(
    ("dx", "dy", "level"),
    [
        ((1 / 64, 0), (0, 1 / 16), 0.0),  # a texel for a pixel, both ways
        ((4 / 64, 0), (0, 1 / 16), 2.0),  # the longer side counts
        ((1 / 64, 0), (0, 8 / 16), 3.0),  # in rows, which are fewer
        ((0, 8 / 16), (0, 0), 3.0),  # for any rotation of the picture
        ((3 / 64, 4 / 16), (0, 0), math.log2(5)),  # as long as the diagonal
        ((-6 / 64, 0), (0, 0), math.log2(6)),
        ((0.1 / 64, 0), (0, 0.2 / 16), 0.0),  # never finer than the map
        ((0, 0), (0, 0), 0.0),
    ],
)
def test_the_level_of_detail_is_the_longer_side_in_texels(dx, dy, level) -> None:
    footprint = Footprint(Vec2(*dx), Vec2(*dy))
    assert level_of_detail(footprint, IVec2(64, 16)) == pytest.approx(level, abs=1e-5)


def test_the_footprint_is_that_of_the_undisplaced_uv(monkeypatch) -> None:
    """G5: the relief changes the uv at which maps are read, not the footprint."""
    from basrelief.engine import choose_device
    from basrelief.material import sample
    from basrelief.rendering.programs import program_of, values_of
    from basrelief.scene import Object, Orbit, Scene

    points = []
    wrapped = pixels.surface_at

    def recording(point, *rest):
        points.append(point)
        return wrapped(point, *rest)

    monkeypatch.setattr(pixels, "surface_at", recording)
    seen = {}
    for technique in ("flat", "relief"):
        obj = Object(sample("bricks", (24, 32)), technique=technique, scale=0.2)
        scene = Scene((obj,), camera=Orbit(20, 30, 2.0))
        program, values = (
            program_of(obj.resolved),
            values_of(obj.resolved, scene, (32, 18), choose_device("cpu")),
        )
        points.clear()
        for place in [(16, 9), (12, 8), (19, 11)]:
            pixel_in_python(program, values, *place)
        seen[technique] = list(points)
    assert len(seen["flat"]) == len(seen["relief"]) == 3
    for still, moved in zip(seen["flat"], seen["relief"], strict=True):
        assert moved.footprint == still.footprint
        assert moved.uv != still.uv
