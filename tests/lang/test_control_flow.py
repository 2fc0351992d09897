"""Branches, loops and early returns: divergent lanes compute the same as plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import Buffer
from basrelief.lang.program import Program
from helpers.comparing import assert_python_is_cpu, cpu, write_module

SHADERS = '''
@struct
class Input:
    a: float
    i: int

@struct
class Result:
    value: float
    count: int
    flag: bool

LEAST = 0.125


@shader
def early_returns(a: float, i: int) -> Result:
    if i < 0:
        return Result(a, i, True)
    if a > 2.0:
        if i > 3:
            return Result(a * 2.0, i, False)
        elif i == 2:
            a2 = a + 1.0
            return Result(a2, 2, True)
    elif a < -1.0:
        return Result(-a, 7, False)
    return Result(0.0, i * 2, i > 1)


@shader
def returns_from_loops(a: float, i: int) -> Result:
    total = a
    for k in range(5):
        for n in range(k, i):
            total = total * 0.5 + float(n)
            if total > 3.0 and n == 2:
                return Result(total, k * 10 + n, True)
            if total < -100.0:
                break
        if k == i:
            return Result(total, k, False)
    return Result(total, -1, False)


@shader
def break_and_continue(a: float, i: int) -> Result:
    total = 0.0
    rounds = 0
    for k in range(12):
        if k % 3 == i % 3:
            continue
        rounds += 1
        if float(k) > a + 4.0:
            break
        total = total + float(k) * LEAST
        if k > i:
            if total > 2.0:
                break
            continue
        total = total - 0.25
    return Result(total, rounds, rounds > 4)


@shader
def continue_in_both_branches(a: float, i: int) -> Result:
    count = 0
    for k in range(6):
        if k < i:
            count = count + 1
            continue
        else:
            if a < 0.0:
                break
            count = count + 10
    return Result(a, count, True)


@shader
def while_with_a_counter(a: float, i: int) -> Result:
    x = abs(a) + 1.0
    n = 0
    while n < 20 and x < 50.0 and n < i + 9:
        x = x * 1.5
        if x > 30.0:
            x = x + 1.0
        n += 1
    return Result(x, n, x > 40.0)


@shader
def loops_with_their_own_bounds(a: float, i: int) -> Result:
    total = a
    count = 0
    for k in range(i):
        total += float(k)
    for k in range(-i, i, 3):
        total += float(k) * 0.5
        count += 1
    for k in range(i, 7):
        for n in range(k, 9, 2):
            count += n
    for k in range(3):
        count += k
    return Result(total, count, count > 5)


@shader
def counter_name_reused(a: float, i: int) -> Result:
    total = 0
    for k in range(3):
        total += k
    for k in range(i, 5):
        total += k
    for k in range(2, 4):
        total += k
    k = i * 100
    return Result(a, total + k, True)


@shader
def counters_at_the_end_of_the_range(a: float, i: int) -> Result:
    n = 0
    for k in range(2147483640, 2147483647, 5):
        n += 1
        if n > 50:
            break
    for k in range(2147483640 + min(max(i, 0), 6), 2147483647, 4):
        n += 100
        if n > 5000:
            break
    for _ in range(2):
        for _ in range(3):
            n += 7
    return Result(a, n, True)


@shader
def set_in_branches_and_used_after(a: float, i: int) -> Result:
    if a > 0.5:
        v = Vec3(a, 1.0, 2.0)
        n = 3
    elif i > 1:
        v = Vec3(0.0, a, 1.0)
        n = i
    else:
        v = Vec3(a)
        n = -1
    for k in range(3):
        if k == i:
            w = v * 2.0
        else:
            w = v
        v = w + Vec3(1.0, 0.0, float(k))
    flag = i > 2
    if flag:
        n = n * 2
    return Result(dot(v, Vec3(1.0, 10.0, 100.0)), n, flag)


@shader
def set_late_used_in_a_loop(a: float, i: int) -> Result:
    x = a
    y = 0.0
    for k in range(4):
        if k >= i:
            t = x * 0.5 + float(k)
            if t > 1.0:
                y = y + t
                x = -x
            else:
                x = t
    return Result(x, int(y * 8.0), y > x)


@shader
def sign_of(x: float) -> float:
    if x > 0.0:
        return 1.0
    if x < 0.0:
        return -1.0
    return 0.0


@shader
def steps_down(x: float, least: int) -> int:
    n = 0
    value = x
    while n < 30 and value > 1.0:
        value = value * 0.75
        n += 1
    return n if n > least else least


@shader
def calls_within_branches(a: float, i: int) -> Result:
    total = 0.0
    n = 1
    if i > 0:
        total = sign_of(a) * float(steps_down(abs(a) * 10.0, i))
        for k in range(steps_down(a, 1)):
            total = total + sign_of(total - float(k))
            n = n + 100 // steps_down(a, k)
    if sign_of(a) > 0.0 and steps_down(a, 0) > 0 or i == 2:
        total = total + sign_of(-a)
    return Result(total if sign_of(a) < 0.0 else -total, n, steps_down(a, i) == i)


@shader
def nothing_to_do(a: float, i: int) -> Result:
    """Blocks with only comments and `pass`."""
    if a > 0.0:
        pass
    else:
        # only a comment above
        pass
    for _ in range(i):
        pass
    return Result(a, i, False)


@shader
def returns_in_every_branch(a: float, i: int) -> Result:
    for k in range(4):
        if k == i:
            if a > 0.0:
                return Result(a, k, True)
            else:
                return Result(-a, k, False)
        elif a > 6.0:
            return Result(6.0, -k, False)
    if a > 1.0:
        return Result(1.0, 1, True)
    else:
        return Result(2.0, 2, True)
'''

ENTRY = """

