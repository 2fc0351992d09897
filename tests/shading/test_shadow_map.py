"""Shadows of objects on one another, against rays from the points that are seen to the light."""

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
from helpers.synthetic import drawn, map_of, rays, uniform_material

SIDE = 512
MATTE = Shading(ambient=(0.0, 0.0, 0.0), specular=(0.0, 0.0, 0.0))
LOOK = {"shading": MATTE, "shading_model": "phong", "background": None}
ABOVE = LookAt((0.0, 6.0, 2.5), orthographic_height=2.4)
FLOOR = Object(uniform_material(), transform=LYING @ placed(scale=(4.0, 4.0, 1.0)))

MIDDLE, WIDTH = np.array([0.1, 0.45, -0.05]), 0.5
"""Of the ball and the box that stand above the floor."""
LIGHTS = {
    "directional": directional(70.0, 50.0),
    "a lamp outside": point((1.5, 2.9, 1.0)),
    "a lamp between the objects": point((0.65, 0.8, 0.2)),
    "a spot": spot((1.2, 2.4, 0.8), (0.1, 0.2, 0.0), angle=40.0, softness=0.1),
}


def share(objects, light, **scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How much of a light reaches each pixel of a picture, where any would; and the points."""
    lights = (light,) if isinstance(light, Light) else light
    scene = {"camera": ABOVE, "lights": lights, "shadow_map_size": SIDE, **LOOK, **scene}
    dark, plain_ = (drawn(*objects, **scene, shadows=kind) for kind in ("hard", "none"))
    origins, directions = rays(scene["camera"])
    depth = np.where(plain_.hit, plain_.distance, 0.0)
    met = origins + directions * depth[..., None]
    bright = plain_.color[:, :, 0] > 0.01
    np.testing.assert_array_equal(plain_.distance, dark.distance)
    return dark.color[:, :, 0] / np.maximum(plain_.color[:, :, 0], 0.01), met, bright


def towards(light: Light, met: np.ndarray) -> np.ndarray:
    """From points to a light: the whole way, or a long one."""
    if light.kind == DIRECTIONAL:
        return np.broadcast_to(-50.0 * np.array([*light.direction], np.float64), met.shape)
    return np.array([*light.position], np.float64) - met


def ball_between(met, way, radius: float, middle=MIDDLE) -> np.ndarray:
    offset = met - middle
    a, b, c = (way * way).sum(-1), (offset * way).sum(-1), (offset**2).sum(-1) - radius**2
    with np.errstate(invalid="ignore"):
        nearest = np.clip(-b / a, 0.0, 1.0)
    return a * nearest**2 + 2 * b * nearest + c < 0.0


def box_between(met, way, half: float) -> np.ndarray:
    with np.errstate(divide="ignore"):
        ends = np.stack([(MIDDLE + s * half - met) / way for s in (-1.0, 1.0)])
    enter, leave = ends.min(0).max(-1), ends.max(0).min(-1)
    return (enter < leave) & (leave > 0.0) & (enter < 1.0)


def texel(light: Light) -> float:
    """About the width of a texel of the depth map where the ball or the box is."""
    views = light_views(Scene((FLOOR, standing("sphere")), lights=(light,), shadow_map_size=SIDE))
    wide = float(np.linalg.norm([*views[0].camera.right]))
    away = float(np.linalg.norm(np.array([*light.position]) - MIDDLE))
    return wide if light.kind == DIRECTIONAL else wide * away


def standing(shape: str, **options) -> Object:
    return Object(uniform_material(), shape=shape, transform=placed(MIDDLE, WIDTH), **options)


@pytest.mark.parametrize("name", LIGHTS)
@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_a_shadow_falls_where_geometry_says(shape: str, name: str) -> None:
    """C18: on a floor, its edge within two texels of the depth map."""
    light = LIGHTS[name]
    reaching, met, bright = share((FLOOR, standing(shape)), light)
    floor = bright & (np.abs(met[..., 1]) < 1e-3)
    between = ball_between if shape == "sphere" else box_between
    blur = 2.0 * texel(light)
    way = towards(light, met)
    dark = floor & between(met, way, WIDTH / 2 - blur)
    lit = floor & ~between(met, way, WIDTH / 2 + blur)
    assert dark.mean() > 0.01
    assert lit.mean() > 0.15
    np.testing.assert_array_equal(reaching[dark], 0.0)
    np.testing.assert_allclose(reaching[lit], 1.0, atol=1e-6)


def test_all_other_objects_cast_shadows() -> None:
    """Two balls over a floor, each with a shadow of its own, in whatever order."""
    light = LIGHTS["directional"]
    other = np.array([-0.7, 0.3, 0.25])
    balls = (
        standing("sphere"),
        Object(uniform_material(), "sphere", transform=placed(other, WIDTH)),
    )
    for objects in ((FLOOR, *balls), (*balls[::-1], FLOOR)):
        reaching, met, bright = share(objects, light)
        floor = bright & (np.abs(met[..., 1]) < 1e-3)
        way, inner = towards(light, met), WIDTH / 2 - 2.0 * texel(light)
        for middle in (MIDDLE, other):
            dark = floor & ball_between(met, way, inner, middle)
            assert dark.mean() > 0.01
            np.testing.assert_array_equal(reaching[dark], 0.0)


DEEP = 0.3


@pytest.mark.parametrize("shadows_on", ["relief", "polygon"])
def test_a_shadow_falls_on_the_displaced_point(shadows_on: str) -> None:
    """C18: on a floor pushed in by 0.3, or, where that is wanted, on the polygon above it."""
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
    reaching, met, bright = share((floor, standing("sphere")), light, shadows_on=shadows_on)
    below = bright & (np.abs(met[..., 1] + DEEP) < 1e-3)
    assert below.mean() > 0.3
    places = {"relief": met}
    # the same rays, where they pass the polygon
    _, directions = rays(ABOVE)
    places["polygon"] = met - directions * (met[..., 1:2] / directions[..., 1:2])
    blur = 2.0 * texel(light)
    found = {}
    for where, place in places.items():
        way = towards(light, place)
        dark = below & ball_between(place, way, WIDTH / 2 - blur)
        lit = below & ~ball_between(place, way, WIDTH / 2 + blur)
        assert dark.mean() > 0.01
        wrong = (reaching[dark] > 0.0).sum() + (reaching[lit] < 1.0 - 1e-6).sum()
        found[where] = int(wrong)
    assert found.pop(shadows_on) == 0
    assert min(found.values()) > 20


def test_a_raised_relief_casts_a_shadow() -> None:
    """C18: a ridge that stands out of a polygon shadows a shelf that lies above the polygon."""
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
    # from the right at 45 degrees: dark from 0.15 left of the ridge to the ridge
    light = directional(90.0, 45.0)
    reaching, met, _ = share((ridge, shelf), light, camera=camera)
    on_shelf = np.abs(met[..., 1] - 0.15) < 1e-4
    x = met[..., 0]
    dark = on_shelf & (x > -0.22) & (x < -0.13)
    lit = on_shelf & ((x < -0.28) | (x > 0.13))
    assert min(dark.sum(), lit.sum()) > 100
    np.testing.assert_array_equal(reaching[dark], 0.0)
    np.testing.assert_allclose(reaching[lit], 1.0, atol=1e-6)
    # and with no relief there is nothing above the shelf
    still = replace(ridge, technique="flat", settings={}, reference_height=1.0)
    reaching, met, bright = share((still, shelf), light, camera=camera)
    np.testing.assert_allclose(reaching[bright], 1.0, atol=1e-6)


@pytest.mark.parametrize("name", LIGHTS)
def test_nothing_shadows_itself(name: str) -> None:
    """No acne: where no object stands before another, all is as bright as without shadows."""
    light = LIGHTS[name]
    ball = standing("sphere")
    away = Object(uniform_material(), shape="box", transform=placed((1.5, 0.3, -0.8), 0.3))
    reaching, _, bright = share((ball, away), light, camera=ABOVE)
    assert bright.mean() > 0.01
    np.testing.assert_allclose(reaching[bright], 1.0, atol=1e-6)


def test_what_lies_in_one_plane_casts_nothing_on_itself() -> None:
    """A floor and a sheet in it, lit at 37° to the floor: within a texel of the depth map the floor
    comes 1.33 texels closer to the light."""
    sheet = Object(uniform_material(), transform=placed((0.3, 0.0, -0.2)) @ LYING)
    reaching, _, bright = share((FLOOR, sheet), directional(25.0, 37.0), shadow_map_size=64)
    assert bright.mean() > 0.5
    np.testing.assert_allclose(reaching[bright], 1.0, atol=1e-6)


@pytest.mark.parametrize(("texels", "visible"), [(1.2, 1.0), (2.0, 0.0)])
def test_a_sheet_casts_a_shadow_on_a_floor_two_texels_below(texels: float, visible: float) -> None:
    """And none on one closer. Lit from straight above, a texel of the depth map is level."""
    light = directional(0.0, 90.0)

    def sheet(height: float) -> Object:
        """Two units wide and 1.6 deep, over the floor."""
        return Object(
            uniform_material(), transform=placed((0.2, height, 0.0), (2.0, 1.0, 1.6)) @ LYING
        )

    (view,) = light_views(Scene((FLOOR, sheet(0.3)), lights=(light,), shadow_map_size=32))
    texel = float(np.linalg.norm([*view.camera.right]))
    from_aside = LookAt((0.0, 1.0, 4.0), orthographic_height=2.4)
    objects = (FLOOR, sheet(texels * texel))
    reaching, met, bright = share(objects, light, camera=from_aside, shadow_map_size=32)
    floor = bright & (np.abs(met[..., 1]) < 1e-3)
    # at the sheet's edges the four texels differ
    x, z, blur = np.abs(met[..., 0] - 0.2), np.abs(met[..., 2]), 1.5 * texel
    below = floor & (x < 1.0 - blur) & (z < 0.8 - blur)
    beside = floor & ((x > 1.0 + blur) | (z > 0.8 + blur))
    assert min(below.sum(), beside.sum()) > 100
    np.testing.assert_array_equal(reaching[below], visible)
    np.testing.assert_allclose(reaching[beside], 1.0, atol=1e-6)


def test_each_light_has_its_own_shadow() -> None:
    """Two lights together are the sum of each alone, their shadows included."""
    objects = (FLOOR, standing("sphere"))
    two = (directional(70.0, 50.0, intensity=0.5), point((-1.5, 2.5, 0.5)))
    scene = {"camera": ABOVE, "shadows": "hard", "shadow_map_size": 128, **LOOK}
    alone = [drawn(*objects, lights=(light,), **scene).color for light in two]
    both = drawn(*objects, lights=two, **scene).color
    np.testing.assert_allclose(both[:, :, :3], sum(alone)[:, :, :3], atol=1e-5)
    assert ((alone[0][:, :, 0] == 0.0) & (alone[1][:, :, 0] > 0.0)).sum() > 50
    assert ((alone[1][:, :, 0] == 0.0) & (alone[0][:, :, 0] > 0.0)).sum() > 50


def test_an_object_may_cast_nothing() -> None:
    for casts, dark in (("shape", True), ("none", False)):
        objects = (FLOOR, standing("sphere", casts=casts))
        reaching, _, bright = share(objects, LIGHTS["directional"])
        assert bool((reaching[bright] < 0.5).any()) == dark


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
def test_the_views_of_a_light_see_all_that_it_lights(light: Light, side: int) -> None:
    """Whatever lies on the objects is within the middles of the outer texels of a view."""
    scene = Scene((FLOOR, standing("box")), lights=(light,), shadow_map_size=side)
    around = np.random.default_rng(3)
    on_floor = around.uniform(-2.0, 2.0, (150, 3)) * (1.0, 0.0, 1.0)
    on_box = MIDDLE + WIDTH / 2 * around.uniform(-1.0, 1.0, (60, 3))
    views = light_views(scene)
    for place in [*on_floor, *on_box]:
        way = towards(light, place)
        cosine = -(way / np.linalg.norm(way)) @ np.array([*light.direction], np.float64)
        if light.kind == 2 and cosine < float(light.cos_outer) + 1e-3:
            continue
        seen = []
        for view in views:
            at = projected(view.camera, vector(place))
            inside = min(at.x, at.y) >= 0.5 and max(at.x, at.y) < side - 0.5
            seen.append(bool(at.z > 0.0 and inside))
        assert any(seen), place


@pytest.mark.parametrize("side", [16, 1024])
def test_what_reaches_furthest_is_seen_too(side: int) -> None:
    """The ends of a long bar along a side of the depth map."""
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
def test_raised_reliefs_are_seen_too(light: Light, side: int) -> None:
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


def test_views_are_no_wider_than_they_have_to_be() -> None:
    """All around a floor of 4 × 4 and a box of one: a ball of √8 around the middle."""
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
    # the ball is √¾ · 1.02 wide, and a little for the outer texels
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
def test_what_a_ray_meets_is_seen_where_the_ray_began(eye, target, parallel, at, distance) -> None:
    """`projected` is `primary_ray` the other way round."""
    away = np.subtract(target, eye)
    across = np.hypot(away[0], away[2])
    if across < 0.3:
        target = (eye[0] + 1.0, eye[1], eye[2])
    lens = {"orthographic_height": 2.0} if parallel else {"field_of_view": 50.0}
    camera = look_at(eye, target, size=(64, 40), **lens)
    ray = primary_ray(camera, Vec2(*at))
    place = np.array([*ray.origin], np.float64) + distance * np.array([*ray.direction])
    seen = projected(camera, vector(place))
    # a place of about 10 is known to 1e-6, a pixel 0.05 wide, or 0.02 at a distance of 1
    blur = 2e-3 + 1e-3 / min(distance, 1.0)
    np.testing.assert_allclose([seen.x, seen.y], at, atol=blur)
    assert float(seen.z) == pytest.approx(distance, rel=1e-5, abs=1e-5)
    behind = np.array([*ray.origin], np.float64) - distance * np.array([*ray.direction])
    assert projected(camera, vector(behind)).z < 0.0


# --- one position against one depth map -----------------------------------------------------------

FIRST, MAP = (3, 2), 8
"""Where in a sheet of depth maps a view's own begins, and its texels a side."""
PARALLEL = look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), size=(MAP, MAP), orthographic_height=1.6)
CENTRAL = look_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), size=(MAP, MAP), field_of_view=30.0)
"""Views down the z axis: of texels 0.2 wide, and of some that widen with the distance."""


