"""Shaders printed apart: put together they are the programs that are printed whole."""

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
from basrelief.lang.library import EDGE, library_of, linked
from basrelief.lang.values import IVec2
from basrelief.rendering.programs import choices_of, program_of, values_of
from basrelief.scene.objects import technique_named
from basrelief.shading.choices import RULES, Choices
from basrelief.shading.shadow_map import CastView
from basrelief.techniques import TECHNIQUES
from basrelief.viewer.printed import Ask, answers, printed, tree_of
from helpers.variants import random_choices


@struct
class Length:
    """A length."""

    value: float


@slot
def measure(place: Vec2, scale: float) -> float:
    """How far a place is."""


@shader
def straight(place: Vec2, scale: float) -> float:
    """As the crow flies."""
    return scale * (place.x * place.x + place.y * place.y)


@shader
def along_u(place: Vec2) -> float:
    """Sideways alone; of no scale."""
    return abs(place.x)


@shader
def measured(at: IVec2, scale: Length) -> Length:
    """The entry."""
    return Length(measure(Vec2(float(at.x), float(at.y)), scale.value))


OPTIONS = {measure: [straight, along_u]}


def test_a_slot_hands_on_what_its_shader_takes() -> None:
    made = library_of([measured], OPTIONS)
    assert set(made.slots["measure"]) == {"straight", "along_u"}
    for name, call in (("straight", "straight(place_, scale)"), ("along_u", "along_u(place_)")):
        text = linked(made, "measured", {"measure": name, EDGE: "wrap"})
        assert f"  return {call};" in text
        assert text.count("fn measure(place_: vec2f, scale: f32) -> f32 {") == 1
        assert ("fn along_u(" in text) == (name == "along_u")
        assert "fn main(" in text


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ShaderError, match="does not fit the slot"):
        library_of([measured], {measure: [measured]})


class Numbers(TypeSlot):
    """Whatever numbers there are."""


@slot
def chosen(numbers: Numbers, length: Length) -> Length:
    """A length by numbers."""


@struct
class Switch:
    """What no GPU can be given."""

    on: bool


@shader
def switched(numbers: Switch, length: Length) -> Length:
    """As it is, or nothing."""
    return length if numbers.on else Length(0.0)


@shader
def choosing(at: IVec2, numbers: Numbers, length: Length) -> Length:
    """The entry."""
    return chosen(numbers, length)


def test_a_record_that_no_gpu_can_be_given_is_refused() -> None:
    with pytest.raises(ShaderError, match="a record that a GPU reads holds no bool"):
        library_of([choosing], {chosen: [switched]})


# --- the library's own programs ------------------------------------------------------------------


@functools.cache
def _gpu() -> Any:
    return GpuEngine().gpu


def _some_choices(count: int, seed: int) -> list[Choices]:
    return [choices for _, choices in random_choices(count, seed)]


def test_a_tree_says_what_its_rule_says() -> None:
    every = answers(TECHNIQUES)
    trees = {slot: tree_of(rule, every) for slot, rule in RULES.items()}
    asked = 0
    for choices in _some_choices(300, 1):
        for slot_, rule in RULES.items():
            tree: Any = trees[slot_]
            while isinstance(tree, Ask):
                value = getattr(choices, tree.name)
                text = next(t for t, v in every[tree.name].items() if v is value or v == value)
                tree = tree.then[text]
                asked += 1
            assert tree is rule(choices)
    assert asked > 300


def test_a_tree_asks_nothing_in_vain() -> None:
    def check(tree: Any) -> int:
        if not isinstance(tree, Ask):
            return 0
        first, *others = tree.then.values()
        assert any(each != first for each in others)
        return 1 + sum(check(each) for each in tree.then.values())

    assert sum(check(tree_of(rule, answers(TECHNIQUES))) for rule in RULES.values()) > 30
    # what does not matter is not asked
    assert tree_of(lambda c: c.fades and False, {"fades": {"true": True, "false": False}}) is False


