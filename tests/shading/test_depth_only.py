"""Depth maps: the pixel's program without lighting, with the same depth as the picture."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from basrelief.engine import Planes, choose_device
from basrelief.lang import Vec2
from basrelief.lang.llvm import print_llvm
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import sample
from basrelief.rendering.programs import depth_program_of, object_values, program_of
from basrelief.scene import LYING, Object, Orbit, Scene, placed, rotated
from basrelief.shading.intersection import CameraSample
from helpers.synthetic import drawn, map_of, noise

SIZE = (64, 48)
CAMERA = Orbit(25.0, 35.0, 2.4)
FULL = {"shadows": "hard", "fog_mode": "exponential", "occlusion_kind": "directional"}
"""A scene in which every part of the light has code."""
LIT = {
    "lights", "shading", "fog", "views", "distances", "incident_light", "reflectance", "ggx",
    "ambient_light", "shading_point", "self_shadow_visibility", "shadow_map_visibility",
    "projected", "shadow_receiver", "directional_visibility", "apply_fog", "exponential_fog",
}  # fmt: skip
"""Names in a program with light: its resources, its records and the functions of the pixel."""
OBJECTS: dict[str, dict[str, Any]] = {
    "a plane": {"reference_height": 0.6, "transform": LYING},
    "a clipped plane": {"edge": "clip", "technique": "relief"},
    "a raised box": {"shape": "box", "reference_height": 0.3, "transform": rotated("y", 20.0)},
    "a sphere": {"shape": "sphere", "technique": "exact", "tiling": (4.0, -2.0)},
    "a cylinder": {"shape": "cylinder", "technique": "cone", "reference_height": 0.5},
    "columns": {"technique": "texel", "shape": "box", "scale": 0.2},
    "nothing displaced": {"technique": "flat", "shape": "cylinder"},
    "a mask": {"alpha": "mask", "transform": placed(scale=(1.2, 0.8, 1.0)) @ LYING},
    "half transparent": {"alpha": "blend", "shape": "sphere"},
}


def obj(name: str = "a plane", **options: Any) -> Object:
    hole = map_of(noise(11, (32, 32), 1, 0.0, 1.0))
    material = replace(sample("bricks", 32), opacity=hole)
    return Object(material, **{"alpha": "opaque", "scale": 0.12, **OBJECTS[name], **options})


def depth_map(made: Object) -> Planes:
    """The planes of an object's part of a depth map, seen by a camera instead of a light."""
    engine = choose_device("cpu")
    view = CameraSample(Scene((made,), CAMERA).shader_camera(SIZE), Vec2(0.5, 0.5))
    return engine.run(
        depth_program_of(made.resolved),
        {**object_values(made.resolved, engine), "sample": view},
        SIZE,
    )


def words(program: Program) -> set[str]:
    """All words of the WGSL and LLVM texts of a program, without comments."""
    wgsl = re.sub(r"//.*", "", print_wgsl(program.module, program.edge))
    llvm = re.sub(r";.*", "", print_llvm(program.module, 8))
    return set(re.findall(r"[A-Za-z_]\w*", wgsl + llvm))


@pytest.mark.parametrize("name", OBJECTS)
def test_a_depth_map_has_no_code_of_light_fog_or_shadow(name: str) -> None:
    """A program that draws a picture has all of it, so the names in LIT exist."""
    made, other = obj(name), Object(sample("tiles", 16), "sphere")
    lit = words(program_of(made.resolved, Scene((made, other), **FULL)))
    assert lit >= LIT - ({"self_shadow_visibility"} if name == "nothing displaced" else set())
    of_shadow = {"shadowing", "Shadowing", "shadow", "max_shadow_steps"}
    assert words(depth_program_of(made.resolved)) & (LIT | of_shadow) == set()


@pytest.mark.parametrize("name", OBJECTS)
def test_a_depth_only_variant_has_no_code_of_light(name: str) -> None:
    """With any other field of the variant."""
    made, other = obj(name), Object(sample("tiles", 16), "sphere")
    program = program_of(made.resolved, Scene((made, other), **FULL))
    depth_only = replace(program, variant=replace(program.variant, depth_only=True))
    assert words(depth_only) & LIT == set()


@pytest.mark.parametrize("name", OBJECTS)
@pytest.mark.parametrize("scene", [{}, FULL], ids=["plain", "full"])
def test_a_depth_map_has_the_depth_of_the_picture(name: str, scene: dict[str, Any]) -> None:
    """Where the object is solid; no hit elsewhere."""
    made = obj(name)
    planes, frame = depth_map(made), drawn(made, camera=CAMERA, size=SIZE, **scene)
    hit = planes["hit"] != 0
    assert 0.05 < hit.mean() < 0.95
    np.testing.assert_array_equal(hit, frame.hit)
    np.testing.assert_array_equal(planes["distance"][hit], frame.distance[hit])
    np.testing.assert_array_equal(planes["uv.x"][hit], frame.uv[hit][:, 0])
    np.testing.assert_array_equal(planes["uv.y"][hit], frame.uv[hit][:, 1])


def test_an_opaque_caster_has_no_holes_in_the_depth_map() -> None:
    whole, holed = (depth_map(obj("a mask", casts=casts)) for casts in ("opaque", "shape"))
    solid = drawn(obj("a mask", alpha="opaque"), camera=CAMERA, size=SIZE)
    np.testing.assert_array_equal(whole["hit"] != 0, solid.hit)
    np.testing.assert_array_equal(whole["distance"][solid.hit], solid.distance[solid.hit])
    assert (holed["hit"] != 0).sum() < 0.8 * solid.hit.sum()


def test_a_relief_that_fades_for_the_camera_is_whole_for_a_light() -> None:
    fading, whole = depth_map(obj(fade=(0.2, 0.4))), depth_map(obj())
    np.testing.assert_array_equal(fading["distance"], whole["distance"])
    gone = drawn(obj(fade=(0.2, 0.4)), camera=CAMERA, size=SIZE)
    assert np.abs(gone.distance - whole["distance"])[gone.hit & (whole["hit"] != 0)].max() > 0.01
