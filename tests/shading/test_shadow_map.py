"""Shadows that objects cast on each other, against rays from the visible points to the light."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.lang import Buffer, HeightField, IVec2, Vec2
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.programs import program_of
from basrelief.rendering.shadow_maps import light_views
from basrelief.scene import LYING, LookAt, Object, Orbit, Scene, directional, placed, point, spot
from basrelief.scene.cameras import look_at
from basrelief.shading.brdf import Shading
from basrelief.shading.camera import primary_ray, projected
from basrelief.shading.lights import DIRECTIONAL, FAR_AWAY, Light
from basrelief.shading.shadow_map import ShadowMapView, shadow_map_visibility
from helpers.agreement import assert_engines_agree
from helpers.synthetic import drawn, map_of, matte, rays, uniform_material

SIDE = 512
MATTE = Shading(ambient=(0.0, 0.0, 0.0))
LOOK = {"shading": MATTE, "shading_model": "phong", "background": None}
ABOVE = LookAt((0.0, 6.0, 2.5), orthographic_height=2.4)
FLOOR = Object(uniform_material(), transform=LYING @ placed(scale=(4.0, 4.0, 1.0)))

MIDDLE, WIDTH = np.array([0.1, 0.45, -0.05]), 0.5
"""Centre and width of the ball and the box above the floor."""
LIGHTS = {
    "directional": directional(70.0, 50.0),
    "a lamp outside": point((1.5, 2.9, 1.0)),
    "a lamp between the objects": point((0.65, 0.8, 0.2)),
    "a spot": spot((1.2, 2.4, 0.8), (0.1, 0.2, 0.0), angle=40.0, softness=0.1),
}


def light_visibility(objects, light, **scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Visibility of a light at each pixel, the pixels' points, and where it shines unshadowed."""
    lights = (light,) if isinstance(light, Light) else light
    scene = {"camera": ABOVE, "lights": lights, "shadow_map_size": SIDE, **LOOK, **scene}
    dark, plain_ = (drawn(*map(matte, objects), **scene, shadows=kind) for kind in ("hard", "none"))
    origins, directions = rays(scene["camera"])
    depth = np.where(plain_.hit, plain_.distance, 0.0)
    points = origins + directions * depth[..., None]
    bright = plain_.color[:, :, 0] > 0.01
    np.testing.assert_array_equal(plain_.distance, dark.distance)
    return dark.color[:, :, 0] / np.maximum(plain_.color[:, :, 0], 0.01), points, bright


def towards(light: Light, points: np.ndarray) -> np.ndarray:
    """Vectors from points to a lamp, or long ones to a directional light."""
    if light.kind == DIRECTIONAL:
        return np.broadcast_to(-50.0 * np.array([*light.direction], np.float64), points.shape)
    return np.array([*light.position], np.float64) - points


def ball_between(points, to_light, radius: float, middle=MIDDLE) -> np.ndarray:
    offset = points - middle
    a, b, c = (
        (to_light * to_light).sum(-1),
        (offset * to_light).sum(-1),
        (offset**2).sum(-1) - radius**2,
    )
    with np.errstate(invalid="ignore"):
        nearest = np.clip(-b / a, 0.0, 1.0)
    return a * nearest**2 + 2 * b * nearest + c < 0.0


def box_between(points, to_light, half: float) -> np.ndarray:
    with np.errstate(divide="ignore"):
        ends = np.stack([(MIDDLE + s * half - points) / to_light for s in (-1.0, 1.0)])
    t_enter, t_exit = ends.min(0).max(-1), ends.max(0).min(-1)
    return (t_enter < t_exit) & (t_exit > 0.0) & (t_enter < 1.0)


def texel(light: Light) -> float:
    """Approximate width of a shadow-map texel at the ball or the box."""
    views = light_views(Scene((FLOOR, standing("sphere")), lights=(light,), shadow_map_size=SIDE))
    wide = float(np.linalg.norm([*views[0].camera.right]))
    away = float(np.linalg.norm(np.array([*light.position]) - MIDDLE))
    return wide if light.kind == DIRECTIONAL else wide * away


def standing(shape: str, **options) -> Object:
    return Object(uniform_material(), shape=shape, transform=placed(MIDDLE, WIDTH), **options)


