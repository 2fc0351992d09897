"""Scenes: defaults, and one-line messages for invalid values."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from basrelief.engine.cpu import CpuEngine
from basrelief.errors import InputError
from basrelief.lang import HeightField, Vec3, setting, struct
from basrelief.material import Map, Material, sample
from basrelief.rendering.render import render
from basrelief.scene import (
    LYING,
    SHAPES,
    LookAt,
    Object,
    Orbit,
    Scene,
    checked_record,
    directional,
    placed,
    point,
    rotated,
    spot,
    technique_named,
)
from basrelief.shading.brdf import Shading
from basrelief.shading.lights import DIRECTIONAL, POINT, SPOT
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.techniques import (
    SYNONYMS,
    TECHNIQUES,
    Hit,
    Ray,
    flat,
    hit_at,
    relief,
    t_at,
    technique,
)
from basrelief.techniques.march import March, Steps

NAN, INF = math.nan, math.inf


def heights(values=((0.2, 0.9, 0.4), (0.6, 0.1, 0.5))) -> Material:
    pixels = np.asarray(values, np.float32)[:, :, None]
    return Material("made up", height=Map(pixels, False, "made up"))


FLAT = Material("flat one")
BUMPY = heights()


def obj(**options) -> Object:
    return Object(BUMPY, **options)


def refused(make) -> str:
    """The one-line error message."""
    with pytest.raises(InputError) as caught:
        make()
    message = str(caught.value)
    assert message
    assert "\n" not in message
    return message


# --- objects --------------------------------------------------------------------------------------

REFUSED = {
    "an unknown technique": ({"technique": "leap"}, "no technique is called 'leap'; use one of"),
    "no such file": ({"technique": "nowhere.py:mine"}, "nowhere.py: there is no such file"),
    "an unknown shape": ({"shape": "torus"}, "shape is one of plane, box, sphere, cylinder"),
    "an unknown projection": ({"projection": "skew"}, "projection is one of full, biased, limited"),
    "an unknown edge": ({"edge": "mirror"}, "edge is one of wrap, clamp, clip, not 'mirror'"),
    "a scale below 0": ({"scale": -0.1}, "scale is -0.1: give a number from 0 to 10"),
    "a scale beyond 10": ({"scale": 11}, "scale is 11: give a number from 0 to 10"),
    "a scale that is none": ({"scale": NAN}, "scale is nan"),
    "an endless scale": ({"scale": INF}, "scale is inf"),
    "a reference height beyond 1": (
        {"reference_height": 1.5}, "reference_height is 1.5: give a number from 0 to 1",
    ),
    "a reference height below 0": ({"reference_height": -0.1}, "reference_height is -0.1"),
    "a bias below −1": ({"bias": -1.42}, "bias is -1.42: give a number from -1 to 100"),
    "a bias that is none": ({"bias": NAN}, "bias is nan"),
    "a negative strength": (
        {"surface_parameters": SurfaceParameters(normal_strength=-1.0)}, "normal_strength is -1",
    ),
    "no roughness": ({"surface_parameters": SurfaceParameters(roughness=NAN)}, "roughness is nan"),
    "darker than black": (
        {"surface_parameters": SurfaceParameters(base_color=(0, -1, 0))}, "base_color is -1",
    ),
    "no tiles": ({"tiling": (0.0, 1.0)}, "tiling (0.0, 1.0): give finite numbers other than 0"),
    "endless tiles": ({"tiling": (1.0, INF)}, "tiling (1.0, inf)"),
    "an endless shift": ({"shift": (INF, 0.0)}, "give finite numbers"),
    "no steps": ({"technique": "steep", "settings": {"steps": 0}}, "steps is 0: give a number"),
    "negative steps": ({"settings": {"max_steps": -2}}, "max_steps is -2: give a number from 1"),
    "too many steps": ({"settings": {"min_steps": 5000}}, "min_steps is 5000: give a number"),
    "half a step": ({"settings": {"min_steps": 2.5}}, "min_steps is a whole number, not 2.5"),
    "steps that are none": ({"settings": {"min_steps": NAN}}, "min_steps is nan"),
    "steps as text": ({"settings": {"min_steps": "many"}}, "is a number, not 'many'"),
    "no number of steps": ({"settings": {"min_steps": None}}, "is a number, not None"),
    "steps that are true": ({"settings": {"min_steps": True}}, "is a number, not True"),
    "several steps": ({"settings": {"min_steps": [1, 2]}}, "min_steps is a number, not [1, 2]"),
    "steps by name": ({"settings": {"min_steps": {}}}, "min_steps is a number, not {}"),
    "complex steps": ({"settings": {"min_steps": 1j}}, "min_steps is a number, not 1j"),
    "a negative offset": (
        {"technique": "offset", "settings": {"max_offset": -0.1}}, "max_offset is -0.1",
    ),
    "an unknown setting": (
        {"settings": {"step": 3}}, "relief has no setting 'step'; it has min_steps, max_steps",
    ),
    "a setting of a technique without": (
        {"technique": "flat", "settings": {"steps": 3}}, "no setting 'steps'; it has none",
    ),
    "another technique's record": ({"settings": March()}, "relief takes settings of type Relief"),
    "a record out of range": (
        {"technique": "steep", "settings": Steps(0)}, "steps is 0: give a number from 1",
    ),
    "a transform to nothing": ({"transform": placed(scale=(1, 0, 1))}, "transform must be finite"),
    "an endless transform": ({"transform": placed((INF, 0, 0))}, "transform must be finite"),
    "a transform of 3 × 3": ({"transform": np.eye(3)}, "transform"),
    "a transform of rows": ({"transform": [[1, 0], [0, 1]]}, "transform"),
    "a transform in perspective": (
        {"transform": np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1.0]])},
        "transform",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_invalid_objects_are_refused(what) -> None:
    options, message = REFUSED[what]
    assert message in refused(lambda: obj(**options))


@pytest.mark.parametrize("name", [name for name in TECHNIQUES if name != "flat"])
def test_a_technique_without_heights_is_refused(name) -> None:
    message = refused(lambda: Object(FLAT, technique=name))
    assert f"flat one has no height map, which {name} needs" in message
    assert "flat" in message.split(";")[1]


def test_the_default_technique_without_heights_is_flat() -> None:
    assert Object(FLAT).resolved.technique is flat
    assert not Object(FLAT).resolved.has_relief
    assert obj().resolved.technique is relief
    assert obj().resolved.has_relief
    assert not obj(technique="flat").resolved.has_relief


def test_defaults_come_from_material_and_technique() -> None:
    assert obj().resolved.scale == 0.05
    assert Object(replace(BUMPY, depth=0.02, tile=0.4)).resolved.scale == pytest.approx(0.05)
    assert Object(replace(BUMPY, depth=0.08, tile=0.4)).resolved.scale == pytest.approx(0.2)
    assert Object(replace(BUMPY, depth=0.08, tile=0.4), scale=0.3).resolved.scale == 0.3
    assert Object(replace(BUMPY, depth=0.08, tile=0.4), scale=0.0).resolved.scale == 0.0
    for name, made in TECHNIQUES.items():
        one = obj(technique=name)
        assert (one.resolved.reference_height, one.resolved.projection) == (
            made.reference_height,
            made.projection,
        )
    assert obj(technique="offset", reference_height=0.0).resolved.reference_height == 0.0
    assert obj(technique="offset_limited", projection="full").resolved.projection == "full"


def test_settings_change_only_the_named_fields() -> None:
    one = obj(technique="parallax_occlusion", settings={"max_steps": 20, "min_steps": 4.0})
    assert one.resolved.settings == March(4, 20, 0.0)
    assert obj(technique="steep", settings=Steps(3)).settings == Steps(3)
    assert obj(technique="steep").resolved.settings == Steps()


def test_tiles_are_about_square() -> None:
    wide = heights(np.full((2, 4), 0.5))
    assert Object(wide).resolved.tiling.tiles == (1.0, 1.0)
    assert Object(wide, shape="sphere").resolved.tiling.tiles == (4.0, 4.0)
    assert Object(wide, shape="cylinder").resolved.tiling.tiles == (3.0, 2.0)
    assert Object(wide, shape="sphere", tiling=(5, 1)).resolved.tiling.tiles == (5, 1)


def test_a_plane_lies_flat_in_the_proportions_of_its_maps() -> None:
    """The picture's top is away from a camera at azimuth 0; the sides are those of the maps."""
    wide, high = Object(heights(np.full((2, 4), 0.5))), Object(heights(np.full((4, 2), 0.5)))
    corner = np.array([-0.5, 0.5, 0.0, 1.0])  # top left
    np.testing.assert_allclose((wide.resolved.transform @ corner)[:3], [-0.5, 0, -0.25], atol=1e-12)
    np.testing.assert_allclose((high.resolved.transform @ corner)[:3], [-0.25, 0, -0.5], atol=1e-12)
    # z is scaled like x: the scale is a fraction of a tile's width, which for the high one is half
    np.testing.assert_allclose((wide.resolved.transform @ [0, 0, 1, 0])[:3], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(
        (high.resolved.transform @ [0, 0, 1, 0])[:3], [0, 0.5, 0], atol=1e-12
    )
    assert np.array_equal(Object(BUMPY, shape="box").resolved.transform, np.eye(4))


# --- transforms -----------------------------------------------------------------------------------


def test_rotations_are_counterclockwise() -> None:
    for axis, start, end in (("x", 1, 2), ("y", 2, 0), ("z", 0, 1)):
        quarter = rotated(axis, 90.0)[:3, :3]  # type: ignore[arg-type]
        np.testing.assert_allclose(quarter @ np.eye(3)[start], np.eye(3)[end], atol=1e-12)
        assert np.linalg.det(quarter) == pytest.approx(1.0)
    np.testing.assert_allclose((LYING @ [0, 0, 1, 0])[:3], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose((LYING @ [0, 1, 0, 0])[:3], [0, 0, -1], atol=1e-12)


def test_placed_scales_before_it_translates() -> None:
    np.testing.assert_allclose(placed((1, 2, 3), 2.0) @ [1, 1, 1, 1], [3, 4, 5, 1])
    np.testing.assert_allclose(placed(scale=(2, 3, 4)) @ [1, 1, 1, 1], [2, 3, 4, 1])


def test_placements_hold_the_inverse_transform() -> None:
    matrix = placed((0.5, -1, 2), (2, 0.5, 3)) @ rotated("y", 25.0)
    place = obj(transform=matrix).resolved.placement()
    world = np.array([0.3, -0.7, 1.1])
    local = place.to_object @ Vec3(*(world - np.array([*place.origin])))
    np.testing.assert_allclose([*local], (np.linalg.inv(matrix) @ [*world, 1])[:3], atol=1e-6)


# --- lights ---------------------------------------------------------------------------------------


def test_constructors_of_lights() -> None:
    sun = directional(90.0, 0.0, (1.0, 0.5, 0.25), 2.0)
    assert sun.kind == DIRECTIONAL
    np.testing.assert_allclose([*sun.direction], [-1, 0, 0], atol=1e-6)
    np.testing.assert_allclose([*sun.color], [2.0, 1.0, 0.5])
    np.testing.assert_allclose([*directional(0.0, 90.0).direction], [0, -1, 0], atol=1e-6)
    lamp = point((1, 2, 3), falloff=1.0)
    assert (lamp.kind, lamp.falloff) == (POINT, 1.0)
    cone = spot((0, 2, 0), angle=60.0, softness=0.5)
    assert cone.kind == SPOT
    np.testing.assert_allclose([*cone.direction], [0, -1, 0], atol=1e-6)
    assert float(cone.cos_outer) == pytest.approx(math.cos(math.radians(30)))
    assert float(cone.cos_inner) == pytest.approx(math.cos(math.radians(15)))


@pytest.mark.parametrize(
    "make",
    [
        lambda: directional(NAN),
        lambda: directional(elevation=INF),
        lambda: directional(intensity=NAN),
        lambda: directional(color=(1.0, INF, 0.0)),
        lambda: point((0.0, NAN, 0.0)),
        lambda: point((0.0, 0.0, 0.0), falloff=INF),
        lambda: spot((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
        lambda: spot((0.0, 1.0, 0.0), angle=0.0),
        lambda: spot((0.0, 1.0, 0.0), angle=180.0),
        lambda: spot((0.0, 1.0, 0.0), angle=NAN),
        lambda: spot((0.0, 1.0, 0.0), softness=1.5),
        lambda: directional(intensity=-1.0),
        lambda: point((0.0, 1.0, 0.0), color=(1.0, -0.5, 0.0)),
        lambda: directional(color=(1.0, 1.0)),
        lambda: point((1.0, 2.0)),
        lambda: spot((0.0, 1.0), (0.0, 0.0)),
    ],
)
def test_invalid_lights_are_refused(make) -> None:
    refused(make)


# --- scenes and their cameras ---------------------------------------------------------------------


def test_an_unknown_shading_model_is_refused() -> None:
    message = refused(lambda: Scene((obj(),), shading_model="lambert"))  # type: ignore[arg-type]
    assert "shading_model is one of ggx, phong, not 'lambert'" in message


@pytest.mark.parametrize("texels", [NAN, INF, 64.5])
def test_an_integer_is_a_whole_finite_number(texels: float) -> None:
    message = refused(lambda: Scene((obj(),), shadow_map_size=texels))  # type: ignore[arg-type]
    assert message == f"shadow_map_size is {texels}: give a whole number"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"shading": Shading(ambient=(NAN, 0.0, 0.0))}, "ambient is nan"),
        ({"shading": Shading(diffuse=-1.0)}, "diffuse is -1: give a number from 0"),
        ({"background": (NAN, 0.0, 0.0)}, "background (nan, 0.0, 0.0): give three"),
        ({"background": (0.1, -0.2, 0.0)}, "background (0.1, -0.2, 0.0): give three"),
        ({"background": (0.1, 0.2)}, "background is (0.1, 0.2): give three"),
    ],
)
def test_invalid_colours_are_refused(options, message) -> None:
    assert message in refused(lambda: Scene((obj(),), **options))


