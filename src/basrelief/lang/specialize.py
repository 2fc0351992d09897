"""Specialization: typed shaders → the functions of one program.

Slots are bound and static conditions decided. Dead code is removed: statements, locals and
parameters that nothing reads, and the functions that only they call.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from basrelief.lang import conditions, tree
from basrelief.lang.resources import flatten_parameter, flatten_parameters
from basrelief.lang.shader import Shader, accepted_parameters
from basrelief.lang.types import ShaderError, is_type_slot

Functions = Mapping[Shader[..., Any], tree.Function]
BlockPath = tuple[tree.Block, ...]
"""A block, last, preceded by the blocks around it, outermost first."""


def specialize(
    entry: Shader[..., Any],
    functions: Functions,
    bindings: Mapping[Shader[..., Any], Shader[..., Any]],
    types: Mapping[type, Any],
    static_value: Callable[[str], Any],
) -> tree.Module:
    """Program of an entry, from the typed functions that it can reach, callees first.

    `types` are the types of type slots; `static_value` gives the value of a static field by name.
    """
    specializer = _Specializer(functions, bindings, types, static_value)
    entry_function = specializer.function(entry, entry=True)
    results = [specializer.results[s] for s in functions if s in specializer.results]
    # make names unique
    names: set[str] = set()
    for function in results:
        name, number = function.name, 2
        while function.name in names:
            function.name = f"{name}_{number}"
            number += 1
        names.add(function.name)
    return tree.Module(results, entry_function)


def library_functions(
    functions: Functions, static_value: Callable[[str], Any]
) -> dict[Shader[..., Any], tree.Function]:
    """The same functions with their slots, type slots and parameters.

    Static conditions stay undecided on fields for which `static_value` gives None.
    """
    specializer = _LibrarySpecializer(functions, {}, {}, static_value)
    return {shader: specializer.function(shader) for shader in functions}


class _Specializer:
    """The functions of a program, specialized on their first call."""

    keeps_everything = False

    def __init__(
        self,
        functions: Functions,
        bindings: Mapping[Shader[..., Any], Shader[..., Any]],
        types: Mapping[type, Any],
        static_value: Callable[[str], Any],
    ) -> None:
        self.functions, self.bindings = functions, bindings
        self.types, self.static_value = types, static_value
        self.results: dict[Shader[..., Any], tree.Function] = {}

    def function(self, shader: Shader[..., Any], *, entry: bool = False) -> tree.Function:
        """Specialized function of a shader, with its live parameters; an entry keeps the pixel."""
        if shader in self.results:
            return self.results[shader]
        typed = self.functions[shader]
        body = _BodySpecializer(self, typed)
        result = self.results[shader] = tree.Function(
            name=typed.name,
            parameters={
                name: self.type_of(t)
                for index, (name, t) in enumerate(typed.parameters.items())
                if self.keeps_everything or name in body.live or (entry and index == 0)
            },
            result=self.type_of(typed.result),
            body=body.block,
            doc=typed.doc,
            location=typed.location,
            locals=body.locals,
            constants=body.constants,
        )
        return result

    def resolve_call(
        self, shader: Shader[..., Any], arguments: tuple[tree.Expression, ...]
    ) -> tuple[tree.Function, Iterator[tree.Expression]]:
        """Function that a call of a shader or slot calls, and its live arguments."""
        resolved = shader
        while resolved.is_slot:
            resolved = self.bindings[resolved]
        function = self.function(resolved)
        by_name = dict(zip(flatten_parameters(shader.signature[0]), arguments, strict=True))
        accepted = zip(
            accepted_parameters(shader, resolved) or (), resolved.signature[0].items(), strict=True
        )
        pairs = (
            pair
            for outer, (inner, t) in accepted
            for pair in zip(flatten_parameter(outer, t), flatten_parameter(inner, t), strict=True)
        )
        return function, (by_name[name] for name, inner in pairs if inner in function.parameters)

    def evaluate(self, condition: tree.Condition) -> bool | tree.Condition:
        """Value of a static condition, or what is left of it to decide."""
        return tree.holds(condition, self.static_value)

    def type_of(self, t: Any) -> Any:
        """The type, with a type slot replaced by its record."""
        if not is_type_slot(t):
            return t
        if t not in self.types:
            raise ShaderError(f"the type slot {t.__name__} is not bound; bind its slot")
        return self.types[t]


class _LibrarySpecializer(_Specializer):
    """Keeps everything, for functions that any program may link."""

    keeps_everything = True

    def resolve_call(
        self, shader: Shader[..., Any], arguments: tuple[tree.Expression, ...]
    ) -> tuple[tree.Function, Iterator[tree.Expression]]:
        return self.function(shader), iter(arguments)

    def evaluate(self, condition: tree.Condition) -> bool | tree.Condition:
        return conditions.decided(condition, self.static_value)

    def type_of(self, t: Any) -> Any:
        return t


class _BodySpecializer:
    """Statements of one function without dead code, and the declarations of its variables.

    Goes through statements from last to first, so that the names read later are known, and repeats
    until `live` no longer grows, because loops read what later statements assign. `live` are the
    names of variables and parameters that are read.
    """

    def __init__(self, program: _Specializer, function: tree.Function) -> None:
        self.program = program
        self.live: set[str] = set()
        self.cache: dict[int, tuple[tree.Expression, set[str]]] = {}
        self.names: set[str] = set()
        before = -1
        while before < len(self.live):
            before = len(self.live)
            self.uses: dict[str, list[BlockPath]] = {}
            self.assignments: dict[str, list[tuple[BlockPath, tree.Assign]]] = {}
            self.block = self.inner(function.body, ())
        self.locals = {
            name: program.type_of(t)
            for name, t in function.locals.items()
            if name in self.assignments
        }
        self.constants = frozenset(self.place_declarations())

    # --- statements -----------------------------------------------------------------------------

    def inner(self, block: tree.Block, outer: BlockPath) -> tree.Block:
        result = tree.Block()
        self.add(block, (*outer, result))
        result.statements.reverse()
        return result

    def add(self, block: tree.Block, path: BlockPath) -> None:
        """Add the live statements of a block to the innermost block of a path, last one first."""
        output = path[-1].statements
        for node in reversed(block.statements):
            count = len(output)
            self.statement(node, path)
            if len(output) > count and node.comments:
                output[-1].comments = (*node.comments, *output[-1].comments)

    def statement(self, node: tree.Statement, path: BlockPath) -> None:
        output, keeps_everything = path[-1].statements, self.program.keeps_everything
        match node:
            case tree.Assign(name, value):
                if keeps_everything or name in self.live:
                    assignment = tree.Assign(name, self.value(value, path))
                    self.uses.setdefault(name, []).append(path)
                    self.assignments.setdefault(name, []).append((path, assignment))
                    output.append(assignment)
            case tree.If(tree.Static(_, condition), body, otherwise):
                decided = self.program.evaluate(condition)
                if isinstance(decided, bool):
                    self.add(body if decided else otherwise, path)
                else:
                    b, a = self.inner(otherwise, path), self.inner(body, path)
                    output.append(tree.If(tree.Static(bool, decided), a, b))
            case tree.If(test, body, otherwise):
                b, a = self.inner(otherwise, path), self.inner(body, path)
                if keeps_everything or a.statements or b.statements:
                    output.append(tree.If(self.value(test, path), a, b))
            case tree.For(name, start, stop, step, body):
                a = self.inner(body, path)
                if keeps_everything or a.statements:
                    start, stop = self.value(start, path), self.value(stop, path)
                    output.append(tree.For(name, start, stop, step, a))
            case tree.While(test, body):
                a = self.inner(body, path)
                output.append(tree.While(self.value(test, path), a))
            case tree.Return(value):
                output.append(tree.Return(self.value(value, path)))
            case _:
                output.append(type(node)())

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: tree.Expression, path: BlockPath) -> tree.Expression:
        """Specialized expression; records the names that it reads."""
        cached = self.cache.get(id(node))
        if cached is None:
            self.names = set()
            cached = self.cache[id(node)] = self.expression(node), self.names
        expression, names = cached
        self.live |= names
        for name in names:
            self.uses.setdefault(name, []).append(path)
        return expression

    def expression(self, node: tree.Expression) -> tree.Expression:
        match node:
            case tree.Literal():
                return node
            case tree.Local(t, name):
                self.names.add(name)
                return tree.Local(self.program.type_of(t), name) if is_type_slot(t) else node
            case tree.ShaderCall(_, shader, arguments):
                function, passed = self.program.resolve_call(shader, arguments)
                return tree.Call(function.result, function, tuple(map(self.expression, passed)))
            case tree.Static(_, condition):
                decided = self.program.evaluate(condition)
                if isinstance(decided, bool):
                    return tree.Literal(bool, decided)
                return tree.Static(bool, decided)
            case tree.Select(_, tree.Static(_, condition), then, otherwise):
                decided = self.program.evaluate(condition)
                if isinstance(decided, bool):
                    return self.expression(then if decided else otherwise)
        return tree.map_children(node, self.expression)

    # --- declarations ---------------------------------------------------------------------------

    def place_declarations(self) -> Iterator[str]:
        """Declare each variable in the innermost block that contains all its uses; yields the names
        that are assigned only by their declaration."""
        for name, t in self.locals.items():
            uses = self.uses[name]
            depth = min(map(len, uses))
            while any(path[depth - 1] is not uses[0][depth - 1] for path in uses):
                depth -= 1
            first_path, first = self.assignments[name][-1]
            if len(first_path) == depth:
                first.declares = True
                if len(self.assignments[name]) == 1:
                    yield name
            else:
                first_path[depth - 1].hoisted[name] = t