@pytest.mark.parametrize("name", LIGHTS)
@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_a_shadow_on_the_floor_equals_that_of_the_geometry(shape: str, name: str) -> None:
    """C18: its edge is within two texels of the shadow map."""
    light = LIGHTS[name]
    visibility, points, bright = light_visibility((FLOOR, standing(shape)), light)
    floor = bright & (np.abs(points[..., 1]) < 1e-3)
    between = ball_between if shape == "sphere" else box_between
    blur = 2.0 * texel(light)
    to_light = towards(light, points)
    dark = floor & between(points, to_light, WIDTH / 2 - blur)
    lit = floor & ~between(points, to_light, WIDTH / 2 + blur)
    assert dark.mean() > 0.01
    assert lit.mean() > 0.15
    np.testing.assert_array_equal(visibility[dark], 0.0)
    np.testing.assert_allclose(visibility[lit], 1.0, atol=1e-6)


def test_all_other_objects_cast_shadows() -> None:
    """Two balls over a floor, each with its shadow, in any order of the objects."""
    light = LIGHTS["directional"]
    other = np.array([-0.7, 0.3, 0.25])
    balls = (
        standing("sphere"),
        Object(uniform_material(), "sphere", transform=placed(other, WIDTH)),
    )
    for objects in ((FLOOR, *balls), (*balls[::-1], FLOOR)):
        visibility, points, bright = light_visibility(objects, light)
        floor = bright & (np.abs(points[..., 1]) < 1e-3)
        to_light, inner = towards(light, points), WIDTH / 2 - 2.0 * texel(light)
        for middle in (MIDDLE, other):
            dark = floor & ball_between(points, to_light, inner, middle)
            assert dark.mean() > 0.01
            np.testing.assert_array_equal(visibility[dark], 0.0)


DEEP = 0.3


@pytest.mark.parametrize("shadows_on", ["relief", "polygon"])
def test_a_shadow_falls_on_the_displaced_point(shadows_on: str) -> None:
    """C18: on a relief 0.3 below its polygon, or on the polygon if `shadows_on` says so."""
    steps = {"min_steps": 8, "max_steps": 8}
    floor = replace(
        FLOOR,
        material=uniform_material(height=0.5),
        technique="parallax_occlusion",
        settings=steps,
        scale=2.0 * DEEP,
        transform=LYING @ placed(scale=(4.0, 4.0, 1.0)),
    )
    light = LIGHTS["directional"]
    visibility, points, bright = light_visibility(
        (floor, standing("sphere")), light, shadows_on=shadows_on
    )
    below = bright & (np.abs(points[..., 1] + DEEP) < 1e-3)
    assert below.mean() > 0.3
    places = {"relief": points}
    # where the same rays cross the polygon
    _, directions = rays(ABOVE)
    places["polygon"] = points - directions * (points[..., 1:2] / directions[..., 1:2])
    blur = 2.0 * texel(light)
    found = {}
    for where, place in places.items():
        to_light = towards(light, place)
        dark = below & ball_between(place, to_light, WIDTH / 2 - blur)
        lit = below & ~ball_between(place, to_light, WIDTH / 2 + blur)
        assert dark.mean() > 0.01
        wrong = (visibility[dark] > 0.0).sum() + (visibility[lit] < 1.0 - 1e-6).sum()
        found[where] = int(wrong)
    assert found.pop(shadows_on) == 0
    assert min(found.values()) > 20


def test_a_raised_relief_casts_a_shadow() -> None:
    """C18: a ridge raised above its polygon shadows a shelf that is also above the polygon."""
    heights = np.zeros((4, 80, 1))
    heights[:, 32:48] = 1.0
    ridge = Object(
        Material("ridge", height=map_of(heights)),
        technique="relief",
        settings={"min_steps": 64, "max_steps": 64},
        scale=0.3,
        reference_height=0.0,
        edge="clamp",
        transform=LYING,
    )
    shelf = Object(uniform_material(), transform=placed((0.0, 0.15, 0.0)) @ LYING)
    camera = LookAt((0.0, 3.0, 0.0), up=(0.0, 0.0, -1.0), orthographic_height=0.6)
    # light from the right at 45 degrees: dark for 0.15 left of the ridge
    light = directional(90.0, 45.0)
    visibility, points, _ = light_visibility((ridge, shelf), light, camera=camera)
    on_shelf = np.abs(points[..., 1] - 0.15) < 1e-4
    x = points[..., 0]
    dark = on_shelf & (x > -0.22) & (x < -0.13)
    lit = on_shelf & ((x < -0.28) | (x > 0.13))
    assert min(dark.sum(), lit.sum()) > 100
    np.testing.assert_array_equal(visibility[dark], 0.0)
    np.testing.assert_allclose(visibility[lit], 1.0, atol=1e-6)
    # without the relief nothing is above the shelf
    still = replace(ridge, technique="flat", settings={}, reference_height=1.0)
    visibility, points, bright = light_visibility((still, shelf), light, camera=camera)
    np.testing.assert_allclose(visibility[bright], 1.0, atol=1e-6)


