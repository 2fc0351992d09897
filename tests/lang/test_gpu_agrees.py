"""The same programs on the GPU and on the CPU: operators, intrinsics, control flow, maps.

On finite, moderate values: WGSL promises nothing about NaN and infinity.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from test_control_flow import ENTRY, NAMES, SHADERS
from test_operators import INPUTS, TABLES, table_module

from basrelief.lang import Buffer, Mat3, Vec3
from basrelief.lang.program import Program
from helpers.comparing import INTS, bits, cpu, shown, write_module
from helpers.random_programs import Writer

pytestmark = pytest.mark.gpu

GPU_INPUTS = INPUTS | {"mixed": INPUTS["mixed"].replace("bool", "int")}
"""Inputs of the tables; records on a GPU cannot contain bools, so `p` and `q` are ints."""

LOOSE = {"asin(a)": 1e-6, "acos(a)": 1e-6, "atan(a)": 1e-6}
"""Allowed absolute errors of functions of several operations."""

ULPS = 4
"""Allowed error of one operation or intrinsic in units in the last place: WGSL allows 2.5 for a
division, and the contraction of a multiplication and an addition."""

NARROW = 1e-5
"""Allowed error relative to the largest operand, for sums that cancel."""


@functools.cache
def gpu():
    from basrelief.engine.gpu import GpuEngine

    return GpuEngine()


def both(entry, values, size, edge="wrap"):
    program = Program(entry, {}, edge)
    actual = gpu().run(program, values, size)
    expected = cpu().run(program, values, size)
    assert {n: p.dtype for n, p in actual.items()} == {n: p.dtype for n, p in expected.items()}
    return expected, actual


def ulp_distance(a, b):
    """Distance of two float arrays in units in the last place."""
    ordered = [
        np.where(w < 0, -(w & 0x7FFFFFFF), w).astype(np.int64)
        for w in (np.ascontiguousarray(x).view(np.int32).astype(np.int64) for x in (a, b))
    ]
    return np.abs(ordered[0] - ordered[1])


MODERATE = {
    "floats": lambda draw: [
        (a, b, c) for a, b, c in draw.uniform(0.05, 4, (150, 3)) * draw.choice([1, -1], (150, 3))
    ],
    "ints": lambda draw: (
        draw.choice(np.array(INTS), (400, 3)).tolist() + draw.integers(-50, 50, (200, 3)).tolist()
    ),
    "mixed": lambda draw: [
        (a, b, int(i), int(j), int(p), int(q))
        for (a, b), (i, j), (p, q) in zip(
            draw.uniform(-9, 9, (150, 2)),
            draw.integers(-5, 9, (150, 2)),
            draw.random((150, 2)) < 0.5,
            strict=True,
        )
    ],
    "vectors": lambda draw: [
        (r[0:2], r[2:4], r[4:7], r[7:10], r[10:14], r[14:18], r[18], r[19])
        for r in draw.uniform(0.1, 3, (90, 20)) * draw.choice([1, -1], (90, 20))
    ],
    "matrices": lambda draw: [
        (Mat3(Vec3(*r[:3]), Vec3(*r[3:6]), Vec3(*r[6:9])), r[9:], w[:2], w[2:4], w[4])
        for r, w in zip(
            draw.uniform(-3, 3, (90, 12)), draw.integers(-999, 999, (90, 5)), strict=True
        )
    ],
}


@pytest.mark.parametrize("table", TABLES)
def test_operators_and_intrinsics(folder, table):
    # each of these has its own test below
    leave_out = {text for texts in ALONE.values() for text in texts}
    module, expressions = table_module(folder, table, leave_out, GPU_INPUTS)
    inputs = TABLES[table][0]
    draw = np.random.default_rng(11)
    rows = [row if isinstance(row, tuple) else tuple(row) for row in MODERATE[inputs](draw)]
    items = Buffer([module.Input(*row) for row in rows])
    expected, actual = both(module.entry, {"items": items}, (len(rows), 1))
    wrong = []
    for name in expected:
        text = expressions[int(name.split(".")[0][1:])][1]
        a, b = expected[name][0], actual[name][0]
        if a.dtype != np.float32:
            bad = a != b
        else:
            with np.errstate(invalid="ignore"):
                finite = np.isfinite(a) & (np.abs(a) < 1e30)
                small = np.abs(a.astype(np.float64) - b) <= np.maximum(1, np.abs(a)) * LOOSE.get(
                    text, NARROW
                )
            # logarithms and powers of negative numbers are clamped differently by each engine
            clamped = text.split("(")[0] in ("log", "log2", "pow") and "abs" not in text
            positive = np.array([row[0] > 0 for row in rows]) if clamped else True
            bad = finite & positive & (ulp_distance(a, b) > ULPS) & ~small
        if bad.any():
            k = int(np.argmax(bad))
            wrong.append(
                f"{text} [{name}] of {items.items[k]}: CPU {shown(bits(a[k]))}, GPU "
                f"{shown(bits(b[k]))}; {bad.sum()} of {len(rows)}"
            )
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("name", NAMES)
def test_control_flow(folder, name):
    module = write_module(folder, SHADERS + ENTRY.format(name=name))
    draw = np.random.default_rng(4)
    # quarters: sums and products of them are exact, so no branch hangs on a last digit
    rows = [(float(draw.integers(-16, 17)) / 4, int(draw.integers(-3, 9))) for _ in range(203)]
    items = Buffer([module.Input(*row) for row in rows])
    expected, actual = both(getattr(module, f"run_{name}"), {"items": items}, (len(rows), 1))
    assert (expected["count"] == actual["count"]).all()
    assert (expected["flag"] == actual["flag"]).all()
    np.testing.assert_allclose(actual["value"], expected["value"], rtol=1e-6, atol=1e-6)


ALONE = {
    "a vector and a scalar mixed by a vector": {f"mix(u{n}, s, v{n})" for n in (2, 3, 4)},
    "a selected matrix": {"m if i < 0 else transpose(m)"},
    "matrices in the result": {"transpose(m)", "Mat3(v3, m.x, Vec3(1.0, 2.0, 3.0))"},
    "constants that overflow": {"1 << 31"},
}
"""Expressions that WGSL writes differently, by topic."""

ALONE_ROWS = """
@struct
class Input:
    a: float
    b: float
    i: int
    m: Mat3
    u2: Vec2
    v2: Vec2

