"""Every operator and intrinsic: plain Python against the CPU, bit for bit.

Each expression is a field of a result; one program computes a table of them for each record of a
buffer.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basrelief.lang import Buffer
from basrelief.lang.intrinsics import INTRINSICS
from helpers.comparing import FLOATS, INTS, assert_python_is_cpu, write_module

INPUTS = {
    "floats": "a: float\n    b: float\n    c: float",
    "ints": "i: int\n    j: int\n    k: int",
    "mixed": "a: float\n    b: float\n    i: int\n    j: int\n    p: bool\n    q: bool",
    "vectors": "u2: Vec2\n    v2: Vec2\n    u3: Vec3\n    v3: Vec3\n    u4: Vec4\n    v4: Vec4\n"
    "    s: float\n    t: float",
    "matrices": "m: Mat3\n    v3: Vec3\n    g: IVec2\n    h: IVec2\n    i: int",
}
"""Input records of the tables, by name."""

TABLES: dict[str, tuple[str, list[tuple[str, str]]]] = {
    "float arithmetic": ("floats", [
        ("float", text) for text in (
            "a + b", "a - b", "a * b", "a / b", "-a", "a * b + c", "a - b * c", "(a + b) + c",
            "a + (b + c)", "a / b / c", "1.0 / a", "a * 0.0", "a + 0.0", "0.0 - a", "a * 2.0 - a",
            "a / 3.0", "-(a - b)", "-0.0 + a", "a - a", "a / a",
        )
    ]),
    "float comparison": ("floats", [
        ("bool", text) for text in (
            "a < b", "a <= b", "a > b", "a >= b", "a == b", "a != b", "a < b < c", "a <= b > c",
            "a == b == c", "not a < b", "a < b and b < c", "a < b or b != c", "a == a", "a != a",
            "not (a < b or not b >= c)", "(a < b) == (b < c)", "(a < b) != (c == c)",
            "a < 0.0 or a > 1.0 and b < 0.5", "True", "not False",
        )
    ]),
    "int arithmetic": ("ints", [
        ("int", text) for text in (
            "i + j", "i - j", "i * j", "i // j", "i % j", "-i", "i & j", "i | j", "i ^ j",
            "i << 0", "i << 5", "i << 31", "i >> 0", "i >> 1", "i >> 31", "i * j + k", "i // 3",
            "i % 3", "i // -3", "i % -3", "i // 8", "i % 8", "i // -1", "i % -1", "i // 0", "i % 0",
            "7 // i", "7 % i", "-7 // i", "-7 % i", "(i & 0xFF) << 8 | j >> 24",
            "i // j * j + i % j",
            "i - j - k", "-(-i)", "1 << 31", "i * -1",
        )
    ]),
    "int comparison": ("ints", [
        ("bool", text) for text in (
            "i < j", "i <= j", "i > j", "i >= j", "i == j", "i != j", "i < j < k", "i == j != k",
            "not i < j", "i < j and j < k or i == 3",
        )
    ]),
    "choices and conversions": ("mixed", [
        ("float", "a if p else b"), ("float", "a if a < b else b if p else -a"),
        ("int", "i if p and q else j"), ("int", "i if p or q else j"), ("bool",
        "p if q else a < b"),
        ("bool", "p and q"), ("bool", "p or q"), ("bool", "not p"), ("bool", "p == q"),
        ("bool", "p != q"), ("float", "a / b if b != 0.0 else 0.0"),
        ("int", "i // j if j != 0 else -1"), ("Vec2", "Vec2(a, b) if p else Vec2(b)"),
        ("float", "float(i)"), ("float", "float(a)"), ("float", "float(p)"), ("int", "int(a)"),
        ("int", "int(i)"), ("int", "int(p)"), ("int", "int(a * 1e-3)"), ("int", "int(-a)"),
        ("int", "int(floor(a + 0.5))"), ("float", "float(i) / float(j)"), ("int",
        "int(p) + int(q)"),
    ]),
    "intrinsics of floats": ("floats", [
        ("float", text) for text in (
            "abs(a)", "min(a, b)", "max(a, b)", "min(min(a, b), c)", "max(0.0, min(a, 1.0))",
            "sqrt(a)", "floor(a)", "fract(a)", "minimum(a, b)", "maximum(a, b)", "clamp(a, b, c)",
            "clamp(a, 0.0, 1.0)", "saturate(a)", "mix(a, b, c)", "mix(a, b, 0.25)",
            "smoothstep(a, b, c)", "smoothstep(0.0, 1.0, a)", "copysign(a, b)", "copysign(1.0, a)",
            "copysign(a, -0.0)", "sign(a)",
        )
    ] + [("int", "float_bits(a)"), ("float", "bits_float(float_bits(a))")]),
    "intrinsics of ints": ("ints", [
        ("int", text) for text in ("abs(i)", "min(i, j)", "max(i, j)", "min(max(i, 0), 255)")
    ] + [("float", "float(i)"), ("float", "bits_float(i)"), ("float", "bits_float(i ^ j)")]),
    "functions of one": ("floats", [
        ("float", f"{name}(a)") for name in (
            "exp", "exp2", "log", "log2", "sin", "cos", "tan", "asin", "acos", "atan",
        )
    ]),
    "functions of two": ("floats", [
        ("float", text) for text in ("pow(a, b)", "atan2(a, b)", "pow(abs(a), 2.2)",
        "atan2(a, 1.0)")
    ]),
    "vector arithmetic": ("vectors", [
        (kind, text.replace("U", f"u{n}").replace("V", f"v{n}"))
        for n, kind in ((2, "Vec2"), (3, "Vec3"), (4, "Vec4"))
        for text in (
            "U + V", "U - V", "U * V", "U / V", "-U", "U * s", "s * U", "U / s", "s / U", "U + s",
            "s + U", "U - s", "s - U", "U * 2.0 + V", "2.0 * U", "U * s + V * t",
        )
    ]),
    "vector intrinsics": ("vectors", [
        (kind, text.replace("U", f"u{n}").replace("V", f"v{n}"))
        for n, vector in ((2, "Vec2"), (3, "Vec3"), (4, "Vec4"))
        for kind, text in (
            (vector, "sqrt(U)"), (vector, "floor(U)"), (vector, "fract(U)"), (vector,
            "saturate(U)"),
            (vector, "minimum(U, V)"), (vector, "maximum(U, s)"), (vector, "clamp(U, s, V)"),
            (vector, "clamp(U, 0.0, 1.0)"), (vector, "mix(U, V, s)"), (vector, "mix(U, V, V)"),
            (vector, "mix(U, s, V)"), ("float", "dot(U, V)"), ("float", "length(U)"),
            (vector, "normalize(U)"), (vector, "reflect(U, V)"),
        )
    ] + [("Vec3", "cross(u3, v3)"), ("Vec3", "cross(u3, u3)")]),
    "swizzles and construction": ("vectors", [
        ("float", "u2.y"), ("float", "u3.b"), ("float", "u4.a"), ("Vec2", "u2.yx"), ("Vec2",
        "u3.zz"),
        ("Vec2", "u4.wx"), ("Vec3", "u2.xyx"), ("Vec3", "u3.bgr"), ("Vec3", "u4.rgb"),
        ("Vec4", "u2.xyxy"), ("Vec4", "u3.zzzx"), ("Vec4", "u4.wzyx"), ("Vec2", "Vec2(s)"),
        ("Vec3", "Vec3(s)"), ("Vec4", "Vec4(1.0)"), ("Vec3", "Vec3(u2, s)"), ("Vec3",
        "Vec3(s, u2)"),
        ("Vec4", "Vec4(u2, v2)"), ("Vec4", "Vec4(s, u3)"), ("Vec4", "Vec4(s, u2, t)"),
        ("Vec4", "Vec4(u4)"), ("float", "(u3 + v3).zy.y"), ("float", "Vec3(s, t, 2.0).zxy.z"),
        ("Vec3", "u3 if s < t else v3"),
    ]),
    "matrices and ints in pairs": ("matrices", [
        ("Vec3", "m @ v3"), ("Vec3", "m.x"), ("Vec3", "m.y + m.z"), ("float", "m.z.y"),
        ("Vec3", "transpose(m) @ v3"), ("Mat3", "transpose(m)"), ("Vec3", "m @ (m @ v3)"),
        ("Mat3", "Mat3(v3, m.x, Vec3(1.0, 2.0, 3.0))"), ("Mat3", "m if i < 0 else transpose(m)"),
        ("IVec2", "g + h"), ("IVec2", "g - h"), ("IVec2", "g * h"), ("IVec2", "-g"),
        ("IVec2", "g * i"), ("IVec2", "i + g"), ("IVec2", "i - g"), ("IVec2", "g - 1"),
        ("IVec2", "g.yx"), ("int", "g.y"), ("IVec2", "IVec2(i)"), ("IVec2", "IVec2(i, g.x)"),
        ("IVec2", "IVec2(g)"), ("IVec2", "g if i < 0 else h"),
    ]),
}  # fmt: skip

RESOURCES = {"corners", "sampled", "texel", "stored", "size", "levels", "len"}
"""Intrinsics that `test_map_reads.py` tests, and `engine/test_hardware_filter.py`."""


def table_module(folder, table, leave_out=(), records=INPUTS):
    """Module whose entry computes the expressions of a table, and the expressions."""
    inputs, expressions = TABLES[table]
    expressions = [e for e in expressions if e[1] not in leave_out]
    fields = records[inputs]
    names = [line.split(":")[0].strip() for line in fields.splitlines()]
    # where bools are stored as ints
    tested = {n: " != 0" for n in ("p", "q") if f"{n}: int" in fields}
    loads = "\n".join(f"    {name} = item.{name}{tested.get(name, '')}" for name in names)
    found = "\n".join(f"    f{n}: {t}" for n, (t, _) in enumerate(expressions))
    values = "\n".join(f"    f{n} = {text}" for n, (_, text) in enumerate(expressions))
    results = ", ".join(f"f{n}" for n in range(len(expressions)))
    text = f"""
