"""Text of the command line is parsed to a value, or refused in one line."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from basrelief.cli import arguments
from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.material import Map, Material
from basrelief.scene import (
    LYING,
    LookAt,
    Object,
    Orbit,
    Scene,
    Tiling,
    directional,
    placed,
    point,
    rotated,
    spot,
)
from basrelief.scene.presets import preset
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.techniques import (
    TECHNIQUES,
    HeightField,
    Hit,
    Ray,
    hit_at,
    relief,
    struct,
    t_at,
    technique,
)


@functools.cache
def bumpy() -> Material:
    heights = np.linspace(0.0, 1.0, 6, dtype=np.float32).reshape(2, 3, 1)
    return Material("bumpy", height=Map(heights, False, "made up"))


def scene(**texts: Any) -> Scene:
    return arguments.scene(bumpy(), **texts)


def refused(make: Callable[[], Any]) -> str:
    """The error message, which must be one line."""
    with pytest.raises(InputError) as caught:
        make()
    message = str(caught.value)
    assert message
    assert "\n" not in message
    return message


# --- simple values --------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["1280x720", "1280×720", "1280,720", " 1280 x 720 "])
def test_sizes(text: str) -> None:
    assert arguments.size(text) == (1280, 720)


@pytest.mark.parametrize("text", ["", "1280", "x720", "1x2x3", "-1x2", "1.5x2", "ax2", "1234567x1"])
def test_invalid_sizes(text: str) -> None:
    message = refused(lambda: arguments.size(text))
    assert message.startswith(f"--size {text}: write width x height")


@pytest.mark.parametrize(("text", "expected"), [("1", 1.0), ("-2.5e-1", -0.25), (" 3 ", 3.0)])
def test_numbers(text: str, expected: float) -> None:
    assert arguments.number(text, "it") == expected


@pytest.mark.parametrize("text", ["", "one", "1,2", "1/2", "0x10", "--1"])
def test_invalid_numbers(text: str) -> None:
    assert refused(lambda: arguments.number(text, "--set a")) == f"--set a {text}: write a number"


@pytest.mark.parametrize("text", ["nan", "inf", "-infinity", "1e999"])
def test_numbers_that_are_not_finite(text: str) -> None:
    assert refused(lambda: arguments.number(text, "it")) == f"it {text}: write a finite number"


@pytest.mark.parametrize("text", ["-5", "5-", "-", "0--5"])
def test_ranges_below_0_and_without_ends_are_refused(text: str) -> None:
    assert refused(lambda: arguments.span(text, "--angles")).startswith(f"--angles {text}: write ")


def test_values_are_one_or_several() -> None:
    assert arguments.value("2.5", "it") == 2.5
    assert arguments.value("1,2/3", "it") == (1.0, 2.0, 3.0)
    assert arguments.vector("1/2,3", "it") == (1.0, 2.0, 3.0)
    for text in ("1", "1/2", "1/2/3/4"):
        assert "write three numbers, for example 1/2/3" in refused(
            lambda t=text: arguments.vector(t, "it")
        )


def test_names_and_values() -> None:
    assert arguments.name_and_value("max-steps = 3", "--set") == ("max_steps", "3")
    assert arguments.name_and_value("a=b=c", "--set") == ("a", "b=c")
    for text in ("", "a", "a=", "=3", "a= "):
        assert refused(lambda t=text: arguments.name_and_value(t, "--set")) == (
            f"--set {text}: write NAME=VALUE"
        )


def test_pairs() -> None:
    assert arguments.pair("2x3", "--tiling") == (2.0, 3.0)
    assert arguments.pair("-0.5,1", "--shift") == (-0.5, 1.0)
    assert arguments.pair("4", "--tiling") == (4.0, 4.0)
    assert "write one number, or two, for" in refused(lambda: arguments.pair("1x2x3", "--tiling"))


def test_colors() -> None:
    assert arguments.color("0.1,0.2,0.3", "--background") == (0.1, 0.2, 0.3)
    assert arguments.color("0.5", "--background") == (0.5, 0.5, 0.5)
    assert arguments.color(" none", "--background") is None
    for text in ("1,2", "1,2,3,4", "0.1,-0.1,0.1"):
        assert "write one or three numbers" in refused(
            lambda t=text: arguments.color(t, "--background")
        )


# --- cameras and lights ---------------------------------------------------------------------------


def test_cameras() -> None:
    assert arguments.camera_from("azimuth=10, elevation=-5") == Orbit(10.0, -5.0)
    assert arguments.camera_from("distance=3,target=1/2/3,field-of-view=50") == Orbit(
        distance=3.0, target=(1.0, 2.0, 3.0), field_of_view=50.0
    )
    assert arguments.camera_from("orthographic_height=2") == Orbit(orthographic_height=2.0)
    assert arguments.camera_from("up=1/0/0, position=1/2/3") == LookAt(
        (1.0, 2.0, 3.0), up=(1.0, 0.0, 0.0)
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "--camera : write NAME=VALUE"),
        ("30", "--camera 30: write NAME=VALUE"),
        (
            "azimut=3",
            "--camera: there is no parameter azimut; there are azimuth, elevation, distance",
        ),
        (
            "position=1/1/1,azimuth=3",
            "there is no parameter azimuth; there are position, target, up",
        ),
        ("azimuth=left", "--camera: azimuth left: write a number"),
        ("azimuth=1/2", "--camera: azimuth 1/2: write a number"),
        ("target=0", "--camera: target 0: write three numbers, for example 1/2/3"),
        ("target=1,2,3", "--camera: target 1: write three numbers"),
    ],
)
def test_invalid_cameras(text: str, message: str) -> None:
    assert message in refused(lambda: arguments.camera_from(text))


def test_lights() -> None:
    assert arguments.light_from("directional") == directional()
    assert arguments.light_from(" directional ,azimuth=5,intensity=2") == directional(
        5.0, intensity=2.0
    )
    assert arguments.light_from("point,position=1/2/3,color=1/0.5/0") == point(
        (1.0, 2.0, 3.0), (1.0, 0.5, 0.0)
    )
    assert arguments.light_from("spot,position=0/1/0,angle=20") == spot((0.0, 1.0, 0.0), angle=20.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "--light : begin with directional, point, spot"),
        ("lamp,position=1/2/3", "begin with directional, point, spot"),
        ("point", "--light point: add a position, for example position=1/2/1"),
        ("point,position=1", "--light point: position 1: write three numbers"),
        (
            "point,position=1/2/3,angle=3",
            "--light point: there is no parameter angle; there are pos",
        ),
        ("point,position=1/2/3,intensity=1/2", "--light point: intensity 1/2: write a number"),
        ("point,position=1/2/3,color=1", "--light point: color 1: write three numbers"),
        ("spot,position=0/0/0", "a light needs finite numbers and a direction that is not zero"),
        ("spot,position=0/1/0,angle=190", "a spot of angle 190"),
        ("directional,azimuth=inf", "--light directional: azimuth inf: write a finite number"),
    ],
)
def test_invalid_lights(text: str, message: str) -> None:
    assert message in refused(lambda: arguments.light_from(text))


# --- scenes ---------------------------------------------------------------------------------------


def test_a_scene_without_options_is_the_default() -> None:
    parsed, default = scene(), Scene((Object(bumpy()),))
    assert parsed.objects[0].technique is relief
    for name in ("camera", "lights", "shading", "shading_model", "background"):
        assert getattr(parsed, name) == getattr(default, name)
    for name in (
        "settings", "scale", "reference_height", "projection", "bias", "edge", "tiling", "shift",
    ):  # fmt: skip
        assert getattr(parsed.objects[0], name) == getattr(default.objects[0], name)


def test_settings_go_to_their_records() -> None:
    texts = ["max-steps=9", "roughness=0.5", "base_color=0.1/0.2/0.3", "ambient=0.4"]
    parsed = scene(settings=texts, technique="relief", bias=0.2)
    obj = parsed.objects[0]
    assert obj.resolved.settings == replace(relief.settings(), max_steps=9)
    assert obj.resolved.surface_parameters == SurfaceParameters(
        base_color=Vec3(0.1, 0.2, 0.3), roughness=0.5
    )
    assert parsed.shading.ambient == Vec3(0.4)
    assert obj.bias == 0.2
    # the last one wins
    twice = scene(settings=["steps=8", "steps=9"], technique="steep").objects[0]
    assert twice.resolved.settings.steps == 9


@struct
class Plain:
    """Settings of a technique of one's own, one of them without a range."""

    depth: float = 0.5