@struct
class Pair:
    a: float
    n: int

"""
ALONE_PROGRAMS = {
    "two comparisons as arguments": ("""
@struct
class Result:
    less: bool
    more: bool
""", "return Result(g.a < g.b, g.b > g.a * 2.0)"),
    "a vector and a scalar mixed by a vector": ("""
@struct
class Result:
    v: Vec2
""", "return Result(mix(g.u2, g.a, g.v2))"),
    "a selected matrix": ("""
@struct
class Result:
    v: Vec3
""", "m = g.m if g.a < 0.0 else transpose(g.m)\n    return Result(m @ Vec3(1.0, 2.0, 4.0))"),
    "a selected record": ("""
@struct
class Result:
    pair: Pair
""", "return Result(Pair(g.a, 1) if g.a < g.b else Pair(g.b, g.i))"),
    "matrices in the result": ("""
@struct
class Result:
    m: Mat3
""", "return Result(transpose(g.m))"),
    "constants that overflow": ("""
@struct
class Result:
    n: int
    k: int
""", "return Result((1 << 31) + g.i, 65537 * 65537 + g.i)"),
    "the smallest int": ("""
LEAST = -2147483648

@struct
class Result:
    n: int
""", "return Result(max(g.i, LEAST) - LEAST)"),
    "names with an underscore": ("""
@struct
class Result:
    n: int
""", "target = g.i\n    target_ = 5\n    k_end = 3\n    total = 0\n"
     "    for k in range(target):\n        total = total + k\n"
     "    return Result(total + target_ + k_end)"),
}  # fmt: skip


@pytest.mark.parametrize("what", ALONE_PROGRAMS)
def test_expressions_that_wgsl_writes_differently(folder, what):
    result, body = ALONE_PROGRAMS[what]
    head = "\n@shader\ndef entry(pixel: IVec2, items: Buffer[Input]) -> Result:\n"
    text = f"{ALONE_ROWS}{result}{head}    g = items[pixel.x]\n    {body}\n"
    module = write_module(folder, text)
    draw = np.random.default_rng(3)
    rows = [
        (r[0], r[1], int(r[2]), Mat3(Vec3(*r[3:6]), Vec3(*r[6:9]), Vec3(*r[9:12])), r[:2], r[2:4])
        for r in draw.uniform(-4, 4, (20, 12))
    ]
    items = Buffer([module.Input(*row) for row in rows])
    expected, actual = both(module.entry, {"items": items}, (20, 1))
    for name, plane in expected.items():
        np.testing.assert_allclose(actual[name], plane, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("seed", range(5))
def test_random_programs_of_ints(folder, seed):
    module = write_module(folder, Writer(seed, size=4, exact=True).program())
    draw = np.random.default_rng(seed)
    rows = [(0.0, 0.0, int(i), int(j)) for i, j in draw.integers(-9, 12, (75, 2))]
    items = Buffer([module.Input(*row) for row in rows])
    expected, actual = both(module.entry, {"items": items}, (75, 1))
    for name, plane in expected.items():
        assert (plane == actual[name]).all(), name
