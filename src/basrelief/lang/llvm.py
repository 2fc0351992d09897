"""LLVM IR printer of the typed tree: one SIMD lane for each pixel.

Each scalar of the subset is a vector of L lanes, a Vec3 three of them. A mask holds the active
lanes: `if` narrows it and skips a block that no lane enters; loops run until it is empty; `break`,
`continue` and an early `return` remove lanes; assignments to variables of outer blocks are selects
under it. After M. Pharr and W. R. Mark, ispc: A SPMD Compiler for
High-Performance CPU Programming, 2012.

No fast-math and no contraction: every lane computes the same bits as the shader in plain Python,
for any number of lanes.

The compiled entry is `void run.rows(uniforms, resources, planes, plane_stride, row_stride, width,
first_row, last_row)`; the end of this module describes the memory layout, and `layout.py` that of
resources.
"""

from __future__ import annotations

import functools
import struct as binary
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from basrelief.lang import tree
from basrelief.lang.elementary import ELEMENTARY
from basrelief.lang.frontend import written_functions
from basrelief.lang.intrinsics import INTRINSICS, Written
from basrelief.lang.layout import HeaderWord
from basrelief.lang.resources import is_handle
from basrelief.lang.types import SCALARS, VECTORS, ShaderError, fields_of, leaves
from basrelief.lang.values import Mat3

Leaves = list[str]
"""The scalars of a value in the order of `types.leaves`, each an SSA name or constant."""

_MAX_BRANCHLESS_COST = 14
"""Operations up to which a branch is computed by all lanes instead of skipped."""

_FLOAT_COMPARE = {"<": "olt", "<=": "ole", ">": "ogt", ">=": "oge", "==": "oeq", "!=": "une"}
_INT_COMPARE = {"<": "slt", "<=": "sle", ">": "sgt", ">=": "sge", "==": "eq", "!=": "ne"}
_FLOAT_OPERATION = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}
_INT_OPERATION = {
    "+": "add", "-": "sub", "*": "mul", "&": "and", "|": "or", "^": "xor", "<<": "shl",
    ">>": "ashr",
}  # fmt: skip


def print_llvm(module: tree.Module, lanes: int) -> str:
    """LLVM IR of a program, with vectors of `lanes`."""
    out = _ModuleState(lanes)
    text = [_FunctionPrinter(out, function).text() for function in module.functions]
    printed: set[str] = set()
    while out.written - printed:
        for name in sorted(out.written - printed):
            printed.add(name)
            text.append(_FunctionPrinter(out, written_functions()[name], _MATH).text())
    text.append(_EntryPrinter(out, module.entry).text())
    return "\n".join([*sorted(out.declarations), "", *text, "!0 = !{}", ""])


_MATH = "math."


class _ModuleState:
    """State that all functions of a module share: lanes, declarations, type names."""

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        self.declarations: set[str] = set()
        self.written: set[str] = set()
        """Names of the functions of `written_functions` that are called."""
        self.names = {
            float: f"<{lanes} x float>",
            int: f"<{lanes} x i32>",
            bool: f"<{lanes} x i1>",
        }

    def constant(self, value: Any, t: type) -> str:
        """A literal in every lane."""
        if t is float:
            bits: int = binary.unpack(">Q", binary.pack(">d", float(np.float32(value))))[0]
            scalar = f"float 0x{bits:016X}"
        elif t is int:
            scalar = f"i32 {int(value)}"
        else:
            scalar = f"i1 {'true' if value else 'false'}"
        return "<" + ", ".join([scalar] * self.lanes) + ">"

    def vector(self, t: Any) -> list[str]:
        """LLVM types of the scalars of t."""
        return [self.names[leaf] for _, leaf in leaves(t)]

    def result(self, t: Any) -> str:
        """LLVM return type of a function with a result of type t."""
        parts = self.vector(t)
        return parts[0] if len(parts) == 1 else "{" + ", ".join(parts) + "}"