@pytest.mark.parametrize("name", LIGHTS)
def test_no_object_shadows_itself(name: str) -> None:
    """No shadow acne: objects that do not occlude each other are as bright as without shadows."""
    light = LIGHTS[name]
    ball = standing("sphere")
    away = Object(uniform_material(), shape="box", transform=placed((1.5, 0.3, -0.8), 0.3))
    visibility, _, bright = light_visibility((ball, away), light, camera=ABOVE)
    assert bright.mean() > 0.01
    np.testing.assert_allclose(visibility[bright], 1.0, atol=1e-6)


def test_coplanar_objects_do_not_shadow_each_other() -> None:
    """A floor and a sheet in its plane, lit at 37°: within a texel of the shadow map the floor
    comes 1.33 texels closer to the light."""
    sheet = Object(uniform_material(), transform=placed((0.3, 0.0, -0.2)) @ LYING)
    visibility, _, bright = light_visibility(
        (FLOOR, sheet), directional(25.0, 37.0), shadow_map_size=64
    )
    assert bright.mean() > 0.5
    np.testing.assert_allclose(visibility[bright], 1.0, atol=1e-6)


@pytest.mark.parametrize(("texels", "visible"), [(1.2, 1.0), (2.0, 0.0)])
def test_a_sheet_casts_a_shadow_on_a_floor_two_texels_below(texels: float, visible: float) -> None:
    """No shadow on a floor 1.2 texels below. The light is overhead, so texels are level."""
    light = directional(0.0, 90.0)

    def sheet(height: float) -> Object:
        """A sheet of 2 × 1.6 units at a height over the floor."""
        return Object(
            uniform_material(), transform=placed((0.2, height, 0.0), (2.0, 1.0, 1.6)) @ LYING
        )

    (view,) = light_views(Scene((FLOOR, sheet(0.3)), lights=(light,), shadow_map_size=32))
    texel = float(np.linalg.norm([*view.camera.right]))
    from_aside = LookAt((0.0, 1.0, 4.0), orthographic_height=2.4)
    objects = (FLOOR, sheet(texels * texel))
    visibility, points, bright = light_visibility(
        objects, light, camera=from_aside, shadow_map_size=32
    )
    floor = bright & (np.abs(points[..., 1]) < 1e-3)
    # at the sheet's edges the visibility is filtered over four texels
    x, z, blur = np.abs(points[..., 0] - 0.2), np.abs(points[..., 2]), 1.5 * texel
    below = floor & (x < 1.0 - blur) & (z < 0.8 - blur)
    beside = floor & ((x > 1.0 + blur) | (z > 0.8 + blur))
    assert min(below.sum(), beside.sum()) > 100
    np.testing.assert_array_equal(visibility[below], visible)
    np.testing.assert_allclose(visibility[beside], 1.0, atol=1e-6)


def test_each_light_has_its_own_shadow() -> None:
    """A picture with two lights is the sum of the pictures with one, shadows included."""
    objects = (FLOOR, standing("sphere"))
    two = (directional(70.0, 50.0, intensity=0.5), point((-1.5, 2.5, 0.5)))
    scene = {"camera": ABOVE, "shadows": "hard", "shadow_map_size": 128, **LOOK}
    alone = [drawn(*objects, lights=(light,), **scene).color for light in two]
    both = drawn(*objects, lights=two, **scene).color
    np.testing.assert_allclose(both[:, :, :3], sum(alone)[:, :, :3], atol=1e-5)
    assert ((alone[0][:, :, 0] == 0.0) & (alone[1][:, :, 0] > 0.0)).sum() > 50
    assert ((alone[1][:, :, 0] == 0.0) & (alone[0][:, :, 0] > 0.0)).sum() > 50


