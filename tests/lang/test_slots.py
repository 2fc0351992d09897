"""Slots: what may be bound to one, and what a bound shader may leave out."""

from __future__ import annotations

import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import IVec2, ShaderError, TypeSlot, Vec2, bound, shader, slot, struct, watched
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl


class Knobs(TypeSlot):
    """The record of whichever shader is bound."""


@struct
class Gain:
    gain: float


@struct
class Out:
    value: float


@slot
def weighed(count: int, place: Vec2, knobs: Knobs) -> float:
    """A number from three."""


@shader
def with_all(count: int, place: Vec2, knobs: Gain) -> float:
    return float(count) + place.x * knobs.gain - place.y


@shader
def without_count(where: Vec2, set: Gain) -> float:
    return where.x * set.gain - where.y


@shader
def without_place(number: int, set: Gain) -> float:
    return float(number) * set.gain


@shader
def without_knobs(count: int, place: Vec2) -> float:
    return float(count) + place.x


@shader
def out_of_order(place: Vec2, count: int, knobs: Gain) -> float:
    return float(count) + place.x * knobs.gain


@shader
def entry(at: IVec2, knobs: Knobs) -> Out:
    return Out(weighed(at.x + 3, Vec2(float(at.y), 0.5), knobs))


@pytest.mark.parametrize(
    ("made", "wanted"),
    [
        (with_all, lambda x, y: x + 3 + y * 2.5 - 0.5),
        (without_count, lambda x, y: y * 2.5 - 0.5),
        (without_place, lambda x, y: (x + 3) * 2.5),
    ],
)
def test_what_is_bound_takes_the_parameters_that_it_names(made, wanted) -> None:
    program = Program(entry, {weighed: made})
    planes = CpuEngine().run(program, {"knobs": Gain(2.5)}, (5, 4))
    for x, y in [(0, 0), (4, 3), (2, 1)]:
        with bound(program.bindings):
            plain = entry(IVec2(x, y), Gain(2.5))
        assert float(plain.value) == float(planes["value"][y, x]) == wanted(x, y)
    assert "fn entry(" in print_wgsl(program.module, "wrap")


@pytest.mark.parametrize("made", [without_knobs, out_of_order])
def test_what_does_not_fit_is_refused(made) -> None:
    """A type slot cannot be left out, and the order is the slot's."""
    with pytest.raises(ShaderError, match=f"{made.name}.* does not fit the slot weighed"):
        _ = Program(entry, {weighed: made}).module


def test_by_name_as_by_position() -> None:
    with bound({weighed: without_count}):
        by_name = weighed(count=1, knobs=Gain(2.0), place=Vec2(3.0, 4.0))
    assert float(by_name) == 2.0


def test_a_watch_stands_around_every_call() -> None:
    """Slots, what is bound to them, and arguments by name; what it returns is the result."""
    seen: list[tuple[str, dict]] = []

    def watch(called, given, run):
        seen.append((called.name, dict(given)))
        result = run()
        return -result if called is watched_slot else result

    with bound({watched_slot: watched_double}), watched(watch):
        assert watched_entry(3.0) == -6.0 + 1.0
    assert [name for name, _ in seen] == ["watched_entry", "watched_slot", "watched_double"]
    assert [given for _, given in seen] == [{"x": 3.0}] * 3
    with bound({watched_slot: watched_double}):
        assert watched_entry(3.0) == 7.0
    assert len(seen) == 3


@slot
def watched_slot(x: float) -> float:
    """To be bound."""


@shader
def watched_double(x: float) -> float:
    return x * 2.0


@shader
def watched_entry(x: float) -> float:
    return watched_slot(x) + 1.0