def visibility(camera, at, distance: float, met, light: int = 7) -> float:
    """The share of a light that reaches a position by its picture coordinates and distance, past
    what the depth maps met."""
    ray = primary_ray(camera, Vec2(*at))
    place = np.array([*ray.origin], np.float64) + distance * np.array([*ray.direction])
    views = Buffer([ShadowMapView(7, camera, MAP, IVec2(*FIRST))], ShadowMapView)
    field = HeightField([np.asarray(met, np.float32)], "clamp")
    return float(shadow_map_visibility(field, views, light, vector(place)))


def sheet_of(value: float) -> np.ndarray:
    return np.full((13, 15), value)


# the position is a quarter of a texel right, two fifths below the middle of its upper left texel
AT = (4.75, 2.9)
WEIGHTS = {(4, 2): 0.45, (5, 2): 0.15, (4, 3): 0.3, (5, 3): 0.1}


@pytest.mark.parametrize("texel", WEIGHTS)
@pytest.mark.parametrize("camera", [PARALLEL, CENTRAL])
def test_four_texels_are_compared_and_weighted(camera, texel: tuple[int, int]) -> None:
    """Each is 1 where it met nothing closer than 1.5 texels before the position."""
    distance = 3.0
    pixel = float(np.linalg.norm([*camera.right]))
    bias = 1.5 * (pixel if camera is PARALLEL else pixel * distance)
    column, row = texel[0] + FIRST[0], texel[1] + FIRST[1]
    for before, shadowed in ((bias - 0.001, False), (bias + 0.001, True)):
        met = sheet_of(FAR_AWAY)
        met[row, column] = distance - before
        wanted = 1.0 - WEIGHTS[texel] * shadowed
        assert visibility(camera, AT, distance, met) == pytest.approx(wanted, abs=1e-5)
        # all but one
        met = sheet_of(1.0)
        met[row, column] = distance - before
        wanted = WEIGHTS[texel] * (not shadowed)
        assert visibility(camera, AT, distance, met) == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize("camera", [PARALLEL, CENTRAL])
