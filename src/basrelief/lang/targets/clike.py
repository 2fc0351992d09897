"""Base of the printers for C-like languages: names, order, statements and expressions.

A target language subclasses `ModulePrinter` and `FunctionPrinter`, and overrides what it spells
differently: types, declarations, function heads, loops, selections, intrinsics. Names, docstrings
and comments of the shaders are kept, so that the text can be read. After Slang's
`CLikeSourceEmitter`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from basrelief.lang import tree
from basrelief.lang.frontend import written_functions
from basrelief.lang.intrinsics import INTRINSICS, Componentwise, Text, Written
from basrelief.lang.resources import Edge, buffer_record
from basrelief.lang.types import SCALARS, VECTORS, ShaderError, fields_of, is_record


class ModulePrinter(ABC):
    """Printer of the functions of a module, and of the records and helpers that they share."""

    types: ClassVar[Mapping[Any, str]]
    """Spelling of the types that are not records."""
    reserved_words: ClassVar[frozenset[str]]
    """Keywords and built-in names of the language, besides its intrinsics."""
    declared_names: ClassVar[frozenset[str]]
    """Names that the printer declares at module scope; fields may have them too."""
    function_printer: type[FunctionPrinter]

    def __init__(
        self,
        functions: Sequence[tree.Function],
        edge: Edge | None = None,
        reserved: Iterable[str] = (),
    ) -> None:
        self.functions = functions
        language = self.function_printer.language
        spellings = {name: i.spelling.get(language, name) for name, i in INTRINSICS.items()}
        natives = {n: s for n, s in spellings.items() if not isinstance(s, Written)}
        written = written_functions(edge)
        self.written = {name: f for name, f in written.items() if name not in natives}
        """Helpers, of `lang.helpers` and `lang.elementary`, that intrinsics call, by name."""
        self.needed: set[tree.Function] = set()
        """The helpers that the functions printed so far call."""
        self.records: dict[Any, None] = {}
        for function in functions:
            for t in [*function.parameters.values(), function.result, *function.locals.values()]:
                self.add_record(t)
        names = [s for s in natives.values() if not isinstance(s, Text)]
        self.reserved = {*self.reserved_words, *self.declared_names, *names, *reserved}
        self.scope: dict[Any, str] = {}
        """Unique names of functions and records."""
        for function in [*functions, *self.written.values()]:
            self.assign_name(function, function.name)
        for record in self.records:
            self.assign_name(record, record.__name__)

    def add_record(self, t: Any) -> None:
        """Add a record, or the record of a buffer's items, after the records of its fields."""
        t = buffer_record(t) or t
        if is_record(t) and t not in self.records:
            for field in fields_of(t).values():
                self.add_record(field)
            self.records[t] = None

    def assign_name(self, obj: Any, name: str) -> str:
        """Assign a unique name to a function or type of the module, and return it."""
        while name in self.reserved:
            name += "_"
        self.reserved.add(name)
        self.scope[obj] = name
        return name

    def field(self, name: str) -> str:
        """Name of a field, changed if the language reserves it."""
        return f"{name}_" if name in self.reserved_words else name

    def type(self, t: Any) -> str:
        return self.types[t] if t in self.types else self.reference(t)

    def reference(self, obj: Any) -> str:
        """Name of a function or type of the module, where it is used."""
        return self.scope[obj]

    def is_passed(self, t: Any) -> bool:
        """Whether a value of this type is passed to functions; buffers are global."""
        return buffer_record(t) is None

    def static(self, condition: tree.Condition, then: str, otherwise: str) -> str:
        """Text that selects between two texts by a static condition.

        Only libraries have such conditions; programs are specialized before they are printed.
        """
        raise AssertionError(condition)

    def function_texts(self) -> dict[str, str]:
        """Texts of the functions by name, after those of the helpers that they call."""
        texts = {f: self.function_printer(self, f).text() for f in self.functions}
        # callers first, since printing them decides which are needed
        for function in reversed(self.written.values()):
            if function in self.needed:
                texts[function] = self.function_printer(self, function).text()
        order = [*self.written.values(), *self.functions]
        return {self.scope[f]: texts[f] for f in order if f in texts}

    def parameter_names(self, function: tree.Function) -> dict[str, str]:
        """Unique names of the parameters of a function that are passed."""
        names = self.function_printer(self, function).names
        return {name: names[name] for name, t in function.parameters.items() if self.is_passed(t)}

    @abstractmethod
    def record_text(self, record: Any) -> str:
        """Text of the declaration of a record."""

    def declarations(self) -> dict[str, str]:
        """Texts of the functions, and of all that they need, by name, callees before callers."""
        functions = self.function_texts()
        return {self.scope[r]: self.record_text(r) for r in self.records} | functions


