"""Vectors, matrices and records, and shaders that run as plain Python."""

from __future__ import annotations

import copy
import math
import pickle
import sys
import threading
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.lang import (
    IVec2,
    Mat3,
    ShaderError,
    Vec2,
    Vec3,
    Vec4,
    bound,
    floor,
    setting,
    shader,
    slot,
    sqrt,
    struct,
)
from basrelief.lang.types import fields_of, from_leaves, leaf_values, leaves
from helpers.comparing import write_module

FLOAT32 = st.floats(width=32, allow_nan=False)
SCALE = 3.0
COUNT = 2


@struct
class Inner:
    uv: Vec2
    count: int


@struct
class Outer:
    near: Inner
    weight: float = setting(default=0.5, doc="how much", low=0.0, high=1.0)
    on: bool = True


@shader
def scaled(x: float) -> float:
    """Constants, literals and built-ins of every kind."""
    y = x * SCALE + 0.1
    for k in range(COUNT):
        y = y + float(k) / 3.0
    return max(y, min(1.0, abs(x)))


@shader
def wrapping(n: int) -> int:
    return n * 65537 + 2147483647


@slot
def chosen(x: float) -> float:
    """A slot."""


@shader
def doubled(x: float) -> float:
    return x * 2.0


@shader
def halved(x: float) -> float:
    return x * 0.5


@shader
def through_the_slot(x: float) -> float:
    return chosen(x) + 1.0


# --- vectors ------------------------------------------------------------------------------------


@given(st.lists(FLOAT32, min_size=4, max_size=4))
def test_swizzles_name_components(c):
    v = Vec4(*c)
    for letters in ("xyzw", "rgba"):
        for index, letter in enumerate(letters):
            assert getattr(v, letter) == np.float32(c[index])
    assert v.wzyx == Vec4(*reversed(c))
    assert v.xxz == Vec3(c[0], c[0], c[2])
    assert v.ga == Vec2(c[1], c[3])
    assert Vec2(*c[:2]).yxyx == Vec4(c[1], c[0], c[1], c[0])


@pytest.mark.parametrize("name", ["z", "xz", "xg", "", "xxxxx", "q", "__deepcopy__", "_x"])
def test_invalid_swizzles(name):
    with pytest.raises(AttributeError):
        getattr(Vec2(1.0, 2.0), name)


def test_no_vector_has_three_ints():
    with pytest.raises(AttributeError, match="3 ints"):
        _ = IVec2(1, 2).xyx


@pytest.mark.parametrize("value", [Vec2(1, 2), Vec3(1), Vec4(0), IVec2(3, 4), Mat3(*[Vec3(1)] * 3)])
def test_values_are_immutable_hashable_and_copied(value):
    with pytest.raises(AttributeError, match="immutable"):
        value.x = 5.0
    with pytest.raises(AttributeError):
        value.another = 5.0
    for again in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        assert again == value
        assert hash(again) == hash(value)
    assert type(value).__name__ in repr(value)
    assert value != 1.0


def test_construction_from_parts():
    assert Vec3(1.0) == Vec3(1.0, 1.0, 1.0)
    assert Vec4(Vec2(1, 2), Vec2(3, 4)) == Vec4(1, 2, 3, 4) == Vec4(1, Vec3(2, 3, 4))
    assert list(Vec3(1, 2, 3)) == [1, 2, 3]
    assert len(Vec3(1, 2, 3)) == 3
    with pytest.raises(TypeError, match="Vec3 takes 3 components, not 2"):
        Vec3(1.0, 2.0)
    with pytest.raises(TypeError, match="Vec2 takes 2 components, not 3"):
        Vec2(Vec3(1, 2, 3))


def test_components_are_32_bits_wide():
    assert all(isinstance(c, np.float32) for c in Vec3(0.1, 1, np.float64(2)))
    assert all(isinstance(c, np.int32) for c in IVec2(1, np.int64(2)))
    assert Vec2(0.1).x == np.float32(0.1)


