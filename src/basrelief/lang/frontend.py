"""The front end: Python syntax trees of shaders → typed trees, with names resolved and types
inferred.

Source outside the subset is refused with file, line, carets under the text and what to write
instead.
Everything is a value, each name has one type, and every loop terminates.
"""

from __future__ import annotations

import ast
import functools
import inspect
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from basrelief.lang import conditions, elementary, helpers, tree
from basrelief.lang.intrinsics import Intrinsic, intrinsic_of
from basrelief.lang.resources import (
    MAPS,
    Edge,
    Map,
    buffer_record,
    condition_fields,
    flatten_parameter,
    flatten_parameters,
    is_erased,
    is_handle,
    members_of,
)
from basrelief.lang.shader import INT_RANGE, Shader
from basrelief.lang.slots import Bindings, bound_types
from basrelief.lang.specialize import library_functions, specialize
from basrelief.lang.types import (
    SCALARS,
    VECTORS,
    StaticField,
    fields_of,
    is_record,
    is_type_slot,
    type_name,
)
from basrelief.lang.values import Mat3, Vec3, swizzle_indices

_BINARY = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%",
    ast.MatMult: "@", ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.LShift: "<<",
    ast.RShift: ">>",
}  # fmt: skip
_COMPARE = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip


_MAX_FLOAT = 3.4028235e38


def analyse(
    entry: Shader[..., Any],
    bindings: Bindings | None = None,
    static_value: Callable[[str], Any] = lambda name: None,
) -> tree.Module:
    """Typed tree of a program: the entry and all functions that it calls, with its slots bound.

    `static_value` gives the value of each static field by name. Raises ShaderError for source
    outside the subset, also in branches that are not taken.
    """
    bindings = bindings or {}
    types = bound_types(bindings)
    functions = _reachable([entry], bindings)
    return specialize(_resolve_slot(entry, bindings), functions, bindings, types, static_value)


def analyse_library(
    shaders: Iterable[Shader[..., Any]], static_value: Callable[[str], Any] = lambda name: None
) -> dict[Shader[..., Any], tree.Function]:
    """Typed functions of shaders and of all their callees, unspecialized.

    A slot becomes a function of its own name without a body. Type slots, unread parameters, and
    static conditions on fields for which `static_value` gives None remain.
    """
    return library_functions(_reachable(shaders, None), static_value)


@functools.cache
def written_functions(edge: Edge | None = None) -> dict[str, tree.Function]:
    """Typed functions of `lang.helpers` and `lang.elementary` by name, callees before callers.

    `edge` is that of all maps; None leaves it a static condition.
    """
    found = [*vars(helpers).values(), *vars(elementary).values()]
    functions = _reachable([s for s in found if isinstance(s, Shader)], None)
    return {f.name: f for f in library_functions(functions, lambda name: edge).values()}


@dataclass(frozen=True)
class _Analysis:
    """Typed function of a shader, the shaders that it calls, and the values of its global names."""

    function: tree.Function
    calls: tuple[Shader[..., Any], ...]
    names: Mapping[str, Any]


def _analysis_of(shader: Shader[..., Any]) -> _Analysis:
    """Analysis of a shader, independent of programs; repeated when a global name has changed."""
    cached: _Analysis | None = shader.analysis
    if cached is None or any(shader.find(name) is not v for name, v in cached.names.items()):
        cached = shader.analysis = _FunctionAnalysis(shader).run()
    return cached


def _reachable(
    shaders: Iterable[Shader[..., Any]], bindings: Bindings | None
) -> dict[Shader[..., Any], tree.Function]:
    """Typed functions of shaders and of all their callees, callees before callers.

    With bindings, a slot is replaced by the shader bound to it. Raises ShaderError for recursion.
    """
    functions: dict[Shader[..., Any], tree.Function] = {}
    visiting: list[Shader[..., Any]] = []

    def visit(shader: Shader[..., Any]) -> None:
        if bindings is not None:
            shader = _resolve_slot(shader, bindings)
        if shader in functions:
            return
        if shader in visiting:
            raise shader.error(f"{shader.name} calls itself; write a bounded loop")
        visiting.append(shader)
        analysis = _analysis_of(shader)
        for callee in analysis.calls:
            visit(callee)
        visiting.pop()
        functions[shader] = analysis.function

    for shader in shaders:
        visit(shader)
    return functions


def _resolve_slot(shader: Shader[..., Any], bindings: Bindings) -> Shader[..., Any]:
    """The shader itself, or the shader bound to it if it is a slot."""
    while shader.is_slot:
        if shader not in bindings:
            raise shader.error(f"the slot {shader.name} is not bound; pass a shader for it")
        shader = bindings[shader]
    return shader


