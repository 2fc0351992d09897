"""`@shader` and `@slot`: Python functions as shaders, run as plain Python or compiled.

Called from Python, a shader runs as its own function in its own file, so that breakpoints work.
Only its literals and conversions are rewritten to 32 bits, which Python's own are not.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import dis
import functools
import inspect
import linecache
import sys
import textwrap
import threading
from collections.abc import Callable, Iterator, Mapping
from types import CodeType
from typing import Any, Generic, NamedTuple, ParamSpec, TypeVar

import numpy as np

from basrelief.lang.intrinsics import INTRINSICS
from basrelief.lang.types import ShaderError, coerce, is_record, is_type_slot

P = ParamSpec("P")
R = TypeVar("R", covariant=True)
INT_RANGE = "an int has 32 bits; write a number from -2147483648 to 2147483647"
_context = threading.local()
_LOAD_GLOBAL, _EXTENDED = dis.opmap["LOAD_GLOBAL"], dis.opmap["EXTENDED_ARG"]


class Shader(Generic[P, R]):
    """Function of the shader subset: call it as a plain function, or compile a program of it."""

    def __init__(self, function: Callable[P, R], *, is_slot: bool = False) -> None:
        self.function = function
        self.name: str = function.__name__
        self.is_slot = is_slot
        self.analysis: Any = None
        """Result of the front end, cached for other programs."""
        functools.update_wrapper(self, function)

    def __repr__(self) -> str:
        return f"<{'slot' if self.is_slot else 'shader'} {self.__module__}.{self.name}>"

    @functools.cached_property
    def source(self) -> Source:
        """The function's syntax tree with its file and lines."""
        return Source(self.function)

    @functools.cached_property
    def signature(self) -> tuple[dict[str, Any], Any]:
        """Parameters by name with their types, and the type of the result."""
        try:
            hints = inspect.get_annotations(self.function, eval_str=True)
        except Exception as error:
            raise self.error(f"an annotation of {self.name} fails: {error}; correct it") from None
        names = list(inspect.signature(self.function).parameters)
        for name in [*names, "return"]:
            if name not in hints:
                what = "result" if name == "return" else f"parameter {name}"
                raise self.error(
                    f"the {what} of {self.name} has no type; annotate it, as in `x: float` or "
                    "`-> Vec3`",
                    name,
                )
        return {name: hints[name] for name in names}, hints["return"]

    @property
    def location(self) -> str:
        """File and line of the definition."""
        code = self.function.__code__
        return f"{code.co_filename}:{code.co_firstlineno}"

    def error(self, message: str, parameter: str = "") -> ShaderError:
        """Error at the definition, or at one of its parameters, or at its "return" type."""
        try:
            source = self.source
        except ShaderError:
            return ShaderError(f"{self.location}: {message}")
        arguments = [n for n in ast.walk(source.tree.args) if isinstance(n, ast.arg)]
        nodes: dict[str, ast.AST | None] = {argument.arg: argument for argument in arguments}
        nodes["return"] = source.tree.returns
        return source.error(nodes.get(parameter) or source.tree, message)

    def lookup(self, name: str) -> Any:
        """Value of a global or enclosing name. Raises KeyError for an unknown one."""
        enclosing = self.function.__code__.co_freevars
        if name in enclosing:
            try:
                return (self.function.__closure__ or ())[enclosing.index(name)].cell_contents
            except ValueError:
                raise KeyError(name) from None  # it is set after the shader is made
        if name in self.function.__globals__:
            return self.function.__globals__[name]
        return vars(__import__("builtins"))[name]

    def find(self, name: str) -> Any:
        """Value of a global or enclosing name, None for an unknown one."""
        try:
            return self.lookup(name)
        except KeyError:
            return None

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """Global and enclosing names that the function reads."""
        code = self.function.__code__
        read: dict[str, None] = {}
        # `dis.get_instructions` takes a third of a millisecond, and there are a hundred shaders
        high = 0
        for operation, low in zip(code.co_code[::2], code.co_code[1::2], strict=True):
            if operation == _LOAD_GLOBAL:
                read[code.co_names[(high | low) >> 1]] = None
            high = (high | low) << 8 if operation == _EXTENDED else 0
        return (*read, *code.co_freevars)

    @property
    def _function_32_bit(self) -> Callable[..., Any]:
        """The function in 32 bits, rewritten again when a number that it reads has changed."""
        function, captured = self._rewritten
        if any(self.find(name) is not value for name, value in captured.items()):
            del self._rewritten
            function, _ = self._rewritten
        return function

    @functools.cached_property
    def _rewritten(self) -> tuple[Callable[..., Any], dict[str, Any]]:
        return _rewrite_in_32_bits(self)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        watch = getattr(_context, "watch", None)
        if watch is None:
            return self._run(*args, **kwargs)
        arguments = inspect.signature(self.function).bind(*args, **kwargs).arguments
        return watch(self, arguments, lambda: self._run(*args, **kwargs))

    def _run(self, *args: Any, **kwargs: Any) -> R:
        if self.is_slot:
            bound = getattr(_context, "bindings", {}).get(self)
            if bound is None:
                raise ShaderError(f"the slot {self.name} is not bound; use `with bound({{...}})`")
            accepted = accepted_parameters(self, bound)
            if accepted is None or len(accepted) == len(self.signature[0]):
                return bound(*args, **kwargs)
            named = inspect.signature(self.function).bind(*args, **kwargs).arguments
            return bound(*(named[name] for name in accepted))
        if getattr(_context, "inside", False):
            return self._function_32_bit(*args, **kwargs)
        arguments = inspect.signature(self.function).bind(*args, **kwargs)
        arguments.apply_defaults()
        types, _ = self.signature
        values = [coerce(value, types[name]) for name, value in arguments.arguments.items()]
        _context.inside = True
        try:
            with np.errstate(all="ignore"):
                return self._function_32_bit(*values)
        finally:
            _context.inside = False


