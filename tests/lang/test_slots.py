"""Slots: which shaders can be bound, and which parameters they may omit."""

from __future__ import annotations

import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import IVec2, ShaderError, TypeSlot, Vec2, bound, shader, slot, struct, watched
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl


class Numbers(TypeSlot):
    """The record of the bound shader."""


@struct
class Gain:
    gain: float


@struct
class Out:
    value: float


@slot
def weighted_sum(count: int, place: Vec2, numbers: Numbers) -> float:
    """A number from three parameters."""


@shader
def with_all(count: int, place: Vec2, numbers: Gain) -> float:
    return float(count) + place.x * numbers.gain - place.y


@shader
def without_count(where: Vec2, set: Gain) -> float:
    return where.x * set.gain - where.y


@shader
def without_place(number: int, set: Gain) -> float:
    return float(number) * set.gain


@shader
def without_numbers(count: int, place: Vec2) -> float:
    return float(count) + place.x


@shader
def out_of_order(place: Vec2, count: int, numbers: Gain) -> float:
    return float(count) + place.x * numbers.gain


@shader
def entry(at: IVec2, numbers: Numbers) -> Out:
    return Out(weighted_sum(at.x + 3, Vec2(float(at.y), 0.5), numbers))


@pytest.mark.parametrize(
    ("bound_shader", "expected"),
    [
        (with_all, lambda x, y: x + 3 + y * 2.5 - 0.5),
        (without_count, lambda x, y: y * 2.5 - 0.5),
        (without_place, lambda x, y: (x + 3) * 2.5),
    ],
)
def test_a_bound_shader_takes_the_parameters_that_it_declares(bound_shader, expected) -> None:
    program = Program(entry, {weighted_sum: bound_shader})
    planes = CpuEngine().run(program, {"numbers": Gain(2.5)}, (5, 4))
    for x, y in [(0, 0), (4, 3), (2, 1)]:
        with bound(program.bindings):
            plain = entry(IVec2(x, y), Gain(2.5))
        assert float(plain.value) == float(planes["value"][y, x]) == expected(x, y)
    assert "fn entry(" in print_wgsl(program.module, "wrap")


@pytest.mark.parametrize("bound_shader", [without_numbers, out_of_order])
def test_a_shader_that_does_not_fit_is_refused(bound_shader) -> None:
    """A type slot cannot be omitted, and the order is that of the slot."""
    with pytest.raises(
        ShaderError, match=f"{bound_shader.name}.* does not fit the slot weighted_sum"
    ):
        _ = Program(entry, {weighted_sum: bound_shader}).module


def test_arguments_by_name() -> None:
    with bound({weighted_sum: without_count}):
        by_name = weighted_sum(count=1, numbers=Gain(2.0), place=Vec2(3.0, 4.0))
    assert float(by_name) == 2.0


def test_a_watch_wraps_every_call() -> None:
    """It sees slots and bound shaders, with arguments by name, and returns the result."""
    seen: list[tuple[str, dict]] = []

    def watch(called, arguments, run):
        seen.append((called.name, dict(arguments)))
        result = run()
        return -result if called is watched_slot else result

    with bound({watched_slot: watched_double}), watched(watch):
        assert watched_entry(3.0) == -6.0 + 1.0
    assert [name for name, _ in seen] == ["watched_entry", "watched_slot", "watched_double"]
    assert [arguments for _, arguments in seen] == [{"x": 3.0}] * 3
    with bound({watched_slot: watched_double}):
        assert watched_entry(3.0) == 7.0
    assert len(seen) == 3


@slot
def watched_slot(x: float) -> float:
    """A slot."""


@shader
def watched_double(x: float) -> float:
    return x * 2.0


@shader
def watched_entry(x: float) -> float:
    return watched_slot(x) + 1.0