class _FunctionAnalysis:
    """Analysis of one shader, statement by statement."""

    def __init__(self, shader: Shader[..., Any]) -> None:
        self.shader = shader
        self.source = shader.source
        self.parameters, self.result = shader.signature
        self.check_signature()
        for name, t in [*self.parameters.items(), ("return", self.result)]:
            self.check_type(t, name)
        self.locals: dict[str, Any] = {}
        self.loop_names: set[str] = set()
        self.assigned: set[str] = set()
        self.calls: dict[Shader[..., Any], None] = {}
        self.names: dict[str, Any] = {}
        self.block = tree.Block()

    def check_signature(self) -> None:
        code = self.shader.function.__code__
        if not len(self.parameters) == code.co_argcount == len(self.source.tree.args.args):
            raise self.shader.error(
                "parameters with * or / are outside the subset; write plain parameters"
            )
        for name in (self.shader.name, *code.co_varnames):
            self.check_name(name)
        for name, t in self.parameters.items():
            for member in members_of(t):
                if f"{name}_{member}" in code.co_varnames:
                    raise self.shader.error(
                        f"{name}_{member} is the name of {name}.{member} in a program; use another "
                        "name"
                    )

    def check_name(self, name: str) -> None:
        if not name.isascii():
            raise self.shader.error(
                f"the name {name} is not ASCII, which shading languages require; rename it", name
            )

    def check_type(self, t: Any, name: str, is_field: bool = False) -> None:
        record = buffer_record(t) or t
        if is_record(record):
            for field, inner in fields_of(record).items():
                self.check_name(field)
                self.check_type(inner, name, is_field=True)
        is_value = t in SCALARS or t in VECTORS or t is Mat3 or is_record(t) or is_type_slot(t)
        handle = is_handle(t) and (record is t or is_record(record))
        is_parameter = handle or is_erased(t) or members_of(t)
        if is_value or (is_parameter and name != "return" and not is_field):
            return
        handles = " or a resource handle" if name != "return" and not is_field else ""
        raise self.shader.error(
            f"{type_name(t)} is not a type of the subset; use float, int, bool, Vec2 … Mat3, "
            f"a @struct{handles}",
            name,
        )

    def run(self) -> _Analysis:
        if not self.shader.is_slot:
            terminates = self.analyse_block(self.block, self.source.tree.body)
            if terminates is not True:
                raise self.source.error(
                    self.source.tree.body[-1],
                    f"{self.shader.name} can end without a result; end every path with `return`",
                )
        function = tree.Function(
            name=self.shader.name,
            parameters=flatten_parameters(self.parameters),
            result=self.result,
            body=self.block,
            doc=inspect.cleandoc(self.shader.__doc__ or ""),
            location=self.shader.location,
            locals=self.locals,
        )
        return _Analysis(function, tuple(self.calls), self.names)

    # --- statements -------------------------------------------------------------------------

    def analyse_block(self, block: tree.Block, statements: list[ast.stmt]) -> conditions.Terminates:
        """Analyse statements into a block; returns whether every path leaves the block."""
        outer, self.block = self.block, block
        terminates: conditions.Terminates = False
        for index, node in enumerate(statements):
            if terminates is True:
                raise self.source.error(node, "unreachable statement; remove it")
            if terminates is not False:
                # the other statements run only where the static condition does not leave the block
                rest = tree.Block()
                self.emit(tree.If(tree.Static(bool, terminates), tree.Block(), rest))
                terminates = conditions.disjunction(
                    terminates, self.analyse_block(rest, statements[index:])
                )
                break
            before = self.source.comments_before(node.lineno)
            terminates = self.statement(node, before)
        self.block = outer
        return terminates

    def emit(self, statement: tree.Statement) -> None:
        self.block.statements.append(statement)

    def statement(self, node: ast.stmt, comments: tuple[str, ...]) -> conditions.Terminates:
        match node:
            case ast.Expr(ast.Constant(str())):
                return False
            case ast.Assign([ast.Name(name)], value):
                self.assign(node, name, self.expression(value), comments)
            case ast.AnnAssign(ast.Name(name), _, ast.expr() as value):
                self.assign(node, name, self.expression(value), comments)
            case ast.AugAssign(ast.Name(name), operator, value):
                current = ast.copy_location(ast.Name(name, ast.Load()), node)
                whole = ast.copy_location(ast.BinOp(current, operator, value), node)
                self.assign(node, name, self.expression(whole), comments)
            case ast.If():
                return self.if_statement(node, comments)
            case ast.For(ast.Name(), ast.Call(ast.Name("range"), _, []), _, []):
                self.for_statement(node, comments)
            case ast.While(orelse=[]):
                self.while_statement(node, comments)
            case ast.Break() | ast.Continue():
                kind = tree.Break if isinstance(node, ast.Break) else tree.Continue
                self.emit(kind(comments=comments))
                return True
            case ast.Return(ast.expr() as value):
                result = self.expression(value)
                self.expect(value, result.type, self.result, "the result")
                self.emit(tree.Return(result, comments=comments))
                return True
            case ast.Pass():
                return False
            case _:
                raise self.source.error(node, _statement_hint(node))
        return False

    def assign(
        self, node: ast.stmt, name: str, value: tree.Expression, comments: tuple[str, ...]
    ) -> None:
        if name in self.parameters:
            raise self.source.error(node, "a parameter cannot be assigned to; use a new name")
        if name in self.loop_names:
            raise self.source.error(node, "a loop counter cannot be assigned to; use a new name")
        if is_handle(value.type):
            raise self.source.error(node, "a resource cannot be assigned; pass it as an argument")
        first_type = self.locals.setdefault(name, value.type)
        self.expect(node, value.type, first_type, f"the variable {name}")
        self.assigned.add(name)
        self.emit(tree.Assign(name, value, comments=comments))

    def if_statement(self, node: ast.If, comments: tuple[str, ...]) -> conditions.Terminates:
        test = self.condition(node.test)
        then, otherwise = tree.Block(), tree.Block()
        before = set(self.assigned)
        then_terminates = self.analyse_block(then, node.body)
        after_then, self.assigned = self.assigned, set(before)
        else_terminates = self.analyse_block(otherwise, node.orelse)
        after_else = self.assigned
        if then_terminates is True or else_terminates is True:
            self.assigned = after_else if then_terminates is True else after_then
        else:
            self.assigned = after_then & after_else
        (statement,) = conditions.hoist_static(test, then, otherwise, conditions.branch).statements
        statement.comments = comments
        self.emit(statement)
        return conditions.hoist_static(
            test, then_terminates, else_terminates, conditions.if_terminates
        )

    def for_statement(self, node: ast.For, comments: tuple[str, ...]) -> None:
        assert isinstance(node.target, ast.Name)
        assert isinstance(node.iter, ast.Call)
        name = node.target.id
        if not 1 <= len(node.iter.args) <= 3:
            raise self.source.error(
                node.iter, "range takes (stop), (start, stop) or (start, stop, step)"
            )
        bounds = [self.expression(a) for a in node.iter.args]
        for bound, text in zip(bounds, node.iter.args, strict=True):
            self.expect(text, bound.type, int, "a bound of range")
        start = bounds[0] if len(bounds) > 1 else tree.Literal(int, 0)
        stop = bounds[1] if len(bounds) > 1 else bounds[0]
        step = bounds[2] if len(bounds) > 2 else tree.Literal(int, 1)
        if not isinstance(step, tree.Literal) or step.value <= 0:
            raise self.source.error(
                node.iter,
                "the step of a range must be a positive literal; to count down, use n - 1 - k",
            )
        is_counter = name in self.loop_names and name != "_"
        if is_counter or name in self.parameters or name in self.locals:
            raise self.source.error(
                node.target, f"{name} is already a variable; use a new name for the counter"
            )
        self.loop_names.add(name)
        inner = self.loop_body(node, name)
        self.loop_names.discard(name)
        self.emit(tree.For(name, start, stop, int(step.value), inner, comments=comments))

    def while_statement(self, node: ast.While, comments: tuple[str, ...]) -> None:
        test = self.condition(node.test)
        if not _is_counted_loop(node):
            raise self.source.error(
                node.test,
                "this loop may not terminate; count in it (`k < n and …`, with `k = k + 1` "
                "last in the body), or write `for k in range(n)` with a `break`",
            )
        inner = self.loop_body(node, None)
        self.emit(tree.While(test, inner, comments=comments))

    def loop_body(self, node: ast.For | ast.While, counter: str | None) -> tree.Block:
        inner = tree.Block()
        before = set(self.assigned)
        if counter:
            self.assigned.add(counter)
        self.analyse_block(inner, node.body)
        self.assigned = before
        return inner

    # --- expressions ------------------------------------------------------------------------

    def expect(self, node: ast.AST, actual: Any, expected: Any, what: str) -> None:
        if actual != expected:
            message = f"{what} is {type_name(expected)}, not {type_name(actual)}"
            raise self.source.error(node, f"{message}; {_conversion_hint(actual, expected)}")

    def condition(self, node: ast.expr) -> tree.Expression:
        test = self.expression(node)
        self.expect(node, test.type, bool, "a condition")
        return test

    def expression(self, node: ast.expr) -> tree.Expression:
        match node:
            case ast.Constant(value):
                return self.literal(node, value)
            case ast.Name(name):
                return self.name(node, name)
            case ast.UnaryOp():
                return self.unary(node)
            case ast.BinOp():
                return self.binary(node)
            case ast.BoolOp(operator, values):
                parts = [self.condition(value) for value in values]
                word = "and" if isinstance(operator, ast.And) else "or"
                return functools.reduce(functools.partial(conditions.logic, word), parts)
            case ast.Compare():
                return self.comparison(node)
            case ast.IfExp(test, then, otherwise):
                a, b = self.expression(then), self.expression(otherwise)
                condition = self.condition(test)
                if is_handle(a.type) and not isinstance(condition, tree.Static):
                    raise self.source.error(
                        node, "a texture or buffer can be selected only by a static condition; "
                        "select between the values read"
                    )  # fmt: skip
                self.expect(otherwise, b.type, a.type, "the other value")
                return conditions.hoist_static(condition, a, b, conditions.select)
            case ast.Attribute(operand, name):
                if self.static_fields_of(operand):
                    return self.static_bool(node)
                if members_of(self.parameter_type(operand)):
                    return self.member(node, operand)
                return self.attribute(node, self.expression(operand), name)
            case ast.Subscript(operand, index):
                buffer = self.expression(operand)
                record = buffer_record(buffer.type)
                if record is None:
                    raise self.source.error(
                        node, "only a Buffer can be indexed; name components, as in `v.x`"
                    )
                position = self.expression(index)
                self.expect(index, position.type, int, "an index")
                return tree.Item(record, buffer, position)
            case ast.Call():
                return self.call(node)
        raise self.source.error(node, _expression_hint(node))

    def literal(self, node: ast.AST, value: Any) -> tree.Expression:
        if type(value) is int and not -(2**31) <= value < 2**31:
            raise self.source.error(node, INT_RANGE)
        if type(value) is float and _MAX_FLOAT < abs(value) < math.inf:
            raise self.source.error(node, "a float has 32 bits; write a number up to 3.4028235e38")
        if type(value) not in SCALARS:
            raise self.source.error(
                node,
                "write a number or a bool; strings are for static conditions only, as in "
                '`variant.fog_mode == "linear"`',
            )
        return tree.Literal(type(value), value)

    def name(self, node: ast.Name, name: str) -> tree.Expression:
        if is_erased(self.parameters.get(name)):
            raise self.source.error(
                node,
                f"{name} is not a value; branch on its fields, or pass it to a shader",
            )
        if members_of(self.parameters.get(name)):
            raise self.source.error(
                node, f"{name} is a group of resources; name a member, or pass it to a shader"
            )
        if name in self.parameters:
            return tree.Local(self.parameters[name], name)
        if name in self.loop_names:
            return tree.Local(int, name)
        if name in self.locals:
            if name not in self.assigned:
                raise self.source.error(
                    node, f"{name} may be unassigned here; assign it before the branch"
                )
            return tree.Local(self.locals[name], name)
        value = self.lookup(node, name)
        if type(value) in SCALARS:
            return self.literal(node, value)
        raise self.source.error(
            node, f"{name} is not a number or a value of this shader; pass it as a parameter"
        )

    def lookup(self, node: ast.AST, name: str) -> Any:
        """Value of a global or enclosing name, which the shader must not assign to."""
        if name in self.shader.function.__code__.co_varnames:
            raise self.source.error(
                node,
                f"{name} is assigned in this shader and has no value here; use another name",
            )
        try:
            self.names[name] = self.shader.lookup(name)
        except KeyError:
            raise self.source.error(node, f"{name} is not defined; define or import it") from None
        return self.names[name]

    def unary(self, node: ast.UnaryOp) -> tree.Expression:
        operand = self.expression(node.operand)
        if isinstance(node.op, ast.Not):
            self.expect(node.operand, operand.type, bool, "the operand of `not`")
            return conditions.negation(operand)
        number = operand.type in (float, int) or operand.type in VECTORS
        if not isinstance(node.op, ast.USub) or not number:
            raise self.source.error(
                node, "write `-x` for a number or vector, or `not x` for a bool"
            )
        if isinstance(operand, tree.Literal) and operand.type is int:
            return tree.Literal(int, _fold_ints("-", 0, int(operand.value)))
        return tree.Unary(operand.type, "-", operand)

    def binary(self, node: ast.BinOp) -> tree.Expression:
        left, right = self.expression(node.left), self.expression(node.right)
        symbol = _BINARY.get(type(node.op))
        if symbol is None:
            raise self.source.error(
                node, "there is no such operator; for a power write pow(x, y), or x * x"
            )
        result = _binary_type(symbol, left, right)
        if result is None:
            raise self.source.error(
                node,
                f"`{symbol}` does not apply to {type_name(left.type)} and {type_name(right.type)}"
                + _binary_hint(symbol, left, right),
            )
        if isinstance(left, tree.Literal) and isinstance(right, tree.Literal) and result is int:
            # targets fold expressions of literals with rules of their own: leave them none
            return tree.Literal(int, _fold_ints(symbol, int(left.value), int(right.value)))
        if isinstance(left, tree.Literal) and isinstance(right, tree.Literal) and result is float:
            with np.errstate(all="ignore"):
                number = float(
                    _FOLDED_OPERATORS[symbol](np.float32(left.value), np.float32(right.value))
                )
            if math.isfinite(number):
                return tree.Literal(float, number)
        return tree.Binary(result, symbol, left, right)

    def comparison(self, node: ast.Compare) -> tree.Expression:
        if any(self.static_field(n) for n in [node.left, *node.comparators]):
            return self.static_comparison(node)
        operands = [self.expression(n) for n in [node.left, *node.comparators]]
        parts: list[tree.Expression] = []
        for compared, a, b in zip(node.ops, operands, operands[1:], strict=False):
            symbol = _COMPARE.get(type(compared))
            same = a.type == b.type and a.type in SCALARS
            if symbol is None or not same or (a.type is bool and symbol not in ("==", "!=")):
                types = f"{type_name(a.type)} and {type_name(b.type)}"
                raise self.source.error(
                    node,
                    f"compare two floats or two ints, not {types}; "
                    + _comparison_hint(symbol, a.type, b.type),
                )
            parts.append(tree.Compare(bool, symbol, a, b))
        return functools.reduce(functools.partial(tree.Logic, bool, "and"), parts)

    def attribute(self, node: ast.AST, operand: tree.Expression, name: str) -> tree.Expression:
        t = operand.type
        if t in VECTORS:
            component, size = VECTORS[t]
            indices = swizzle_indices(name, size)
            result = indices and _vector_type(component, len(indices))
            if indices and result:
                return tree.Swizzle(result, operand, indices)
        elif t is Mat3 and name in "xyz" and len(name) == 1:
            return tree.Swizzle(Vec3, operand, ("xyz".index(name),))
        elif is_record(t) and name in fields_of(t):
            return tree.Member(fields_of(t)[name], operand, name)
        raise self.source.error(node, f"{type_name(t)} has no field {name}; {_fields_hint(t)}")

    # --- static conditions ---------------------------------------------------------------------

    def parameter_type(self, node: ast.AST) -> Any:
        """Type of the parameter or member of a group that a node names; None for other nodes."""
        match node:
            case ast.Name(name):
                return self.parameters.get(name)
            case ast.Attribute(ast.Name(name), member):
                return members_of(self.parameters.get(name)).get(member)
        return None

    def member(self, node: ast.Attribute, group: ast.expr) -> tree.Expression:
        """Member of a group of resources."""
        t = self.parameter_type(node)
        if t is None:
            kind = self.parameter_type(group)
            members = ", ".join(members_of(kind))
            raise self.source.error(
                node, f"{type_name(kind)} has no member {node.attr}; it has {members}"
            )
        return tree.Local(t, f"{ast.unparse(group)}_{node.attr}")

    def static_fields_of(self, node: ast.AST) -> Mapping[str, StaticField]:
        """Fields that conditions can read of a static record or a map, by name; else none."""
        return condition_fields(self.parameter_type(node))

    def static_field(self, node: ast.AST) -> StaticField | None:
        """Field of a static record or map that a node reads; None for anything else."""
        fields = self.static_fields_of(node.value) if isinstance(node, ast.Attribute) else {}
        if not fields:
            return None
        assert isinstance(node, ast.Attribute)
        if node.attr not in fields:
            kind = type_name(self.parameter_type(node.value))
            raise self.source.error(
                node,
                f"{kind} has no field or property {node.attr} that is str, bool or int; it has "
                + ", ".join(fields),
            )
        return fields[node.attr]

    def static_bool(self, node: ast.Attribute) -> tree.Expression:
        """Static field as a condition. Raises ShaderError unless it is a bool."""
        field = self.static_field(node)
        assert field is not None
        if field.kind is not bool:
            example = repr(field.choices[0]) if field.choices else "…"
            raise self.source.error(
                node,
                f"{node.attr} is not a value; compare it with a literal, as in "
                f"`{ast.unparse(node)} == {example}`",
            )
        return tree.Static(bool, (field.name, (True,)))

    def static_comparison(self, node: ast.Compare) -> tree.Expression:
        """Comparison of a static field with one or more literals."""
        field, values = self.static_field(node.left), self.literals(node)
        if field is None or values is None:
            raise self.source.error(
                node,
                "compare a static field with a literal, by `==` or `!=`, or with several, by "
                "`in (…)` or `not in (…)`",
            )
        assert isinstance(node.left, ast.Attribute)
        name = node.left.attr
        for value in values:
            if type(value) is not field.kind:
                raise self.source.error(
                    node,
                    f"{name} is {type_name(field.kind)}, not {value!r}; compare it with a literal "
                    "of its type",
                )
            if field.choices and value not in field.choices:
                choices = ", ".join(map(str, field.choices))
                raise self.source.error(node, f"there is no {name} {value!r}; use one of {choices}")
        condition = tree.Static(bool, (field.name, values))
        if isinstance(node.ops[0], ast.NotEq | ast.NotIn):
            return conditions.negation(condition)
        return condition

    def literals(self, node: ast.Compare) -> tuple[Any, ...] | None:
        """Literals on the right side of a comparison; None for anything else."""
        match node.ops, node.comparators:
            case [ast.Eq() | ast.NotEq()], [ast.Constant(value)]:
                return (value,)
            case [ast.In() | ast.NotIn()], [ast.Tuple(items)]:
                constants = [item.value for item in items if isinstance(item, ast.Constant)]
                return tuple(constants) if len(constants) == len(items) > 0 else None
        return None

    # --- calls --------------------------------------------------------------------------------

    def call(self, node: ast.Call) -> tree.Expression:
        if not isinstance(node.func, ast.Name):
            raise self.source.error(
                node.func,
                "a call has the plain name of a shader or intrinsic; import it by name, as in "
                "`from basrelief.lang import sin`",
            )
        target = self.lookup(node.func, node.func.id)
        intrinsic = intrinsic_of(target)
        if intrinsic is not None:
            return self.intrinsic_call(node, intrinsic)
        if isinstance(target, Shader):
            return self.shader_call(node, target)
        if target in VECTORS or target is Mat3:
            return self.construct_vector(node, target)
        if is_record(target):
            return self.construct_record(node, target)
        raise self.source.error(node.func, f"{node.func.id} is not a shader; mark it with @shader")

    def intrinsic_call(self, node: ast.Call, intrinsic: Intrinsic) -> tree.Expression:
        arguments = self.positional(node)
        try:
            result = intrinsic.rule(tuple(a.type for a in arguments))
        except TypeError as error:
            hint = "; write 1.0 for 1, or float(…)" if int in {a.type for a in arguments} else ""
            raise self.source.error(node, f"{intrinsic.name} {error}{hint}") from None
        return tree.IntrinsicCall(result, intrinsic.name, arguments)

    def positional(self, node: ast.Call) -> tuple[tree.Expression, ...]:
        if node.keywords:
            raise self.source.error(node, "pass these arguments by position")
        return tuple(self.expression(a) for a in node.args)

    def arguments(self, node: ast.Call, names: list[str]) -> dict[str, ast.expr]:
        """Arguments of a call, by the names of its parameters."""
        if len(node.args) > len(names) or any(isinstance(a, ast.Starred) for a in node.args):
            raise self.source.error(
                node, f"{ast.unparse(node.func)} takes ({', '.join(names)}); pass these"
            )
        by_name = dict(zip(names, node.args, strict=False))
        for keyword in node.keywords:
            if keyword.arg not in names:
                raise self.source.error(
                    keyword,
                    f"there is no parameter {keyword.arg}; the parameters are {', '.join(names)}",
                )
            if keyword.arg in by_name:
                raise self.source.error(
                    keyword, f"the parameter {keyword.arg} has an argument already; remove one"
                )
            by_name[keyword.arg] = keyword.value
        return by_name

    def shader_call(self, node: ast.Call, target: Shader[..., Any]) -> tree.Expression:
        parameters, result = target.signature
        by_name = self.arguments(node, list(parameters))
        arguments: list[tree.Expression] = []
        for name, t in parameters.items():
            if name not in by_name:
                raise self.source.error(
                    node,
                    f"{target.name} needs an argument for {name}; pass a {type_name(t)}",
                )
            if is_erased(t) or members_of(t):
                passed = self.parameter_type(by_name[name])
                if passed is not t and not (t is Map and passed in MAPS):
                    raise self.source.error(
                        by_name[name], f"{name} is {type_name(t)}; pass the one of this shader"
                    )
                # an erased parameter is the same in the whole program and is not passed
                flat = flatten_parameter(ast.unparse(by_name[name]), t)
                arguments += [tree.Local(member, path) for path, member in flat.items()]
                continue
            argument = self.expression(by_name[name])
            self.expect(by_name[name], argument.type, t, name)
            arguments.append(argument)
        self.calls[target] = None
        return tree.ShaderCall(result, target, tuple(arguments))

    def construct_vector(self, node: ast.Call, target: Any) -> tree.Expression:
        parts = self.positional(node)
        if target is Mat3:
            fits = [p.type for p in parts] == [Vec3] * 3
        else:
            component, size = VECTORS[target]
            widths = [_width(p.type, component) for p in parts]
            fits = 0 not in widths and (sum(widths) == size or widths == [1])
        if not fits:
            types = ", ".join(type_name(p.type) for p in parts)
            parts_hint = "three Vec3, its columns"
            if target is not Mat3:
                kind = f"{type_name(component)}s"
                parts_hint = f"{size} {kind}, vectors of {size} {kind} in all, or one to repeat"
            raise self.source.error(
                node, f"cannot make a {type_name(target)} from ({types}); pass {parts_hint}"
            )
        return tree.Construct(target, parts)

    def construct_record(self, node: ast.Call, target: Any) -> tree.Expression:
        fields = fields_of(target)
        by_name = self.arguments(node, list(fields))
        parts: list[tree.Expression] = []
        for name, t in fields.items():
            if name in by_name:
                part = self.expression(by_name[name])
            elif hasattr(target, name) and type(getattr(target, name)) in SCALARS:
                part = self.literal(node, getattr(target, name))
            else:
                raise self.source.error(
                    node, f"{type_name(target)} needs a value for {name}; pass a {type_name(t)}"
                )
            self.expect(by_name.get(name, node), part.type, t, f"{type_name(target)}.{name}")
            parts.append(part)
        return tree.Construct(target, tuple(parts))


