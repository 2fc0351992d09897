"""The typed tree: the intermediate representation between the front end and the printers.

Every expression has a type. Statements keep the comments above them, so that a printer can print
them too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

Condition = tuple[Any, ...]
"""A condition on the static record of a program, as data: `(field, values)` where the field has one
of the values, `("not", condition)`, `("and", a, b)` or `("or", a, b)`."""


def holds(condition: Condition, value_of: Callable[[str], Any]) -> bool:
    """Whether a condition is true; `value_of` gives the value of a static field by its name."""
    match condition:
        case ("not", a):
            return not holds(a, value_of)
        case ("and", a, b):
            return holds(a, value_of) and holds(b, value_of)
        case ("or", a, b):
            return holds(a, value_of) or holds(b, value_of)
    name, values = condition
    return value_of(name) in values


@dataclass(frozen=True)
class Expression:
    """Node that has a value."""

    type: Any


@dataclass(frozen=True)
class Literal(Expression):
    value: float | int | bool


@dataclass(frozen=True)
class Local(Expression):
    """A parameter or a local variable."""

    name: str


@dataclass(frozen=True)
class Static(Expression):
    """A bool that is known when a program is made; specialized trees have none."""

    condition: Condition


@dataclass(frozen=True)
class Unary(Expression):
    """`-x` or `not x`."""

    operator: str
    operand: Expression


@dataclass(frozen=True)
class Infix(Expression):
    """Two expressions with an operator between them."""

    operator: str
    left: Expression
    right: Expression


class Binary(Infix):
    """`+ - * / // % @ & | ^ << >>`; one side may be a scalar where the other is a vector."""


class Compare(Infix):
    """`< <= > >= == !=` of two scalars of one type."""


class Logic(Infix):
    """`and` or `or` of bools."""


@dataclass(frozen=True)
class Select(Expression):
    """`then if test else otherwise`."""

    test: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True)
class Swizzle(Expression):
    """Components of a vector by index, or one column of a matrix."""

    operand: Expression
    indices: tuple[int, ...]


@dataclass(frozen=True)
class Member(Expression):
    """A field of a record."""

    operand: Expression
    name: str


@dataclass(frozen=True)
class Construct(Expression):
    """A vector, matrix or record from its parts; a single scalar fills a whole vector."""

    parts: tuple[Expression, ...]


@dataclass(frozen=True)
class IntrinsicCall(Expression):
    name: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True)
class Call(Expression):
    """A call of another function of the program."""

    function: Function
    arguments: tuple[Expression, ...]


@dataclass(frozen=True)
class ShaderCall(Expression):
    """A call of a shader or slot, before a program binds it to a function."""

    shader: Any
    arguments: tuple[Expression, ...]


@dataclass(frozen=True)
class Item(Expression):
    """`buffer[index]`, the index clamped to the buffer."""

    buffer: Expression
    index: Expression


def map_children(node: Expression, change: Callable[[Expression], Expression]) -> Expression:
    """The same expression with `change` applied to each of its operands."""

    def mapped(value: Any) -> Any:
        if isinstance(value, Expression):
            return change(value)
        return tuple(map(mapped, value)) if isinstance(value, tuple) else value

    return type(node)(*(mapped(getattr(node, name)) for name in node.__match_args__))


@dataclass
class Statement:
    """Node without a value; `comments` stood above it in the source."""

    comments: tuple[str, ...] = field(default=(), kw_only=True)


@dataclass
class Assign(Statement):
    """`name = value`; `declares` where it declares the variable in its block."""

    name: str
    value: Expression
    declares: bool = False


@dataclass
class If(Statement):
    test: Expression
    body: Block
    otherwise: Block


@dataclass
class For(Statement):
    """`for name in range(start, stop, step)`, step a positive literal."""

    name: str
    start: Expression
    stop: Expression
    step: int
    body: Block


@dataclass
class While(Statement):
    test: Expression
    body: Block


@dataclass
class Break(Statement):
    pass


@dataclass
class Continue(Statement):
    pass


@dataclass
class Return(Statement):
    value: Expression


@dataclass
class Block:
    """Statements in order, and the variables that are declared on entry (name to type)."""

    statements: list[Statement] = field(default_factory=list)
    hoisted: dict[str, Any] = field(default_factory=dict)


@dataclass(eq=False)
class Function:
    """Typed shader: unique name, parameters, result, body, docstring, locals."""

    name: str
    parameters: dict[str, Any]
    result: Any
    body: Block
    doc: str
    location: str
    locals: dict[str, Any] = field(default_factory=dict)
    constants: frozenset[str] = frozenset()
    """Locals with one assignment, which declares them."""


@dataclass(eq=False)
class Module:
    """Whole program: functions, callees before callers."""

    functions: list[Function]
    entry: Function

    @property
    def handles(self) -> dict[str, Any]:
        """The resource parameters of the entry, by name."""
        from basrelief.lang.resources import is_handle

        return {n: t for n, t in self.entry.parameters.items() if is_handle(t)}


def contains(block: Block, *kinds: type[Statement]) -> bool:
    """Whether a block contains a statement of these kinds; `break` and `continue` of inner loops
    do not count."""
    for statement in block.statements:
        if isinstance(statement, kinds):
            return True
        inner = tuple(k for k in kinds if k not in (Break, Continue))
        match statement:
            case If(_, body, otherwise):
                if contains(body, *kinds) or contains(otherwise, *kinds):
                    return True
            case For(body=body) | While(body=body):
                if inner and contains(body, *inner):
                    return True
    return False


def expressions(node: Any) -> Iterator[Expression]:
    """All expressions in a block, statement or expression, each before its operands."""
    # a stack, since generators within generators are slow
    stack = [node]
    while stack:
        node = stack.pop()
        match node:
            case tuple() | list():
                stack += reversed(node)
            case Block():
                stack += reversed(node.statements)
            case Expression() | Statement():
                if isinstance(node, Expression):
                    yield node
                stack += [getattr(node, name) for name in reversed(node.__match_args__)]
