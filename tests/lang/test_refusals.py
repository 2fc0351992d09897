"""Source outside the subset is refused with file, line, carets under it and what to write."""

from __future__ import annotations

import ast
import asyncio
import linecache
import re
from pathlib import Path

import pytest

from basrelief.lang.frontend import analyse
from basrelief.lang.program import Program
from basrelief.lang.types import ShaderError
from helpers.comparing import write_module
from helpers.refusals import refusal_in

BEFORE = """
import math

HALF = 0.5
INFINITE = math.inf
NAMES = ("a", "b")

@struct
class Point:
    x: float
    v: Vec3
    n: int

def helper(x):
    return x

@shader
def half(x: float) -> float:
    return x * HALF

@slot
def chosen(x: float) -> float: ...

"""

BODIES = {
    # containers, closures, text
    "y = [x, x]": ("[x, x]", "no containers; use Vec2"),
    "y = (x, x)": ("(x, x)", "no containers"),
    "y = {1: x}": ("{1: x}", "no containers"),
    "y = {x}": ("{x}", "no containers"),
    "y = lambda z: z": ("lambda z: z", "write a shader"),
    "y = [z for z in p.v]": ("[z for z in p.v]", "write a loop"),
    "y = 'red'": ("'red'", "strings are for static conditions only"),
    "y = f'{x}'": ("f'{x}'", "no strings"),
    "y = None": ("None", "write a number or a bool"),
    "y = 1j": ("1j", "write a number or a bool"),
    "y = (z := x)": ("z := x", "outside the subset"),
    # statements
    "try:\n        y = x\n    except ValueError:\n        y = 0.0": ("try:", "no exceptions"),
    "raise ValueError": ("raise ValueError", "no exceptions"),
    "assert x > 0.0": ("assert x > 0.0", "no exceptions"),
    "p.x = 1.0": ("p.x = 1.0", "immutable"),
    "p.v.x += 1.0": ("p.v.x += 1.0", "immutable"),
    "p.v[0] = 1.0": ("p.v[0] = 1.0", "immutable"),
    "y = z = x": ("y = z = x", "one plain name"),
    "y, z = p.v.xy": ("y, z = p.v.xy", "one plain name"),
    "y: float": ("y: float", "one plain name"),
    "half(x)": ("half(x)", "assign or return it"),
    "def inner(): pass": ("def inner", "top level"),
    "with x: pass": ("with x: pass", "outside the subset"),
    "global HALF": ("global HALF", "outside the subset"),
    "del x": ("del x", "outside the subset"),
    "import math": ("import math", "outside the subset"),
    "return": ("return", "return a value"),
    # names and types
    "y = unheard_of": ("unheard_of", "unheard_of is not defined"),
    "y = NAMES": ("NAMES", "pass it as a parameter"),
    "y = half": ("half", "pass it as a parameter"),
    "y = helper(x)": ("helper", "mark it with @shader"),
    "y = math.sin(x)": ("math.sin", "plain name"),
    "y = print(x)": ("print", "mark it with @shader"),
    "y = 1.0\n    y = 2": ("y = 2", "is float, not int; write 1.0 for 1"),
    "y = 2\n    y = x": ("y = x", "the variable y is int, not float"),
    "y = p\n    y = p.v": ("y = p.v", "Point, not Vec3"),
    "x = 1.0": ("x = 1.0", "a parameter cannot be assigned to"),
    "x += 1.0": ("x += 1.0", "a parameter cannot be assigned to"),
    "y = x + n": ("x + n", "does not apply to float and int; write 1.0 for 1, or float(…)"),
    "y = x * 2": ("x * 2", "write 1.0 for 1"),
    "y = n / 2": ("n / 2", "write // for an int quotient"),
    "y = x // 2.0": ("x // 2.0", "use floor(a / b)"),
    "y = x % 1.0": ("x % 1.0", "fract"),
    "y = x ** 2.0": ("x ** 2.0", "pow(x, y), or x * x"),
    "y = n << n": ("n << n", "from 0 to 31"),
    "y = n >> 32": ("n >> 32", "from 0 to 31"),
    "y = x & 1": ("x & 1", "does not apply to float and int"),
    "y = True + 1": ("True + 1", "does not apply to bool and int"),
    "y = p.v + p.v.xy": ("p.v + p.v.xy", "does not apply to Vec3 and Vec2"),
    "y = p.v @ p.v": ("p.v @ p.v", "does not apply to Vec3 and Vec3"),
    "y = +x": ("+x", "write `-x`"),
    "y = ~n": ("~n", "write `-x`"),
    "y = -True": ("-True", "write `-x`"),
    "y = not x": ("x", "is bool, not float"),
    "y = x and True": ("x", "a condition is bool, not float"),
    "if n:\n        y = 1.0": ("n", "a condition is bool, not int"),
    "while x:\n        y = 1.0": ("x", "a condition is bool, not float"),
    "y = 1.0 if x else 2.0": ("x", "a condition is bool, not float"),
    "y = 1.0 if x > 0.0 else 2": ("2", "the other value is float, not int"),
    "y = x < 1": ("x < 1", "compare two floats or two ints, not float and int"),
    "y = p.v == p.v": ("p.v == p.v", "compare two floats or two ints"),
    "y = x is x": ("x is x", "compare"),
    "y = x in p": ("x in p", "compare"),
    "y = True < False": ("True < False", "compare"),
    "y = 2147483648": ("2147483648", "an int has 32 bits"),
    "y = 1e39": ("1e39", "a float has 32 bits"),
    "y = p.w": ("p.w", "Point has no field w"),
    "y = p.v.w": ("p.v.w", "Vec3 has no field w"),
    "y = p.v.xg": ("p.v.xg", "Vec3 has no field xg"),
    "y = x.x": ("x.x", "float has no field x"),
    "y = p.v[0]": ("p.v[0]", "only a Buffer can be indexed"),
    # calls
    "y = half(x, x)": ("half(x, x)", "half takes (x); pass these"),
    "y = half()": ("half()", "needs an argument for x"),
    "y = half(n)": ("n", "x is float, not int; write 1.0 for 1, or float(…)"),
    "y = half(y=x)": ("y=x", "no parameter y"),
    "y = half(x, x=x)": ("x=x", "the parameter x has an argument already; remove one"),
    "y = half(*p.v)": ("half(*p.v)", "half takes (x)"),
    "y = sin(n)": ("sin(n)", "sin takes (float), not (int)"),
    "y = sin(x, x)": ("sin(x, x)", "sin takes (float), not (float, float)"),
    "y = sqrt(n)": ("sqrt(n)", "1 floats or float vectors"),
    "y = min(x, n)": ("min(x, n)", "two floats or two ints"),
    "y = min(p.v, p.v)": ("min(p.v, p.v)", "minimum and maximum take vectors"),
    "y = dot(p.v, p.v.xy)": ("dot(p.v, p.v.xy)", "2 float vectors of one size"),
    "y = clamp(x, low=0.0, high=1.0)": ("clamp(x, low=0.0, high=1.0)", "by position"),
    "y = abs(p.v)": ("abs(p.v)", "one number"),
    "y = len(p)": ("len(p)", "a Buffer"),
    "y = Vec3(x, x)": ("Vec3(x, x)", "a Vec3 from (float, float)"),
    "y = Vec3(1, 2, 3)": ("Vec3(1, 2, 3)", "from (int, int, int)"),
    "y = Vec2(p.v)": ("Vec2(p.v)", "a Vec2 from (Vec3)"),
    "y = IVec2(x)": ("IVec2(x)", "IVec2 from (float)"),
    "y = Mat3(x, x, x)": ("Mat3(x, x, x)", "a Mat3 from (float, float, float)"),
    "y = Point(x)": ("Point(x)", "Point needs a value for v"),
    "y = Point(x, p.v, 2.0)": ("2.0", "Point.n is int, not float"),
    "y = Point(x, p.v, n, n)": ("Point(x, p.v, n, n)", "Point takes (x, v, n); pass these"),
    # loops
    "while x > 0.0:\n        y = x": ("x > 0.0", "may not terminate; count in it"),
    "while True:\n        y = x": ("True", "not terminate"),
    "k = 0\n    while k < 9 or x > 0.0:\n        k += 1": ("k < 9 or x > 0.0", "not terminate"),
    "k = 0\n    while k < 9:\n        k -= 1": ("k < 9", "not terminate"),
    "k = 0\n    while k < 9:\n        if x > 0.0:\n            k += 1": ("k < 9", "not terminate"),
    "k = 0\n    while k < 9:\n        k += 1\n        k = k * 0": ("k < 9", "not terminate"),
    "k = 0\n    while k < 9:\n        if x > 0.0:\n            continue\n        k += 1": (
        "k < 9", "not terminate",
    ),
    "k = 0\n    m = 5\n    while k < m:\n        k += 1\n        m = m + 1": (
        "k < m", "not terminate",
    ),
    "k = 0\n    while k < 9:\n        k += 1\n    else:\n        y = x": ("while k < 9:",
    "cannot have an `else`"),
    "for k in range(3):\n        k = 5": ("k = 5", "counter cannot be assigned to"),
    "for k in range(3):\n        pass\n    else:\n        y = x": (
        "for k in range(3):", "without `else`",
    ),
    "for k in p.v:\n        pass": ("for k in p.v:", "range(…)"),
    "for k, m in range(3):\n        pass": ("for k, m in range(3):", "range(…)"),
    "for k in range(x):\n        pass": ("x", "a bound of range is int, not float"),
    "for k in range(5, 0, -1):\n        pass": ("range(5, 0, -1)", "positive literal"),
    "for k in range(0, 5, n):\n        pass": ("range(0, 5, n)", "positive literal"),
    "for k in range():\n        pass": ("range()", "range takes (stop)"),
    "for k in range(1, 2, 3, 4):\n        pass": ("range(1, 2, 3, 4)", "range takes"),
    "for n in range(3):\n        pass": ("n", "n is already a variable"),
    "for k in range(3):\n        for k in range(2):\n            pass": (
        "k", "k is already a variable",
    ),
    "for k in range(3):\n        pass\n    y = k": ("k", "k is assigned in this shader"),
    # values on every path
    "if x > 0.0:\n        y = x\n    z = y": ("y", "y may be unassigned here"),
    "for k in range(n):\n        y = x\n    z = y": ("y", "may be unassigned"),
    "z = y\n    y = x": ("y", "y is assigned in this shader"),
    "HALF = HALF": ("HALF", "HALF is assigned in this shader"),
    "sqrt = sqrt(x)": ("sqrt", "sqrt is assigned in this shader"),
    "return x\n    y = x": ("y = x", "unreachable statement"),
    "for k in range(3):\n        break\n        y = x": ("y = x", "unreachable statement"),
    "if x > 0.0:\n        return x\n    else:\n        return n": ("n",
    "the result is float"),
    "return n": ("n", "the result is float, not int"),
    "return p": ("p", "the result is float, not Point"),
}  # fmt: skip
"""By the first statements of a shader: the marked text, and a part of the message."""