# --- rules of the subset ------------------------------------------------------------------------


def _width(t: Any, component: Any) -> int:
    if t is component:
        return 1
    kind, size = VECTORS.get(t, (None, 0))
    return size if kind is component else 0


def _vector_type(component: Any, count: int) -> Any:
    if count == 1:
        return component
    return next((t for t, shape in VECTORS.items() if shape == (component, count)), None)


def _binary_type(symbol: str, left: tree.Expression, right: tree.Expression) -> Any:
    """Type of `left symbol right`; None where the operator does not apply."""
    a, b = left.type, right.type
    if symbol == "@":
        return Vec3 if (a, b) == (Mat3, Vec3) else None
    if symbol in ("&", "|", "^", "//", "%"):
        return int if (a, b) == (int, int) else None
    if symbol in ("<<", ">>"):
        fits = isinstance(right, tree.Literal) and 0 <= right.value < 32
        return int if (a, b) == (int, int) and fits else None
    is_integer = a is int or VECTORS.get(a, (None,))[0] is int
    if symbol == "/" and is_integer:
        return None
    if a == b and (a in (float, int) or a in VECTORS):
        return a
    for vector, scalar in ((a, b), (b, a)):
        if vector in VECTORS and VECTORS[vector][0] is scalar:
            return vector
    return None


