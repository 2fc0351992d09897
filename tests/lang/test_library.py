"""Shaders printed apart: put together they are the programs that are printed whole."""

from __future__ import annotations

import random
from typing import Any

import pytest

from basrelief.choices import RULES, Choices, bindings_of
from basrelief.engine.gpu import GpuEngine
from basrelief.lang import ShaderError, TypeSlot, Vec2, shader, slot, struct
from basrelief.lang.library import Library, library_of, linked
from basrelief.lang.program import Program
from basrelief.lang.values import IVec2
from basrelief.lang.wgsl import print_wgsl
from basrelief.scene import SURFACES
from basrelief.shaders import pixel
from basrelief.shaders.surfaces.surface import SurfaceSettings
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.shaders.techniques.technique import Settings
from basrelief.viewer.printed import Ask, answers, printed, tree_of


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
    for name, call in (("straight", "straight(place, scale)"), ("along_u", "along_u(place)")):
        text = linked(made, "measured", {"measure": name, "edge": "wrap"})
        assert f"  return {call};" in text
        assert text.count("fn measure(place: vec2f, scale: f32) -> f32 {") == 1
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


def _some_choices(count: int, seed: int) -> list[Choices]:
    every = answers(TECHNIQUES)
    rng = random.Random(seed)
    return [
        Choices(**{name: rng.choice([*each.values()]) for name, each in every.items()})
        for _ in range(count)
    ]


def _bound(library: Library, choices: Choices) -> dict[str, str]:
    names = library.names
    bound = {names[slot]: names[made] for slot, made in bindings_of(choices).items()}
    return {
        **bound,
        "edge": choices.edge,
        names[Settings]: names[choices.technique.settings],
        names[SurfaceSettings]: names[SURFACES[choices.surface]],
    }


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
    def check(tree: Any) -> None:
        if isinstance(tree, Ask):
            assert len({id(each) for each in tree.then.values()}) > 1
            for each in tree.then.values():
                check(each)

    for rule in RULES.values():
        check(tree_of(rule, answers(TECHNIQUES)))


@pytest.mark.gpu
def test_linked_programs_compile() -> None:
    made = printed().library
    engine = GpuEngine()
    seen = set()
    for choices in _some_choices(24, 2):
        text = linked(made, "pixel", _bound(made, choices))
        assert text.count("fn main(") == 1
        engine.gpu.create_shader_module(code=text)
        seen.add(text)
    assert len(seen) == 24


def test_a_linked_program_has_the_functions_of_the_whole_one() -> None:
    made = printed().library
    for choices in _some_choices(12, 3):
        bound = _bound(made, choices)
        whole = print_wgsl(
            Program(pixel.pixel, bindings_of(choices), choices.edge).module, choices.edge
        )
        apart = linked(made, "pixel", bound)
        # a constant that a shader returns, or a march's loop, stands in both
        for line in ("fn main(", "@compute @workgroup_size(8, 8)"):
            assert line in whole
            assert line in apart
        loops = [line.strip() for line in whole.splitlines() if line.strip().startswith("for (")]
        assert loops
        for line in loops:
            assert line in apart
