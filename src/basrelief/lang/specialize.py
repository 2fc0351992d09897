"""Typed shaders → the functions of one program: slots bound, static conditions decided.

What nothing reads any more is left out: statements, locals, parameters, and the functions that only
they need. A program without heights has no trace of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from basrelief.lang import tree
from basrelief.lang.resources import flat_names, flattened
from basrelief.lang.shader import Shader, taken_parameters
from basrelief.lang.types import ShaderError, is_type_slot

Functions = Mapping[Shader[..., Any], tree.Function]
Path = tuple[tree.Block, ...]
"""A block, the last, and those around it."""


def specialized(
    entry: Shader[..., Any],
    functions: Functions,
    bindings: Mapping[Shader[..., Any], Shader[..., Any]],
    types: Mapping[type, Any],
    static_value: Callable[[str], Any],
) -> tree.Module:
    """The program of an entry, of the typed functions that it can reach, callees first.

    `types` are those that type slots stand for; `static_value` gives what conditions read by name.
    """
    made = _Program(functions, bindings, types, static_value)
    function = made.function(entry, entry=True)
    # by name, each clear of those before
    found = [made.done[shader] for shader in functions if shader in made.done]
    names: set[str] = set()
    for each in found:
        name, number = each.name, 2
        while each.name in names:
            each.name = f"{name}_{number}"
            number += 1
        names.add(each.name)
    return tree.Module(found, function)


def unspecialized(functions: Functions) -> dict[Shader[..., Any], tree.Function]:
    """The same functions with slots, type slots, static conditions and all parameters kept."""
    made = _Library(functions, {}, {}, lambda name: None)
    return {shader: made.function(shader) for shader in functions}


class _Program:
    """The functions of a program, made as calls ask for them."""

    keeps_all = False

    def __init__(
        self,
        functions: Functions,
        bindings: Mapping[Shader[..., Any], Shader[..., Any]],
        types: Mapping[type, Any],
        static_value: Callable[[str], Any],
    ) -> None:
        self.functions, self.bindings = functions, bindings
        self.types, self.static_value = types, static_value
        self.done: dict[Shader[..., Any], tree.Function] = {}

    def function(self, shader: Shader[..., Any], *, entry: bool = False) -> tree.Function:
        """A shader's function with the parameters that it reads; of an entry the pixel too."""
        if shader in self.done:
            return self.done[shader]
        typed = self.functions[shader]
        body = _Body(self, typed)
        made = self.done[shader] = tree.Function(
            name=typed.name,
            parameters={
                name: self.type_of(t)
                for index, (name, t) in enumerate(typed.parameters.items())
                if self.keeps_all or name in body.read or (entry and index == 0)
            },
            result=self.type_of(typed.result),
            body=body.block,
            doc=typed.doc,
            location=typed.location,
            locals=body.locals,
            constants=body.constants,
        )
        return made

    def called(
        self, shader: Shader[..., Any], arguments: tuple[tree.Expression, ...]
    ) -> tuple[tree.Function, Iterator[tree.Expression]]:
        """The function that a call of a shader or slot calls, and the arguments that it reads."""
        resolved = shader
        while resolved.is_slot:
            resolved = self.bindings[resolved]
        function = self.function(resolved)
        by_name = dict(zip(flattened(shader.signature[0]), arguments, strict=True))
        taken = zip(
            taken_parameters(shader, resolved) or (), resolved.signature[0].items(), strict=True
        )
        pairs = (
            pair
            for outer, (inner, t) in taken
            for pair in zip(flat_names(outer, t), flat_names(inner, t), strict=True)
        )
        return function, (by_name[name] for name, inner in pairs if inner in function.parameters)

    def truth(self, condition: tree.Condition) -> bool | None:
        """What a static condition is, None where it stays one."""
        return tree.holds(condition, self.static_value)

    def type_of(self, t: Any) -> Any:
        """A type, with type slots filled in."""
        if not is_type_slot(t):
            return t
        if t not in self.types:
            raise ShaderError(f"the type slot {t.__name__} is not bound")
        return self.types[t]


class _Library(_Program):
    """Functions for whatever program they will be put into."""

    keeps_all = True

    def called(
        self, shader: Shader[..., Any], arguments: tuple[tree.Expression, ...]
    ) -> tuple[tree.Function, Iterator[tree.Expression]]:
        return self.function(shader), iter(arguments)

    def truth(self, condition: tree.Condition) -> bool | None:
        return None

    def type_of(self, t: Any) -> Any:
        return t