_FOLDED_OPERATORS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "//": operator.floordiv, "%": operator.mod, "&": operator.and_, "|": operator.or_,
    "^": operator.xor,
    "<<": operator.lshift, ">>": operator.rshift,
}  # fmt: skip


def _fold_ints(symbol: str, a: int, b: int) -> int:
    """Result of an operation on two int literals, in 32 bits."""
    with np.errstate(all="ignore"):
        return int(_FOLDED_OPERATORS[symbol](np.int32(a), np.int32(b)))


def _binary_hint(symbol: str, left: tree.Expression, right: tree.Expression) -> str:
    types = {left.type, right.type}
    if symbol == "@":
        return "; write a Mat3 @ a Vec3, or dot(a, b)"
    if symbol in ("<<", ">>"):
        return "; shift an int by a literal from 0 to 31"
    if symbol == "/" and types == {int}:
        return "; write // for an int quotient, or float(a) / float(b)"
    if symbol in ("//", "%"):
        return "; for floats use floor(a / b) or fract"
    if symbol in ("&", "|", "^"):
        return "; it takes two ints; for bools write `and`, `or` or `!=`"
    if types == {int, float}:
        return "; write 1.0 for 1, or float(…)"
    if bool in types:
        return "; for a bool write `1.0 if b else 0.0`, or float(b)"
    return "; its operands are two numbers or vectors of one type, or a vector and a number"


