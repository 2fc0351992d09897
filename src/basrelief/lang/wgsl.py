"""WGSL printer of the typed tree; names, docstrings and comments are kept, for readers.

Maps are textures read texel by texel: heights as `texture_2d<f32>`, other maps as `texture_2d<u32>`
of 16-bit fractions. The shaders interpolate, so that all engines filter alike. Records are uniform
buffers; a `Buffer` is a storage buffer that starts with its count. `engine/gpu.py` binds them in
the order of `bindings`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, assert_never

import numpy as np

from basrelief.lang import tree
from basrelief.lang.frontend import elementary_functions
from basrelief.lang.layout import align_and_size
from basrelief.lang.resources import Edge, HeightField, Texture, buffer_record, is_handle
from basrelief.lang.types import SCALARS, VECTORS, ShaderError, fields_of, is_record, leaves
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4

GROUP = (8, 8)
"""Width and height of a workgroup in pixels; among the fastest shapes measured."""

_TYPES: dict[Any, str] = {
    float: "f32",
    int: "i32",
    bool: "bool",
    Vec2: "vec2f",
    Vec3: "vec3f",
    Vec4: "vec4f",
    IVec2: "vec2i",
    Mat3: "mat3x3f",
    HeightField: "texture_2d<f32>",
    Texture: "texture_2d<u32>",
}


@dataclass(frozen=True)
class Binding:
    """Resource binding of group 0; its number is its index in the list."""

    kind: Literal["run", "planes", "sampler", "uniform", "buffer", "map"]
    name: str
    type: Any = None


def bindings(entry: tree.Function) -> list[Binding]:
    """Resource bindings of a program with this entry, in order."""
    result = [
        Binding("run", "run"),
        Binding("planes", "planes"),
        Binding("sampler", "edge_sampler"),
    ]
    for name, t in list(entry.parameters.items())[1:]:
        kind: Literal["uniform", "buffer", "map"] = "uniform"
        if is_handle(t):
            kind = "map" if buffer_record(t) is None else "buffer"
        result.append(Binding(kind, name, t))
    return result


def _variable_name(binding: Binding) -> str:
    """Name of the WGSL variable of a binding."""
    is_builtin = binding.kind in ("run", "planes", "sampler")
    return binding.name if is_builtin else f"{binding.name}_{binding.kind}"


def print_wgsl(module: tree.Module, edge: Edge) -> str:
    """WGSL of a program: a compute shader, entry point `main`, one invocation for each pixel."""
    printer = ModulePrinter(module.functions, [module.entry], edge)
    body = printer.functions_text()
    return "\n".join([printer.bindings_text(module.entry), body, printer.main_text(module.entry)])


class ModulePrinter:
    """Prints the functions of a module, and the records and helpers that they share.

    `edge` is the edge of all maps, None in a library, where it is a static condition.
    """

    def __init__(
        self,
        functions: Sequence[tree.Function],
        entries: Sequence[tree.Function],
        edge: Edge | None,
    ) -> None:
        self.functions = functions
        self.edge = edge
        self.helpers: set[str] = set()
        self.elementary: set[str] = set()
        """Names of elementary functions of our own, which are more exact than WGSL's."""
        self.conditions: dict[tree.Condition, int] = {}
        """Static conditions of a library and their numbers."""
        self.selected_types: dict[Any, None] = {}
        """Matrices and records that are selected by a condition; WGSL's `select` takes neither."""
        self.records: dict[Any, None] = {}
        for function in functions:
            for t in [*function.parameters.values(), function.result, *function.locals.values()]:
                self.add_record(t)
        parameters = [p for entry in entries for p in list(entry.parameters.items())[1:]]
        variables = [_variable_name(b) for entry in entries for b in bindings(entry)]
        self.reserved = {*_RESERVED, *_PRINTED_NAMES, *variables}
        self.scope: dict[Any, str] = {}
        """Unique names of functions and records."""
        for function in [*functions, *elementary_functions().values()]:
            self.assign_name(function, function.name)
        for record in self.records:
            self.assign_name(record, record.__name__)
        self.shared: set[Any] = set()
        """Records in buffers, which have the layout of `layout.py`."""
        for _, t in parameters:
            self.add_shared(buffer_record(t) or t)
        self.buffers = {
            buffer_record(t): f"{name}_buffer"
            for name, t in parameters
            if buffer_record(t) is not None
        }

    def add_record(self, t: Any) -> None:
        t = buffer_record(t) or t
        if is_record(t) and t not in self.records:
            for field in fields_of(t).values():
                self.add_record(field)
            self.records[t] = None

    def add_shared(self, t: Any) -> None:
        if is_record(t):
            self.shared.add(t)
            for field in fields_of(t).values():
                self.add_shared(field)

    def assign_name(self, obj: Any, name: str) -> str:
        """Assign a unique name to a function or type of the module, and return it."""
        while name in self.reserved:
            name += "_"
        self.reserved.add(name)
        self.scope[obj] = name
        return name

    def field(self, name: str) -> str:
        """Name of a field, changed if WGSL reserves it."""
        return f"{name}_" if name in _RESERVED else name

    def type(self, t: Any) -> str:
        return _TYPES[t] if t in _TYPES else self.scope[t]

    def static(self, condition: tree.Condition, then: str, otherwise: str) -> str:
        """Two texts under a static condition, of which the linker keeps one."""
        number = self.conditions.setdefault(condition, len(self.conditions))
        return f"{IF}{number}{THEN}{then}{ELSE}{otherwise}{END}"

    def functions_text(self) -> str:
        """Text of the functions, and of the records and helpers that they need."""
        functions = list(self.function_texts())
        return "\n".join([*self.record_texts(), *self.helper_texts(), *functions])

    def function_texts(self) -> Iterator[str]:
        for function in self.functions:
            yield _FunctionPrinter(self, function).text()
        printed: set[str] = set()
        while self.elementary - printed:
            for name in sorted(self.elementary - printed):
                printed.add(name)
                yield _FunctionPrinter(self, elementary_functions()[name]).text()

    def parameter_names(self, function: tree.Function) -> dict[str, str]:
        """Unique names of the parameters of a function; buffers are global and have none."""
        names = _FunctionPrinter(self, function).names
        return {
            name: names[name] for name, t in function.parameters.items() if buffer_record(t) is None
        }

    def record_texts(self) -> Iterator[str]:
        for record in self.records:
            fields = fields_of(record)
            lines = [f"struct {self.scope[record]} {{"]
            for name, t in fields.items():
                first = record in self.shared and name == next(iter(fields))
                align = "@align(16) " if first or is_record(t) else ""
                lines.append(f"  {align}{self.field(name)}: {self.type(t)},")
            if not fields:
                lines.append("  @align(16) unused: f32,")  # WGSL has no empty structures
            yield "\n".join([*lines, "}", ""])

    def helper_texts(self) -> Iterator[str]:
        """Helpers for what WGSL lacks, as far as the functions printed so far need them."""
        needed = set(self.helpers)
        if needed & {"corners", "texel"}:
            needed.add("level_size")
            yield self.edge_text()
        yield from (text for name, text in HELPERS.items() if name in needed)
        for t in self.selected_types:
            yield _SELECT_FUNCTION.replace("NAME", self.select_function(t)).replace(
                "TYPE", self.type(t)
            )

    def edge_text(self) -> str:
        """Helper for the edge of maps."""
        if self.edge is not None:
            return AT_EDGE[self.edge]
        return self.static(("map.edge", ("wrap",)), AT_EDGE["wrap"], AT_EDGE["clamp"])

    def select_function(self, t: Any) -> str:
        """Name of the function that selects one of two values of a type."""
        key = ("select", t)
        return self.scope.get(key) or self.assign_name(key, f"select_{t.__name__}")

    def bindings_text(self, entry: tree.Function) -> str:
        """Text of the resource bindings of a program with this entry."""
        return "\n".join([_RUN, *self._binding_texts(entry)])

    def _binding_texts(self, entry: tree.Function) -> Iterator[str]:
        for number, binding in enumerate(bindings(entry)):
            where = f"@group(0) @binding({number}) var"
            match binding.kind:
                case "run":
                    yield f"{where}<uniform> run: Run;"
                case "planes":
                    yield f"{where}<storage, read_write> planes: array<u32>;"
                case "sampler":
                    yield f"{where} edge_sampler: sampler;"
                case "uniform":
                    if is_record(binding.type):
                        align_and_size(binding.type)  # refuses a bool
                    yield f"{where}<uniform> {_variable_name(binding)}: {self.type(binding.type)};"
                case "map":
                    yield f"{where} {_variable_name(binding)}: {self.type(binding.type)};"
                case "buffer":
                    record = buffer_record(binding.type)
                    assert record is not None
                    item = self.type(record)
                    buffer = self.assign_name(("buffer", record), f"{item}Buffer")
                    yield (
                        f"struct {buffer} {{\n  count: i32,\n"
                        f"  @align({align_and_size(record)[0]}) items: array<{item}>,\n}}\n"
                        f"{where}<storage, read> {self.buffers[record]}: {buffer};"
                    )
                case _:
                    assert_never(binding.kind)

    def scalars(self, value: str, t: Any) -> Iterator[tuple[str, Any]]:
        """WGSL expressions and types of the scalars of a value."""
        if t is Mat3:
            for column in range(3):
                yield from self.scalars(f"{value}[{column}]", Vec3)
        elif is_record(t):
            for name, field in fields_of(t).items():
                yield from self.scalars(f"{value}.{self.field(name)}", field)
        elif t in VECTORS:
            yield from ((f"{value}.{name}", leaf) for name, leaf in leaves(t))
        else:
            yield value, t

    def main_text(self, entry: tree.Function) -> str:
        """Text of the entry point, which runs for each pixel."""
        arguments = ["vec2i(at)"]
        for binding in bindings(entry)[3:]:
            if binding.kind != "buffer":
                arguments.append(_variable_name(binding))
        lines = [f"  let result = {self.scope[entry]}({', '.join(arguments)});"]
        for index, (value, t) in enumerate(self.scalars("result", entry.result)):
            word = f"u32({value})" if t is bool else f"bitcast<u32>({value})"
            lines.append(f"  planes[place + {index}u * run.plane_stride] = {word};")
        return _ENTRY.replace("GROUP", f"{GROUP[0]}, {GROUP[1]}").replace("BODY", "\n".join(lines))