def test_an_object_may_cast_no_shadow() -> None:
    for casts, dark in (("shape", True), ("none", False)):
        objects = (FLOOR, standing("sphere", casts=casts))
        visibility, _, bright = light_visibility(objects, LIGHTS["directional"])
        assert bool((visibility[bright] < 0.5).any()) == dark


# --- the views of lights --------------------------------------------------------------------------


@pytest.mark.parametrize("side", [16, 100, 1024])
@pytest.mark.parametrize(
    "light",
    [
        *LIGHTS.values(),
        point((0.1, 0.2, 0.1)),
        spot((0.3, 1.0, 0.2), (0.0, 0.0, 0.5), angle=150.0),
        point((3e5, 9e5, 1e5), falloff=0.0),
    ],
)
def test_the_views_of_a_light_contain_every_lit_point(light: Light, side: int) -> None:
    """Each point on the objects is inside the centres of a view's outer texels."""
    scene = Scene((FLOOR, standing("box")), lights=(light,), shadow_map_size=side)
    around = np.random.default_rng(3)
    on_floor = around.uniform(-2.0, 2.0, (150, 3)) * (1.0, 0.0, 1.0)
    on_box = MIDDLE + WIDTH / 2 * around.uniform(-1.0, 1.0, (60, 3))
    views = light_views(scene)
    for place in [*on_floor, *on_box]:
        to_light = towards(light, place)
        cosine = -(to_light / np.linalg.norm(to_light)) @ np.array([*light.direction], np.float64)
        if light.kind == 2 and cosine < float(light.cos_outer) + 1e-3:
            continue
        seen = []
        for view in views:
            at = projected(view.camera, vector(place))
            inside = min(at.x, at.y) >= 0.5 and max(at.x, at.y) < side - 0.5
            seen.append(bool(at.z > 0.0 and inside))
        assert any(seen), place


@pytest.mark.parametrize("side", [16, 1024])
def test_a_view_contains_the_ends_of_a_long_object(side: int) -> None:
    """A long bar along a side of the shadow map."""
    bar = Object(uniform_material(), shape="box", transform=placed(scale=(4.0, 0.1, 0.1)))
    small = Object(uniform_material(), shape="box", transform=placed(scale=0.1))
    scene = Scene((bar, small), lights=(directional(0.0, 90.0),), shadow_map_size=side)
    (view,) = light_views(scene)
    for place in bar.resolved.bounding_points():
        at = projected(view.camera, vector(place))
        assert min(at.x, at.y) >= 0.5
        assert max(at.x, at.y) < side - 0.5


@pytest.mark.parametrize(
    "light",
    [
        directional(90.0, 0.0),
        directional(0.0, 90.0),
        directional(20.0, 65.0),
        point((1.4, 0.3, 0.2)),
        point((-9.0, 0.5, 2.0)),
    ],
)
@pytest.mark.parametrize("side", [16, 1024])
def test_views_contain_raised_reliefs(light: Light, side: int) -> None:
    """A relief that stands 2 · 1.5 above a polygon of 0.5 × 0.4."""
    tower = Object(
        uniform_material(height=1.0), technique="relief", scale=2.0, reference_height=0.0,
        transform=LYING @ placed(scale=(0.5, 0.4, 1.5)),
    )  # fmt: skip
    small = Object(uniform_material(), shape="box", transform=placed(scale=0.1))
    views = light_views(Scene((tower, small), lights=(light,), shadow_map_size=side))
    for x, y, z in itertools.product((-0.25, 0.25), (0.0, 3.0), (-0.2, 0.2)):
        seen = [projected(view.camera, vector((x, y, z))) for view in views]
        assert any(
            at.z > 0.0 and min(at.x, at.y) >= 0.5 and max(at.x, at.y) < side - 0.5 for at in seen
        )