def scene_from(eye, *objects, target=(0.3, 0.2, 0.1)) -> Scene:
    return Scene(objects, camera=LookAt(tuple(eye), target))


INSIDE = {
    "sphere": ((0.2, 0.1, -0.3), (0.3, 0.3, 0.3)),
    "box": ((0.45, -0.45, 0.45), (0.45, 0.2, 0.55)),
    "cylinder": ((0.3, -0.45, 0.3), (0.45, 0.0, 0.45)),
}


@pytest.mark.parametrize("shape", INSIDE)
def test_a_camera_inside_an_object_is_refused(shape) -> None:
    """Tested in object space: a camera just outside is accepted."""
    inside, beside = (np.array([*place, 1.0]) for place in INSIDE[shape])
    matrix = placed((0.3, 0.2, 0.1), (0.5, 2.0, 1.5)) @ rotated("z", 30.0)
    made = Object(BUMPY, shape=shape, transform=matrix)
    message = refused(scene_from((matrix @ inside)[:3], made).check_camera)
    assert (
        message
        == f"the camera is inside the {shape}; move it away, for example --camera distance=3"
    )
    scene_from((matrix @ beside)[:3], made).check_camera()
    # among several objects too
    refused(scene_from((matrix @ inside)[:3], obj(), made).check_camera)