class _FunctionPrinter:
    """Prints one function."""

    def __init__(self, module: ModulePrinter, function: tree.Function) -> None:
        self.module = module
        self.function = function
        self.lines: list[str] = []
        self.indent = 1
        self.names: dict[str, str] = {}
        self.used = set(module.reserved)
        for name in [*function.parameters, *function.locals]:
            self.names[name] = self.fresh(name)

    def fresh(self, name: str) -> str:
        """A name that is unique in the function; `_` becomes `round`."""
        unique = "round" if name == "_" else name
        while unique in self.used:
            unique += "_"
        self.used.add(unique)
        return unique

    def text(self) -> str:
        m, f = self.module, self.function
        parameters = [
            f"{self.names[name]}: {m.type(t)}"
            for name, t in f.parameters.items()
            if buffer_record(t) is None
        ]
        self.block(f.body)
        doc = [f"// {line}".rstrip() for line in f.doc.splitlines()]
        head = f"fn {m.scope[f]}({', '.join(parameters)}) -> {m.type(f.result)} {{"
        return "\n".join([*doc, head, "".join(self.lines) + "}\n"])

    def emit(self, line: str) -> None:
        self.lines.append("  " * self.indent + line + "\n")

    # --- statements -----------------------------------------------------------------------------

    def block(self, block: tree.Block) -> None:
        for name, t in block.hoisted.items():
            self.emit(f"var {self.names[name]}: {self.module.type(t)};")
        for statement in block.statements:
            for comment in statement.comments:
                self.emit(f"// {comment}")
            self.statement(statement)

    def inner(self, block: tree.Block) -> None:
        self.indent += 1
        self.block(block)
        self.indent -= 1

    def block_text(self, block: tree.Block) -> str:
        """Text of a block without braces, at the present indentation."""
        outer, self.lines = self.lines, []
        self.block(block)
        text, self.lines = "".join(self.lines), outer
        return text

    def statement(self, statement: tree.Statement) -> None:
        match statement:
            case tree.Assign(name, value, declares):
                word = "let " if name in self.function.constants else "var "
                self.emit(f"{word if declares else ''}{self.names[name]} = {self.value(value)};")
            case tree.If(tree.Static(_, condition), body, otherwise):
                then, other = self.block_text(body), self.block_text(otherwise)
                self.lines.append(self.module.static(condition, then, other))
            case tree.If():
                self.if_statement(statement, "")
            case tree.For():
                self.for_statement(statement)
            case tree.While(test, body):
                self.emit(f"while ({self.value(test)}) {{")
                self.inner(body)
                self.emit("}")
            case tree.Return(value):
                self.emit(f"return {self.value(value)};")
            case tree.Break():
                self.emit("break;")
            case tree.Continue():
                self.emit("continue;")
            case _:
                raise AssertionError(statement)

    def if_statement(self, node: tree.If, before: str) -> None:
        self.emit(f"{before}if ({self.value(node.test)}) {{")
        self.inner(node.body)
        rest = node.otherwise.statements
        is_elif = len(rest) == 1 and not rest[0].comments and not node.otherwise.hoisted
        if is_elif and isinstance(rest[0], tree.If) and not isinstance(rest[0].test, tree.Static):
            self.if_statement(rest[0], "} else ")
            return
        if rest:
            self.emit("} else {")
            self.inner(node.otherwise)
        self.emit("}")

    def for_statement(self, node: tree.For) -> None:
        if node.name not in self.names:
            self.names[node.name] = self.fresh(node.name)
        name, start, stop = self.names[node.name], self.value(node.start), self.value(node.stop)
        if not isinstance(node.stop, tree.Literal):
            # as in Python, the bound is evaluated once
            end = self.fresh(f"{name}_end")
            self.emit(f"let {end} = {stop};")
            stop = end
        if node.step == 1:
            self.emit(f"for (var {name} = {start}; {name} < {stop}; {name}++) {{")
            self.inner(node.body)
            self.emit("}")
            return
        # a longer step could overflow the counter
        last = self.fresh(f"{name}_last")
        self.emit("{")
        self.emit(f"var {name} = {start};")
        self.emit("loop {")
        self.emit(f"  if ({name} >= {stop}) {{ break; }}")
        self.inner(node.body)
        self.emit("  continuing {")
        self.emit(f"    let {last} = {name} > {2**31 - 1 - node.step};")
        self.emit(f"    {name} += {node.step};")
        self.emit(f"    break if {last};")
        self.emit("  }")
        self.emit("}")
        self.emit("}")

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: tree.Expression) -> str:
        """WGSL of an expression, with parentheses only where they are needed."""
        match node:
            case tree.Literal(t, value):
                return _literal(t, value)
            case tree.Local(_, name):
                return self.names[name]
            case tree.Unary(_, operator, operand):
                return f"{'!' if operator == 'not' else '-'}{self.operand(operand, 8)}"
            case tree.Binary(_, operator, left, right) if operator in ("//", "%"):
                name = "floor_divide" if operator == "//" else "floor_modulo"
                self.module.helpers |= {name, "floor_divide"}
                return f"{name}({self.arguments((left, right))})"
            case tree.Infix(_, operator, left, right):
                return self.infix(operator, left, right)
            case tree.Static(_, condition):
                return self.module.static(condition, "true", "false")
            case tree.Select(_, tree.Static(_, condition), then, otherwise):
                return self.module.static(condition, self.argument(then), self.argument(otherwise))
            case tree.Select(_, test, then, otherwise):
                word = "select"
                if node.type is Mat3 or is_record(node.type):
                    self.module.selected_types[node.type] = None
                    word = self.module.select_function(node.type)
                return f"{word}({self.arguments((otherwise, then, test))})"
            case tree.Swizzle(_, operand, indices) if operand.type is Mat3:
                return f"{self.operand(operand, 9)}[{indices[0]}]"
            case tree.Swizzle(_, operand, indices):
                return f"{self.operand(operand, 9)}.{''.join('xyzw'[i] for i in indices)}"
            case tree.Member(_, operand, name):
                return f"{self.operand(operand, 9)}.{self.module.field(name)}"
            case tree.Construct(t, parts):
                return f"{self.module.type(t)}({self.arguments(parts)})"
            case tree.IntrinsicCall():
                return self.intrinsic(node)
            case tree.Call(_, function, arguments):
                if function not in self.module.functions:
                    self.module.elementary.add(function.name)
                passed = [a for a in arguments if buffer_record(a.type) is None]
                return f"{self.module.scope[function]}({self.arguments(passed)})"
            case tree.Item(_, buffer, index):
                items = self.module.buffers[buffer_record(buffer.type)]
                return f"{items}.items[{self.value(index)}]"
        raise AssertionError(node)

    def arguments(self, nodes: Iterable[tree.Expression]) -> str:
        """Text of the arguments of a call."""
        return ", ".join(map(self.argument, nodes))

    def argument(self, node: tree.Expression) -> str:
        """Text of an argument; comparisons need parentheses: `f(a < b, c > d)` is a template."""
        text = self.value(node)
        return f"({text})" if isinstance(node, tree.Compare | tree.Logic) else text

    def operand(self, node: tree.Expression, strength: int) -> str:
        """Text of an operand, in parentheses where it binds less tightly than `strength`."""
        text = self.value(node)
        return f"({text})" if _operator_strength(node, text) < strength else text

    def infix(self, operator: str, left: tree.Expression, right: tree.Expression) -> str:
        symbol = _SYMBOLS.get(operator, operator)
        strength = _STRENGTH[symbol]
        if symbol in ("<<", ">>"):
            assert isinstance(right, tree.Literal)
            return f"{self.operand(left, 8)} {symbol} {right.value}u"
        if symbol in ("&", "|", "^"):
            return f"{self.operand(left, 8)} {symbol} {self.operand(right, 8)}"
        if symbol in ("&&", "||"):
            # WGSL wants parentheses where && and || are mixed
            same = isinstance(left, tree.Logic) and left.operator == operator
            return (
                f"{self.operand(left, strength if same else 3)} {symbol} {self.operand(right, 3)}"
            )
        a = self.operand(left, strength + (symbol in _COMPARISONS))
        return f"{a} {symbol} {self.operand(right, strength + 1)}"

    def cell_as_floats(self, cell: tree.Expression) -> str:
        """Text of a cell as floats, without the conversion if it was made from floats."""
        if isinstance(cell, tree.Construct) and len(cell.parts) == 2:
            casts = [p for p in cell.parts if isinstance(p, tree.IntrinsicCall) and p.name == "int"]
            floats = [self.value(p.arguments[0]) for p in casts if p.arguments[0].type is float]
            if len(floats) == 2:
                return f"vec2f({', '.join(floats)})"
        return f"vec2f({self.value(cell)})"

    def intrinsic(self, node: tree.IntrinsicCall) -> str:
        name, arguments = node.name, node.arguments
        if name == "len":
            return f"{self.module.buffers[buffer_record(arguments[0].type)]}.count"
        if name in _OWN_FUNCTIONS:
            self.module.elementary.add(name)
            own = self.module.scope[elementary_functions()[name]]
            return f"{own}({self.arguments(arguments)})"
        texts = [self.argument(a) for a in arguments]
        if name == "mix" and node.type in VECTORS and arguments[1].type is float:
            texts[1] = f"{self.module.type(node.type)}({texts[1]})"
        if name in _SAME_TYPE_ARGUMENTS and node.type in VECTORS:
            # all arguments must have one type
            vector = self.module.type(node.type)
            texts = [
                f"{vector}({text})" if a.type in SCALARS else text
                for text, a in zip(texts, arguments, strict=True)
            ]
        if name == "levels":
            return f"i32(textureNumLevels({texts[0]}))"
        if name == "size" and _is_finest(arguments[1]):
            return f"vec2i(textureDimensions({texts[0]}))"
        if name == "corners" and _is_finest(arguments[2]):
            self.module.helpers.add("corners_of_finest")
            return f"corners_of_finest({texts[0]}, {self.cell_as_floats(arguments[1])})"
        if name == "size":
            self.module.helpers.add("level_size")
            level = f"clamp({texts[1]}, 0, i32(textureNumLevels({texts[0]})) - 1)"
            return f"level_size(textureDimensions({texts[0]}), {level})"
        if name in HELPERS:
            self.module.helpers.add(name)
        return f"{_WGSL_NAMES.get(name, name)}({', '.join(texts)})"