def test_views_are_at_most_3_to_6_percent_too_wide() -> None:
    """The scene, a floor of 4 × 4 and a small box, lies in a ball of radius about √8."""
    box = Object(
        uniform_material(), shape="box", transform=placed((0.0, 0.1, 0.0), (0.2, 0.2, 0.2))
    )
    radius, side = math.hypot(2.0, 2.0, 0.1), 256

    def half_angle(light: Light) -> float:
        (view,) = light_views(Scene((FLOOR, box), lights=(light,), shadow_map_size=side))
        across = float(np.linalg.norm([*view.camera.right])) * (side - 2) / 2
        return across if light.kind == DIRECTIONAL else math.degrees(math.atan(across))

    assert radius <= half_angle(directional(25.0, 50.0)) <= 1.03 * radius
    for distance in (5.0, 40.0, 300.0):
        wanted = math.degrees(math.asin(radius / distance))
        found = half_angle(point((0.0, 0.1 + distance, 0.0)))
        assert wanted <= found <= 1.06 * wanted
    assert 10.0 <= half_angle(spot((0.3, 2.0, 0.1), angle=20.0)) <= 10.02


@pytest.mark.parametrize(("angle", "count"), [(99.0, 1), (101.0, 6)])
def test_beyond_a_hundred_degrees_a_light_has_six_views(angle: float, count: int) -> None:
    box = Object(uniform_material(), shape="box")
    objects = (box, Object(uniform_material(), shape="box", transform=placed(scale=0.5)))

    def views(light: Light) -> int:
        return len(light_views(Scene(objects, lights=(light,), shadow_map_size=4096)))

    assert views(spot((0.1, 0.2, 0.3), angle=angle)) == count
    # the ball's radius is √¾ · 1.02, widened for the outer texels
    radius = math.sqrt(0.75) * 1.02 * 4096 / 4094
    assert views(point((radius / math.sin(math.radians(angle / 2)), 0.0, 0.0))) == count


def vector(values):
    from basrelief.lang import Vec3

    return Vec3(*(float(v) for v in values))


PLACES = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


@given(
    PLACES,
    PLACES,
    st.booleans(),
    st.tuples(st.floats(-5.0, 69.0), st.floats(-5.0, 45.0)),
    st.floats(0.1, 20.0),
)
def test_projected_inverts_primary_ray(eye, target, parallel, at, distance) -> None:
    """A point of the ray through a pixel is projected to that pixel, at its distance."""
    away = np.subtract(target, eye)
    across = np.hypot(away[0], away[2])
    if across < 0.3:
        target = (eye[0] + 1.0, eye[1], eye[2])
    lens = {"orthographic_height": 2.0} if parallel else {"field_of_view": 50.0}
    camera = look_at(eye, target, size=(64, 40), **lens)
    ray = primary_ray(camera, Vec2(*at))
    place = np.array([*ray.origin], np.float64) + distance * np.array([*ray.direction])
    seen = projected(camera, vector(place))
    # float32 rounds a coordinate of 10 by 1e-6; a pixel is 0.05 wide, or 0.02 at distance 1
    blur = 2e-3 + 1e-3 / min(distance, 1.0)
    np.testing.assert_allclose([seen.x, seen.y], at, atol=blur)
    assert float(seen.z) == pytest.approx(distance, rel=1e-5, abs=1e-5)
    behind = np.array([*ray.origin], np.float64) - distance * np.array([*ray.direction])
    assert projected(camera, vector(behind)).z < 0.0


# --- one position against one shadow map ----------------------------------------------------------

CORNER, MAP = (3, 2), 8
"""Corner of the view's region in the atlas of depths, and texels a side."""
PARALLEL = look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), size=(MAP, MAP), orthographic_height=1.6)
CENTRAL = look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), size=(MAP, MAP), field_of_view=30.0)
"""Views down the z axis: with texels 0.2 wide, and with texels that widen with distance."""


def visibility_at(camera, at, distance: float, depths, light: int = 7) -> float:
    """Visibility of a light at a position, given by its picture coordinates and distance, for an
    atlas of depths."""
    ray = primary_ray(camera, Vec2(*at))
    place = np.array([*ray.origin], np.float64) + distance * np.array([*ray.direction])
    views = Buffer([ShadowMapView(7, camera, MAP, IVec2(*CORNER))], ShadowMapView)
    field = HeightField([np.asarray(depths, np.float32)], "clamp")
    return float(shadow_map_visibility(field, views, light, vector(place)))


def constant_depths(value: float) -> np.ndarray:
    return np.full((13, 15), value)