@technique()
def halfway(field: HeightField, ray: Ray, settings: Plain) -> Hit:
    """The ray at a fixed height."""
    return hit_at(ray, t_at(ray, settings.depth), True, 0)


def test_a_setting_without_a_range_is_set() -> None:
    obj = scene(technique=halfway, settings=["depth=0.25"]).objects[0]
    assert obj.resolved.settings.depth == 0.25
    assert "there are depth" in refused(lambda: scene(technique=halfway, settings=["deep=1"]))


def test_positions_and_sizes() -> None:
    obj = scene(tiling="2x3", shift="0.5,0.25", shape="box", stretch="1/2/3").objects[0]
    assert obj.tiling == (2.0, 3.0)
    assert obj.shift == (0.5, 0.25)
    assert (obj.resolved.transform == placed(scale=(1.0, 2.0, 3.0))).all()


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        ({"settings": ["steps"]}, "--set steps: write NAME=VALUE"),
        ({"settings": ["step=3"]}, "--set step: there is no such setting here; there are min_step"),
        ({"settings": ["steps=3"], "technique": "relief"}, "--set steps: there is no such setting"),
        ({"settings": ["max_steps=0"]}, "max_steps is 0: give a number from 1 to 4096"),
        ({"settings": ["steps=0"], "technique": "steep"}, "steps is 0: give a number from 1 to"),
        ({"settings": ["max_steps=2.5"]}, "max_steps is a whole number, not 2.5"),
        ({"settings": ["max_steps=many"]}, "--set max_steps many: write a number"),
        ({"settings": ["max_steps=1/2"]}, "max_steps"),
        ({"settings": ["roughness=2"]}, "roughness is 2: give a number from 0 to 1"),
        ({"settings": ["emission=1/2"]}, "emission"),
        ({"settings": ["ambient=-1"]}, "ambient is -1"),
        ({"settings": ["bias=1"]}, "--set bias: it is an option of its own; write --bias"),
        ({"bias": -2.0}, "bias is -2: give a number from -1 to 100"),
        ({"technique": "leap"}, "no technique is called 'leap'; use one of flat, offset"),
        ({"shape": "torus"}, "shape is one of plane, box, sphere, cylinder, not 'torus'"),
        ({"projection": "skew"}, "projection is one of full, biased, limited, not 'skew'"),
        ({"edge": "mirror"}, "edge is one of wrap, clamp, clip, not 'mirror'"),
        ({"shading_model": "cel"}, "shading_model is one of ggx, phong, not 'cel'"),
        ({"scale": math.nan}, "scale is nan: give a number from 0 to 10"),
        ({"reference_height": 2.0}, "reference_height is 2: give a number from 0 to 1"),
        ({"tiling": "0"}, "tiling (0.0, 0.0): give finite numbers other than 0"),
        ({"tiling": "wide"}, "--tiling wide: write a number"),
        ({"shift": "inf"}, "--shift inf: write a finite number"),
        ({"stretch": "1/2/3", "shape": "torus"}, "shape is one of plane, box, sphere, cylinder"),
        ({"stretch": "2"}, "--stretch 2: write three numbers"),
        ({"stretch": "1/0/1"}, "--stretch 1/0/1: write numbers other than 0"),
        ({"background": "red"}, "--background red: write a number"),
        ({"heights": "soft"}, "heights is one of sharp, smooth, mip, not 'soft'"),
        ({"fade": "near"}, "--fade near: write a number"),
        ({"fade": "3,1"}, "fade 3 to 1: give two distances, the nearer first"),
        ({"surface": "sea"}, "surface is one of standard, landscape, not 'sea'"),
        ({"settings": ["water_level=0.1"]}, "--set water_level: there is no such setting here"),
        ({"settings": ["water_level=1"], "surface": "standard"}, "--set water_level: there is"),
        ({"settings": ["fog_density=-1"]}, "fog_density is -1: give a number from 0 to 1000"),
        (
            {"fog_mode": "thick"},
            "fog_mode is one of none, linear, exponential, exponential_squared, not 'th",
        ),
        ({"occlusion_kind": "all"}, "occlusion_kind is one of ambient, directional, not 'all'"),
        ({"map_tiling": ["2x3"]}, "--map-tiling 2x3: write NAME=VALUE"),
        ({"map_tiling": ["height=2"]}, "--map-tiling height: the maps are base_color, normal, re"),
        ({"map_tiling": ["normal=wide"]}, "--map-tiling normal wide: write a number"),
        ({"map_tiling": ["normal=0"]}, "tiling of normal (0.0, 0.0): give finite numbers other"),
        ({"map_shift": ["glow=1"]}, "--map-shift glow: the maps are base_color"),
        ({"layer": "sample:x"}, "there is no sample 'x'"),
        ({"opening": 1.5}, "opening is 1.5: give a number from 0 to 1"),
        ({"opening": 0.5, "measured": True}, "--depth and --tile are those of the material, not"),
        ({"layer_tiling": "2"}, "--layer-tiling, --layer-shift: there is no layer; add --layer F"),
        ({"layer": "sample:grid", "layer_shift": "far"}, "--layer-shift far: write a number"),
        ({"add": ["torus"]}, "shape is one of plane, box, sphere, cylinder, not 'torus'"),
        ({"add": ["box,big"]}, "--add box big: write NAME=VALUE"),
        ({"add": ["box,radius=1"]}, "--add box: there is no parameter radius; there are posit"),
        (
            {"add": ["box,position=1"]},
            "--add box: position 1: write three numbers, for example 1/2/3",
        ),
        (
            {"add": ["box,size=1/2"]},
            "--add box: size 1/2: write one number, or three, for example 1/2/3",
        ),
        ({"add": ["box,layer_shift=1"]}, "--add box: layer_shift: there is no layer; add layer="),
        ({"add": ["box,ambient=1"]}, "--add box: there is no parameter ambient"),
        ({"add": ["box,water_level=1"]}, "--add box: there is no parameter water_level"),
        ({"add": ["box,normal_tiling=two"]}, "--add box: normal_tiling two: write a number"),
        ({"add": ["box,roughness=2"]}, "roughness is 2: give a number from 0 to 1"),
        ({"add": ["box,surface=lake"]}, "surface is one of standard, landscape"),
        ({"add": ["box,size=0"]}, "size 0: write numbers above 0"),
        (
            {"add": ["box,turn=30"]},
            "--add box: turn 30: write an axis and degrees, for example x/30",
        ),
        ({"add": ["box,turn=x/far"]}, "--add box: turn far: write a number"),
        ({"add": ["box,color=1/2"]}, "base_color is one number, or 3 of them"),
        ({"add": ["box,technique=relief"]}, "plain has no height map, which relief needs"),
        ({"add": ["box,material=sample:x"]}, "there is no sample 'x'"),
    ],
)
def test_invalid_scenes(texts: dict[str, Any], message: str) -> None:
    assert message in refused(lambda: scene(**texts))


