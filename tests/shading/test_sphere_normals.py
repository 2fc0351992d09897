"""Normals on a sphere: the relief has the same depth on every tile."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import Mat3, Vec2, Vec3
from basrelief.shading.camera import CameraRay
from basrelief.shading.intersection import Intersection, Placement
from basrelief.shading.pixel import shading_point
from basrelief.shading.shapes import FAR, ShapeRay, sphere_chart
from basrelief.shading.surfaces.surface import Surface
from basrelief.shading.tangent_frame import tangent_frame
from basrelief.shading.variant import Variant

SCALE = 0.08
TILES = (4.0, 2.0)
UNIT = Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1))


def drawn_normal(latitude: float, along_u: float, along_v: float, variant: Variant) -> np.ndarray:
    """The shading normal for heights that rise by given amounts over a tile along u and v."""
    y, ring = np.sin(np.radians(latitude)), np.cos(np.radians(latitude))
    normal = Vec3(0.6 * ring, y, 0.8 * ring)
    surface_chart = sphere_chart(normal)
    frame = tangent_frame(
        normal, surface_chart.along_u / TILES[0], surface_chart.along_v / TILES[1]
    )
    intersection = Intersection(
        True, 2.0, FAR, Vec2(0.0), frame, Vec3(0, 0, 1), ShapeRay(normal, -normal), 1.0
    )
    # the normal of heights with square texels and a range of SCALE tile widths
    leaning = Vec3(-SCALE * along_u, SCALE * along_v, 1.0)
    surface = Surface(Vec3(1.0), 1.0, leaning, 1.0, 1.0, 0.0, Vec3(0.0), Vec3(0.0), 1.0)
    none = Vec3(0.0)
    ray = CameraRay(normal * 3.0, -normal, none, none, none, none)
    placement = Placement(none, UNIT, Vec2(*TILES), Vec2(0.0), 1.0)
    point = shading_point(ray, placement, intersection, surface, Vec3(0, 0, 1), 2.0, variant)
    return np.array([*point.normal], float)


@pytest.mark.parametrize("latitude", [0.0, 35.0, 60.0, -80.0])
@pytest.mark.parametrize("slopes", [(1.0, 0.0), (0.0, 0.7), (-0.5, 1.3)])
def test_the_normal_is_that_of_the_displaced_sphere(latitude: float, slopes) -> None:
    """∝ ∂S/∂u × ∂S/∂v of S = P + D h N at h = 0, by differences in float64."""
    deep = SCALE * np.pi / TILES[0]
    u0 = np.arctan2(0.6, 0.8) / (2 * np.pi)
    v0 = 0.5 - latitude / 180.0

    def displaced(u: float, v: float) -> np.ndarray:
        azimuth, polar = 2 * np.pi * u, np.pi * v
        out = np.array(
            [np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)]
        )
        height = slopes[0] * (u - u0) * TILES[0] + slopes[1] * (v - v0) * TILES[1]
        return out * (0.5 + deep * height)

    step = 1e-6
    along_u = displaced(u0 + step, v0) - displaced(u0 - step, v0)
    along_v = displaced(u0, v0 + step) - displaced(u0, v0 - step)
    wanted = np.cross(along_v, along_u)
    got = drawn_normal(latitude, *slopes, Variant(shape="sphere", displaced=True))
    np.testing.assert_allclose(got, wanted / np.linalg.norm(wanted), atol=2e-5)


def test_without_a_relief_the_normal_map_is_used_as_stored() -> None:
    flat = Variant(shape="sphere")
    steep, at_equator = (drawn_normal(latitude, 1.0, 0.0, flat) for latitude in (60.0, 0.0))
    outward = [np.array([0.6 * c, s, 0.8 * c]) for s, c in ((3**0.5 / 2, 0.5), (0.0, 1.0))]
    assert steep @ outward[0] == pytest.approx(at_equator @ outward[1], abs=1e-6)