def test_a_camera_inside_a_raised_relief_is_refused() -> None:
    raised = obj(transform=np.eye(4), reference_height=0.25, scale=0.4)
    assert "inside the plane" in refused(scene_from((0.1, 0.1, 0.29), raised).check_camera)
    scene_from((0.1, 0.1, 0.31), raised).check_camera()
    scene_from((0.6, 0.1, 0.29), raised).check_camera()
    pushed_in = obj(transform=np.eye(4), reference_height=1.0, scale=0.4)
    scene_from((0.1, 0.1, 0.05), pushed_in).check_camera()
    drawn_flat = obj(transform=np.eye(4), reference_height=0.25, scale=0.4, technique="flat")
    scene_from((0.1, 0.1, 0.05), drawn_flat).check_camera()


def test_a_relief_of_many_tiles_is_raised_by_the_width_of_one() -> None:
    """The scale is a fraction of a tile's width, so four tiles are raised a quarter as far."""
    raised = obj(transform=np.eye(4), reference_height=0.0, scale=0.4, tiling=(-4.0, 1.0))
    assert "inside the plane" in refused(scene_from((0.1, 0.1, 0.09), raised).check_camera)
    scene_from((0.1, 0.1, 0.11), raised).check_camera()


def test_a_camera_behind_a_lone_plane_is_refused() -> None:
    scene = scene_from((0.0, -0.5, 0.2), obj(), target=(0, 0, 0))
    assert "the camera is behind the plane, which has no back" in refused(scene.check_camera)
    scene_from((0.0, -0.5, 0.2), obj(), Object(BUMPY, shape="box", transform=placed((0, 3, 0))),
              target=(0, 0, 0)).check_camera()  # fmt: skip