def refusal_of(module) -> str:
    """The message of the error, after checks of its excerpt."""
    with pytest.raises(ShaderError) as caught:
        analyse(module.wrong)
    refusal = refusal_in(caught.value)
    assert refusal.file == module.__file__
    return refusal.message


@pytest.mark.parametrize(
    ("body", "excerpt"),
    [
        ("    y = '×' if x > 0.0 else [x]", ["    y = '×' if x > 0.0 else [x]", "        ^^^"]),
        (
            "    y = x if '×' == 'x' else [x]",
            ["    y = x if '×' == 'x' else [x]", " " * 29 + "^^^"],
        ),
        ("\tif x > 0.0:\n\t\ty =\tn / 2", ["    y =\tn / 2", "       \t^^^^^"]),
        (
            "    y = half(\n        n,\n    ) + half(\n        x\n    )",
            ["    n,", "    ^"],
        ),
        ("    y = [\n        x,\n    ]", ["    y = [", "        ^"]),
    ],
)
def test_carets_are_under_the_text(folder, body, excerpt):
    """After characters of several bytes, after tabs, and in expressions of several lines."""
    head = "@shader\ndef wrong(x: float, n: int) -> float:\n"
    indent = body[: len(body) - len(body.lstrip())]
    module = write_module(folder, f"{BEFORE}{head}{body}\n{indent}return x\n")
    with pytest.raises(ShaderError) as caught:
        analyse(module.wrong)
    assert caught.value.excerpt.split("\n") == excerpt


