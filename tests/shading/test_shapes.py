"""Shapes against their parametric forms in float64: points, normals, ∂P/∂u, ∂P/∂v, uv, exits."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basrelief.lang import Vec3
from basrelief.lang.frontend import analyse
from basrelief.lang.types import leaf_values
from basrelief.shading.shapes import (
    FAR,
    Chart,
    ShapeIntersection,
    ShapeRay,
    chart,
    intersect_box,
    intersect_cylinder,
    intersect_plane,
    intersect_shape,
    intersect_sphere,
    max_shell_distance,
    no_intersection,
    slab_interval,
    sphere_interval,
)
from basrelief.shading.variant import Variant

SHAPES = [intersect_plane, intersect_box, intersect_sphere, intersect_cylinder]
SOLIDS = [intersect_box, intersect_sphere, intersect_cylinder]


def on_sphere(u, v):
    across, down = 2 * math.pi * (u - 0.5), math.pi * v
    ring = math.sin(down)
    return (0.5 * ring * math.sin(across), 0.5 * math.cos(down), 0.5 * ring * math.cos(across))


def on_cylinder(u, v):
    across = 2 * math.pi * (u - 0.5)
    return (0.5 * math.sin(across), 0.5 - v, 0.5 * math.cos(across))


def on_top(u, v):
    return (u - 0.5, 0.5, v - 0.5)


def on_bottom(u, v):
    return (u - 0.5, -0.5, 0.5 - v)


PATCHES = {
    "plane": (intersect_plane, lambda u, v: (u - 0.5, 0.5 - v, 0)),
    "box front": (intersect_box, lambda u, v: (u - 0.5, 0.5 - v, 0.5)),
    "box back": (intersect_box, lambda u, v: (0.5 - u, 0.5 - v, -0.5)),
    "box right": (intersect_box, lambda u, v: (0.5, 0.5 - v, 0.5 - u)),
    "box left": (intersect_box, lambda u, v: (-0.5, 0.5 - v, u - 0.5)),
    "box top": (intersect_box, on_top),
    "box bottom": (intersect_box, on_bottom),
    "sphere": (intersect_sphere, on_sphere),
    "cylinder side": (intersect_cylinder, on_cylinder),
    "cylinder top": (intersect_cylinder, lambda u, v: on_top(0.5 + math.pi * (u - 0.5), v)),
    "cylinder bottom": (intersect_cylinder, lambda u, v: on_bottom(0.5 + math.pi * (u - 0.5), v)),
}
"""Each patch of each shape: P(u, v) in float64, written from the conventions."""

OUTWARD = {
    "plane": (0, 0, 1),
    "box front": (0, 0, 1),
    "box back": (0, 0, -1),
    "box right": (1, 0, 0),
    "box left": (-1, 0, 0),
    "box top": (0, 1, 0),
    "box bottom": (0, -1, 0),
    "cylinder top": (0, 1, 0),
    "cylinder bottom": (0, -1, 0),
}
"""Normals of the flat patches; those of the round ones point away from the axis."""


def a(vector):
    return np.array([*vector], np.float64)


def cast(surface, origin, direction):
    return surface(ShapeRay(Vec3(*origin), Vec3(*direction)))


def kind_of(surface) -> str:
    """Name of the shape that a shader intersects."""
    return surface.name.removeprefix("intersect_")


def chart_at(surface, point):
    """The chart of a shape at a point on it."""
    return chart(point.position, point.normal, Variant(shape=kind_of(surface)))


def assert_finite(surface, point):
    """Assert finite numbers, a unit normal and derivatives other than 0."""
    surface_chart = chart_at(surface, point)
    assert np.isfinite([float(x) for x in leaf_values(point, ShapeIntersection)]).all()
    assert np.isfinite([float(x) for x in leaf_values(surface_chart, Chart)]).all()
    assert np.linalg.norm(a(point.normal)) == pytest.approx(1, abs=1e-6)
    assert np.linalg.norm(a(surface_chart.along_u)) > 1e-5
    assert np.linalg.norm(a(surface_chart.along_v)) > 1e-5


def derivative(form, u, v, du, dv, step=1e-5):
    after, before = form(u + du * step, v + dv * step), form(u - du * step, v - dv * step)
    return (np.array(after) - np.array(before)) / (2 * step)


def outward(patch, position):
    if patch in OUTWARD:
        return np.array(OUTWARD[patch], np.float64)
    away = position * (1, 0 if patch.startswith("cylinder") else 1, 1)
    return away / np.linalg.norm(away)


@pytest.mark.parametrize("surface", SHAPES)
def test_the_shaders_are_in_the_subset_and_a_variant_has_its_own(surface):
    analyse(surface)
    variant = Variant(shape=kind_of(surface))
    ray = ShapeRay(Vec3(0.1, 0.2, 3), Vec3(0, 0, -1))
    assert intersect_shape(ray, variant).found
    assert intersect_shape(ray, variant) == surface(ray)
    assert names_in(intersect_shape, variant) & {each.name for each in SHAPES} == {surface.name}
    charts = {
        "plane": "plane_chart",
        "box": "plane_chart",
        "sphere": "sphere_chart",
        "cylinder": "cylinder_chart",
    }
    # a cap of the cylinder has the chart of a plane
    wanted = {charts[kind_of(surface)]} | (
        {"plane_chart"} if surface is intersect_cylinder else set()
    )
    assert names_in(chart, variant) & {*charts.values()} == wanted


def names_in(function, variant):
    """The names of all functions that a shader's variant needs."""
    module = analyse(function, static_value=lambda name: getattr(variant, name))
    return {each.name for each in module.functions}