class _Body:
    """What is left of the statements of one function, and where its variables are declared.

    Statements are gone through from the last to the first, so that it is known what is read further
    on; again until no more variables are read, since loops go round. `read` are their names, those
    of parameters among them.
    """

    def __init__(self, program: _Program, function: tree.Function) -> None:
        self.program = program
        self.read: set[str] = set()
        self.made: dict[int, tuple[tree.Expression, set[str]]] = {}
        self.names: set[str] = set()
        before = -1
        while before < len(self.read):
            before = len(self.read)
            self.places: dict[str, list[Path]] = {}
            self.assignments: dict[str, list[tuple[Path, tree.Assign]]] = {}
            self.block = self.inner(function.body, ())
        self.locals = {
            name: program.type_of(t)
            for name, t in function.locals.items()
            if name in self.assignments
        }
        self.constants = frozenset(self.declared())

    # --- statements -----------------------------------------------------------------------------

    def inner(self, block: tree.Block, outer: Path) -> tree.Block:
        made = tree.Block()
        self.add(block, (*outer, made))
        made.statements.reverse()
        return made

    def add(self, block: tree.Block, path: Path) -> None:
        """Add what is left of a block to the innermost of a path, from its last statement on."""
        found = path[-1].statements
        for node in reversed(block.statements):
            count = len(found)
            self.statement(node, path)
            if len(found) > count and node.comments:
                found[-1].comments = (*node.comments, *found[-1].comments)

    def statement(self, node: tree.Statement, path: Path) -> None:
        found, keeps_all = path[-1].statements, self.program.keeps_all
        match node:
            case tree.Assign(name, value):
                if keeps_all or name in self.read:
                    made = tree.Assign(name, self.value(value, path))
                    self.places.setdefault(name, []).append(path)
                    self.assignments.setdefault(name, []).append((path, made))
                    found.append(made)
            case tree.If(tree.Static(_, condition) as test, body, otherwise):
                truth = self.program.truth(condition)
                if truth is None:
                    b, a = self.inner(otherwise, path), self.inner(body, path)
                    found.append(tree.If(test, a, b))
                else:
                    self.add(body if truth else otherwise, path)
            case tree.If(test, body, otherwise):
                b, a = self.inner(otherwise, path), self.inner(body, path)
                if keeps_all or a.statements or b.statements:
                    found.append(tree.If(self.value(test, path), a, b))
            case tree.For(name, start, stop, step, body):
                a = self.inner(body, path)
                if keeps_all or a.statements:
                    start, stop = self.value(start, path), self.value(stop, path)
                    found.append(tree.For(name, start, stop, step, a))
            case tree.While(test, body):
                a = self.inner(body, path)
                found.append(tree.While(self.value(test, path), a))
            case tree.Return(value):
                found.append(tree.Return(self.value(value, path)))
            case _:
                found.append(type(node)())

    # --- expressions ----------------------------------------------------------------------------

    def value(self, node: tree.Expression, path: Path) -> tree.Expression:
        """An expression as the program has it, its names noted."""
        known = self.made.get(id(node))
        if known is None:
            self.names = set()
            known = self.made[id(node)] = self.expression(node), self.names
        self.read |= known[1]
        for name in known[1]:
            self.places.setdefault(name, []).append(path)
        return known[0]

    def expression(self, node: tree.Expression) -> tree.Expression:
        match node:
            case tree.Literal():
                return node
            case tree.Local(t, name):
                self.names.add(name)
                return tree.Local(self.program.type_of(t), name) if is_type_slot(t) else node
            case tree.ShaderCall(_, shader, arguments):
                function, passed = self.program.called(shader, arguments)
                return tree.Call(function.result, function, tuple(map(self.expression, passed)))
            case tree.Static(_, condition):
                truth = self.program.truth(condition)
                return node if truth is None else tree.Literal(bool, truth)
            case tree.Select(_, tree.Static(_, condition), then, otherwise):
                truth = self.program.truth(condition)
                if truth is not None:
                    return self.expression(then if truth else otherwise)
        return tree.changed(node, self.expression)

    # --- where variables live -------------------------------------------------------------------

    def declared(self) -> Iterator[str]:
        """Give each variable the innermost block that holds all its uses as its home; the names of
        those that are assigned once, where they are declared."""
        for name, t in self.locals.items():
            places = self.places[name]
            depth = min(map(len, places))
            while any(path[depth - 1] is not places[0][depth - 1] for path in places):
                depth -= 1
            first_path, first = self.assignments[name][-1]
            if len(first_path) == depth:
                first.declares = True
                if len(self.assignments[name]) == 1:
                    yield name
            else:
                first_path[depth - 1].hoisted[name] = t