def test_further_objects() -> None:
    parsed = scene(add=["plane,position=0/1/0,tiling=2x3,shift=0.5,casts=none", "sphere,turn=z/90"])
    first, lying, ball = parsed.objects
    assert first.shape == "plane"
    assert (lying.tiling, lying.shift, lying.casts) == ((2.0, 3.0), (0.5, 0.5), "none")
    assert lying.resolved.transform == pytest.approx(placed((0.0, 1.0, 0.0)) @ LYING)
    assert ball.resolved.transform == pytest.approx(rotated("z", 90.0))
    (_, lifted) = scene(
        add=["sphere,material=sample:tiles,reference_height=0.5,bias=0.2,scale=0.1"]
    ).objects
    assert (lifted.resolved.technique, lifted.resolved.reference_height, lifted.bias) == (
        relief,
        0.5,
        0.2,
    )


def test_further_objects_have_all_that_the_main_one_has() -> None:
    """Layer, tilings of single maps, surface, and the numbers of the records."""
    text = (
        "sphere,material=sample:tiles,technique=relief,max_steps=9,roughness=0.25,heights=smooth,"
        "mip_bias=2,tiling=4x2,normal_tiling=2x3,normal_shift=0.5/0.25,emission_shift=0.5,"
        "layer=sample:grid,layer_tiling=6x5,layer_shift=0.25/0,alpha=mask,cutoff=0.4,color=1/0.5/0"
    )
    obj = scene(add=[text]).objects[1].resolved
    assert (obj.technique, obj.settings.max_steps, obj.smoothing.mip_bias) == (relief, 9, 2.0)
    assert obj.surface_parameters == SurfaceParameters(
        base_color=Vec3(1.0, 0.5, 0.0), roughness=0.25, cutoff=0.4
    )
    assert obj.tilings == {
        "normal": Tiling((2.0, 3.0), (0.5, 0.25)),
        "emission": Tiling((4.0, 2.0), (0.5, 0.5)),
    }
    assert (obj.layer.material.name, obj.layer.tiling) == ("grid", Tiling((6.0, 5.0), (0.25, 0.0)))
    lake = scene(
        add=["plane,material=sample:noise,surface=landscape,water_level=0.6,layer=sample:stone"]
    )
    lake_obj = lake.objects[1].resolved
    assert (lake_obj.surface, lake_obj.surface_parameters.water_level) == (
        "landscape",
        pytest.approx(0.6),
    )
    assert lake_obj.layer.tiling == Tiling((10.0, 10.0))