class _InstructionPrinter:
    """Appends instructions, with fresh names for their results."""

    def __init__(self, out: _ModuleState) -> None:
        self.out = out
        self.lines: list[str] = []
        self.entry_lines: list[str] = []
        self.count = 0

    def emit(self, line: str) -> None:
        self.lines.append("  " + line)

    def fresh(self, hint: str) -> str:
        self.count += 1
        return f"{hint}.{self.count}"

    def define(self, instruction: str, hint: str = "v") -> str:
        name = f"%{self.fresh(hint)}"
        self.emit(f"{name} = {instruction}")
        return name

    def label(self, name: str) -> None:
        self.lines.append(f"{name}:")

    def variable(self, t: type, hint: str) -> str:
        name = f"%{self.fresh(hint)}"
        self.entry_lines.append(f"  {name} = alloca {self.out.names[t]}")
        return name

    def load(self, pointer: str, t: type) -> str:
        return self.define(f"load {self.out.names[t]}, ptr {pointer}")

    def store(self, value: str, pointer: str, t: type) -> None:
        self.emit(f"store {self.out.names[t]} {value}, ptr {pointer}")

    def operation(self, name: str, a: str, b: str, t: type) -> str:
        return self.define(f"{name} {self.out.names[t]} {a}, {b}")

    def integer(self, name: str, a: str, b: str | int) -> str:
        right = b if isinstance(b, str) else self.out.constant(b, int)
        return self.operation(name, a, right, int)

    def and_masks(self, a: str, b: str) -> str:
        return self.operation("and", a, b, bool)

    def not_mask(self, mask: str) -> str:
        return self.operation("xor", mask, self.out.constant(True, bool), bool)

    def compare(self, symbol: str, a: str, b: str, t: type) -> str:
        if t is float:
            return self.define(f"fcmp {_FLOAT_COMPARE[symbol]} {self.out.names[float]} {a}, {b}")
        return self.define(f"icmp {_INT_COMPARE[symbol]} {self.out.names[t]} {a}, {b}")

    def select(self, test: str, a: str, b: str, t: type) -> str:
        names = self.out.names
        return self.define(f"select {names[bool]} {test}, {names[t]} {a}, {names[t]} {b}")

    def intrinsic(self, name: str, result: type, *arguments: tuple[str, type]) -> str:
        """Call an LLVM intrinsic on all lanes."""
        names = self.out.names
        types = [names[t] for _, t in arguments]
        self.out.declarations.add(f"declare {names[result]} @{name}({', '.join(types)})")
        passed = ", ".join(f"{names[t]} {a}" for a, t in arguments)
        return self.define(f"call {names[result]} @{name}({passed})")

    def lane_function(self, name: str, *arguments: str) -> str:
        suffix = f"v{self.out.lanes}f32"
        return self.intrinsic(f"{name}.{suffix}", float, *((a, float) for a in arguments))

    def to_int(self, x: str) -> str:
        """Conversion to int: truncated, clamped, NaN to 0; `llvm.fptosi.sat` is not vectorized."""
        floats, least, most = self.out.names[float], -(2.0**31), 2.0**31 - 128
        zero = "zeroinitializer"
        is_number = self.define(f"fcmp ord {floats} {x}, {zero}")
        clamped = self.select(is_number, x, zero, float)
        for symbol, end in (("<", least), (">", most)):
            bound = self.out.constant(end, float)
            clamped = self.select(
                self.compare(symbol, clamped, bound, float), bound, clamped, float
            )
        integer = self.define(f"fptosi {floats} {clamped} to {self.out.names[int]}")
        # no float lies between the largest one below 2³¹ and 2³¹
        too_large = self.compare(">", x, self.out.constant(most, float), float)
        return self.select(too_large, self.out.constant(2**31 - 1, int), integer, int)

    def to_float(self, x: str) -> str:
        return self.define(f"sitofp {self.out.names[int]} {x} to {self.out.names[float]}")

    def int_bound(self, which: str, value: str, bound: str | int) -> str:
        """Minimum (smin, umin) or maximum (smax) of two ints."""
        right = bound if isinstance(bound, str) else self.out.constant(bound, int)
        return self.intrinsic(f"llvm.{which}.v{self.out.lanes}i32", int, (value, int), (right, int))

    def splat(self, scalar: str, t: type) -> str:
        """Vector with the same scalar in every lane."""
        name, count = self.out.names[t], self.out.lanes
        kind = name.split(" x ")[1][:-1]
        first = self.define(f"insertelement {name} poison, {kind} {scalar}, i32 0")
        zeros = f"<{count} x i32> zeroinitializer"
        return self.define(f"shufflevector {name} {first}, {name} poison, {zeros}")

    def gather(self, base: str, index: str, kind: str, element: str | None = None) -> list[str]:
        """Load one scalar of LLVM type `kind` for each lane, from an array of `element`s."""
        result = []
        for lane in range(self.out.lanes):
            narrow = self.define(f"extractelement {self.out.names[int]} {index}, i32 {lane}")
            wide = self.define(f"zext i32 {narrow} to i64")
            pointer = self.define(f"getelementptr {element or kind}, ptr {base}, i64 {wide}")
            result.append(self.define(f"load {kind}, ptr {pointer}, align 4, !invariant.load !0"))
        return result

    def split_pairs(self, pairs: Sequence[str], kind: str) -> list[str]:
        """Split 64 bits in each lane: vectors of the lower and of the upper 32 bits."""
        lanes = self.out.lanes
        wide = self.vector_of(pairs, "i64")
        flat = self.define(f"bitcast <{lanes} x i64> {wide} to <{2 * lanes} x {kind}>")
        result = []
        for side in (0, 1):
            indices = ", ".join(f"i32 {2 * lane + side}" for lane in range(lanes))
            mask = f"<{lanes} x i32> <{indices}>"
            pair = f"<{2 * lanes} x {kind}>"
            result.append(self.define(f"shufflevector {pair} {flat}, {pair} poison, {mask}"))
        return result

    def vector_of(self, scalars: Sequence[str], kind: str) -> str:
        """Vector of one scalar for each lane."""
        vector = "poison"
        for lane, scalar in enumerate(scalars):
            name = f"<{self.out.lanes} x {kind}>"
            vector = self.define(f"insertelement {name} {vector}, {kind} {scalar}, i32 {lane}")
        return vector