@pytest.mark.parametrize(
    "camera",
    [
        Orbit(distance=0.0),
        Orbit(distance=-1.0),
        Orbit(distance=NAN),
        Orbit(azimuth=NAN),
        Orbit(elevation=INF),
        Orbit(field_of_view=0.0),
        Orbit(field_of_view=180.0),
        Orbit(orthographic_height=0.0),
        Orbit(orthographic_height=NAN),
        Orbit(target=(NAN, 0.0, 0.0)),
        LookAt((0.0, 0.0, 0.0)),
        LookAt((INF, 2.0, 0.0)),
        LookAt((1.0, 2.0)),  # type: ignore[arg-type]
    ],
)
def test_invalid_cameras_are_refused(camera) -> None:
    refused(lambda: Scene((obj(),), camera=camera).check_camera())


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", [1.0, 5.0])
def test_without_a_distance_the_whole_object_is_in_the_picture(shape, size) -> None:
    """The default distance fits objects of any size into a wide picture."""
    plain = obj(shape=shape, technique="flat")
    one = obj(
        shape=shape, technique="flat", transform=placed(scale=size) @ plain.resolved.transform
    )
    hit = render(Scene((one,), lights=()), size=(64, 36), samples=1, device=CPU).hit
    assert not np.concatenate([hit[0], hit[-1], hit[:, 0], hit[:, -1]]).any()
    assert hit.mean() > 0.15