def shader(function: Callable[P, R]) -> Shader[P, R]:
    """Make a shader of a function in the shader subset."""
    return Shader(function)


def slot(function: Callable[P, R]) -> Shader[P, R]:
    """Declare a shader whose body is bound when a program is made; the body here is `...`."""
    return Shader(function, is_slot=True)


@functools.lru_cache(maxsize=1024)
def accepted_parameters(slot: Shader[..., Any], shader: Shader[..., Any]) -> tuple[str, ...] | None:
    """Parameters of a slot that a bound shader accepts, in order; None where it does not fit.

    Parameters match by type; the shader may omit some. A type slot matches any record.
    """
    offered = iter(slot.signature[0].items())
    accepted = []
    for parameter_type in shader.signature[0].values():
        name = next((name for name, t in offered if _matches(t, parameter_type)), None)
        if name is None:
            return None
        accepted.append(name)
    # only the shader decides the type of a type slot, so it may not omit it
    omitted = set(slot.signature[0]) - set(accepted)
    if any(is_type_slot(slot.signature[0][name]) for name in omitted):
        return None
    return tuple(accepted)


def _matches(offered: Any, parameter_type: Any) -> bool:
    return offered == parameter_type or (is_type_slot(offered) and is_record(parameter_type))


@contextlib.contextmanager
def bound(bindings: Mapping[Shader[..., Any], Shader[..., Any]]) -> Iterator[None]:
    """Bind slots for shaders called as plain Python in the `with` block, in this thread."""
    before = getattr(_context, "bindings", {})
    _context.bindings = {**before, **bindings}
    try:
        yield
    finally:
        _context.bindings = before


Watch = Callable[[Shader[..., Any], Mapping[str, Any], Callable[[], Any]], Any]


@contextlib.contextmanager
def watched(watch: Watch) -> Iterator[None]:
    """Wrap each call of a shader as plain Python in `watch(shader, arguments, run)`.

    `watch` receives the arguments by name and calls `run()` for the result, which it returns. Holds
    in the `with` block, for this thread.
    """
    before = getattr(_context, "watch", None)
    _context.watch = watch
    try:
        yield
    finally:
        _context.watch = before


class Source:
    """Syntax tree of a function, with its file, lines and comments."""

    def __init__(self, function: Callable[..., Any]) -> None:
        code = function.__code__
        self.file, self.first_line = code.co_filename, code.co_firstlineno
        linecache.checkcache(self.file)
        self.lines = linecache.getlines(self.file, function.__globals__)
        if not self.lines:
            raise ShaderError(
                f"{self.file}: {function.__name__}: its source is not available; "
                "write shaders in a file or a notebook cell"
            )
        file = _parse_file("".join(self.lines))
        place = code.co_name, self.first_line
        if canonical_code(code) not in file.code.get(place, ()):
            raise ShaderError(
                f"{self.file}: {function.__name__}: the file has changed since it was loaded; "
                "load it again"
            )
        if place not in file.functions:
            raise self.error_in_line(self.first_line, "a shader must be a plain `def`; write one")
        self.tree = file.functions[place]

    def comments_before(self, line: int) -> tuple[str, ...]:
        """Comment lines directly above a line of the file."""
        comments: list[str] = []
        index = line - 2
        while index >= 0 and self.lines[index].strip().startswith("#"):
            comments.insert(0, self.lines[index].strip().lstrip("# "))
            index -= 1
        return tuple(comments)

    def error(self, node: ast.AST, message: str) -> ShaderError:
        """Error with the file and line of a node, and carets under its text in that line."""
        place: Any = node
        line = self.lines[place.lineno - 1].rstrip()
        # columns of syntax trees count bytes
        first, last = (
            len(line.encode()[:column].decode(errors="replace"))
            for column in (place.col_offset, place.end_col_offset)
        )
        if isinstance(node, ast.FunctionDef):
            last = line.find("(")
        elif place.end_lineno > place.lineno:
            last = len(line)
        return self.error_in_line(place.lineno, message, first, last)

    def error_in_line(
        self, number: int, message: str, first: int = 0, last: int | None = None
    ) -> ShaderError:
        """Error with a line of the file, and carets under its columns first … last − 1."""
        line = self.lines[number - 1].rstrip()
        first = max(first, len(line) - len(line.lstrip()))
        last = len(line) if last is None else last
        blank = "".join(c if c == "\t" else " " for c in line[:first])
        carets = blank + "^" * max(1, last - first)
        error = ShaderError(f"{self.file}:{number}: {message}")
        error.excerpt = textwrap.indent(textwrap.dedent(f"{line}\n{carets}"), "    ")
        return error