ADVICE = re.compile("; |takes |^(define|loop|pass|return|write) ")
"""What every message has: an instruction, or what there is to choose from."""


@pytest.mark.parametrize("body", BODIES)
def test_refused_in_a_body(folder, body):
    offending, advice = BODIES[body]
    head = "@shader\ndef wrong(x: float, n: int, p: Point) -> float:\n    "
    module = write_module(folder, f"{BEFORE}{head}{body}\n    return x\n")
    with pytest.raises(ShaderError) as caught:
        analyse(module.wrong)
    refusal = refusal_in(caught.value)
    assert refusal.marked == offending
    assert advice in refusal.message
    assert ADVICE.search(refusal.message), refusal.message


HEADS = {
    "def wrong(x) -> float:": ("parameter x of wrong has no type; annotate it", "return x"),
    "def wrong(x: float):": ("the result of wrong has no type; annotate it", "return x"),
    "def wrong(x: list) -> float:": ("list is not a type", "return 1.0"),
    "def wrong(x: 'Unheard') -> float:": ("an annotation of wrong fails", "return 1.0"),
    "def wrong(x: str) -> float:": ("str is not a type", "return 1.0"),
    "def wrong(f: HeightField) -> HeightField:": ("HeightField is not a type", "return f"),
    "def wrong(b: Buffer[float]) -> int:": ("is not a type", "return len(b)"),
    "def wrong(*x: float) -> float:": ("write plain parameters", "return 1.0"),
    "def wrong(x: float, *, y: float) -> float:": ("write plain parameters", "return x"),
    "def wrong(x: float, /) -> float:": ("write plain parameters", "return x"),
    "def wrong(größe: float) -> float:": ("not ASCII", "return größe"),
    "def wrong(x: float) -> float: # no result": ("can end without a result", "y = x"),
    "def wrong(x: float) -> float: # half of one": (
        "can end without a result", "if x > 0.0:\n        return x",
    ),
    "def wrong(x: float) -> float: # in a loop": (
        "can end without a result", "for k in range(3):\n        return x",
    ),
    "def wrong(x: Odd) -> float:": ("list is not a type", "return 1.0"),
    "def wrong(x: Holding) -> float:": ("HeightField is not a type", "return 1.0"),
    "async def wrong(x: float) -> float:": ("a plain `def`", "return x"),
    "def wrong(f: HeightField, g: HeightField) -> int:": (
        "a texture or buffer can be selected only", "return levels(f if True else g)",
    ),
    "def wrong(f: HeightField) -> int:": ("cannot be assigned", "g = f\n    return levels(g)"),
    "def wrong(f: Texture) -> Vec4:": ("takes (HeightField, IVec2, int)",
                                       "return corners(f, IVec2(0, 0), 0)"),
}  # fmt: skip