IF, THEN, ELSE, END = "\ue000", "\ue001", "\ue002", "\ue003"
"""Delimiters of a static condition's number and its two texts: private-use characters."""


def _is_finest(level: tree.Expression) -> bool:
    return isinstance(level, tree.Literal) and level.value == 0


_SYMBOLS = {"@": "*", "and": "&&", "or": "||"}
"""WGSL operators whose symbols differ."""
_STRENGTH = {
    "||": 1, "&&": 2, "<": 3, "<=": 3, ">": 3, ">=": 3, "==": 3, "!=": 3, "&": 0, "|": 0, "^": 0,
    "<<": 0, ">>": 0, "+": 5, "-": 5, "*": 6, "/": 6,
}  # fmt: skip
_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


def _operator_strength(node: tree.Expression, text: str) -> int:
    match node:
        case tree.Binary(operator=operator) if operator in ("//", "%"):
            return 9
        case tree.Infix(operator=operator):
            return _STRENGTH[_SYMBOLS.get(operator, operator)]
        case tree.Unary():
            return 7
        case tree.Select(test=tree.Static()):
            return -1
    return 7 if text.startswith("-") else 9


def _literal(t: type, value: Any) -> str:
    if t is bool:
        return "true" if value else "false"
    if t is int:
        return str(value) if value > -(2**31) else "(-2147483647 - 1)"
    number = np.float32(value)
    if not math.isfinite(number):
        raise ShaderError(f"the number {value} is too large for float32; WGSL has no infinity")
    text = str(number)
    return text if re.search(r"[.e]", text) else f"{text}.0"


