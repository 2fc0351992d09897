"""Libraries of shaders: linked programs equal those that are printed whole."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from basrelief.engine.gpu import GpuEngine
from basrelief.lang import (
    Buffer,
    HeightField,
    ShaderError,
    Texture,
    TypeSlot,
    Vec2,
    shader,
    slot,
    struct,
)
from basrelief.lang.library import library_of
from basrelief.lang.program import Program
from basrelief.lang.tree import holds
from basrelief.lang.values import IVec2
from basrelief.rendering.programs import program_of, values_of
from basrelief.scene import technique_named
from basrelief.shading.geometry import Vertex
from basrelief.shading.shadow_map import ShadowMapView
from basrelief.techniques import displace
from basrelief.viewer.printed import program_library
from helpers.linking import linked
from helpers.variants import random_programs


@struct
class Length:
    """A length."""

    value: float


@slot
def measure(place: Vec2, scale: float) -> float:
    """Distance of a place."""


@shader
def straight(place: Vec2, scale: float) -> float:
    """Squared Euclidean distance."""
    return scale * (place.x * place.x + place.y * place.y)


@shader
def along_u(place: Vec2) -> float:
    """Distance along u, without the scale."""
    return abs(place.x)


@shader
def measured(at: IVec2, scale: Length) -> Length:
    """The entry."""
    return Length(measure(Vec2(float(at.x), float(at.y)), scale.value))


OPTIONS = {measure: [straight, along_u]}


def test_a_slot_passes_the_arguments_that_its_shader_takes() -> None:
    made = library_of([measured], OPTIONS)
    assert set(made.slots["measure"]) == {"straight", "along_u"}
    for shader_, call in ((straight, "straight(place_, scale)"), (along_u, "along_u(place_)")):
        text = linked(made, Program(measured, {measure: shader_}))
        assert f"  return {call};" in text
        assert text.count("fn measure(place_: vec2f, scale: f32) -> f32 {") == 1
        assert ("fn along_u(" in text) == (shader_ is along_u)
        assert "fn main(" in text


def test_a_shader_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ShaderError, match="does not fit the slot"):
        library_of([measured], {measure: [measured]})


class Numbers(TypeSlot):
    """The numbers of the bound shader."""


@slot
def chosen(numbers: Numbers, length: Length) -> Length:
    """A length, changed by numbers."""


@struct
class Switch:
    """A record that no GPU can read."""

    on: bool


@shader
def switched(numbers: Switch, length: Length) -> Length:
    """The length, or 0."""
    return length if numbers.on else Length(0.0)


@shader
def choosing(at: IVec2, numbers: Numbers, length: Length) -> Length:
    """The entry."""
    return chosen(numbers, length)


def test_a_record_that_no_gpu_can_read_is_refused() -> None:
    with pytest.raises(ShaderError, match="a record that a GPU reads cannot contain a bool"):
        library_of([choosing], {chosen: [switched]})


# --- the library's own programs ------------------------------------------------------------------


@functools.cache
def _gpu() -> Any:
    return GpuEngine().gpu


@pytest.mark.gpu
def test_every_option_and_condition_compiles() -> None:
    made = program_library().library
    gpu = _gpu()
    remaining: set[Any] = {
        (slot_, each) for slot_, options in made.slots.items() for each in options
    }
    # the condition of a pass of a bake is in no pixel program
    conditions = [each for each in made.conditions if each != ("by_sector", (True,))]
    remaining |= {(each, truth) for each in conditions for truth in (False, True)}
    for _, program in random_programs(400, 2):
        bound = made.bound_names(program.bindings)
        decided = {(each, holds(each, program.static_value)) for each in conditions}
        if new := remaining & {*bound.items(), *decided}:
            gpu.create_shader_module(code=linked(made, program))
            remaining -= new
    assert not remaining


OWN = """
from basrelief.lang import HeightField, setting, shader, struct
from basrelief.techniques import Hit, Ray, hit_at, technique

@struct
class Settings:
    share: float = setting(default=0.5, doc="a share", low=0.0, high=1.0)

@shader
def {helper}(x: float) -> float:
    return x * 0.5

@technique()
def {name}(field: HeightField, ray: Ray, settings: Settings) -> Hit:
    return hit_at(ray, {helper}(settings.share), True, 1)
"""


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["field", "ray", "settings", "baked", "displace", "pixel", "main"])
@pytest.mark.parametrize("helper", ["edge", "constructor", "at_edge", "corners", "fn"])
def test_a_technique_may_have_any_name(tmp_path: Path, name: str, helper: str) -> None:
    (tmp_path / "own.py").write_text(OWN.replace("{name}", name).replace("{helper}", helper))
    own = technique_named(f"{tmp_path / 'own.py'}:{name}")
    made = program_library({"own": own})
    ((_, program),) = random_programs(1, 4)
    bindings = {**program.bindings, displace: own}
    text = linked(made.library, replace(program, bindings=bindings))
    _gpu().create_shader_module(code=text)


def test_a_slot_without_options_is_refused() -> None:
    with pytest.raises(ShaderError, match="the slot measure has no options"):
        library_of([measured], {})


@pytest.mark.gpu
@pytest.mark.parametrize("case", ["exact", "texel", "landscape", "smooth"])
def test_a_linked_program_computes_the_same_as_a_whole_one(case: str) -> None:
    material = basrelief.sample("bricks", 64)
    options: dict[str, Any] = {
        "exact": {"technique": "exact", "shape": "sphere"},
        "texel": {"technique": "texel", "edge": "clamp"},
        "landscape": {"surface": "landscape", "scale": 0.2},
        "smooth": {"heights": "smooth", "tiling": (6.0, 6.0), "fade": (1.0, 3.0)},
    }[case]
    obj = basrelief.Object(material, **options)
    scene = basrelief.Scene((obj,), basrelief.Orbit(24.0, 32.0), shadows="soft", fog_mode="linear")
    engine, size = GpuEngine(), (64, 48)
    program, values = program_of(obj.resolved, scene), values_of(obj.resolved, scene, size, engine)
    made = program_library()
    text = linked(made.library, program)
    types = program.parameters
    needed = [replace(b, type=types.get(b.name)) for b in made.library.bindings["pixel"]]
    texel = np.zeros((1, 1, 4), np.uint16)
    dummies = {b.name: Texture([texel], program.edge) for b in needed if b.type is Texture}
    far = HeightField([np.ones((1, 1), np.float32)], program.edge)
    dummies |= {"distances": far, "views": Buffer((), ShadowMapView)}
    dummies |= {"geometry_vertices": Buffer((), Vertex)}
    with (
        engine.prepare(program, values, size) as whole,
        engine.prepare_text(text, program, {**dummies, **values}, size, needed) as other,
    ):
        for job in (whole, other):
            job.dispatch(0, size[1])
        drawn = whole.read(size[1])
        assert (drawn[7] != 0).mean() > 0.1
        assert np.array_equal(drawn, other.read(size[1]))
