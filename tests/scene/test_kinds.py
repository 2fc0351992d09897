"""Kinds: each value has a program, and any other is refused in one line by every interface."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from basrelief import baking
from basrelief.errors import InputError
from basrelief.images import Picture
from basrelief.lang import HeightField, Texture
from basrelief.lang.types import leaf_values
from basrelief.material import channels, sample
from basrelief.material.options import ReadOptions
from basrelief.measure.columns import intersect_columns
from basrelief.measure.debug import SHOWN, debug_picture
from basrelief.measure.oracle import intersect_height_field
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import SURFACES as SURFACE_SHADERS
from basrelief.rendering.programs import program_of
from basrelief.rendering.shadow_maps import light_views
from basrelief.scene import SHAPES, SURFACES, Layer, Object, Scene, directional, motion, point, spot
from basrelief.scene.lights import LIGHTS, light_kind, light_numbers, light_parameters
from basrelief.scene.presets import Preset, preset
from basrelief.settings import kinds, settings_of
from basrelief.settings.kinds import Projection
from basrelief.shading.lights import Light
from basrelief.viewer.printed import MENUS
from basrelief.viewer.shown import as_light_dict, light_of
from helpers.command_line import refused as command_refused
from helpers.command_line import write_heights

OF_OBJECT = {
    "shape": kinds.ShapeKind,
    "projection": Projection,
    "heights": kinds.HeightsKind,
    "filter": kinds.FilterKind,
    "edge": kinds.EdgeKind,
    "mapping": kinds.MappingKind,
    "alpha": kinds.AlphaKind,
    "layer_offset": kinds.LayerOffsetKind,
    "casts": kinds.CastsKind,
    "surface": kinds.SurfaceKind,
}
OF_SCENE = {
    "shading_model": kinds.ShadingModel,
    "shadows": kinds.ShadowsKind,
    "shadows_on": kinds.ShadowsOnKind,
    "occlusion_kind": kinds.OcclusionKind,
    "fog_mode": kinds.FogKind,
}
OPTIONS = {**OF_OBJECT, **OF_SCENE}
CASES = [(name, value) for name, kind in OPTIONS.items() for value in get_args(kind)]
BRICKS = sample("bricks", 16)
UNKNOWN = ("torus", "", "Xyz", "0")


def scene(**options: Any) -> Scene:
    of_scene = {name: options.pop(name) for name in list(options) if name in OF_SCENE}
    return Scene((Object(BRICKS, **options),), **of_scene)


def refusal(make: Any) -> str:
    with pytest.raises(InputError) as caught:
        make()
    assert "\n" not in str(caught.value)
    return str(caught.value)


def expected_refusal(name: str, value: str) -> str:
    """The message that refuses an unknown value: the name, the known values and the value."""
    return f"{name} is one of {', '.join(get_args(OPTIONS[name]))}, not {value!r}"


# --- known values ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "value"), CASES)
def test_each_value_makes_a_program_of_its_own(name: str, value: str) -> None:
    # with other options under which every value matters
    others = {
        "edge": "clip", "mapping": "triplanar", "shadows": "hard", "casts": "shape",
        "layer": Layer(sample("grid", 16)),
    }  # fmt: skip
    ball = Object(BRICKS, "sphere")
    keys = {}
    for each in get_args(OPTIONS[name]):
        made = scene(**{**others, name: each})
        made = replace(made, objects=(*made.objects, ball))
        keys[each] = program_of(made.resolved[0], made).key
    same = [each for each in keys if keys[each] == keys[value]]
    # an object that casts no shadow is drawn by the same program
    if name == "casts":
        assert same == list(keys)
    else:
        assert same == [value]


@pytest.mark.parametrize(
    ("table", "kind"),
    [
        (SURFACE_SHADERS, kinds.SurfaceKind),
        (SHAPES, kinds.ShapeKind),
        (SURFACES, kinds.SurfaceKind),
        *((MENUS[name], OPTIONS[name]) for name in MENUS),
    ],
)
def test_tables_have_every_kind(table: Any, kind: Any) -> None:
    assert tuple(table) == get_args(kind)


def test_the_kinds_of_lights_have_the_numbers_of_the_shaders() -> None:
    """The viewer's page uses the same order."""
    lights = (directional(), point((1.0, 2.0, 3.0)), spot((1.0, 2.0, 3.0)))
    assert [light_kind(light) for light in lights] == list(LIGHTS)
    assert [int(light.kind) for light in lights] == [0, 1, 2]
    # a directional light has one view, one that lights all around six
    around = Scene((Object(BRICKS, "sphere"),), lights=lights, shadow_map_size=16)
    assert [view.light for view in light_views(around)] == [0, 1, 2]
    # inside the ball a lamp has six views, and a spot one, or six if its cone is wide
    place = (0.1, 0.2, 0.3)
    for light, count in (
        (point(place), 6),
        (spot(place, angle=60.0), 1),
        (spot(place, angle=150.0), 6),
    ):
        assert len(light_views(replace(around, lights=(light,)))) == count