# --- names and helpers ---------------------------------------------------------------------------

_WGSL_NAMES = {
    "float": "f32",
    "int": "i32",
    "minimum": "min",
    "maximum": "max",
    "float_bits": "bitcast<i32>",
    "bits_float": "bitcast<f32>",
    "copysign": "copy_sign",
    "pow": "power",
    "log": "log_clamped",
    "log2": "log2_clamped",
}
_OWN_FUNCTIONS = ("asin", "acos", "atan", "atan2")
"""Computed by our own shaders; WGSL allows errors of 4096 units in the last place."""
_SAME_TYPE_ARGUMENTS = {"clamp", "minimum", "maximum"}

AT_EDGE: dict[Edge, str] = {
    "wrap": """\
// A texel of a map or of its border, which repeats the opposite side.
fn at_edge(cell: vec2i, size: vec2i) -> vec2i {
  let low = select(cell, cell + size, cell < vec2i(0));
  return select(low, low - size, low >= size);
}
""",
    "clamp": """\
// A texel of a map or of its border, which repeats the same side.
fn at_edge(cell: vec2i, size: vec2i) -> vec2i {
  return clamp(cell, vec2i(0), size - 1);
}
""",
}
HELPERS = {
    "floor_divide": """\
fn floor_divide(a: i32, b: i32) -> i32 {
  if (b == 0) { return 0; }
  if (b == -1) { return -a; }
  let quotient = a / b;
  let rest = a - quotient * b;
  return select(quotient, quotient - 1, rest != 0 && ((rest ^ b) < 0));
}
""",
    "floor_modulo": """\
fn floor_modulo(a: i32, b: i32) -> i32 {
  return select(a - floor_divide(a, b) * b, 0, b == 0);
}
""",
    "copysign": """\
fn copy_sign(x: f32, sign: f32) -> f32 {
  return select(abs(x), -abs(x), bitcast<i32>(sign) < 0);
}
""",
    "pow": """\
fn power(x: f32, y: f32) -> f32 {
  return select(select(0.0, 1.0, y == 0.0), pow(max(x, 1.17549435e-38), y), x > 0.0);
}
""",
    "log": """\
fn log_clamped(x: f32) -> f32 {
  return log(max(x, 1.17549435e-38));
}
""",
    "log2": """\
fn log2_clamped(x: f32) -> f32 {
  return log2(max(x, 1.17549435e-38));
}
""",
    "level_size": """\
// The size of a level, from that of level 0. Not textureDimensions of the level: where the level
// differs between pixels, Mesa's software driver returns the size of one for all.
fn level_size(finest: vec2u, level: i32) -> vec2i {
  return vec2i(max(finest >> vec2u(u32(level)), vec2u(1)));
}
""",
    "corners_of_finest": """\
// Heights of the texels (x, y), (x+1, y), (x, y+1), (x+1, y+1) of level 0 in one read: gathered
// around their common corner. The sampler applies the edge.
fn corners_of_finest(field: texture_2d<f32>, cell: vec2f) -> vec4f {
  let size = vec2f(textureDimensions(field));
  return textureGather(0, field, edge_sampler, (cell + 1.0) * (1.0 / size)).wzxy;
}
""",
    "corners": """\
// Heights of the texels (x, y), (x+1, y), (x, y+1), (x+1, y+1).
fn corners(field: texture_2d<f32>, cell: vec2i, level: i32) -> vec4f {
  let k = clamp(level, 0, i32(textureNumLevels(field)) - 1);
  let size = level_size(textureDimensions(field), k);
  let corner = clamp(cell, vec2i(-1), size - 1);
  let a = at_edge(corner, size);
  let b = at_edge(corner + 1, size);
  return vec4f(
    textureLoad(field, a, k).x,
    textureLoad(field, vec2i(b.x, a.y), k).x,
    textureLoad(field, vec2i(a.x, b.y), k).x,
    textureLoad(field, b, k).x,
  );
}
""",
    "stored": """\
// The four channels of a texel of a table.
fn stored(map: texture_2d<u32>, cell: vec2i) -> vec4f {
  return vec4f(textureLoad(map, cell, 0));
}
""",
    "texel": """\
// The four channels of a texel, 0 to 65535.
fn texel(map: texture_2d<u32>, cell: vec2i, level: i32) -> vec4f {
  let k = clamp(level, 0, i32(textureNumLevels(map)) - 1);
  let size = level_size(textureDimensions(map), k);
  let place = at_edge(clamp(cell, vec2i(-1), size), size);
  return vec4f(textureLoad(map, place, k));
}
""",
}