class _ParsedFile(NamedTuple):
    """Functions of a file by name and first line (decorators included): syntax trees, and the
    canonical code of everything that starts there."""

    functions: dict[tuple[str, int], ast.FunctionDef]
    code: dict[tuple[str, int], list[str]]


@functools.lru_cache(maxsize=64)
def _parse_file(text: str) -> _ParsedFile:
    file = _ParsedFile({}, {})
    try:
        tree = ast.parse(text)
        # a cell of a notebook may await something
        flags = ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
        pending = [compile(tree, "", "exec", flags, dont_inherit=True)]
    except (SyntaxError, ValueError):
        return file
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
            file.functions[node.name, first] = node
    while pending:
        code = pending.pop()
        file.code.setdefault((code.co_name, code.co_firstlineno), []).append(canonical_code(code))
        pending += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    return file


def canonical_code(code: CodeType) -> str:
    """Text of a code object without files and lines, so that moving a file changes no key.

    Not `marshal`: its bytes depend on the reference counts of objects in this process.
    """
    constants = [canonical_code(c) if isinstance(c, CodeType) else c for c in code.co_consts]
    parts = (code.co_code, constants, code.co_names, code.co_varnames, code.co_freevars)
    return repr(parts)


def _rewrite_in_32_bits(shader_: Shader[..., Any]) -> tuple[Callable[..., Any], dict[str, Any]]:
    """The function with 32-bit literals, conversions and loop counters, and its captured values.

    The values are those of the numbers and enclosing variables that it reads, by name.
    """
    source = shader_.source
    rewriter = _Rewriter(shader_)
    body = rewriter.visit(copy.deepcopy(source.tree))
    body.decorator_list = []
    body.returns = None
    for argument in body.args.args:
        argument.annotation = None
    names = list(rewriter.captured)
    factory = ast.FunctionDef(
        name="_factory",
        args=ast.arguments([], [ast.arg(name) for name in names], None, [], [], None, []),
        body=[body, ast.Return(ast.Name(body.name, ast.Load()))],
        decorator_list=[],
    )
    if sys.version_info >= (3, 12):
        factory.type_params = []
    module = ast.fix_missing_locations(ast.Module([factory], []))
    scope: dict[str, Any] = {}
    exec(compile(module, source.file, "exec"), shader_.function.__globals__, scope)
    function: Callable[..., Any] = scope["_factory"](*rewriter.captured.values())
    function.__defaults__ = shader_.function.__defaults__
    return function, rewriter.numbers


def _int_range(*bounds: Any) -> Iterator[Any]:
    return map(np.int32, range(*map(int, bounds)))


class _Rewriter(ast.NodeTransformer):
    """Replaces numbers by captured 32-bit values, and `float`, `int`, `range` … by our own."""

    def __init__(self, shader_: Shader[..., Any]) -> None:
        self.shader = shader_
        self.captured: dict[str, Any] = {}
        self.numbers: dict[str, Any] = {}
        self.locals = set(shader_.function.__code__.co_varnames)

    def _capture(self, name: str, value: Any, node: ast.AST) -> ast.AST:
        self.captured[name] = value
        return ast.copy_location(ast.Name(name, ast.Load()), node)

    def _number(self, value: Any, node: ast.AST) -> ast.AST:
        if isinstance(value, int) and not -(2**31) <= value < 2**31:
            raise self.shader.source.error(node, INT_RANGE)
        scalar = np.float32(value) if isinstance(value, float) else np.int32(value)
        return self._capture(f"_number_{len(self.captured)}", scalar, node)

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        return self._number(node.value, node) if type(node.value) in (float, int) else node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id in self.locals or not isinstance(node.ctx, ast.Load):
            return node
        try:
            value = self.shader.lookup(node.id)
        except KeyError:
            return node
        if type(value) in (float, int):
            self.numbers[node.id] = value
            return self._number(value, node)
        if value is range:
            return self._capture("_range", _int_range, node)
        if any(value is builtin for builtin in (float, int, len, min, max)):
            return self._capture(f"_{node.id}", INTRINSICS[node.id].python, node)
        if node.id in self.shader.function.__code__.co_freevars:
            self.numbers[node.id] = value
            return self._capture(node.id, value, node)
        return node