@pytest.mark.parametrize("patch", PATCHES)
@given(
    u=st.floats(0.02, 0.98),
    v=st.floats(0.05, 0.95),
    cosine=st.floats(0.05, 1),
    turn=st.floats(0, 6.2),
    away=st.floats(0.1, 30),
    speed=st.sampled_from([0.01, 1.0, 37.0]),
)
@settings(max_examples=40)
def test_a_ray_aimed_at_a_point_finds_it_with_its_frame(patch, u, v, cosine, turn, away, speed):
    surface, form = PATCHES[patch]
    if patch in ("cylinder top", "cylinder bottom"):
        # inside the disc of the cap
        u, v = 0.5 + 0.69 / math.pi * (u - 0.5), 0.5 + 0.69 * (v - 0.5)
    position = np.array(form(u, v), np.float64)
    along_u, along_v = derivative(form, u, v, 1, 0), derivative(form, u, v, 0, 1)
    normal = outward(patch, position)
    side = along_u / np.linalg.norm(along_u)
    across = side * math.cos(turn) + np.cross(normal, side) * math.sin(turn)
    view = normal * cosine + across * math.sqrt(1 - cosine * cosine)
    point = cast(surface, position + view * away, -view * speed)

    assert point.found
    # rounding of the ray's origin and direction, magnified at grazing angles
    near = 1e-6 * (1 + away) / cosine
    assert point.distance * speed == pytest.approx(away, abs=2 * near)
    np.testing.assert_allclose(a(point.position), position, atol=near)
    np.testing.assert_allclose(a(point.normal), normal, atol=4 * near)
    surface_chart = chart_at(surface, point)
    np.testing.assert_allclose(a(surface_chart.uv), (u, v), atol=3 * near)
    np.testing.assert_allclose(a(surface_chart.along_u), along_u, atol=20 * near)
    np.testing.assert_allclose(a(surface_chart.along_v), along_v, atol=20 * near)
    assert np.cross(a(point.normal), a(surface_chart.along_u)) @ -a(surface_chart.along_v) > 0
    assert_finite(surface, point)