@pytest.mark.gpu
def test_every_option_of_every_slot_compiles() -> None:
    made = printed()
    gpu = _gpu()
    left = {(name, each) for name, options in made.library.slots.items() for each in options} - {
        ("is_asked", "in_sector"),
        ("is_asked", "everywhere"),
    }  # of a bake's step
    for choices in _some_choices(400, 2):
        bound = made.bound(choices)
        new = left & set(bound.items())
        for entry in ("pixel", "missed_hit") if new else ():
            text = linked(made.library, entry, bound, choices)
            gpu.create_shader_module(code=text)
            left -= {(name, each) for name, each in new if f" {name}" in text}
    # programs of boxes never ask for the surface between texels
    assert left == {("surface_height", "top_at")}


OWN = """
from basrelief.lang import HeightField, setting, shader, struct
from basrelief.techniques import Hit, Ray, at, technique

@struct
class Settings:
    share: float = setting(default=0.5, doc="a share", low=0.0, high=1.0)

@shader
def {helper}(x: float) -> float:
    return x * 0.5

@technique()
def {name}(field: HeightField, ray: Ray, settings: Settings) -> Hit:
    return Hit(at(ray, {helper}(settings.share)), 0.5, True, 1)
"""


@pytest.mark.gpu
@pytest.mark.parametrize("name", ["field", "ray", "settings", "baked", "displace", "pixel", "main"])
@pytest.mark.parametrize("helper", ["edge", "constructor", "edge_of_map", "corners", "fn"])
def test_a_technique_may_have_any_name(tmp_path: Path, name: str, helper: str) -> None:
    (tmp_path / "own.py").write_text(OWN.replace("{name}", name).replace("{helper}", helper))
    own = technique_named(f"{tmp_path / 'own.py'}:{name}")
    made = printed({"own": own})
    (choices,) = _some_choices(1, 4)
    text = linked(made.library, "pixel", made.bound(replace(choices, technique=own)), choices)
    _gpu().create_shader_module(code=text)


def test_a_slot_without_options_is_refused() -> None:
    with pytest.raises(ShaderError, match="nothing can be bound to the slot measure"):
        library_of([measured], {})


@pytest.mark.gpu
@pytest.mark.parametrize("way", ["exact", "texel", "landscape", "smooth"])
def test_a_linked_program_computes_what_the_whole_one_does(way: str) -> None:
    material = basrelief.sample("bricks", 64)
    options: dict[str, Any] = {
        "exact": {"technique": "exact", "shape": "sphere"},
        "texel": {"technique": "texel", "edge": "clamp"},
        "landscape": {"surface": "landscape", "scale": 0.2},
        "smooth": {"heights": "smooth", "tiling": (6.0, 6.0), "fade": (1.0, 3.0)},
    }[way]
    thing = basrelief.Object(material, **options)
    scene = basrelief.Scene((thing,), basrelief.Orbit(24.0, 32.0), shadows="soft", fog="linear")
    engine, size = GpuEngine(), (64, 48)
    program, values = program_of(thing, scene), values_of(thing, scene, size, engine)
    made = printed()
    choices = choices_of(thing, scene)
    text = linked(made.library, "pixel", made.bound(choices), choices)
    types = program.parameters
    needed = [replace(b, type=types.get(b.name)) for b in made.library.bindings["pixel"]]
    texel = np.zeros((1, 1, 4), np.uint16)
    nothing = {b.name: Texture([texel], program.edge) for b in needed if b.type is Texture}
    far = HeightField([np.ones((1, 1), np.float32)], program.edge)
    nothing |= {"distances": far, "views": Buffer((), CastView)}
    with (
        engine.prepare(program, values, size) as whole,
        engine.prepare_text(text, program, {**nothing, **values}, size, needed) as apart,
    ):
        for job in (whole, apart):
            job.dispatch(0, size[1])
        drawn = whole.read(size[1])
        assert (drawn[7] != 0).mean() > 0.1
        assert np.array_equal(drawn, apart.read(size[1]))