class _FunctionPrinter(_InstructionPrinter):
    """Prints one function: statements under masks, expressions scalar by scalar."""

    def __init__(self, out: _ModuleState, function: tree.Function, prefix: str = "") -> None:
        super().__init__(out)
        self.function = function
        self.prefix = prefix
        self.pointers: dict[str, list[str]] = {}
        self.handles: dict[str, str] = {}
        self.counters: dict[str, str] = {}
        self.home: dict[str, tree.Block] = {}
        self.mask = self.variable(bool, "mask")
        self.returned = self.variable(bool, "returned")
        self.continued: list[str] = []
        self.results = [self.variable(leaf, "result") for _, leaf in leaves(function.result)]
        self.block = function.body

    # --- parameters and results ---------------------------------------------------------------

    def text(self) -> str:
        function, out = self.function, self.out
        # a name with a dot cannot clash with those of parameters and shaders
        parameters = [f"{out.names[bool]} %active.lanes"]
        self.store("%active.lanes", self.mask, bool)
        self.store("zeroinitializer", self.returned, bool)
        for name, t in function.parameters.items():
            if is_handle(t):
                self.handles[name] = f"%{name}"
                parameters.append(f"ptr noalias readonly %{name}")
                continue
            self.pointers[name] = []
            for path, leaf in leaves(t, name):
                parameters.append(f"{out.names[leaf]} %arg.{path}")
                pointer = self.variable(leaf, path)
                self.store(f"%arg.{path}", pointer, leaf)
                self.pointers[name].append(pointer)
        if self.early_returns:
            # lanes that never return hold zeros, not undefined values
            for pointer, (_, leaf) in zip(self.results, leaves(function.result), strict=True):
                self.store("zeroinitializer", pointer, leaf)
        self.body(function.body)
        self.return_results()
        doc = "".join(f"; {line}\n" for line in function.doc.splitlines())
        head = (
            f"define internal fastcc {out.result(function.result)} "
            f"@{self.prefix}{function.name}({', '.join(parameters)}) alwaysinline nounwind {{"
        )
        return doc + "\n".join([head, *self.entry_lines, *self.lines, "}", ""])

    def return_results(self) -> None:
        kinds = [leaf for _, leaf in leaves(self.function.result)]
        values = [self.load(p, t) for p, t in zip(self.results, kinds, strict=True)]
        aggregate = self.out.result(self.function.result)
        if len(values) == 1:
            self.emit(f"ret {aggregate} {values[0]}")
            return
        result = "poison"
        for index, (value, t) in enumerate(zip(values, kinds, strict=True)):
            result = self.define(
                f"insertvalue {aggregate} {result}, {self.out.names[t]} {value}, {index}"
            )
        self.emit(f"ret {aggregate} {result}")

    # --- control --------------------------------------------------------------------------------

    def active(self) -> str:
        return self.load(self.mask, bool)

    def any(self, mask: str) -> str:
        lanes = self.out.lanes
        bits = self.define(f"bitcast {self.out.names[bool]} {mask} to i{lanes}")
        return self.define(f"icmp ne i{lanes} {bits}, 0")

    def branch(self, condition: str, yes: str, no: str) -> None:
        self.emit(f"br i1 {condition}, label %{yes}, label %{no}")

    def jump(self, target: str) -> None:
        self.emit(f"br label %{target}")

    def body(self, block: tree.Block) -> None:
        """Statements of a block; its hoisted variables start at zero."""
        outer, self.block = self.block, block
        for name, t in block.hoisted.items():
            self.declare(name, t)
            for pointer, (_, leaf) in zip(self.pointers[name], leaves(t), strict=True):
                self.store("zeroinitializer", pointer, leaf)
        self.statements(block.statements)
        self.block = outer

    def statements(self, statements: Sequence[tree.Statement]) -> None:
        for index, statement in enumerate(statements):
            self.statement(statement)
            if _may_deactivate_lanes(statement) and index + 1 < len(statements):
                rest, end = self.fresh("rest"), self.fresh("end")
                self.branch(self.any(self.active()), rest, end)
                self.label(rest)
                self.statements(statements[index + 1 :])
                self.jump(end)
                self.label(end)
                return

    def statement(self, statement: tree.Statement) -> None:
        for comment in statement.comments:
            self.emit(f"; {comment}")
        match statement:
            case tree.Assign():
                self.assign(statement)
            case tree.If():
                self.if_statement(statement)
            case tree.For():
                self.for_statement(statement)
            case tree.While():
                self.loop(lambda: self.value(statement.test)[0], statement.body, lambda: None)
            case tree.Return(value):
                self.return_statement(self.value(value))
            case tree.Break():
                self.store("zeroinitializer", self.mask, bool)
            case tree.Continue():
                waiting = self.load(self.continued[-1], bool)
                now = self.operation("or", waiting, self.active(), bool)
                self.store(now, self.continued[-1], bool)
                self.store("zeroinitializer", self.mask, bool)
            case _:
                raise AssertionError(statement)

    def return_statement(self, values: Leaves) -> None:
        mask = self.active()
        self.store_leaves(
            values, self.results, self.function.result, mask if self.early_returns else None
        )
        returned = self.operation("or", self.load(self.returned, bool), mask, bool)
        self.store(returned, self.returned, bool)
        self.store("zeroinitializer", self.mask, bool)

    def store_leaves(
        self, values: Leaves, pointers: Sequence[str], t: Any, mask: str | None
    ) -> None:
        """Store a value of type t, with a mask only in its lanes."""
        for pointer, value, (_, leaf) in zip(pointers, values, leaves(t), strict=True):
            if mask is not None:
                value = self.select(mask, value, self.load(pointer, leaf), leaf)
            self.store(value, pointer, leaf)

    @functools.cached_property
    def early_returns(self) -> bool:
        """Whether lanes may return before the last statement."""
        return any(map(_may_deactivate_lanes, self.function.body.statements))

    def if_statement(self, node: tree.If) -> None:
        before = self.active()
        test = self.value(node.test)[0]
        deactivates = _may_deactivate_lanes(node)
        after: list[str] = []
        for block, lanes in ((node.body, test), (node.otherwise, None)):
            if not block.statements and not deactivates:
                continue
            mask = self.and_masks(before, lanes or self.not_mask(test))
            self.store(mask, self.mask, bool)
            self.branch_body(block, mask)
            after.append(self.active())
        if deactivates:
            before = self.operation("or", after[0], after[1], bool)
        self.store(before, self.mask, bool)

    def branch_body(self, block: tree.Block, mask: str) -> None:
        if _cost(block) <= _MAX_BRANCHLESS_COST:
            self.body(block)
            return
        body_label, end_label = self.fresh("then"), self.fresh("past")
        self.branch(self.any(mask), body_label, end_label)
        self.label(body_label)
        self.body(block)
        self.jump(end_label)
        self.label(end_label)

    def for_statement(self, node: tree.For) -> None:
        start, stop = self.value(node.start)[0], self.value(node.stop)[0]
        if isinstance(node.start, tree.Literal):
            # the counter is the same in all lanes: keep one scalar
            counter = f"%{self.fresh(node.name)}"
            self.entry_lines.append(f"  {counter} = alloca i32")
            self.emit(f"store i32 {int(node.start.value)}, ptr {counter}")
            self.counters[node.name] = counter

            def step() -> None:
                now = self.define(f"load i32, ptr {counter}")
                then = self.increment(now, node.step, "i32", "i32")
                self.emit(f"store i32 {then}, ptr {counter}")
        else:
            pointer = self.variable(int, node.name)
            self.pointers[node.name] = [pointer]
            self.store(start, pointer, int)

            def step() -> None:
                now, kind = self.load(pointer, int), self.out.names[int]
                self.store(
                    self.increment(now, node.step, kind, f"v{self.out.lanes}i32"), pointer, int
                )

        here = tree.Local(int, node.name)
        self.loop(lambda: self.compare("<", self.value(here)[0], stop, int), node.body, step)
        self.counters.pop(node.name, None)

    def increment(self, now: str, step: int, kind: str, suffix: str) -> str:
        """Next value of a counter, saturated at the largest int."""
        added = str(step) if kind == "i32" else self.out.constant(step, int)
        if step == 1:
            return self.define(f"add {kind} {now}, {added}")
        name = f"llvm.sadd.sat.{suffix}"
        self.out.declarations.add(f"declare {kind} @{name}({kind}, {kind})")
        return self.define(f"call {kind} @{name}({kind} {now}, {kind} {added})")

    def loop(self, test: Any, block: tree.Block, step: Any) -> None:
        """Run a block while `test()` is true in any lane; `step()` ends each iteration."""
        before = self.active()
        header, body_label, end_label = self.fresh("loop"), self.fresh("body"), self.fresh("done")
        self.continued.append(self.variable(bool, "continued"))
        self.store("zeroinitializer", self.continued[-1], bool)
        self.jump(header)
        self.label(header)
        mask = self.and_masks(self.active(), test())
        self.store(mask, self.mask, bool)
        self.branch(self.any(mask), body_label, end_label)
        self.label(body_label)
        self.body(block)
        again = self.operation("or", self.active(), self.load(self.continued[-1], bool), bool)
        self.store(again, self.mask, bool)
        self.store("zeroinitializer", self.continued.pop(), bool)
        step()
        self.jump(header)
        self.label(end_label)
        if tree.contains(block, tree.Return):
            before = self.and_masks(before, self.not_mask(self.load(self.returned, bool)))
        self.store(before, self.mask, bool)

    def declare(self, name: str, t: Any) -> None:
        self.pointers[name] = [self.variable(leaf, path) for path, leaf in leaves(t, name)]
        self.home[name] = self.block

    def assign(self, node: tree.Assign) -> None:
        values = self.value(node.value)
        if node.declares:
            self.declare(node.name, node.value.type)
        own_block = self.home[node.name] is self.block
        mask = None if own_block else self.active()
        self.store_leaves(values, self.pointers[node.name], node.value.type, mask)

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: tree.Expression) -> Leaves:
        """Scalars of an expression."""
        match node:
            case tree.Literal(t, value):
                return [self.out.constant(value, t)]
            case tree.Local(t, name):
                return self.local(name, t)
            case tree.Unary(t, "not", operand):
                return [self.not_mask(self.value(operand)[0])]
            case tree.Unary(t, _, operand):
                return [self.negate(v, _component(t)) for v in self.value(operand)]
            case tree.Binary(t, "//", left, right):
                return self.call_written("floor_divide", t, (left, right))
            case tree.Binary(t, "%", left, right):
                return self.call_written("floor_modulo", t, (left, right))
            case tree.Binary():
                return self.binary(node)
            case tree.Compare(_, symbol, left, right):
                p, q = self.value(left)[0], self.value(right)[0]
                return [self.compare(symbol, p, q, left.type)]
            case tree.Logic(_, symbol, left, right):
                p, q = self.value(left)[0], self.value(right)[0]
                return [self.operation(symbol, p, q, bool)]
            case tree.Select(t, test, then, otherwise):
                condition, a, b = map(self.value, (test, then, otherwise))
                kinds = [leaf for _, leaf in leaves(t)]
                return [self.select(condition[0], *args) for args in zip(a, b, kinds, strict=True)]
            case tree.Swizzle(_, operand, indices):
                values = self.value(operand)
                if operand.type is Mat3:
                    return values[3 * indices[0] : 3 * indices[0] + 3]
                return [values[index] for index in indices]
            case tree.Member(_, operand, name):
                return self.member(operand, name)
            case tree.Construct(t, parts):
                values = [v for part in parts for v in self.value(part)]
                spread = t in VECTORS and len(values) == 1
                return values * VECTORS[t][1] if spread else values
            case tree.IntrinsicCall():
                return self.intrinsic_call(node)
            case tree.Call(t, function, arguments):
                if self.prefix:
                    return self.call_written(function.name, t, arguments)
                return self.call(function.name, t, arguments)
            case tree.Item(t, buffer, index):
                return self.item(t, buffer, self.value(index)[0])
        raise AssertionError(node)

    def local(self, name: str, t: Any) -> Leaves:
        if name in self.counters:
            return [self.splat(self.define(f"load i32, ptr {self.counters[name]}"), int)]
        kinds = [leaf for _, leaf in leaves(t)]
        return [self.load(p, leaf) for p, leaf in zip(self.pointers[name], kinds, strict=True)]

    def negate(self, value: str, t: type) -> str:
        if t is float:
            return self.define(f"fneg {self.out.names[float]} {value}")
        return self.operation("sub", "zeroinitializer", value, int)

    def member(self, operand: tree.Expression, name: str) -> Leaves:
        fields = [field for field, t in fields_of(operand.type).items() for _ in leaves(t)]
        values = zip(self.value(operand), fields, strict=True)
        return [value for value, field in values if field == name]

    def binary(self, node: tree.Binary) -> Leaves:
        a, b = self.value(node.left), self.value(node.right)
        if node.operator == "@":
            return self.transform(a, b)
        count = max(len(a), len(b))
        a, b = a * (count // len(a)), b * (count // len(b))
        t = _component(node.type)
        return [self.scalar_binary(node.operator, p, q, t) for p, q in zip(a, b, strict=True)]

    def scalar_binary(self, symbol: str, a: str, b: str, t: type) -> str:
        if t is float:
            return self.operation(_FLOAT_OPERATION[symbol], a, b, float)
        return self.operation(_INT_OPERATION[symbol], a, b, int)

    def transform(self, m: Leaves, v: Leaves) -> Leaves:
        """Matrix times vector; columns are added in order."""
        return [self.dot(m[row::3], v) for row in range(3)]

    def dot(self, a: Leaves, b: Leaves) -> str:
        """Dot product; products are added in order."""
        return self.sum([self.operation("fmul", x, y, float) for x, y in zip(a, b, strict=True)])

    def sum(self, terms: Leaves) -> str:
        return functools.reduce(lambda a, b: self.operation("fadd", a, b, float), terms)

    def call(self, name: str, t: Any, arguments: Sequence[tree.Expression]) -> Leaves:
        """Call a function of the module, with a result of type t, for the active lanes."""
        passed = [f"{self.out.names[bool]} {self.active()}"]
        for argument in arguments:
            if is_handle(argument.type):
                passed.append(f"ptr {self.handle(argument)}")
                continue
            values = self.value(argument)
            types = self.out.vector(argument.type)
            passed.extend(f"{t} {v}" for t, v in zip(types, values, strict=True))
        result = self.out.result(t)
        aggregate = self.define(f"call fastcc {result} @{name}({', '.join(passed)})")
        if _width(t) == 1:
            return [aggregate]
        return [
            self.define(f"extractvalue {result} {aggregate}, {index}") for index in range(_width(t))
        ]

    def call_written(self, name: str, t: Any, arguments: Sequence[tree.Expression]) -> Leaves:
        """Call a function of `written_functions`."""
        self.out.written.add(name)
        return self.call(_MATH + name, t, arguments)

    def intrinsic_call(self, node: tree.IntrinsicCall) -> Leaves:
        spelling = INTRINSICS[node.name].spelling.get("llvm")
        if spelling is None:
            return _INTRINSICS[node.name](self, node)
        if isinstance(spelling, Written):
            return self.call_written(spelling, node.type, node.arguments)
        return [self.lane_function(spelling, *scalars) for scalars in _spread(self, node)]

    # --- resources ------------------------------------------------------------------------------

    def handle(self, node: tree.Expression) -> str:
        assert isinstance(node, tree.Local)
        return self.handles[node.name]

    def header_word(self, handle: str, index: int) -> str:
        """A 32-bit word of a resource header, in every lane."""
        pointer = self.define(f"getelementptr i32, ptr {handle}, i64 {index}")
        return self.splat(self.define(f"load i32, ptr {pointer}, !invariant.load !0"), int)

    def data(self, handle: str) -> str:
        return self.define(f"load ptr, ptr {handle}, !invariant.load !0")

    def level(self, handle: str, level: str) -> dict[str, str]:
        """Size and offset of a level; the level is clamped to those of the map."""
        last = self.integer("sub", self.header_word(handle, HeaderWord.COUNT), 1)
        index = self.int_bound("smin", self.int_bound("smax", level, 0), last)
        info = {}
        for field, name in ((HeaderWord.WIDTH, "width"), (HeaderWord.HEIGHT, "height")):
            # each level is half of the one before: a shift is cheaper than a load
            halved = self.integer("lshr", self.header_word(handle, field), index)
            info[name] = self.int_bound("smax", halved, 1)
        word = self.integer("add", index, HeaderWord.OFFSETS)
        info["first"] = self.vector_of(self.gather(handle, word, "i32"), "i32")
        info["stride"] = self.integer("add", info["width"], 2)
        return info

    def element(self, level: dict[str, str], cell: Leaves, margin: int) -> str:
        """Index of a cell's texel, clamped to −1 … count + margin; the border is in memory."""
        position = []
        for c, count in zip(cell, (level["width"], level["height"]), strict=True):
            most = self.integer("add", count, margin)
            position.append(self.int_bound("smin", self.int_bound("smax", c, -1), most))
        index = self.integer("add", self.integer("mul", position[1], level["stride"]), position[0])
        return self.integer("add", index, level["first"])

    def item(self, record: Any, buffer: tree.Expression, index: str) -> Leaves:
        handle = self.handle(buffer)
        kinds = [leaf for _, leaf in leaves(record)]
        # an unsigned minimum, so that a negative index reads the last item too
        index = self.int_bound("umin", index, self.header_word(handle, HeaderWord.LAST))
        first = self.integer("mul", index, len(kinds))
        base = self.data(handle)
        values = []
        for offset, t in enumerate(kinds):
            position = self.integer("add", first, offset)
            if t is float:
                values.append(self.vector_of(self.gather(base, position, "float"), "float"))
                continue
            word = self.vector_of(self.gather(base, position, "i32"), "i32")
            values.append(word if t is int else self.compare("!=", word, "zeroinitializer", int))
        return values


# --- intrinsics ----------------------------------------------------------------------------------


def _component(t: Any) -> type:
    return t if t in SCALARS else VECTORS[t][0]


def _spread(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Iterator[tuple[str, ...]]:
    """Scalars of the arguments, component by component, with scalars repeated."""
    columns = [p.value(a) for a in node.arguments]
    count = len(columns[0])
    return zip(*(c * (count // len(c)) for c in columns), strict=True)


def _minimum(p: _FunctionPrinter, a: str, b: str, t: type = float) -> str:
    return p.select(p.compare("<", b, a, t), b, a, t)


def _maximum(p: _FunctionPrinter, a: str, b: str, t: type = float) -> str:
    return p.select(p.compare(">", b, a, t), b, a, t)


def _clamp(p: _FunctionPrinter, x: str, low: str, high: str) -> str:
    return _minimum(p, _maximum(p, x, low), high)


def _mix(p: _FunctionPrinter, a: str, b: str, t: str) -> str:
    rest = p.operation("fsub", p.out.constant(1.0, float), t, float)
    return p.sum([p.operation("fmul", a, rest, float), p.operation("fmul", b, t, float)])


def _fraction(p: _FunctionPrinter, x: str) -> str:
    return p.operation("fsub", x, p.lane_function("llvm.floor", x), float)


def _componentwise(function: Any) -> Any:
    """Intrinsic of one component of each argument, applied to all components."""
    return lambda p, node: [function(p, *arguments) for arguments in _spread(p, node)]


def _of_leaves(function: Any) -> Any:
    """Intrinsic of all scalars of each argument."""
    return lambda p, node: function(p, *map(p.value, node.arguments))


def _length(p: _FunctionPrinter, v: Leaves) -> str:
    return p.lane_function("llvm.sqrt", p.dot(v, v))


def _normalize(p: _FunctionPrinter, v: Leaves) -> Leaves:
    inverse = p.operation("fdiv", p.out.constant(1.0, float), _length(p, v), float)
    return [p.operation("fmul", c, inverse, float) for c in v]


def _cross(p: _FunctionPrinter, a: Leaves, b: Leaves) -> Leaves:
    def component(i: int, j: int) -> str:
        first = p.operation("fmul", a[i], b[j], float)
        return p.operation("fsub", first, p.operation("fmul", a[j], b[i], float), float)

    return [component(1, 2), component(2, 0), component(0, 1)]


def _reflect(p: _FunctionPrinter, i: Leaves, n: Leaves) -> Leaves:
    twice = p.operation("fmul", p.out.constant(2.0, float), p.dot(i, n), float)
    return [
        p.operation("fsub", a, p.operation("fmul", b, twice, float), float)
        for a, b in zip(i, n, strict=True)
    ]


def _transpose(p: _FunctionPrinter, m: Leaves) -> Leaves:
    return [m[3 * column + row] for row in range(3) for column in range(3)]


def _smoothstep(p: _FunctionPrinter, low: str, high: str, x: str) -> str:
    over = p.operation("fsub", x, low, float)
    t = p.operation("fdiv", over, p.operation("fsub", high, low, float), float)
    t = _saturate(p, t)
    twice = p.operation("fmul", p.out.constant(2.0, float), t, float)
    rest = p.operation("fsub", p.out.constant(3.0, float), twice, float)
    return p.operation("fmul", p.operation("fmul", t, t, float), rest, float)


def _saturate(p: _FunctionPrinter, x: str) -> str:
    return _clamp(p, x, p.out.constant(0.0, float), p.out.constant(1.0, float))


def _absolute(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    x = p.value(node.arguments[0])[0]
    if node.type is float:
        return [p.lane_function("llvm.fabs", x)]
    negative = p.compare("<", x, "zeroinitializer", int)
    return [p.select(negative, p.negate(x, int), x, int)]


def _conversion(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    source_type = node.arguments[0].type
    x = p.value(node.arguments[0])[0]
    if source_type is bool:
        x = p.define(f"zext {p.out.names[bool]} {x} to {p.out.names[int]}")
        source_type = int
    if source_type is node.type:
        return [x]
    return [p.to_float(x) if node.type is float else p.to_int(x)]


def _min_or_max(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    a, b = p.value(node.arguments[0])[0], p.value(node.arguments[1])[0]
    choose = _minimum if node.name == "min" else _maximum
    return [choose(p, a, b, node.type)]


def _reinterpret(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    source, target = p.out.names[node.arguments[0].type], p.out.names[node.type]
    return [p.define(f"bitcast {source} {p.value(node.arguments[0])[0]} to {target}")]


def _count(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    return [p.header_word(p.handle(node.arguments[0]), HeaderWord.COUNT)]


def _size(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    level = p.level(p.handle(node.arguments[0]), p.value(node.arguments[1])[0])
    return [level["width"], level["height"]]


def _corners(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    """Two 64-bit loads a lane, each of two adjacent texels.

    Not `helpers.corners`, which has four loads, and computes the border that is in memory here.
    """
    handle = p.handle(node.arguments[0])
    cell = p.value(node.arguments[1])
    level = p.level(handle, p.value(node.arguments[2])[0])
    index = p.element(level, cell, -1)
    below = p.integer("add", index, level["stride"])
    base = p.data(handle)
    heights = []
    for row in (index, below):
        pairs = p.gather(base, row, "i64", "float")
        heights += p.split_pairs(pairs, "float")
    return heights


def _texel(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    """One 64-bit load a lane, unpacked into four 16-bit channels."""
    handle = p.handle(node.arguments[0])
    cell = p.value(node.arguments[1])
    level = p.level(handle, p.value(node.arguments[2])[0])
    index = p.element(level, cell, 0)
    channels = []
    for word in p.split_pairs(p.gather(p.data(handle), index, "i64", "i64"), "i32"):
        for bits in (p.integer("and", word, 0xFFFF), p.integer("lshr", word, 16)):
            channels.append(p.to_float(bits))
    return channels


def _stored(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    """A texel of level 0."""
    return _texel(
        p, tree.IntrinsicCall(node.type, "texel", (*node.arguments, tree.Literal(int, 0)))
    )


def _sampled(p: _FunctionPrinter, node: tree.IntrinsicCall) -> Leaves:
    raise ShaderError(
        f"{p.function.location}: sampled reads by the filter of a GPU; run the program there, or "
        "interpolate texels as height_under does"
    )


_INTRINSICS: dict[str, Any] = {
    "fract": _componentwise(_fraction),
    "minimum": _componentwise(_minimum),
    "maximum": _componentwise(_maximum),
    "clamp": _componentwise(_clamp),
    "saturate": _componentwise(_saturate),
    "mix": _componentwise(_mix),
    "smoothstep": _componentwise(_smoothstep),
    "truncated_quotient": _componentwise(lambda p, a, b: p.integer("sdiv", a, b)),
    "dot": _of_leaves(lambda p, a, b: [p.dot(a, b)]),
    "length": _of_leaves(lambda p, v: [_length(p, v)]),
    "normalize": _of_leaves(_normalize),
    "cross": _of_leaves(_cross),
    "reflect": _of_leaves(_reflect),
    "transpose": _of_leaves(_transpose),
    "abs": _absolute,
    "min": _min_or_max,
    "max": _min_or_max,
    "float": _conversion,
    "int": _conversion,
    "float_bits": _reinterpret,
    "bits_float": _reinterpret,
    "len": _count,
    "levels": _count,
    "size": _size,
    "corners": _corners,
    "sampled": _sampled,
    "texel": _texel,
    "stored": _stored,
}
"""Instructions of the intrinsics that are neither an LLVM intrinsic nor written as a shader."""


# --- costs and exits -----------------------------------------------------------------------------


def _may_deactivate_lanes(statement: tree.Statement) -> bool:
    """Whether some lanes may become inactive in a statement that contains others."""
    inner = not isinstance(statement, tree.Return | tree.Break | tree.Continue)
    return inner and tree.contains(tree.Block([statement]), tree.Return, tree.Break, tree.Continue)


def _cost(block: tree.Block) -> int:
    """Estimated operations of a block; a call, a read or a loop makes it expensive."""
    total = 0
    for statement in block.statements:
        match statement:
            case tree.Assign(value=value) | tree.Return(value=value):
                total += _expression_cost(value)
            case tree.If(test=test, body=body, otherwise=otherwise):
                total += _expression_cost(test) + _cost(body) + _cost(otherwise)
            case tree.For() | tree.While():
                total += _MAX_BRANCHLESS_COST + 1
            case tree.Break() | tree.Continue():
                pass
            case _:
                raise AssertionError(statement)
    return total


_FREE = {"float_bits", "bits_float", "transpose"}
_EXPENSIVE = {*ELEMENTARY, "corners", "texel", "stored", "normalize"}


def _expression_cost(node: tree.Expression) -> int:
    match node:
        case tree.Literal() | tree.Local():
            return 0
        case tree.Call() | tree.Item():
            return _MAX_BRANCHLESS_COST + 1
        case tree.Swizzle(operand=a) | tree.Member(operand=a):
            return _expression_cost(a)
        case tree.Construct(parts=parts):
            return sum(map(_expression_cost, parts))
        case tree.IntrinsicCall(name=name, arguments=arguments):
            own = 0 if name in _FREE else _width(node.type)
            if name in _EXPENSIVE:
                own = _MAX_BRANCHLESS_COST + 1
            return own + sum(map(_expression_cost, arguments))
        case tree.Unary(operand=a):
            return 1 + _expression_cost(a)
        case tree.Select(test=a, then=b, otherwise=c):
            return _width(node.type) + sum(map(_expression_cost, (a, b, c)))
        case tree.Binary(left=a, right=b):
            weight = 8 if node.operator in ("//", "%") else 1
            return weight * _width(node.type) + _expression_cost(a) + _expression_cost(b)
        case tree.Compare(left=a, right=b) | tree.Logic(left=a, right=b):
            return 1 + _expression_cost(a) + _expression_cost(b)
    raise AssertionError(node)


def _width(t: Any) -> int:
    return sum(1 for _ in leaves(t))


# --- the entry -----------------------------------------------------------------------------------
#
# uniforms: the scalars of the entry's records, 32 bits each, in order.
# resources: a pointer for each handle, to its `layout.header`.
# planes: a plane of 32-bit words for each scalar of the result, rows `row_stride` words apart.


class _EntryPrinter(_InstructionPrinter):
    """Prints the loop over pixels that calls the entry shader."""

    def __init__(self, out: _ModuleState, entry: tree.Function) -> None:
        super().__init__(out)
        self.entry = entry

    def text(self) -> str:
        lanes = self.out.lanes
        names = self.out.names
        self.emit("%first = icmp slt i32 %first_row, %last_row")
        records = self.arguments()
        self.emit("br i1 %first, label %rows, label %leave")
        self.label("rows")
        self.emit("%y = phi i32 [%first_row, %start], [%next_y, %row_done]")
        y = self.splat("%y", int)
        row = self.define("zext i32 %y to i64")
        stride = self.define("zext i32 %row_stride to i64")
        row_start = self.define(f"mul i64 {row}, {stride}")
        self.emit("br label %pixels")
        self.label("pixels")
        self.emit("%x = phi i32 [0, %rows], [%next_x, %pixels]")
        counting = "<" + ", ".join(f"i32 {k}" for k in range(lanes)) + ">"
        x = self.integer("add", self.splat("%x", int), counting)
        mask = self.compare("<", x, self.splat("%width", int), int)
        column = self.define("zext i32 %x to i64")
        position = self.define(f"add i64 {row_start}, {column}")
        arguments = [f"{names[bool]} {mask}", f"{names[int]} {x}", f"{names[int]} {y}"]
        for t, passed in zip(list(self.entry.parameters.values())[1:], records, strict=True):
            arguments += self.stored(position) if t is self.entry.result else passed
        result = self.out.result(self.entry.result)
        aggregate = self.define(f"call fastcc {result} @{self.entry.name}({', '.join(arguments)})")
        self.store_planes(aggregate, result, position)
        self.emit(f"%next_x = add i32 %x, {lanes}")
        self.emit("%more = icmp slt i32 %next_x, %width")
        self.emit("br i1 %more, label %pixels, label %row_done")
        self.label("row_done")
        self.emit("%next_y = add i32 %y, 1")
        self.emit("%more_rows = icmp slt i32 %next_y, %last_row")
        self.emit("br i1 %more_rows, label %rows, label %leave")
        head = (
            "define dllexport void @run.rows(ptr noalias readonly %uniforms, "
            "ptr noalias readonly %resources, ptr noalias %planes, i64 %plane_stride, "
            "i32 %row_stride, i32 %width, i32 %first_row, i32 %last_row) nounwind {"
        )
        return "\n".join([head, "start:", *self.lines, "leave:", "  ret void", "}", ""])

    def arguments(self) -> list[list[str]]:
        """Arguments of each parameter: records from the uniforms, and handles; loaded once."""
        arguments: list[list[str]] = []
        word = resource = 0
        for t in list(self.entry.parameters.values())[1:]:
            passed: list[str] = []
            arguments.append(passed)
            # loaded for each pixel
            if t is self.entry.result:
                continue
            if is_handle(t):
                slot = self.define(f"getelementptr ptr, ptr %resources, i64 {resource}")
                passed.append(f"ptr {self.define(f'load ptr, ptr {slot}')}")
                resource += 1
                continue
            for _, leaf in leaves(t):
                pointer = self.define(f"getelementptr i32, ptr %uniforms, i64 {word}")
                kind = "float" if leaf is float else "i32"
                value = self.define(f"load {kind}, ptr {pointer}")
                if leaf is bool:
                    value = self.define(f"icmp ne i32 {value}, 0")
                passed.append(f"{self.out.names[leaf]} {self.splat(value, leaf)}")
                word += 1
        return arguments

    def stored(self, position: str) -> list[str]:
        """The values that the planes hold at a position."""
        names, passed = self.out.names, []
        for index, (_, t) in enumerate(leaves(self.entry.result)):
            kind = names[float if t is float else int]
            value = self.define(f"load {kind}, ptr {self.plane(position, index)}, align 4")
            if t is bool:
                value = self.define(f"icmp ne {kind} {value}, zeroinitializer")
            passed.append(f"{names[t]} {value}")
        return passed

    def plane(self, position: str, index: int) -> str:
        """Address of a plane's words at a position."""
        skip = self.define(f"mul i64 %plane_stride, {index}")
        offset = self.define(f"add i64 {position}, {skip}")
        return self.define(f"getelementptr i32, ptr %planes, i64 {offset}")

    def store_planes(self, aggregate: str, result: str, position: str) -> None:
        kinds = [leaf for _, leaf in leaves(self.entry.result)]
        for index, t in enumerate(kinds):
            value = aggregate
            if len(kinds) > 1:
                value = self.define(f"extractvalue {result} {aggregate}, {index}")
            if t is bool:
                value = self.define(f"zext {self.out.names[bool]} {value} to {self.out.names[int]}")
            kind = self.out.names[float if t is float else int]
            self.emit(f"store {kind} {value}, ptr {self.plane(position, index)}, align 4")
