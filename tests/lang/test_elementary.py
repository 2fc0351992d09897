"""Functions of `lang.elementary` against NumPy in float64, over their stated domains.

A million values each on the CPU, and samples of them in plain Python, to the last bit.
"""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import Buffer, elementary
from basrelief.lang.elementary import ELEMENTARY
from basrelief.lang.program import Program
from basrelief.lang.shader import Shader
from helpers.comparing import assert_python_is_cpu, bits, cpu, write_module

WIDTH, HEIGHT = 1000, 1000
"""Size of the pictures whose pixels are the values of a sweep."""

SHADERS = """
@struct
class Sweep:
    # 0: from low to high in even steps; 1: the bits of floats, from those of low to those of high
    kind: int
    low: float
    high: float
    other: float

@struct
class Result:
    x: float
    y: float

@shader
def swept(pixel: IVec2, sweep: Sweep) -> float:
    n = pixel.y * 1000 + pixel.x
    t = float(n) / 999999.0
    if sweep.kind == 1:
        first = float_bits(sweep.low)
        step = (float_bits(sweep.high) - first) // 999999
        return bits_float(first + n * step)
    return sweep.low + (sweep.high - sweep.low) * t
"""
ENTRY = """
@shader
def sweep_{name}(pixel: IVec2, sweep: Sweep) -> Result:
    x = swept(pixel, sweep)
    return Result(x, {call})
"""
CALLS = {name: f"{name}(x)" for name in ELEMENTARY} | {
    "pow": "pow(x, sweep.other)",
    "atan2": "atan2(x, sweep.other)",
}

TINY, HUGE = 1.17549435e-38, 3.4028235e38


@pytest.fixture(scope="module")
def module(folder):
    entries = (ENTRY.format(name=name, call=call) for name, call in CALLS.items())
    return write_module(folder, SHADERS + "".join(entries))


def sweep(module, name, low, high, *, by_bits=False, other=0.0):
    """x and f(x) for a million x, as float64."""
    values = {"sweep": module.Sweep(int(by_bits), low, high, other)}
    program = Program(getattr(module, f"sweep_{name}"))
    planes = cpu(threads=2).run(program, values, (WIDTH, HEIGHT))
    # some rows of them in plain Python
    rows = {name: plane[::389] for name, plane in planes.items()}
    entry = getattr(module, f"sweep_{name}")
    for y in range(len(rows["x"])):
        for x in range(0, WIDTH, 97):
            record = entry((x, y * 389), **values)
            assert bits(record.y) == bits(rows["y"][y, x]), f"{name}({rows['x'][y, x]!r})"
    return planes["x"].astype(np.float64).ravel(), planes["y"].astype(np.float64).ravel()