def test_tilings_of_layers_and_single_maps() -> None:
    tiling = scene(layer="sample:grid").objects[0].layer.tiling
    assert tiling == Tiling((10.0, 10.0))
    ours = preset("habrador")
    layer = scene(preset=ours, layer_shift="0.5").objects[0].layer
    assert (layer.material.name, layer.tiling) == ("stone", Tiling((0.4, 0.4), (0.5, 0.5)))
    own = scene(preset=ours, map_shift=["base_color=0.5", "normal=0.25"]).objects[0].tilings
    assert own["base_color"] == Tiling((0.4, 0.4), (0.5, 0.5))
    # tiles that are not set are those of the heights
    assert own["normal"] == Tiling((0.2, 0.2), (0.25, 0.25))


# --- fuzzed ---------------------------------------------------------------------------------------

NUMBERS = st.one_of(
    st.floats().map(str),
    st.integers(-9, 99).map(str),
    st.lists(st.floats(-5, 5).map(str), min_size=1, max_size=4).map("/".join),
)
TEXTS = st.one_of(st.text(), st.text("0123456789.,/x×=-+einfa ", max_size=12), NUMBERS)
NAMES = st.one_of(
    st.sampled_from(
        [*Orbit.__dataclass_fields__, *LookAt.__dataclass_fields__, "color", "intensity",
         "falloff", "angle", "softness"]
    ),
    st.text(max_size=3),
)  # fmt: skip
SETTINGS = st.one_of(
    st.sampled_from(["min_steps", "max_steps", "steps", "bias", "roughness", "emission", "x"]),
    st.text(max_size=3),
)