@given(FLOAT32, FLOAT32, FLOAT32)
def test_operators_work_by_component_and_stay_float32(a, b, s):
    with np.errstate(all="ignore"):
        u, v, k = Vec2(a, b), Vec2(b, s), np.float32(s)
        for result, x in (
            (u + v, np.float32(a) + np.float32(b)),
            (u - v, np.float32(a) - np.float32(b)),
            (u * k, np.float32(a) * k),
            (k * u, k * np.float32(a)),
            (u * s, np.float32(a) * k),
            (1.0 - u, np.float32(1) - np.float32(a)),
            (k + u, k + np.float32(a)),
            (k - u, k - np.float32(a)),
            (k / u, k / np.float32(a)),
            (u / v, np.float32(a) / np.float32(b)),
            (-u, -np.float32(a)),
        ):
            assert isinstance(result, Vec2)
            assert isinstance(result.x, np.float32)
            np.testing.assert_equal(result.x, x)


def test_vectors_of_different_kinds_do_not_mix():
    for wrong in (Vec3(1), IVec2(1, 2), (1.0, 2.0), None):
        with pytest.raises(TypeError):
            _ = Vec2(1, 2) + wrong


def test_a_matrix_maps_its_columns():
    m = Mat3(Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 10))
    assert m @ Vec3(1, 0, 0) == m.x == Vec3(1, 2, 3)
    assert m @ Vec3(1, 10, 100) == Vec3(741, 852, 1063)
    assert Mat3((1, 2, 3), (4, 5, 6), (7, 8, 10)) == m


# --- records ------------------------------------------------------------------------------------


def test_records_hold_32_bit_values():
    record = Outer(Inner((0.1, 2), 3.0), 0.1, 1)
    assert isinstance(record.near.uv, Vec2)
    assert type(record.near.count) is np.int32
    assert type(record.weight) is np.float32
    assert record.on is True
    assert Outer(Inner(Vec2(0), 0)).weight == np.float32(0.5)
    assert Outer(record.near, on=False) != Outer(record.near)


def test_records_are_frozen_and_checked():
    record = Inner(Vec2(1), 2)
    with pytest.raises(AttributeError):
        record.count = 3
    with pytest.raises(TypeError, match="expected Inner, not int"):
        Outer(5)
    with pytest.raises(TypeError):
        Inner(Vec2(1))


def test_leaves_of_a_record_in_order():
    record = Outer(Inner(Vec2(1.5, 2.5), 3), 4.5, False)
    names = [name for name, _ in leaves(Outer)]
    assert names == ["near.uv.x", "near.uv.y", "near.count", "weight", "on"]
    values = list(leaf_values(record, Outer))
    assert values == [1.5, 2.5, 3, 4.5, False]
    assert from_leaves(iter(values), Outer) == record
    assert list(fields_of(Outer)) == ["near", "weight", "on"]
    assert [name for name, _ in leaves(Mat3, "m")][3] == "m.y.x"


# --- shaders as plain Python ----------------------------------------------------------------------


@pytest.mark.parametrize("x", [0.1, np.float64(0.1), np.float32(0.1), 7, -2.5])
def test_numbers_never_widen(x):
    result = scaled(x)
    assert type(result) is np.float32
    y = np.float32(x) * np.float32(3) + np.float32(0.1)
    y = y + np.float32(0) / np.float32(3) + np.float32(1) / np.float32(3)
    assert result == max(y, min(np.float32(1), abs(np.float32(x))))


def test_ints_wrap_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = wrapping(2**31 - 1)
    assert type(result) is np.int32
    assert result == np.array([(2**31 - 1) * 65537 + 2147483647]).astype(np.int32)[0]


def test_arguments_by_name_and_wrong_arguments():
    assert scaled(x=1.0) == scaled(1.0)
    with pytest.raises(TypeError):
        scaled()
    with pytest.raises(TypeError):
        scaled(1.0, 2.0)
    with pytest.raises(ValueError, match="a word"):
        scaled("a word")


def test_floating_point_warnings_stay_off_inside_and_on_outside():
    @shader
    def quotient(a: float, b: float) -> float:
        return a / b

    assert quotient(1.0, 0.0) == math.inf
    assert np.isnan(quotient(0.0, 0.0))
    with pytest.warns(RuntimeWarning, match="divide by zero"):
        _ = np.float32(1) / np.float32(0)