# the position is 0.25 texel right of and 0.4 below the centre of its upper left texel
AT = (4.75, 2.9)
WEIGHTS = {(4, 2): 0.45, (5, 2): 0.15, (4, 3): 0.3, (5, 3): 0.1}


@pytest.mark.parametrize("texel", WEIGHTS)
@pytest.mark.parametrize("camera", [PARALLEL, CENTRAL])
def test_four_texels_are_compared_and_weighted(camera, texel: tuple[int, int]) -> None:
    """Each counts as lit unless its depth is more than 1.5 texels before the position."""
    distance = 3.0
    pixel = float(np.linalg.norm([*camera.right]))
    bias = 1.5 * (pixel if camera is PARALLEL else pixel * distance)
    column, row = texel[0] + CORNER[0], texel[1] + CORNER[1]
    for before, shadowed in ((bias - 0.001, False), (bias + 0.001, True)):
        depths = constant_depths(FAR_AWAY)
        depths[row, column] = distance - before
        wanted = 1.0 - WEIGHTS[texel] * shadowed
        assert visibility_at(camera, AT, distance, depths) == pytest.approx(wanted, abs=1e-5)
        # all texels but one in shadow
        depths = constant_depths(1.0)
        depths[row, column] = distance - before
        wanted = WEIGHTS[texel] * (not shadowed)
        assert visibility_at(camera, AT, distance, depths) == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize("camera", [PARALLEL, CENTRAL])
def test_points_outside_the_view_of_a_light_are_lit(camera) -> None:
    """A view ends at the centres of its outer texels; a neighbour in the atlas may follow."""
    depths = constant_depths(0.1)
    for at, shadowed in (
        ((0.51, 3.2), True),
        ((0.49, 3.2), False),
        ((7.49, 3.2), True),
        ((7.51, 3.2), False),
        ((5.3, 0.51), True),
        ((5.3, 0.49), False),
        ((5.3, 7.49), True),
        ((5.3, 7.51), False),
    ):
        assert visibility_at(camera, at, 3.0, depths) == (0.0 if shadowed else 1.0)
    # behind the light, and in the view of another light
    assert visibility_at(camera, AT, -0.5, constant_depths(-9.0)) == 1.0
    assert visibility_at(camera, AT, 3.0, depths, light=6) == 1.0


def test_the_darkest_of_several_views_counts() -> None:
    """Two views of one light, side by side in the atlas; either may contain the caster."""
    views = [ShadowMapView(7, PARALLEL, MAP, IVec2(x, 0)) for x in (0, MAP)]
    for near in (0, 1):
        depths = np.full((MAP, 2 * MAP), FAR_AWAY, np.float32)
        depths[:, near * MAP : (near + 1) * MAP] = 1.0
        field = HeightField([depths], "clamp")
        found = shadow_map_visibility(
            field, Buffer(views, ShadowMapView), 7, vector((0.1, 0.2, 2.0))
        )
        assert found == 0.0


# --- what is in a program, and both engines ------------------------------------------------------


def test_a_program_without_casters_or_shadows_has_no_code_for_them() -> None:
    obj, other = Object(sample("tiles", 16)), standing("box")

    def text(*objects: Object, **scene) -> str:
        program = program_of(objects[0].resolved, Scene(objects, **scene))
        return print_wgsl(program.module, program.edge)

    for without in (text(obj, shadows="hard"), text(obj, other)):
        for word in ("shadow_map_visibility", "ShadowMapView", "projected", "distances"):
            assert word not in without
    within = text(obj, other, shadows="hard")
    for word in ("shadow_map_visibility", "ShadowMapView", "projected", "distances"):
        assert word in within


@pytest.mark.gpu
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_cpu_and_gpu_agree(edge: str) -> None:
    """Reliefs that cast shadows on each other and fade for the camera but not for a light."""
    floor = Object(sample("bricks", 64), edge=edge, fade=(2.0, 4.0))
    ball = Object(sample("gravel", 64), "sphere", edge=edge, transform=placed((0, 0.3, 0), 0.4))
    lights = (LIGHTS["directional"], LIGHTS["a spot"], point((0.5, 0.7, 0.3)))
    scene = Scene(
        (floor, ball), Orbit(30.0, 35.0, 2.2), lights, shadows="hard", shadow_map_size=128
    )
    assert_engines_agree(scene, 64)