def test_each_kind_of_light_has_its_own_parameters() -> None:
    found = {
        name: {kind for kind in LIGHTS if name in light_parameters(kind)}
        for name in ("position", "azimuth", "target", "angle", "falloff")
    }
    assert found == {
        "position": {"point", "spot"},
        "azimuth": {"directional"},
        "target": {"spot"},
        "angle": {"spot"},
        "falloff": {"point", "spot"},
    }
    assert light_parameters(spot((1.0, 2.0, 3.0))) == light_parameters("spot")


def test_menus_are_the_fields_of_literal_type() -> None:
    for owner, wanted in ((Object, OF_OBJECT), (Scene, OF_SCENE)):
        expected = {name: get_args(kind) for name, kind in wanted.items()}
        declared = settings_of(owner)
        assert {name: s.choices for name, s in declared.items() if s.choices} == expected
    assert set(MENUS) == set(OPTIONS) - {"casts", "shadows_on", "filter"}
    assert kinds.either(["a", "b", "c"]) == "a, b or c"


@pytest.mark.parametrize(
    ("name", "value", "meant"),
    [
        ("shape", "cube", "box"), ("shape", "Sphere", "sphere"), ("edge", "repeat", "wrap"),
        ("fog_mode", "exp2", "exponential_squared"), ("alpha", "cut-out", "mask"),
        ("shading_model", "Blinn-Phong", "phong"), ("projection", "offset limiting", "limited"),
        ("mapping", "tri-planar", "triplanar"), ("heights", "mipmaps", "mip"),
    ],
)  # fmt: skip
def test_a_value_is_suggested_by_its_meaning(name: str, value: str, meant: str) -> None:
    line = refusal(lambda: scene(**{name: value}))
    assert line == f"{expected_refusal(name, value)}; did you mean {meant}?"


def test_synonyms_mean_values_that_exist() -> None:
    values = {value for kind in OPTIONS.values() for value in get_args(kind)}
    values |= {value for s in settings_of(ReadOptions).values() for value in s.choices}
    assert set(kinds.SYNONYMS.values()) <= values
    assert not values & {*kinds.SYNONYMS}


# --- unknown values -------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "value"), [*itertools.product(OPTIONS, UNKNOWN)])
def test_python_refuses_an_unknown_value(name: str, value: str) -> None:
    assert refusal(lambda: scene(**{name: value})) == expected_refusal(name, value)
    # also when an existing object or scene is changed
    made = scene()
    changed = made.objects[0] if name in OF_OBJECT else made
    assert refusal(lambda: replace(changed, **{name: value})) == expected_refusal(name, value)


@pytest.mark.parametrize("name", OPTIONS)
def test_a_preset_refuses_an_unknown_value(name: str, tmp_path: Path) -> None:
    table = "object" if name in OF_OBJECT else "scene"
    assert refusal(lambda: Preset("mine", values={table: {name: "torus"}})) == expected_refusal(
        name, "torus"
    )
    file = tmp_path / "mine.toml"
    file.write_text(f"[{table}]\n{name} = 'torus'\n")
    assert refusal(lambda: preset(file)) == f"{file}: {expected_refusal(name, 'torus')}"


@pytest.mark.parametrize("name", OPTIONS)
def test_the_command_line_refuses_an_unknown_value(name: str, tmp_path: Path) -> None:
    folder = write_heights(tmp_path / "bumps")
    target = tmp_path / "out.png"
    flag = f"--{name.replace('_', '-')}"
    line = command_refused("render", folder, "--device", "cpu", "-o", target, flag, "torus")
    assert line == expected_refusal(name, "torus")
    assert not target.exists()


@pytest.mark.parametrize("number", [-1, 3, 7])
def test_a_light_of_an_unknown_kind_is_refused(number: int) -> None:
    lamp = replace(point((1.0, 2.0, 3.0)), kind=number)
    line = f"the kind of a light is one of 0 (directional), 1 (point), 2 (spot), not {number}"
    assert refusal(lambda: light_kind(lamp)) == line
    assert refusal(lambda: Scene((Object(BRICKS),), lights=(directional(), lamp))) == line
    assert refusal(lambda: replace(scene(), lights=(lamp,))) == line
    turning = motion.Lighting()
    made = scene()
    object.__setattr__(made, "lights", (lamp,))
    now = motion.Moment(0.25, 1.0, (8, 8))
    assert refusal(lambda: turning(made, now)) == line