@pytest.mark.parametrize("head", HEADS)
def test_refused_by_the_signature(folder, head):
    advice, body = HEADS[head]
    records = """
@struct
class Odd:
    items: list

@struct
class Holding:
    field: HeightField

"""
    module = write_module(folder, f"{BEFORE}{records}@shader\n{head}\n    {body}\n")
    assert advice in refusal_of(module)


def test_recursion(folder):
    module = write_module(
        folder,
        """
@shader
def odd(n: int) -> bool:
    return even(n - 1)

@shader
def even(n: int) -> bool:
    return odd(n - 1)

wrong = even
""",
    )
    assert "even calls itself; write a bounded loop" in refusal_of(module)


def test_an_unbound_slot(folder):
    module = write_module(
        folder,
        BEFORE
        + """
@struct
class Result:
    x: float

@shader
def entry(pixel: IVec2) -> Result:
    return Result(chosen(1.0))

@shader
def of_two(x: float, y: float) -> float:
    return x

@shader
def of_ints(x: int) -> float:
    return 1.0

@shader
def no_pixel(x: float) -> Result:
    return Result(x)

@shader
def no_record(pixel: IVec2) -> float:
    return 1.0
""",
    )
    with pytest.raises(ShaderError, match="the slot chosen is not bound"):
        _ = Program(module.entry).module
    with pytest.raises(ShaderError, match="the slot chosen is not bound"):
        _ = Program(module.entry).key
    with pytest.raises(ShaderError, match=r"the slot chosen is not bound; use `with bound"):
        module.entry((0, 0))
    for wrong in (module.of_two, module.of_ints):
        with pytest.raises(ShaderError) as caught:
            _ = Program(module.entry, {module.chosen: wrong}).module
        text = str(caught.value)
        assert f"{wrong.name}(" in text
        assert "does not fit the slot chosen; its signature is (x: float) -> float" in text
    for wrong in (module.no_pixel, module.no_record):
        with pytest.raises(ShaderError, match="must take a pixel: IVec2 first and return a record"):
            Program(wrong)