@struct
class Input:
    {fields}

@struct
class Result:
{found}

@shader
def entry(pixel: IVec2, items: Buffer[Input]) -> Result:
    item = items[pixel.x]
{loads}
{values}
    return Result({results})
"""
    return write_module(folder, text), expressions


@pytest.fixture(scope="module")
def module_of(folder):
    return functools.cache(lambda table: table_module(folder, table)[0])


def hand_picked(inputs: str) -> list[tuple]:
    """Input records: pairs of the special values, and random ones."""
    draw = np.random.default_rng(5)

    def floats(*shape):
        return draw.choice(np.array(FLOATS, np.float32), shape)

    match inputs:
        case "floats":
            pairs = [(a, b, 0.75) for a, b in itertools.product(FLOATS, FLOATS)]
            return pairs[::3] + [tuple(row) for row in floats(400, 3)]
        case "ints":
            pairs = [(i, j, 3) for i, j in itertools.product(INTS, INTS)]
            return pairs + [tuple(map(int, row)) for row in draw.choice(np.array(INTS), (100, 3))]
        case "mixed":
            return [
                (a, b, i, j, p, q)
                for (a, b), i, j, p, q in zip(
                    floats(500, 2), draw.choice(INTS, 500), draw.choice(INTS, 500),
                    draw.random(500) < 0.5, draw.random(500) < 0.5, strict=True,
                )
            ] + [(a, a, 1, 2, True, False) for a in FLOATS]  # fmt: skip
        case "vectors":
            moderate = draw.normal(0, 2, (60, 20)).astype(np.float32)
            return [
                (row[0:2], row[2:4], row[4:7], row[7:10], row[10:14], row[14:18], row[18], row[19])
                for row in [*floats(60, 20), *moderate]
            ]
        case "matrices":
            from basrelief.lang import Mat3, Vec3

            moderate = draw.normal(0, 2, (60, 12)).astype(np.float32)
            whole = draw.choice(np.array(INTS), (120, 5))
            return [
                (Mat3(Vec3(*r[:3]), Vec3(*r[3:6]), Vec3(*r[6:9])), r[9:], w[:2], w[2:4], w[4])
                for r, w in zip([*floats(60, 12), *moderate], whole, strict=True)
            ]
    raise AssertionError(inputs)


def buffer_of(module, rows) -> Buffer:
    return Buffer([module.Input(*row) for row in rows])


@pytest.mark.parametrize("table", TABLES)
def test_hand_picked_values(module_of, table):
    module = module_of(table)
    items = buffer_of(module, hand_picked(TABLES[table][0]))
    assert_python_is_cpu(module.entry, (len(items), 1), {"items": items})


FLOAT = st.floats(width=32) | st.sampled_from(FLOATS)
INT = st.integers(-(2**31), 2**31 - 1) | st.integers(-9, 9) | st.sampled_from(INTS)
ROWS = {
    "floats": st.tuples(FLOAT, FLOAT, FLOAT),
    "ints": st.tuples(INT, INT, INT),
    "mixed": st.tuples(FLOAT, FLOAT, INT, INT, st.booleans(), st.booleans()),
    "vectors": st.tuples(*(st.tuples(*[FLOAT] * n) for n in (2, 2, 3, 3, 4, 4)), FLOAT, FLOAT),
}


@pytest.mark.parametrize("table", [t for t, (inputs, _) in TABLES.items() if inputs in ROWS])
def test_any_values(module_of, table):
    module = module_of(table)

    @settings(max_examples=12)
    @given(st.lists(ROWS[TABLES[table][0]], min_size=1, max_size=40))
    def check(rows):
        items = buffer_of(module, rows)
        assert_python_is_cpu(module.entry, (len(items), 1), {"items": items})

    check()


def test_every_intrinsic_is_in_a_table():
    texts = " ".join(text for _, expressions in TABLES.values() for _, text in expressions)
    helpers = {i.name for i in INTRINSICS.values() if i.python.__module__.endswith("helpers")}
    public = INTRINSICS.keys() - helpers
    missing = {name for name in public if f"{name}(" not in texts} - RESOURCES
    assert not missing, f"no test calls {missing}; add them to TABLES"