def test_a_value_that_is_not_a_light_is_refused() -> None:
    line = refusal(lambda: Scene((Object(BRICKS),), lights=("directional",)))
    assert line.startswith("a light is 'directional'")
    assert "directional, point or spot" in line
    line = refusal(lambda: Scene((Object(BRICKS),), lights=directional()))
    assert line == "lights are a tuple, as (directional(),)"


def test_objects_and_lights_may_be_generators() -> None:
    made = Scene((Object(BRICKS) for _ in range(2)), lights=(directional() for _ in range(3)))  # type: ignore[arg-type]
    assert (len(made.objects), len(made.lights)) == (2, 3)


@pytest.mark.parametrize(
    "light",
    [
        directional(20.0, -35.0, (1.0, 0.5, 0.25), 3.0),
        point((1.0, 2.0, 3.0), (0.5, 1.0, 0.25), 2.0, falloff=1.0),
        spot((1.0, 2.0, 3.0), (0.5, 0.0, -1.0), (1.0, 0.5, 0.25), 2.0, 1.5, 50.0, 0.5),
        spot((0.0, 1.0, 0.0), angle=100.0, softness=0.0),
    ],
)
def test_a_light_survives_the_round_trip_through_a_page(light: Light) -> None:
    plain = light_numbers(light)
    back = light_of(plain)
    was, now = (list(map(float, leaf_values(each, Light))) for each in (light, back))
    np.testing.assert_allclose(now, was, atol=2e-6)
    # parameters of other kinds of light are ignored
    unused = set(plain) - {*light_parameters(light), "kind", "azimuth", "elevation"}
    assert light_of({**plain, **dict.fromkeys(unused)}) == back


def test_a_page_takes_lights_of_all_kinds_and_no_others() -> None:
    for kind in LIGHTS:
        assert light_kind(light_of(as_light_dict({"kind": kind}))) == kind
    options = {**light_numbers(point((1.0, 2.0, 3.0))), "kind": "lamp"}
    line = "the kind of a light is one of directional, point, spot, not 'lamp'"
    assert refusal(lambda: light_of(options)) == line


# --- edges of maps, and other kinds ---------------------------------------------------------------


@pytest.mark.parametrize("edge", ["clip", "mirror", ""])
def test_maps_refuse_an_unknown_edge(edge: Any) -> None:
    """`clip` is for objects; maps have `wrap` or `clamp`."""
    heights = np.zeros((2, 3), np.float32)
    for make in (
        lambda: HeightField([heights], edge),
        lambda: Texture([np.zeros((2, 3, 4), np.uint16)], edge),
        lambda: intersect_height_field(heights, [[0.5, 0.5]], [[0.1, 0.0]], edge),
        lambda: intersect_columns(heights, [[0.5, 0.5]], [[0.1, 0.0]], edge),
    ):
        with pytest.raises(ValueError, match=f"edge is '{edge}': use wrap or clamp"):
            make()


@pytest.mark.parametrize("name", ["bounds", "cone_map", "relaxed_cone_map", "normal_map",
                                  "horizon_map", "ambient_occlusion", "height_map"])  # fmt: skip
def test_bakes_refuse_an_unknown_edge(name: str) -> None:
    scaled = ("normal_map", "horizon_map", "ambient_occlusion")
    array = np.full((2, 3, 3), 0.5) if name == "height_map" else np.zeros((2, 3), np.float32)
    more = {"scale": 0.1} if name in scaled else {}
    line = refusal(lambda: getattr(baking, name)(array, "clip", **more))
    assert "edge" in line
    assert "wrap or clamp, not clip" in line


def test_an_unknown_channel_is_refused() -> None:
    picture = Picture(np.zeros((2, 3, 3), np.uint8), ("R", "G", "B"), Path("a.png"))
    line = refusal(lambda: channels.extract_channel(picture, "x"))
    assert line == f"channel is one of {', '.join(get_args(channels.Channel))}, not 'x'"


def test_an_unknown_debug_picture_is_refused() -> None:
    empty = np.zeros((1, 1))
    frame = Frame(np.zeros((1, 1, 4)), empty, np.zeros((1, 1, 2)), empty > 0, empty, "cpu")  # type: ignore[arg-type]
    line = refusal(lambda: debug_picture("height", frame))
    assert line.startswith("there is no debug picture 'height'")
    assert f"color, {', '.join(SHOWN)}" in line