def test_out_of_the_view_of_a_light_nothing_is_shadowed(camera) -> None:
    """The view ends at the middles of its outer texels, beside which another view's may lie."""
    met = sheet_of(0.1)
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
        assert visibility(camera, at, 3.0, met) == (0.0 if shadowed else 1.0)
    # behind the light, and another light's view
    assert visibility(camera, AT, -0.5, sheet_of(-9.0)) == 1.0
    assert visibility(camera, AT, 3.0, met, light=6) == 1.0


def test_of_several_views_the_darkest_counts() -> None:
    """Two views of one light, side by side in the sheet, of which either may see what is near."""
    views = [ShadowMapView(7, PARALLEL, MAP, IVec2(x, 0)) for x in (0, MAP)]
    for near in (0, 1):
        met = np.full((MAP, 2 * MAP), FAR_AWAY, np.float32)
        met[:, near * MAP : (near + 1) * MAP] = 1.0
        field = HeightField([met], "clamp")
        found = shadow_map_visibility(
            field, Buffer(views, ShadowMapView), 7, vector((0.1, 0.2, 2.0))
        )
        assert found == 0.0


# --- what is in a program, and both engines ------------------------------------------------------


def test_without_other_objects_or_shadows_there_is_no_code_for_them() -> None:
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
    """Reliefs that cast shadows on one another, and fade from the eye but not from a light."""
    floor = Object(sample("bricks", 64), edge=edge, fade=(2.0, 4.0))
    ball = Object(sample("gravel", 64), "sphere", edge=edge, transform=placed((0, 0.3, 0), 0.4))
    lights = (LIGHTS["directional"], LIGHTS["a spot"], point((0.5, 0.7, 0.3)))
    scene = Scene(
        (floor, ball), Orbit(30.0, 35.0, 2.2), lights, shadows="hard", shadow_map_size=128
    )
    assert_engines_agree(scene, 64)