def _conversion_hint(actual: Any, expected: Any) -> str:
    """Instruction to convert a value to the expected type."""
    if (actual, expected) == (int, float):
        return "write 1.0 for 1, or float(…)"
    if expected is bool and actual in (int, float):
        return f"compare it, as in `x > {actual(0)}`"
    if expected in (int, float) and actual in SCALARS:
        return f"write {type_name(expected)}(…)"
    if expected in SCALARS and actual in VECTORS:
        return "name a component, as in `v.x`"
    if expected in VECTORS:
        return f"write {type_name(expected)}(…)"
    return f"write a value of type {type_name(expected)}, or use a new name"


def _comparison_hint(symbol: str | None, a: Any, b: Any) -> str:
    if symbol is None:
        return "write `==` or `!=`; `is` and `in` are outside the subset"
    if {a, b} == {int, float}:
        return "write 1.0 for 1, or float(…)"
    if a is bool and b is bool:
        return "bools are compared by `==` and `!=` alone"
    return "name components or fields, as in `a.x == b.x`"


def _fields_hint(t: Any) -> str:
    if t in VECTORS:
        letters = "xyzw"[: VECTORS[t][1]]
        return f"its components are {', '.join(letters)}, also several at once, as in `v.{letters}`"
    if t is Mat3:
        return "its columns are x, y and z"
    return f"its fields are {', '.join(fields_of(t))}" if is_record(t) else "it is a plain value"