CPU = CpuEngine()


# --- a user-defined technique ---------------------------------------------------------------------


@struct
class Slide:
    """Settings of the technique below."""

    along: float = setting(default=0.25, doc="how far", low=0.0, high=1.0)
    times: int = setting(default=2, doc="how often", low=1, high=8)
    tint: Vec3 = setting(default=Vec3(1.0), doc="not used", low=0.0)


@technique(reference_height=0.5)
def sliding(field: HeightField, ray: Ray, settings: Slide) -> Hit:
    """Go down by a constant height."""
    height = ray.reference_height - settings.along * float(settings.times)
    return hit_at(ray, t_at(ray, height), True, settings.times)


def test_settings_of_user_defined_techniques_are_checked() -> None:
    assert obj(technique=sliding).resolved.settings == Slide()
    assert obj(technique=sliding).resolved.reference_height == 0.5
    assert obj(technique=sliding, settings={"times": 3}).resolved.settings.times == 3
    assert obj(technique=sliding, settings={"tint": 0.5}).resolved.settings.tint == Vec3(0.5)
    triple = obj(technique=sliding, settings={"tint": (1, 2, 3)})
    assert triple.resolved.settings.tint == Vec3(1, 2, 3)
    assert "along is 2: give" in refused(lambda: obj(technique=sliding, settings={"along": 2}))
    for tint in ((1.0, 2.0), (1.0, -1.0, 0.0), "red", None, (NAN, 0, 0), [[1, 2, 3]]):
        assert "tint" in refused(lambda t=tint: obj(technique=sliding, settings={"tint": t}))