_SELECT_FUNCTION = """\
fn NAME(otherwise: TYPE, then: TYPE, test: bool) -> TYPE {
  if (test) {
    return then;
  }
  return otherwise;
}
"""

_RUN = """\
// The rows of the picture that this dispatch computes, and the layout of the planes.
struct Run {
  width: u32,
  first_row: u32,
  last_row: u32,
  plane_stride: u32,
}
"""

_ENTRY = """\
@compute @workgroup_size(GROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let at = vec2u(id.x, id.y + run.first_row);
  if (at.x >= run.width || at.y >= run.last_row) {
    return;
  }
  let place = id.y * run.width + id.x;
BODY
}
"""

_PRINTED_NAMES = {
    "Run", "main", "id", "at",
    *re.findall(r"fn (\w+)", "".join([*AT_EDGE.values(), *HELPERS.values()])),
}  # fmt: skip
"""Names that the printer declares at module scope."""

# Keywords, reserved words (WGSL, §3.6 and §16.1) and the predeclared names that are printed.
_RESERVED = frozenset(
    re.findall(
        r"\w+",
        """
        alias break case const const_assert continue continuing default diagnostic discard else
        enable false fn for if let loop override requires return struct switch true var while
        NULL Self abstract active alignas alignof as asm asm_fragment async attribute auto await
        become cast catch class co_await co_return co_yield coherent column_major common compile
        compile_fragment concept const_cast consteval constexpr constinit crate debugger
        decltype delete demote demote_to_helper do dynamic_cast enum explicit export extends
        extern external fallthrough filter final finally friend from fxgroup get goto
        groupshared highp impl implements import inline instanceof interface layout lowp macro
        macro_rules match mediump meta mod module move mut mutable namespace new nil noexcept
        noinline nointerpolation non_coherent noncoherent noperspective null nullptr of operator
        package packoffset partition pass patch pixelfragment precise precision premerge priv
        protected pub public readonly ref regardless register reinterpret_cast require resource
        restrict self set shared sizeof smooth snorm static static_assert static_cast std
        subroutine super target template this thread_local throw trait try type typedef typeid
        typename typeof union unless unorm unsafe unsized use using varying virtual volatile
        wgsl where with writeonly yield abs acos asin atan atan2 bitcast bool ceil clamp corners
        cos cross dot exp exp2 f16 f32 floor fract i32 length log log2 main max min mix
        normalize planes pow reflect round run saturate select sin smoothstep sqrt stored tan texel
        transpose u32 vec2 vec3 vec4 vec2f vec3f vec4f vec2i vec2u mat3x3f array atomic ptr
        sampler texture_2d result place Run
        """,
    )
)