@pytest.mark.parametrize(
    ("surface", "origin", "uv"),
    [
        (intersect_plane, (-0.5, 0.5, 2), (0, 0)),
        (intersect_plane, (0.25, 0.5, 2), (0.75, 0)),
        (intersect_plane, (-0.5, -0.25, 2), (0, 0.75)),
        (intersect_box, (-0.4, 0.3, 2), (0.1, 0.2)),
        (intersect_box, (2, 0.3, 0.4), (0.1, 0.2)),
        (intersect_box, (0.4, 0.3, -2), (0.1, 0.2)),
        (intersect_box, (-2, 0.3, -0.4), (0.1, 0.2)),
        (intersect_box, (-0.4, 2, -0.3), (0.1, 0.2)),
        (intersect_box, (-0.4, -2, 0.3), (0.1, 0.2)),
        (intersect_sphere, (0, 0, 2), (0.5, 0.5)),
        (intersect_sphere, (2, 0, 0), (0.75, 0.5)),
        (intersect_sphere, (-2, 0, 0), (0.25, 0.5)),
        (intersect_sphere, (0, 0.25, 2), (0.5, 1 / 3)),
        (intersect_sphere, (0, 2, 0), (0.5, 0)),
        (intersect_sphere, (0, -2, 0), (0.5, 1)),
        (intersect_cylinder, (0, 0.25, 2), (0.5, 0.25)),
        (intersect_cylinder, (2, -0.25, 0), (0.75, 0.75)),
        (intersect_cylinder, (-0.1, 2, -0.3), (0.5 - 0.1 / math.pi, 0.2)),
        (intersect_cylinder, (-0.1, -2, 0.3), (0.5 - 0.1 / math.pi, 0.2)),
    ],
)
def test_axis_parallel_rays_have_the_uv_of_the_conventions(surface, origin, uv):
    direction = [-math.copysign(1, x) if abs(x) == 2 else 0.0 for x in origin]
    for zero in (0.0, -0.0):
        point = cast(surface, origin, [x or zero for x in direction])
        assert point.found
        np.testing.assert_allclose(a(chart_at(surface, point).uv), uv, atol=1e-6)
        assert_finite(surface, point)


@pytest.mark.parametrize("surface", SHAPES)
def test_no_ray_of_a_lattice_makes_a_nan_or_an_infinity(surface):
    places = (-1.0, -0.5, 0.0, 0.5, 1.0)
    directions = [w for w in itertools.product((-1.0, 0.0, 1e-30, 1.0), repeat=3) if any(w)]
    origins = list(itertools.product(places, repeat=3))
    for index, direction in enumerate(directions):
        for origin in origins[index % 7 :: 7]:
            assert_finite(surface, cast(surface, origin, direction))


@pytest.mark.parametrize("surface", SHAPES)
def test_no_intersection_behind_the_ray_or_beside_the_shape(surface):
    rng = np.random.default_rng(7)
    for _ in range(30):
        away = rng.normal(size=3)
        away /= np.linalg.norm(away)
        aside = np.cross(away, (0.3, 0.5, 0.7))
        aside /= np.linalg.norm(aside)
        # all shapes fit the sphere around the unit cube
        for point in (
            cast(surface, away * 0.9, away),
            cast(surface, away * 3 + aside * 0.9, -away),
        ):
            assert not point.found
            assert point == no_intersection()


@pytest.mark.parametrize("surface", SOLIDS)
def test_no_intersection_from_inside(surface):
    rng = np.random.default_rng(8)
    for _ in range(40):
        start = rng.uniform(-0.28, 0.28, 3)
        assert not cast(surface, start, rng.normal(size=3)).found


def test_the_plane_is_intersected_only_from_the_front_and_within_its_edges():
    assert cast(intersect_plane, (0.2, 0.1, 1), (0, 0, -1)).found
    assert not cast(intersect_plane, (0.2, 0.1, -1), (0, 0, 1)).found
    assert not cast(intersect_plane, (0.2, 0.1, 1), (0, 0, 1)).found
    assert not cast(intersect_plane, (0.2, 0.1, 1), (1, 0, 0)).found
    assert not cast(intersect_plane, (0.501, 0.1, 1), (0, 0, -1)).found
    assert not cast(intersect_plane, (0.2, -0.501, 1), (0, 0, -1)).found
    assert cast(intersect_plane, (-0.499, 0.499, 1), (0, 0, -1)).found