@struct
class Unbounded:
    """Settings without ranges, and one without a default."""

    must: float
    count: int = setting(default=1, doc="how many")
    size: float = setting(default=1.0, doc="how large")


def test_settings_without_ranges_are_limited_to_32_bits() -> None:
    made = checked_record(Unbounded, {"must": 1, "count": 7, "size": -2.5}, "mine")
    assert (made.must, made.count, made.size) == (1.0, 7, -2.5)
    assert "count" in refused(
        lambda: checked_record(Unbounded, {"must": 1, "count": 2**40}, "mine")
    )
    assert "size" in refused(lambda: checked_record(Unbounded, {"must": 1, "size": 1e300}, "mine"))
    assert "must" in refused(lambda: checked_record(Unbounded, {}, "mine"))


def test_techniques_are_found_by_name() -> None:
    for name, made in TECHNIQUES.items():
        assert technique_named(name) is made
        assert made.name == name
    message = refused(lambda: technique_named("parallax"))
    assert all(name in message for name in TECHNIQUES)


# --- fuzzed ---------------------------------------------------------------------------------------

ANYTHING = st.one_of(
    st.floats(),
    st.floats(-2, 40),
    st.integers(-5, 60),
    st.integers(),
    st.text(max_size=3),
    st.none(),
    st.booleans(),
    st.lists(st.floats(0, 1), max_size=3),
)
SMALL_NUMBERS = st.one_of(st.floats(-1, 2), st.floats())
OPTIONS = st.fixed_dictionaries(
    {"technique": st.sampled_from(["steep", "relief"])},
    optional={
        "settings": st.dictionaries(
            st.sampled_from(["steps", "min_steps", "max_steps", "search_steps", "other"]),
            ANYTHING,
            max_size=3,
        ),
        "scale": SMALL_NUMBERS,
        "reference_height": SMALL_NUMBERS,
        "bias": SMALL_NUMBERS,
        "tiling": st.tuples(SMALL_NUMBERS, SMALL_NUMBERS),
        "shift": st.tuples(SMALL_NUMBERS, SMALL_NUMBERS),
        "transform": st.builds(
            placed, st.tuples(*[SMALL_NUMBERS] * 3), st.tuples(*[SMALL_NUMBERS] * 3)
        ),
    },
)
CAMERAS = st.builds(
    Orbit,
    SMALL_NUMBERS.map(lambda x: x * 90),
    SMALL_NUMBERS.map(lambda x: x * 90),
    st.one_of(st.none(), st.floats(0, 5), st.floats()),
    field_of_view=st.one_of(st.floats(1, 179), st.floats()),
)


@given(OPTIONS, CAMERAS)
@examples(max_examples=250)
def test_any_settings_are_refused_in_a_line_or_make_a_picture(options, camera) -> None:
    frame, refusal = None, ""
    try:
        scene = Scene((obj(**options),), camera=camera)
        frame = render(scene, size=(7, 5), samples=1, device=CPU)
    except InputError as error:
        refusal = str(error)
    if frame is None:
        assert refusal
        assert "\n" not in refusal
        return
    assert np.isfinite(frame.color).all()
    assert np.isfinite(frame.uv).all()
    assert not np.isnan(frame.distance).any()
    assert (frame.reads >= 0).all()