def _is_counted_loop(node: ast.While) -> bool:
    """Whether a while loop terminates by a counter: its condition has `k < n`, its body always runs
    `k = k + 1` and never assigns n."""
    tests = node.test.values if isinstance(node.test, ast.BoolOp) else [node.test]
    if isinstance(node.test, ast.BoolOp) and isinstance(node.test.op, ast.Or):
        return False
    names = [
        n.id for n in ast.walk(node) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)
    ]
    counters = {
        t.left.id
        for t in tests
        if isinstance(t, ast.Compare)
        and isinstance(t.left, ast.Name)
        and len(t.ops) == 1
        and isinstance(t.ops[0], ast.Lt | ast.LtE)
        and not any(isinstance(n, ast.Name) and n.id in names for n in ast.walk(t.comparators[0]))
    }
    if any(isinstance(n, ast.Continue) for n in ast.walk(node)):
        return False
    increments = [s for s in node.body if _incremented_name(s) in counters]
    return any(names.count(_incremented_name(s) or "") == 1 for s in increments)


def _incremented_name(statement: ast.stmt) -> str | None:
    """The name in `k = k + 1` or `k += 1`, for any positive int; None for other statements."""
    match statement:
        case ast.Assign([ast.Name(a)], ast.BinOp(ast.Name(b), ast.Add(), ast.Constant(int(n)))):
            return a if a == b and n > 0 else None
        case ast.AugAssign(ast.Name(a), ast.Add(), ast.Constant(int(n))):
            return a if n > 0 else None
    return None