@pytest.mark.parametrize("surface", SOLIDS)
def test_the_outline_is_at_half_a_unit(surface):
    # at x = ±½, seen from afar along z, at the height of the centre
    for sign in (-1, 1):
        assert cast(surface, (sign * 0.4999, 0, 100), (0, 0, -1)).found
        assert not cast(surface, (sign * 0.5001, 0, 100), (0, 0, -1)).found


def test_a_grazing_ray_touches_the_sphere_near_its_edge():
    point = cast(intersect_sphere, (-5, 0.4999, 0), (1, 0, 0))
    assert point.found
    assert point.position.y == pytest.approx(0.4999, abs=1e-5)
    assert point.position.x == pytest.approx(-math.sqrt(0.25 - 0.4999**2), abs=1e-3)


def test_far_intersections_with_sphere_and_cylinder_are_accurate():
    # the textbook's discriminant has an error of 0.1 here
    depth = math.sqrt(0.25 - 0.3**2 - 0.2**2)
    point = cast(intersect_sphere, (0.3, 0.2, 1000), (0, 0, -1))
    np.testing.assert_allclose(a(point.position), (0.3, 0.2, depth), atol=2e-4)
    point = cast(intersect_cylinder, (0.3, 0.2, 1000), (0, 0, -1))
    np.testing.assert_allclose(a(point.position), (0.3, 0.2, 0.4), atol=2e-4)


@pytest.mark.parametrize("surface", SOLIDS)
def test_the_parameter_is_the_same_in_a_stretched_and_turned_object(surface):
    rng = np.random.default_rng(9)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    to_world = turn @ np.diag((2.0, 0.5, 3.0))
    to_object = np.linalg.inv(to_world)
    found = 0
    for _ in range(40):
        origin = turn @ (rng.normal(size=3) * 2 + (0, 0, 9))
        direction = to_world @ rng.uniform(-0.5, 0.5, 3) - origin
        point = cast(surface, to_object @ origin, to_object @ direction)
        if point.found:
            found += 1
            world = origin + direction * float(point.distance)
            np.testing.assert_allclose(to_world @ a(point.position), world, atol=2e-5)
    assert found > 20


@pytest.mark.parametrize("surface", SHAPES)
def test_a_longer_direction_divides_the_parameter_and_changes_nothing_else(surface):
    # a power of two, so that results are equal bit for bit
    origin, direction = (0.7, 0.9, 1.9), np.array((-0.27, -0.31, -0.8))
    one, four = cast(surface, origin, direction), cast(surface, origin, direction * 4)
    assert one.found
    assert one.distance == four.distance * 4
    assert (one.position, one.normal) == (four.position, four.normal)
    assert chart_at(surface, one) == chart_at(surface, four)


@pytest.mark.parametrize("away", [(0.0, 1e-5), (1e-6, 0.0), (0.0, 0.0), (-3e-4, 2e-4)])
@pytest.mark.parametrize("pole", [1, -1])
def test_the_poles_of_the_sphere_have_a_frame(pole, away):
    point = cast(intersect_sphere, (away[0], 2 * pole, away[1]), (0, -pole, 0))
    assert point.found
    assert_finite(intersect_sphere, point)
    surface_chart = chart_at(intersect_sphere, point)
    assert surface_chart.uv.y == pytest.approx(0.5 - pole * 0.5, abs=1e-3)
    assert a(surface_chart.along_u) @ a(surface_chart.along_v) == pytest.approx(0, abs=1e-5)
    assert np.cross(a(point.normal), a(surface_chart.along_u)) @ -a(surface_chart.along_v) > 0


@pytest.mark.parametrize("surface", [intersect_sphere, intersect_cylinder])
def test_u_is_0_and_1_at_the_seam_and_stays_within(surface):
    for x in (-1e-3, -1e-6, 1e-6, 1e-3):
        u = chart_at(surface, cast(surface, (x, 0.1, -3), (0, 0, 1))).uv.x
        assert 0 <= u <= 1
        assert u == pytest.approx(0 if x < 0 else 1, abs=1e-3)