class FunctionPrinter:
    """Printer of one function."""

    language: ClassVar[str]
    """Name of the target in the spellings of intrinsics."""

    def __init__(self, module: Any, function: tree.Function) -> None:
        self.module = module
        self.function = function
        self.lines: list[str] = []
        self.indent = 1
        self.names: dict[str, str] = {}
        self.used = set(module.reserved)
        for name in [*function.parameters, *function.locals]:
            self.names[name] = self.fresh(name)

    def fresh(self, name: str) -> str:
        """A name that is unique in the function; the loop variable `_` becomes `round`."""
        unique = "round" if name == "_" else name
        while unique in self.used:
            unique += "_"
        self.used.add(unique)
        return unique

    def text(self) -> str:
        """Text of the function, with its docstring as comments before it."""
        f = self.function
        parameters = [
            self.parameter(self.names[name], t)
            for name, t in f.parameters.items()
            if self.module.is_passed(t)
        ]
        self.block(f.body)
        doc = [f"// {line}".rstrip() for line in f.doc.splitlines()]
        head = self.head(self.module.scope[f], ", ".join(parameters), f.result)
        return "\n".join([*doc, f"{head} {{", "".join(self.lines) + "}\n"])

    def emit(self, line: str) -> None:
        self.lines.append("  " * self.indent + line + "\n")

    # --- what languages spell differently -------------------------------------------------------

    def head(self, name: str, parameters: str, result: Any) -> str:
        """Head of a function, up to its brace."""
        return f"{self.module.type(result)} {name}({parameters})"

    def parameter(self, name: str, t: Any) -> str:
        return f"{self.module.type(t)} {name}"

    def declaration(self, name: str, t: Any, value: str | None, constant: bool = False) -> str:
        """Declaration of a variable, with its first value if there is one."""
        return f"{self.module.type(t)} {name}" + (f" = {value}" if value is not None else "")

    def select(self, node: tree.Select) -> str:
        """Text that selects between two values by a condition that is known only at run time."""
        test, then = self.operand(node.test, 4), self.operand(node.then, 4)
        return f"({test} ? {then} : {self.operand(node.otherwise, 4)})"

    def long_step_loop(self, name: str, stop: str, node: tree.For) -> None:
        """Emit a loop with a step above 1, whose counter must not overflow after the last pass."""
        last = self.fresh(f"{name}_last")
        self.emit(f"bool {last} = false;")
        declared = self.declaration(name, int, self.value(node.start))
        advance = f"{last} = {name} > {2**31 - 1 - node.step}, {name} += {node.step}"
        self.emit(f"for ({declared}; !{last} && {name} < {stop}; {advance}) {{")
        self.inner(node.body)
        self.emit("}")

    def intrinsic_call(self, node: tree.IntrinsicCall, texts: list[str]) -> str:
        """A call of an intrinsic, given the texts of its arguments."""
        spelling = INTRINSICS[node.name].spelling.get(self.language, node.name)
        if isinstance(spelling, Written):
            return self.call(self.module.written[spelling], texts)
        if isinstance(spelling, Text):
            return spelling.format(*texts)
        return f"{spelling}({', '.join(texts)})"

    def call(self, function: tree.Function, texts: Iterable[str]) -> str:
        """A call of a function of the module or of a helper."""
        if function not in self.module.functions:
            self.module.needed.add(function)
        return f"{self.module.reference(function)}({', '.join(texts)})"

    def item(self, node: tree.Item) -> str:
        """An item of a buffer; a language without buffers refuses them before it prints."""
        raise AssertionError(node)

    # --- statements -----------------------------------------------------------------------------

    def block(self, block: tree.Block) -> None:
        for name, t in block.hoisted.items():
            self.emit(f"{self.declaration(self.names[name], t, None)};")
        for statement in block.statements:
            for comment in statement.comments:
                self.emit(f"// {comment}")
            self.statement(statement)

    def inner(self, block: tree.Block) -> None:
        self.indent += 1
        self.block(block)
        self.indent -= 1

    def block_text(self, block: tree.Block) -> str:
        """Text of a block without braces, at the current indentation."""
        outer, self.lines = self.lines, []
        self.block(block)
        text, self.lines = "".join(self.lines), outer
        return text

    def statement(self, statement: tree.Statement) -> None:
        match statement:
            case tree.Assign(name, value, declares) if declares:
                t, constant = value.type, name in self.function.constants
                self.emit(f"{self.declaration(self.names[name], t, self.value(value), constant)};")
            case tree.Assign(name, value):
                self.emit(f"{self.names[name]} = {self.value(value)};")
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
            # as in Python, the bound is evaluated once, before the loop
            end = self.fresh(f"{name}_end")
            self.emit(f"{self.declaration(end, int, stop, constant=True)};")
            stop = end
        if node.step != 1:
            self.long_step_loop(name, stop, node)
            return
        self.emit(f"for ({self.declaration(name, int, start)}; {name} < {stop}; {name}++) {{")
        self.inner(node.body)
        self.emit("}")

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: tree.Expression) -> str:
        """Text of an expression, with parentheses only where they are needed."""
        match node:
            case tree.Literal(t, value):
                return self.literal(t, value)
            case tree.Local(_, name):
                return self.names[name]
            case tree.Unary(_, operator, operand):
                return f"{'!' if operator == 'not' else '-'}{self.operand(operand, 8)}"
            case tree.Binary(_, operator, left, right) if operator in ("//", "%"):
                name = "floor_divide" if operator == "//" else "floor_modulo"
                return self.call(self.module.written[name], map(self.argument, (left, right)))
            case tree.Infix(_, operator, left, right):
                return self.infix(operator, left, right)
            case tree.Static(_, condition):
                return str(self.module.static(condition, "true", "false"))
            case tree.Select(_, tree.Static(_, condition), then, otherwise):
                texts = (self.argument(then), self.argument(otherwise))
                return str(self.module.static(condition, *texts))
            case tree.Select():
                return self.select(node)
            case tree.Swizzle(_, operand, indices) if operand.type not in VECTORS:
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
                passed = (self.argument(a) for a in arguments if self.module.is_passed(a.type))
                return self.call(function, passed)
            case tree.Item():
                return self.item(node)
        raise AssertionError(node)

    def literal(self, t: type, value: Any) -> str:
        if t is bool:
            return "true" if value else "false"
        if t is int:
            return str(value) if value > -(2**31) else "(-2147483647 - 1)"
        number = np.float32(value)
        if not math.isfinite(number):
            raise ShaderError(f"the number {value} is too large for float32; write a smaller one")
        text = str(number)
        return text if set(text) & set(".e") else f"{text}.0"

    def arguments(self, nodes: Iterable[tree.Expression]) -> str:
        """Text of the arguments of a call."""
        return ", ".join(map(self.argument, nodes))

    def argument(self, node: tree.Expression) -> str:
        """Text of an argument."""
        return self.value(node)

    def operand(self, node: tree.Expression, precedence: int) -> str:
        """Text of an operand, in parentheses where it binds less tightly than `precedence`."""
        text = self.value(node)
        return f"({text})" if self.operator_precedence(node, text) < precedence else text

    def infix(self, operator: str, left: tree.Expression, right: tree.Expression) -> str:
        symbol = SYMBOLS.get(operator, operator)
        precedence = PRECEDENCE[symbol]
        if symbol in ("<<", ">>"):
            assert isinstance(right, tree.Literal)
            return f"{self.operand(left, 8)} {symbol} {right.value}u"
        if symbol in ("&", "|", "^"):
            return f"{self.operand(left, 8)} {symbol} {self.operand(right, 8)}"
        if symbol in ("&&", "||"):
            # WGSL requires parentheses where && and || are mixed, and they help readers
            same = isinstance(left, tree.Logic) and left.operator == operator
            return (
                f"{self.operand(left, precedence if same else 3)} {symbol} {self.operand(right, 3)}"
            )
        a = self.operand(left, precedence + (symbol in COMPARISONS))
        return f"{a} {symbol} {self.operand(right, precedence + 1)}"

    def operator_precedence(self, node: tree.Expression, text: str) -> int:
        """Precedence of the outermost operator of an expression, given its text."""
        match node:
            case tree.Binary(operator=operator) if operator in ("//", "%"):
                return 9
            case tree.Infix(operator=operator):
                return PRECEDENCE[SYMBOLS.get(operator, operator)]
            case tree.Unary():
                return 7
            case tree.Select(test=tree.Static()):
                return -1
        return 7 if text.startswith("-") else 9

    def intrinsic(self, node: tree.IntrinsicCall) -> str:
        """Text of a call of an intrinsic, with scalars as vectors where it takes vectors."""
        texts = [self.argument(a) for a in node.arguments]
        rule = INTRINSICS[node.name].rule
        if isinstance(rule, Componentwise) and node.type in VECTORS:
            vector = self.module.type(node.type)
            for index in range(rule.count - rule.scalars):
                if node.arguments[index].type in SCALARS:
                    texts[index] = f"{vector}({texts[index]})"
        return self.intrinsic_call(node, texts)


def is_finest(level: tree.Expression) -> bool:
    """Whether a mip level is the literal 0."""
    return isinstance(level, tree.Literal) and level.value == 0


SYMBOLS = {"@": "*", "and": "&&", "or": "||"}
"""Operators whose symbols differ from Python's."""
PRECEDENCE = {
    "||": 1, "&&": 2, "<": 3, "<=": 3, ">": 3, ">=": 3, "==": 3, "!=": 3, "&": 0, "|": 0, "^": 0,
    "<<": 0, ">>": 0, "+": 5, "-": 5, "*": 6, "/": 6,
}  # fmt: skip
"""Precedence of infix operators, higher binds tighter; that of unary operators is 7, that of calls,
members and names 9. That of bit operators is 0, so that as operands they are always in parentheses,
because languages disagree about it."""
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")
