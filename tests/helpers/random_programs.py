"""Random programs of the shader subset, as source text.

A program is an entry, a few functions it calls, and every kind of statement: assignments in
branches, loops with `break`, `continue` and early returns. The results are meaningless; plain
Python and compiled code only have to agree on them.
"""

from __future__ import annotations

import random

RECORDS = """
@struct
class Input:
    a: float
    b: float
    i: int
    j: int
    p: bool


@struct
class Pair:
    v: Vec3
    n: int


@struct
class Result:
    x: float
    n: int
    q: bool
    v: Vec3
    w: Vec2
    g: IVec2
    pair: Pair
"""

TYPES = ("float", "int", "bool", "Vec2", "Vec3", "IVec2", "Pair")
_FLOATS = ("0.0", "1.0", "0.5", "-2.5", "3.25", "0.1", "16.0")
_INTS = ("0", "1", "2", "3", "5", "-1", "-4", "100", "65537")


class Writer:
    """Writer of one program, determined by its seed."""

    def __init__(self, seed: int, size: int = 6, *, exact: bool = False) -> None:
        self.random = random.Random(seed)
        self.size = size
        # an exact program computes with ints alone, on which all engines agree to the last bit
        self.exact = exact
        self.types = ("int", "int", "IVec2", "bool") if exact else TYPES
        self.parameter_types = self.types[:3] if exact else TYPES
        self.lines: list[str] = []
        self.functions: list[tuple[str, list[str], str]] = []
        self.fresh = 0

    def program(self) -> str:
        for number in range(self.random.randint(1, 3)):
            parameters = [
                self.random.choice(self.parameter_types) for _ in range(self.random.randint(1, 3))
            ]
            self.function(f"part_{number}", parameters, self.random.choice(self.types))
        self.function("whole", ["float", "float", "int", "int", "bool"], "Result", self.size)
        flag = "g.p"
        if self.exact:
            flag = "g.i < g.j"
        self.lines += [
            "@shader",
            "def entry(pixel: IVec2, items: Buffer[Input]) -> Result:",
            "    g = items[pixel.x]",
            f"    return whole(g.a, g.b, g.i, g.j, {flag})",
        ]
        records = RECORDS.replace("    p: bool\n", "") if self.exact else RECORDS
        return records + "\n".join(self.lines) + "\n"

    def name(self, prefix: str) -> str:
        self.fresh += 1
        return f"{prefix}{self.fresh}"

    def function(self, name: str, parameters: list[str], result: str, size: int = 5) -> None:
        names = [self.name("p") for _ in parameters]
        signature = ", ".join(f"{n}: {t}" for n, t in zip(names, parameters, strict=True))
        self.lines += ["@shader", f"def {name}({signature}) -> {result}:"]
        self.result = result
        self.readable = dict(zip(names, parameters, strict=True))
        self.fixed = set(names)
        self.depth, self.loops, self.rounds = 1, 0, 1
        self.block(size)
        self.emit(f"return {self.expression(result, 2)}")
        self.lines += ["", ""]
        if name != "whole":
            self.functions.append((name, parameters, result))

    def emit(self, line: str) -> None:
        self.lines.append("    " * self.depth + line)

    # --- statements -----------------------------------------------------------------------------

    def block(self, size: int) -> bool:
        """Write statements; returns whether the block always leaves at its end."""
        for _ in range(self.random.randint(1, size)):
            self.statement(size)
        return False

    def statement(self, size: int) -> None:
        kinds = ["assign"] * 5
        if self.depth < 5:
            kinds += ["if"] * 4
            if self.rounds < 60:
                kinds += ["for", "for", "while"]
        getattr(self, f"write_{self.random.choice(kinds)}")(size)

    def write_assign(self, _: int) -> None:
        changeable = [n for n in self.readable if n not in self.fixed]
        if changeable and self.random.random() < 0.6:
            name = self.random.choice(changeable)
            t = self.readable[name]
            if t in ("float", "int", "Vec2", "Vec3") and self.random.random() < 0.3:
                self.emit(f"{name} {self.random.choice('+-*')}= {self.expression(t, 2)}")
                return
        else:
            name, t = self.name("v"), self.random.choice(self.types)
        self.emit(f"{name} = {self.expression(t, 3)}")
        self.readable[name] = t

    def write_if(self, size: int) -> None:
        before = dict(self.readable)
        # a variable that every branch sets and that is used afterwards
        shared = self.name("s") if self.random.random() < 0.5 else None
        kind = self.random.choice(self.types)
        after: list[dict[str, str]] = []
        words = ["if"] + ["elif"] * self.random.choice((0, 0, 1)) + ["else"]
        if shared is None and self.random.random() < 0.4:
            words.pop()
            after.append(before)
        for word in words:
            self.readable = dict(before)
            test = "" if word == "else" else f" {self.expression('bool', 2)}"
            self.emit(f"{word}{test}:")
            if not self.inner(size - 2, shared, kind):
                after.append(self.readable)
        self.readable = {n: t for n, t in before.items() if all(n in found for found in after)}
        if not after:
            # every branch leaves, so that nothing may follow: let one path through
            self.lines[-1] = self.lines[-1][: self.indent_of(self.lines[-1])] + "pass"
        elif shared and all(shared in found for found in after):
            self.readable[shared] = kind

    def indent_of(self, line: str) -> int:
        return len(line) - len(line.lstrip())

    def inner(self, size: int, shared: str | None = None, kind: str = "float") -> bool:
        """Write an indented block; returns whether its last statement leaves it."""
        self.depth += 1
        if shared:
            self.emit(f"{shared} = {self.expression(kind, 2)}")
            self.readable[shared] = kind
        if self.random.random() < 0.8 or not shared:
            self.block(max(1, size))
        leaves = self.random.random() < 0.22
        if leaves:
            keywords = ["return"] + (["break", "continue"] * 2 if self.loops else [])
            keyword = self.random.choice(keywords)
            self.emit(
                f"return {self.expression(self.result, 2)}" if keyword == "return" else keyword
            )
        self.depth -= 1
        return leaves

    def write_for(self, size: int) -> None:
        counter = self.random.choice(("k", "m", self.name("k")))
        if counter in self.readable:
            counter = self.name("k")
        start = self.random.choice(("", "", "0, ", "-2, ", f"{self.clamped('int', 4)}, "))
        stop = self.random.choice(("3", "5", self.clamped("int", 5), self.clamped("int", 5)))
        step = self.random.choice(("", "", ", 2", ", 3")) if start else ""
        before = dict(self.readable)
        self.emit(f"for {counter} in range({start}{stop}{step}):")
        self.readable[counter] = "int"
        self.fixed.add(counter)
        self.loop_body(size, 6)
        self.fixed.discard(counter)
        self.readable = before

    def write_while(self, size: int) -> None:
        counter, end = self.name("c"), self.name("e")
        self.emit(f"{end} = {self.clamped('int', 4)}")
        self.emit(f"{counter} = 0")
        self.fixed |= {counter, end}
        self.readable |= {counter: "int", end: "int"}
        before = dict(self.readable)
        also = f" and {self.expression('bool', 1)}" if self.random.random() < 0.5 else ""
        self.emit(f"while {counter} < {end}{also}:")
        start = len(self.lines)
        self.loop_body(size, 4)
        # `continue` would skip the counting
        self.lines[start:] = [
            line.replace("continue", "break") if line.strip() == "continue" else line
            for line in self.lines[start:]
        ]
        self.depth += 1
        self.emit(f"{counter} = {counter} + 1")
        self.depth -= 1
        self.readable = before

    def loop_body(self, size: int, rounds: int) -> None:
        self.loops += 1
        self.rounds *= rounds
        self.depth += 1
        self.block(max(1, size - 2))
        self.depth -= 1
        self.rounds //= rounds
        self.loops -= 1

    def clamped(self, t: str, limit: int) -> str:
        """An int of −limit … limit."""
        return f"min(max({self.expression(t, 1)}, -{limit}), {limit})"

    # --- expressions ----------------------------------------------------------------------------

    def expression(self, t: str, depth: int) -> str:
        choices = [n for n, kind in self.readable.items() if kind == t]
        if self.exact and t == "float":
            choices = []
        if choices and self.random.random() < (0.75 if depth <= 0 else 0.25):
            return self.random.choice(choices)
        if depth <= 0 or (self.exact and t in ("float", "Vec2", "Vec3", "Pair")):
            return self.leaf(t)
        calls = [f for f in self.functions if f[2] == t]
        if calls and self.random.random() < 0.3 and self.rounds < 30:
            name, parameters, _ = self.random.choice(calls)
            return f"{name}({', '.join(self.expression(p, depth - 1) for p in parameters)})"
        if self.random.random() < 0.12 and not (self.exact and t == "Result"):
            test = self.expression("bool", depth - 1)
            return (
                f"({self.expression(t, depth - 1)} if {test} else {self.expression(t, depth - 1)})"
            )
        return getattr(self, f"of_{t}")(lambda kind=t: self.expression(kind, depth - 1))

    def leaf(self, t: str) -> str:
        pick = self.random.choice
        match t:
            case "float":
                return pick(_FLOATS)
            case "int":
                return pick(_INTS[:7] if self.exact else _INTS)
            case "bool":
                return pick(("True", "False"))
            case "Vec2":
                return f"Vec2({pick(_FLOATS)}, {pick(_FLOATS)})"
            case "Vec3":
                return f"Vec3({pick(_FLOATS)})"
            case "IVec2":
                return f"IVec2({pick(_INTS)}, {pick(_INTS)})"
            case "Pair":
                return f"Pair(Vec3({pick(_FLOATS)}), {pick(_INTS)})"
        return self.of_Result(lambda kind: self.leaf(kind))

    def of_float(self, e) -> str:
        return self.random.choice((
            lambda: f"({e()} + {e()})", lambda: f"({e()} - {e()})", lambda: f"({e()} * {e()})",
            lambda: f"({e()} / {e()})", lambda: f"(-{e()})", lambda: f"abs({e()})",
            lambda: f"min({e()}, {e()})", lambda: f"max({e()}, {e()})", lambda: f"sqrt(abs({e()}))",
            lambda: f"floor({e()})", lambda: f"fract({e()})", lambda: f"clamp({e()}, -1.0, {e()})",
            lambda: f"mix({e()}, {e()}, 0.25)", lambda: f"float({e('int')})",
            lambda: f"float({e('bool')})", lambda: f"{e('Vec3')}.z", lambda: f"{e('Vec2')}.y",
            lambda: f"dot({e('Vec3')}, {e('Vec3')})", lambda: f"length({e('Vec2')})",
            lambda: f"sin(min(9.0, max(-9.0, {e()})))", lambda: f"exp2(min(9.0, {e()}))",
            lambda: f"{e('Pair')}.v.x", lambda: f"smoothstep(-1.0, 2.0, {e()})",
            lambda: f"log2(max(0.5, min(99.0, {e()})))", lambda: f"atan({e()})",
        ))()  # fmt: skip

    def of_int(self, e) -> str:
        return self.random.choice((
            lambda: f"({e()} + {e()})", lambda: f"({e()} - {e()})", lambda: f"({e()} * {e()})",
            lambda: f"({e()} // {e()})", lambda: f"({e()} % {e()})", lambda: f"({e()} & {e()})",
            lambda: f"({e()} | {e()})", lambda: f"({e()} ^ {e()})", lambda: f"({e()} >> 3)",
            lambda: f"({e()} << 2)", lambda: f"(-{e()})", lambda: f"abs({e()})",
            lambda: f"min({e()}, {e()})", lambda: f"max({e()}, {e()})",
            lambda: f"int({e('float')})",
            lambda: f"int({e('bool')})", lambda: f"{e('IVec2')}.x", lambda: f"{e('Pair')}.n",
        ))()  # fmt: skip

    def of_bool(self, e) -> str:
        order = self.random.choice(("<", "<=", ">", ">=", "==", "!="))
        return self.random.choice((
            lambda: f"({e('float')} {order} {e('float')})",
            lambda: f"({e('int')} {order} {e('int')})",
            lambda: f"({e('float')} < {e('float')} <= {e('float')})", lambda: f"(not {e()})",
            lambda: f"({e()} and {e()})", lambda: f"({e()} or {e()})", lambda: f"({e()} == {e()})",
        ))()  # fmt: skip

    def of_Vec2(self, e) -> str:  # noqa: N802
        return self.random.choice((
            lambda: f"({e()} + {e()})", lambda: f"({e()} * {e('float')})",
            lambda: f"{e('Vec3')}.zx",
            lambda: f"Vec2({e('float')}, {e('float')})", lambda: f"{e()}.yx", lambda: f"(-{e()})",
            lambda: f"minimum({e()}, {e('float')})", lambda: f"({e()} / {e()})",
        ))()  # fmt: skip

    def of_Vec3(self, e) -> str:  # noqa: N802
        return self.random.choice((
            lambda: f"({e()} - {e()})", lambda: f"({e('float')} * {e()})", lambda: f"{e()}.yzx",
            lambda: f"Vec3({e('Vec2')}, {e('float')})", lambda: f"cross({e()}, {e()})",
            lambda: f"Vec3({e('float')})", lambda: f"saturate({e()})", lambda: f"{e('Pair')}.v",
            lambda: f"mix({e()}, {e()}, {e('float')})", lambda: f"normalize({e()})",
            lambda: f"(Mat3({e()}, {e()}, {e()}) @ {e()})", lambda: f"reflect({e()}, {e()})",
        ))()  # fmt: skip

    def of_IVec2(self, e) -> str:  # noqa: N802
        return self.random.choice((
            lambda: f"IVec2({e('int')}, {e('int')})", lambda: f"({e()} + {e()})",
            lambda: f"({e()} * {e('int')})", lambda: f"{e()}.yx", lambda: f"({e('int')} - {e()})",
        ))()  # fmt: skip

    def of_Pair(self, e) -> str:  # noqa: N802
        return f"Pair({e('Vec3')}, {e('int')})"

    def of_Result(self, e) -> str:  # noqa: N802
        parts = ("float", "int", "bool", "Vec3", "Vec2", "IVec2", "Pair")
        return f"Result({', '.join(e(t) for t in parts)})"