def test_a_shader_may_use_names_of_the_function_around_it():
    offset = 0.25
    steps = 3

    @shader
    def inner(x: float) -> float:
        return x + offset

    @shader
    def outer(x: float) -> float:
        y = x
        # a comment above the loop
        for k in range(steps):
            y = inner(y) * float(k + 1)
        return y

    assert outer(1.0) == ((1.25 + 0.25) * 2 + 0.25) * 3
    assert type(outer(1.0)) is np.float32


def test_slots_are_bound_within_the_block_alone():
    with bound({chosen: doubled}):
        assert through_the_slot(3.0) == 7.0
        with bound({chosen: halved}):
            assert through_the_slot(3.0) == 2.5
            assert chosen(3.0) == 1.5
        assert through_the_slot(3.0) == 7.0
    with pytest.raises(ShaderError, match="chosen is not bound"):
        through_the_slot(3.0)
    # the failed run has left nothing behind
    with pytest.raises(ShaderError), bound({chosen: through_the_slot}), bound({}):
        raise ShaderError("out of the blocks")
    with pytest.raises(ShaderError, match="chosen is not bound"):
        chosen(1.0)


def test_each_thread_has_its_own_bindings():
    results: dict[str, float] = {}
    barrier = threading.Barrier(2)

    def work(name, choice):
        with bound({chosen: choice}):
            barrier.wait(5)
            results[name] = sum(float(through_the_slot(float(n))) for n in range(50))
            barrier.wait(5)

    threads = [
        threading.Thread(target=work, args=args)
        for args in (("doubled", doubled), ("halved", halved))
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == {"doubled": 2 * 1225 + 50, "halved": 0.5 * 1225 + 50}


def test_the_debugger_sees_the_lines_of_the_file():
    """A plain run visits the lines of this file, so that breakpoints work."""
    visited: list[tuple[str, int]] = []

    def trace(frame, event, _argument):
        if event == "line":
            visited.append((frame.f_code.co_filename, frame.f_lineno))
        return trace

    before = sys.gettrace()
    scaled(1.0)
    sys.settrace(trace)
    try:
        scaled(1.0)
    finally:
        sys.settrace(before)
    first = scaled.function.__code__.co_firstlineno
    lines = [line for file, line in visited if file == __file__ and first < line < first + 10]
    # the docstring is line 2 of the shader as it is written, the decorator line 0
    assert lines == [first + n for n in (3, 4, 5, 4, 5, 4, 6)]


def test_an_error_names_its_line_in_the_file(folder):
    module = write_module(
        folder,
        '''


@shader
def deep(x: float) -> float:
    """Two lines

    and a blank one."""
    # a comment
    y = x
    return missing(y)
''',
    )
    with pytest.raises(NameError) as caught:
        module.deep(1.0)
    last = caught.traceback[-1]
    assert str(last.path) == module.__file__
    assert "return missing(y)" in str(last.statement)


def test_indented_shaders_with_text_at_the_margin(folder):
    module = write_module(
        folder,
        '''
def make():
    @shader
    def inside(x: float) -> float:
        """Lines
at the margin."""
# a comment at the margin
        return x + 1.0

    return inside

inside = make()
''',
    )
    assert module.inside(1.0) == 2.0


def test_intrinsics_are_plain_functions_too():
    assert sqrt(np.float32(2)) == np.sqrt(np.float32(2))
    assert floor(Vec2(1.5, -0.5)) == Vec2(1.0, -1.0)
    assert scaled.__doc__ == "Constants, literals and built-ins of every kind."
    assert "scaled" in repr(scaled)


FACTOR = 2.0


@shader
def by_factor(x: float) -> float:
    return x * FACTOR


def test_a_number_that_changes_is_read_again(monkeypatch):
    """A notebook may change a constant; plain Python then reads the new value."""
    assert by_factor(1.5) == 3.0
    monkeypatch.setattr(sys.modules[__name__], "FACTOR", 3.0)
    assert by_factor(1.5) == 4.5