def written(names: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(TEXTS, st.tuples(names, TEXTS).map("=".join))


LISTS = st.lists(written(NAMES), max_size=4).map(",".join)


def parsed_or_refused(read: Callable[[], Any]) -> Any:
    """The parsed value, or None if it is refused; any other exception fails the test."""
    with contextlib.suppress(InputError):
        return read()
    return None


@given(TEXTS)
def test_any_text_is_parsed_or_refused(text: str) -> None:
    for parse in (arguments.number, arguments.numbers, arguments.value, arguments.vector,
                 arguments.pair, arguments.color):  # fmt: skip
        parsed = parsed_or_refused(lambda parse=parse: parse(text, "it"))
        assert parsed is None or np.isfinite(parsed).all()
    parsed_or_refused(lambda: arguments.name_and_value(text, "it"))
    parsed = parsed_or_refused(lambda: arguments.size(text))
    assert parsed is None or min(parsed) >= 0


@given(LISTS)
@examples(max_examples=250)
def test_any_camera_text_is_parsed_or_refused(text: str) -> None:
    parsed = parsed_or_refused(lambda: arguments.camera_from(text))
    if parsed is not None:
        camera = parsed_or_refused(lambda: parsed.camera((8, 6)))
        assert camera is None or np.isfinite([*camera.position, *camera.right]).all()


@given(st.sampled_from(["directional", "point", "spot", "lamp"]), LISTS)
@examples(max_examples=250)
def test_any_light_text_is_parsed_or_refused(kind: str, text: str) -> None:
    parsed = parsed_or_refused(lambda: arguments.light_from(f"{kind},{text}"))
    if parsed is not None:
        assert np.isfinite([*parsed.position, *parsed.direction, *parsed.color]).all()


@given(
    st.fixed_dictionaries(
        {},
        optional={
            "settings": st.lists(written(SETTINGS), max_size=3),
            "technique": st.one_of(st.sampled_from([*TECHNIQUES]), st.text(max_size=8)),
            "tiling": TEXTS,
            "shift": TEXTS,
            "stretch": TEXTS,
            "turn": st.one_of(TEXTS, TEXTS.map("y/{}".format)),
            "background": TEXTS,
            "fade": TEXTS,
            "map_tiling": st.lists(written(st.sampled_from(["normal", "height"])), max_size=2),
            "add": st.lists(
                st.tuples(st.sampled_from(["box", "ball"]), LISTS).map(",".join), max_size=2
            ),
            "shape": st.sampled_from(["plane", "box", "torus"]),
            "scale": st.floats(),
            "reference_height": st.floats(),
        },
    )
)
@examples(max_examples=300)
def test_any_scene_text_is_parsed_or_refused(texts: dict[str, Any]) -> None:
    parsed = parsed_or_refused(lambda: scene(**texts))
    if parsed is not None:
        obj = parsed.objects[0]
        assert np.isfinite(
            [*obj.resolved.tiling.tiles, *obj.shift, obj.bias, obj.resolved.scale]
        ).all()
        assert parsed.background is None or np.isfinite(parsed.background).all()


@pytest.mark.parametrize(("depth", "tile"), [(0.04, None), (None, 1.0)])
def test_depth_and_tile_go_together(depth, tile):
    with pytest.raises(InputError, match="together"):
        arguments.check_lengths(depth, tile, None)
    arguments.check_lengths(0.04, 1.0, None)
    with pytest.raises(InputError, match="not both"):
        arguments.check_lengths(0.04, 1.0, 0.1)