@shader
def run_{name}(pixel: IVec2, items: Buffer[Input]) -> Result:
    item = items[pixel.x]
    return {name}(item.a, item.i)
"""
NAMES = [
    line.split("(")[0].removeprefix("def ")
    for line in SHADERS.splitlines()
    if line.startswith("def ") and line.endswith("-> Result:")
]


@pytest.fixture(scope="module")
def module(folder):
    return write_module(folder, SHADERS + "".join(ENTRY.format(name=name) for name in NAMES))


def items_of(module, count: int) -> Buffer:
    draw = np.random.default_rng(count)
    edges = [(0.0, 0), (7.5, 4), (-3.0, -1), (float("nan"), 2), (float("inf"), 3)]
    rows = edges + [(draw.normal(0, 3), draw.integers(-3, 9)) for _ in range(count)]
    draw.shuffle(rows)
    return Buffer([module.Input(float(a), int(i)) for a, i in rows[:count]])


@pytest.mark.parametrize("name", NAMES)
def test_divergent_lanes(module, name):
    entry = getattr(module, f"run_{name}")
    for lanes, width in ((8, 67), (4, 13), (16, 45)):
        items = items_of(module, width)
        assert_python_is_cpu(entry, (width, 1), {"items": items}, lanes=[lanes])


@pytest.mark.parametrize("width", [1, 2, 3, 7, 8, 9, 13, 1003])
def test_widths_that_are_no_multiple_of_the_lanes(module, width):
    items = items_of(module, width)
    entry = module.run_returns_from_loops
    assert_python_is_cpu(entry, (width, 1), {"items": items}, lanes=(4, 8, 16))


def test_no_pixels_at_all(module):
    items = items_of(module, 3)
    program = Program(module.run_early_returns)
    for size in ((0, 3), (3, 0), (0, 0)):
        planes = cpu(8).run(program, {"items": items}, size)
        assert all(plane.shape == size[::-1] for plane in planes.values())


def test_names_that_the_compiled_code_uses(folder):
    module = write_module(
        folder,
        """
@struct
class Input:
    a: float

@struct
class Result:
    value: float

@shader
def run(active: Buffer[Input], mask: float) -> float:
    returned = active[0].a
    return returned + mask

@shader
def first(result: float, width: float) -> float:
    lanes = result * width
    return lanes

@shader
def entry(pixel: IVec2, items: Buffer[Input]) -> Result:
    x = float(pixel.x)
    rows = run(items, x)
    return Result(first(rows, x))
""",
    )
    items = Buffer([module.Input(2.5)])
    assert_python_is_cpu(module.entry, (5, 2), {"items": items})