def _statement_hint(node: ast.stmt) -> str:
    match node:
        case ast.For():
            return "loop over `range(…)`, without `else`; there are no other iterables"
        case ast.While():
            return "a loop cannot have an `else`; write an `if` after it"
        case ast.Assign() | ast.AnnAssign() | ast.AugAssign():
            return "assign to one plain name; records and vectors are immutable, so make new ones"
        case ast.Return():
            return "return a value, as in `return x`"
        case ast.FunctionDef() | ast.ClassDef():
            return "define shaders and records at the top level of a file"
        case ast.Try() | ast.Raise() | ast.Assert():
            return "the subset has no exceptions; return a record with a status"
        case ast.Expr():
            return "an expression alone has no effect; assign or return it"
    return (
        "this statement is outside the subset; use assignments, if, for … in range, while, return"
    )


def _expression_hint(node: ast.expr) -> str:
    match node:
        case ast.List() | ast.Tuple() | ast.Dict() | ast.Set():
            return "the subset has no containers; use Vec2 … Vec4 or a @struct"
        case ast.Lambda():
            return "the subset has no closures; write a shader"
        case ast.ListComp() | ast.GeneratorExp() | ast.DictComp() | ast.SetComp():
            return "the subset has no comprehensions; write a loop"
        case ast.JoinedStr():
            return "the subset has no strings; write numbers, or static conditions"
    return "this expression is outside the subset; write arithmetic, comparisons and calls"