def test_source_that_is_not_available():
    scope: dict = {}
    text = "from basrelief.lang import *\n@shader\ndef f(x: float) -> float:\n    return x\n"
    exec(text, scope)
    with pytest.raises(ShaderError, match="write shaders in a file or a notebook cell"):
        analyse(scope["f"])


def test_a_cell_of_a_notebook_may_await_something(monkeypatch):
    text = (
        "import asyncio\nfrom basrelief.lang import *\nawait asyncio.sleep(0)\n"
        "@shader\ndef f(x: float) -> float:\n    return x\n"
    )
    scope: dict = {}
    cell = compile(text, "<cell 1>", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    monkeypatch.setitem(linecache.cache, "<cell 1>", (len(text), None, text.splitlines(True), ""))
    asyncio.run(eval(cell, scope))
    assert analyse(scope["f"]).entry.name == "f"


def test_a_number_that_is_too_large_in_plain_python_too(folder):
    module = write_module(
        folder,
        """
@shader
def wrong(n: int) -> int:
    return n + 4294967296
""",
    )
    with pytest.raises(ShaderError, match="an int has 32 bits") as caught:
        module.wrong(1)
    assert refusal_in(caught.value).marked == "4294967296"


@pytest.mark.parametrize("now", ["x + 2.0", "x * 3.0"])
def test_a_file_that_changed_since_it_was_loaded_is_refused(folder, now):
    """Otherwise the new code would be cached under the key of the old."""
    module = write_module(folder, "@shader\ndef f(x: float) -> float:\n    return x * 2.0\n")
    path = Path(module.__file__)
    path.write_text(path.read_text().replace("x * 2.0", now))
    linecache.checkcache(str(path))
    with pytest.raises(ShaderError, match="has changed since it was loaded"):
        analyse(module.f)