def test_a_vertical_view_needs_no_up() -> None:
    """As with an orbit at elevation 90, the picture's top is towards −z."""
    down = LookAt((0.0, 2.0, 0.0)).camera((8, 8))
    assert tuple(down.right) == pytest.approx((1.0 * float(down.right.x), 0.0, 0.0), abs=1e-7)
    assert float(down.right.x) > 0.0
    assert float(down.down.z) > 0.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Object("sample:bricks"), "material is 'sample:bricks': give a Material"),
        (lambda: Object(BUMPY, layer="sample:grid"), "layer is 'sample:grid': give a Layer"),
        (lambda: Object(BUMPY, tilings={"normal": (2, 2)}), "tiling of normal is (2, 2): give a"),
        (lambda: Object(BUMPY, scale="x"), "scale is 'x': give a number"),
        (lambda: Object(BUMPY, fade=3), "fade is 3: give two numbers"),
        (lambda: Object(BUMPY, tiling=(1, 2, 3)), "tiling is (1, 2, 3): give two numbers"),
        (lambda: Scene(("bricks",)), "objects are a tuple of Object"),
        (
            lambda: Scene((), fog_mode="linear", fog={"fog_start": 4, "fog_end": 1}),
            "fog from 4 to 1",
        ),
        (
            lambda: Object(BUMPY, technique="exact", heights="smooth"),
            "exact reads its heights sharp or mip; omit heights smooth",
        ),
    ],
)
def test_values_of_the_wrong_type_are_refused_in_a_line(make, message) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert message in str(caught.value)


def test_one_object_is_a_scene_of_one() -> None:
    assert len(Scene(Object(BUMPY)).objects) == 1


# --- names of techniques --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["parallax_occlusion", "parallax-occlusion", "Parallax-Occlusion"])
def test_names_of_techniques_take_hyphens_and_capitals(name: str) -> None:
    assert technique_named(name).name == "parallax_occlusion"


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("pom", "parallax_occlusion"), ("POM", "parallax_occlusion"), ("csm", "cone"),
        ("relief-mapping", "relief"), ("steep parallax", "steep"),
        ("releif", "relief"),  # codespell:ignore releif
    ],
)  # fmt: skip
def test_unknown_names_suggest_a_technique(name: str, meant: str) -> None:
    assert f"did you mean {meant}?" in refused(lambda: technique_named(name))


def test_synonyms_are_of_techniques_and_are_none_themselves() -> None:
    assert set(SYNONYMS.values()) <= set(TECHNIQUES)
    assert not set(SYNONYMS) & set(TECHNIQUES)


# --- values of a wrong kind -----------------------------------------------------------------------


def test_cameras_and_transforms_of_a_wrong_kind_are_refused() -> None:
    camera: Any = {"azimuth": 3.0}
    assert "give an Orbit or a LookAt" in refused(lambda: Scene(Object(BUMPY), camera=camera))
    transform: Any = "x/30"
    assert "transform must be finite" in refused(lambda: Object(BUMPY, transform=transform))


def test_samples_are_whole_numbers() -> None:
    samples: Any = 1.5
    scene = Scene(Object(BUMPY))
    assert "1.5 samples a pixel" in refused(lambda: render(scene, size=(4, 3), samples=samples))


def test_a_hole_in_heights_of_one_texel_keeps_the_shape_of_its_dust() -> None:
    """Of its own dust, and of the default."""
    flat = Material("flat", height=Map(np.ones((1, 1, 1), np.float32), False, "flat"))
    wide = replace(flat, base_color=Map(np.ones((32, 64, 3), np.float32), True, "wide"))
    own = replace(flat, dust=sample("dust", 48).height)
    for material, size in ((flat, (256, 256)), (wide, (128, 256)), (own, (48, 48))):
        height = Object(material, opening=0.8).resolved.material.height
        assert height is not None
        assert (height.height, height.width) == size
        assert height.linear()[0].min() == 1.0
        assert height.linear().min() < 0.1