@pytest.mark.parametrize("surface", [intersect_box, intersect_cylinder])
def test_no_ray_slips_through_an_edge(surface):
    rng = np.random.default_rng(10)
    for turn in rng.uniform(0, 2 * math.pi, 100):
        edge = np.array((math.sin(turn), 1.0, math.cos(turn))) * 0.5
        if surface is intersect_box:
            square = 0.5 / max(abs(edge[0]), abs(edge[2]))
            edge *= (square, 1, square)
        view = edge * (1, 0, 1) + np.array((0.0, rng.uniform(0.1, 2.0), 0.0))
        point = cast(surface, edge + view * 5, -view)
        assert point.found
        uv = chart_at(surface, point).uv
        assert 0 <= uv.x <= 1
        assert 0 <= uv.y <= 1
        np.testing.assert_allclose(a(point.position), edge, atol=1e-5)


def test_intervals_inside_the_slab_and_the_ball():
    within = slab_interval(0.25, -2.0)
    assert (within.t_enter, within.t_exit) == (-0.125, 0.375)
    still = slab_interval(0.25, 0.0)
    assert still.t_enter < -1e10
    assert still.t_exit > 1e10
    through = sphere_interval(Vec3(0, 0.3, 2), Vec3(0, 0, -0.5))
    assert through.t_enter == pytest.approx(3.2, abs=1e-5)
    assert through.t_exit == pytest.approx(4.8, abs=1e-5)
    behind = sphere_interval(Vec3(0, 0.3, -2), Vec3(0, 0, -0.5))
    assert behind.t_enter == pytest.approx(-4.8, abs=1e-5)
    assert behind.t_exit == pytest.approx(-3.2, abs=1e-5)


# --- exits, and the shell around a shape ----------------------------------------------------------


def size_of(surface, place):
    """Half the width of the shape of this kind whose surface contains a place."""
    x, y, z = place
    if surface is intersect_box:
        return np.abs(place).max()
    return max(math.hypot(x, z), abs(y)) if surface is intersect_cylinder else np.linalg.norm(place)


def rays_at(radius, count, seed):
    """Random rays from outside towards points in a ball."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        away = rng.normal(size=3)
        origin = away / np.linalg.norm(away) * rng.uniform(3.0, 5.0)
        aim = rng.normal(size=3)
        yield origin, aim / np.linalg.norm(aim) * radius * rng.uniform(0.0, 1.0) - origin


@pytest.mark.parametrize("surface", SOLIDS)
def test_a_ray_is_in_the_shape_until_it_leaves(surface):
    intersections = 0
    for origin, direction in rays_at(0.8, 60, 11):
        point = cast(surface, origin, direction)
        if not point.found:
            continue
        intersections += 1
        end = origin + direction * float(point.t_exit)
        assert size_of(surface, end) == pytest.approx(0.5, abs=1e-5)
        for share in (0.01, 0.5, 0.99):
            t = float(point.distance) * (1 - share) + float(point.t_exit) * share
            assert size_of(surface, origin + direction * t) < 0.5 + 1e-6
    assert 20 < intersections < 60


@pytest.mark.parametrize("surface", [intersect_sphere, intersect_cylinder])
@pytest.mark.parametrize("raised", [0.02, 0.3])
def test_max_shell_distance_bounds_the_path_through_a_shell(surface, raised):
    """For the side of a cylinder in the plane across its axis, as for a sphere."""
    longest = 0.0
    for offset in np.linspace(0.0, 0.4999, 40):
        origin, direction = (offset, 0.0, 3.0), (0.0, 0.0, -1.0)
        point = cast(surface, origin, direction)
        enter = 3.0 - math.sqrt((0.5 + raised) ** 2 - offset**2)
        longest = max(longest, float(point.distance) - enter)
    most = float(max_shell_distance(raised, Variant(shape=kind_of(surface))))
    assert longest <= most + 1e-6
    assert longest == pytest.approx(most, abs=0.02)


def test_a_plane_has_no_inside():
    assert cast(intersect_plane, (0.2, 0.1, 1.0), (0.1, 0.0, -1.0)).t_exit == FAR
    assert max_shell_distance(0.4, Variant(shape="plane")) == FAR