def ulp_error(result, exact):
    """The error of float32 results in units of the last place of the exact ones.

    Where the exact result rounds to an infinity, an infinity is right.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        nearest = exact.astype(np.float32)
        unit = np.spacing(np.abs(np.where(np.isinf(nearest), np.float32(HUGE), nearest)))
        error = np.abs(result - exact) / unit.astype(np.float64)
    return np.where(np.isinf(nearest) & (result == nearest), 0.0, error)


@pytest.mark.parametrize(
    ("name", "low", "high", "by_bits", "most"),
    [
        ("exp", -103.0, 88.7228, False, 2),
        ("exp", -1e-3, 1e-3, False, 2),
        ("exp", 88.0, 88.7228, False, 2),
        ("exp2", -149.0, 127.99999, False, 2),
        ("exp2", 127.0, 127.99999, False, 2),
        ("log2", TINY, HUGE, True, 3),
        ("log2", 0.5, 2.0, False, 3),
        ("log", TINY, HUGE, True, 4),
        ("log", 0.5, 2.0, False, 4),
        ("atan", TINY, HUGE, True, 3),
        ("atan", -5.0, 5.0, False, 3),
    ],
)
def test_units_in_the_last_place(module, name, low, high, by_bits, most):
    x, y = sweep(module, name, low, high, by_bits=by_bits)
    exact = {"atan": np.arctan}.get(name, getattr(np, name, None))(x)
    error = ulp_error(y, exact)
    worst = error.argmax()
    assert error[worst] <= most, f"{name}({x[worst]!r}) = {y[worst]!r}, not {exact[worst]!r}"


@pytest.mark.parametrize(
    ("name", "low", "high", "most"),
    [
        ("sin", -8192.0, 8192.0, 1e-7),
        ("sin", -7.0, 7.0, 1e-7),
        ("sin", 8000.0, 8192.0, 1e-7),
        ("cos", -8192.0, 8192.0, 1e-7),
        ("cos", -7.0, 7.0, 1e-7),
        ("asin", -1.0, 1.0, 3e-7),
        ("asin", 0.999, 1.0, 3e-7),
        ("acos", -1.0, 1.0, 4e-7),
        ("acos", 0.999, 1.0, 4e-7),
        ("acos", -1.0, -0.999, 4e-7),
    ],
)
def test_absolute_error(module, name, low, high, most):
    x, y = sweep(module, name, low, high)
    exact = getattr(np, {"asin": "arcsin", "acos": "arccos"}.get(name, name))(x)
    error = np.abs(y - exact)
    worst = error.argmax()
    assert error[worst] <= most, f"{name}({x[worst]!r}) = {y[worst]!r}, not {exact[worst]!r}"


@pytest.mark.parametrize("x", [-3.0, -1e-3, -1e-30, 0.0, -0.0, 1e-40, 0.25, 1.0, 1e20])
def test_atan2(module, x):
    for low, high, by_bits in ((-4.0, 4.0, False), (TINY, HUGE, True), (-1.0, -1e-3, False)):
        y, result = sweep(module, "atan2", low, high, by_bits=by_bits, other=x)
        # -0.0 is taken for 0.0: the angle of the positive axis
        exact = np.arctan2(y, float(np.float32(x)) + 0.0)
        assert np.abs(result - exact).max() <= 4e-7


def test_atan2_at_the_origin():
    for x in (0.0, -0.0):
        assert bits(elementary.atan2(0.0, x)) == 0
        assert bits(elementary.atan2(-0.0, x)) == bits(np.float32(-0.0))


@pytest.mark.parametrize("y", [-3.0, -0.5, 0.3, 0.5, 1.0, 2.2, 5.0, 13.0])
def test_pow(module, y):
    x, result = sweep(module, "pow", 1e-6, 100.0, other=y, by_bits=True)
    power = float(np.float32(y))
    exact = x**power
    whole = (np.abs(exact) > TINY) & (np.abs(exact) < HUGE)
    error = np.abs(result - exact)[whole] / exact[whole]
    assert (error <= 2e-7 * (1 + np.abs(power * np.log2(x[whole])))).all()


def test_pow_of_zero_and_below():
    assert elementary.pow(0.0, 2.0) == 0.0
    assert elementary.pow(0.0, 0.0) == 1.0
    assert elementary.pow(-1.0, 3.0) == 0.0


def test_tan_is_sine_divided_by_cosine(module):
    x, result = sweep(module, "tan", -1.5, 1.5)
    assert (np.abs(result - np.tan(x)) <= 4e-7 * (1 + np.tan(x) ** 2)).all()


def test_logarithms_of_zero_and_below_are_finite():
    for function in (elementary.log, elementary.log2):
        for x in (0.0, -0.0, -5.0, 1e-45, float("-inf")):
            result = function(x)
            assert np.isfinite(result)
            assert result < -80


def test_inverse_sine_and_cosine_are_clamped_beyond_one():
    for function in (elementary.asin, elementary.acos):
        assert function(1.5) == function(1.0)
        assert function(-2.0) == function(-1.0)
        assert function(float("inf")) == function(1.0)


def test_exponentials_at_the_ends_of_their_domain():
    inf = float("inf")
    for function in (elementary.exp, elementary.exp2):
        assert function(inf) == inf
        assert function(1e30) == inf
        assert function(-inf) == 0.0
        assert function(0.0) == 1.0
        assert np.isnan(function(float("nan")))


def test_special_values_in_python(folder):
    """All functions at special values: plain Python and the CPU, to the last bit."""
    special = [0.0, -0.0, 1.0, -1.0, 88.5, 88.9, 127.75, 128.0, -126.5, -149.3, -150.0, 8192.0]
    names = [n for n in ELEMENTARY if n not in ("pow", "atan2")]
    fields = "\n".join(f"    {name}_: float" for name in ELEMENTARY)
    calls = ", ".join([*(f"{name}(x)" for name in names), "pow(x, x)", "atan2(x, 0.5)"])
    module = write_module(
        folder,
        f"""
@struct
class Input:
    x: float

@struct
class Result:
{fields}

@shader
def entry(pixel: IVec2, items: Buffer[Input]) -> Result:
    x = items[pixel.x].x
    return Result({calls})
""",
    )
    items = Buffer([module.Input(x) for x in special])
    assert_python_is_cpu(module.entry, (len(items), 1), {"items": items})


def test_every_function_states_its_error():
    for name in ELEMENTARY:
        function = getattr(elementary, name)
        assert isinstance(function, Shader)
        assert function.__doc__
