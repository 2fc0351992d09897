"""`@shader` and `@slot`: a Python function as a shader, run as it stands or handed to a printer.

Called from Python, a shader runs as the function it is, in the file it is in, so a breakpoint
stops in it; only its literals and conversions are made 32 bits wide, since Python's own are not.
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
import threading
from collections.abc import Callable, Iterator, Mapping
from types import CodeType
from typing import Any, Generic, NamedTuple, ParamSpec, TypeVar

import numpy as np

from basrelief.lang.intrinsics import INTRINSICS
from basrelief.lang.types import ShaderError, coerce, is_record, is_type_slot

P = ParamSpec("P")
R = TypeVar("R", covariant=True)
_running = threading.local()
_LOAD_GLOBAL, _EXTENDED = dis.opmap["LOAD_GLOBAL"], dis.opmap["EXTENDED_ARG"]


class Shader(Generic[P, R]):
    """A function of the shader subset. Call it as a plain function, or compile a program of it."""

    def __init__(self, function: Callable[P, R], *, is_slot: bool = False) -> None:
        self.function = function
        self.name: str = function.__name__
        self.is_slot = is_slot
        self.typed: Any = None
        """What the front end found, kept for the next program."""
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
            raise ShaderError(
                f"{self.location}: {self.name}: an annotation fails: {error}"
            ) from None
        names = list(inspect.signature(self.function).parameters)
        for name in [*names, "return"]:
            if name not in hints:
                what = "result" if name == "return" else f"parameter {name}"
                raise ShaderError(
                    f"{self.location}: {self.name}: the {what} has no type; annotate it, "
                    "for example `x: float` or `-> Vec3`"
                )
        return {name: hints[name] for name in names}, hints["return"]

    @property
    def location(self) -> str:
        """File and line of the definition."""
        code = self.function.__code__
        return f"{code.co_filename}:{code.co_firstlineno}"

    def lookup(self, name: str) -> Any:
        """What a global or enclosing name stands for; raises KeyError where it is unknown."""
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
        """What a name stands for, None where it is unknown."""
        try:
            return self.lookup(name)
        except KeyError:
            return None

    @functools.cached_property
    def names(self) -> tuple[str, ...]:
        """The global and enclosing names that the function reads."""
        code = self.function.__code__
        found: dict[str, None] = {}
        # `dis.get_instructions` takes a third of a millisecond, and there are a hundred shaders
        high = 0
        for operation, low in zip(code.co_code[::2], code.co_code[1::2], strict=True):
            if operation == _LOAD_GLOBAL:
                found[code.co_names[(high | low) >> 1]] = None
            high = (high | low) << 8 if operation == _EXTENDED else 0
        return (*found, *code.co_freevars)

    @property
    def _plain(self) -> Callable[..., Any]:
        """The function in 32 bits, made anew where a number that it names has changed."""
        made, numbers = self._made
        if any(self.find(name) is not value for name, value in numbers.items()):
            del self._made
            made, _ = self._made
        return made

    @functools.cached_property
    def _made(self) -> tuple[Callable[..., Any], dict[str, Any]]:
        return _as_32_bits(self)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        watch = getattr(_running, "watch", None)
        if watch is None:
            return self._run(*args, **kwargs)
        given = inspect.signature(self.function).bind(*args, **kwargs).arguments
        return watch(self, given, lambda: self._run(*args, **kwargs))

    def _run(self, *args: Any, **kwargs: Any) -> R:
        if self.is_slot:
            bound = getattr(_running, "bindings", {}).get(self)
            if bound is None:
                raise ShaderError(f"the slot {self.name} is not bound; use `with bound({{...}})`")
            taken = taken_parameters(self, bound)
            if taken is None or len(taken) == len(self.signature[0]):
                return bound(*args, **kwargs)
            named = inspect.signature(self.function).bind(*args, **kwargs).arguments
            return bound(*(named[name] for name in taken))
        if getattr(_running, "inside", False):
            return self._plain(*args, **kwargs)
        given = inspect.signature(self.function).bind(*args, **kwargs)
        given.apply_defaults()
        types, _ = self.signature
        values = [coerce(value, types[name]) for name, value in given.arguments.items()]
        _running.inside = True
        try:
            with np.errstate(all="ignore"):
                return self._plain(*values)
        finally:
            _running.inside = False


def shader(function: Callable[P, R]) -> Shader[P, R]:
    """Make a function of the shader subset a shader."""
    return Shader(function)


def slot(function: Callable[P, R]) -> Shader[P, R]:
    """Declare a shader whose body is chosen when a program is made; the body here is `...`."""
    return Shader(function, is_slot=True)


@functools.lru_cache(maxsize=1024)
def taken_parameters(slot: Shader[..., Any], shader: Shader[..., Any]) -> tuple[str, ...] | None:
    """The parameters of a slot that a shader bound to it takes, in order; None where it cannot fit.

    They are matched by type, and some may be left out. A type slot stands for any record.
    """
    offered = iter(slot.signature[0].items())
    taken = []
    for wanted in shader.signature[0].values():
        name = next((name for name, t in offered if _stands_for(t, wanted)), None)
        if name is None:
            return None
        taken.append(name)
    # nothing but the shader says what a type slot is
    left_out = set(slot.signature[0]) - set(taken)
    if any(is_type_slot(slot.signature[0][name]) for name in left_out):
        return None
    return tuple(taken)


def _stands_for(offered: Any, wanted: Any) -> bool:
    return offered == wanted or (is_type_slot(offered) and is_record(wanted))


@contextlib.contextmanager
def bound(bindings: Mapping[Shader[..., Any], Shader[..., Any]]) -> Iterator[None]:
    """Bind slots for shaders called as plain Python within the `with` block, in this thread."""
    before = getattr(_running, "bindings", {})
    _running.bindings = {**before, **bindings}
    try:
        yield
    finally:
        _running.bindings = before


Watch = Callable[[Shader[..., Any], Mapping[str, Any], Callable[[], Any]], Any]


@contextlib.contextmanager
def watched(watch: Watch) -> Iterator[None]:
    """Let `watch(shader, arguments, run)` stand around each call of a shader as plain Python.

    It is given the arguments by name, and `run`, whose result it returns. For this thread, within
    the `with` block.
    """
    before = getattr(_running, "watch", None)
    _running.watch = watch
    try:
        yield
    finally:
        _running.watch = before


class Source:
    """A function's syntax tree, its comments, and how to point at a place in it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        code = function.__code__
        self.file, self.first = code.co_filename, code.co_firstlineno
        linecache.checkcache(self.file)
        self.lines = linecache.getlines(self.file, function.__globals__)
        if not self.lines:
            raise ShaderError(
                f"{self.file}: {function.__name__}: its source is not available; "
                "write shaders in a file or a notebook cell"
            )
        parsed = _parsed("".join(self.lines))
        place = code.co_name, self.first
        if code_text(code) not in parsed.code.get(place, ()):
            raise ShaderError(
                f"{self.file}: {function.__name__}: the file has changed since it was loaded; "
                "load it anew"
            )
        if place not in parsed.functions:
            what = self.lines[self.first - 1].strip()
            raise ShaderError(f"{self.file}:{self.first}: `{what}`: a shader is a plain `def`")
        self.tree = parsed.functions[place]

    def comments_before(self, line: int) -> tuple[str, ...]:
        """The comment lines that stand directly above a line of the file."""
        found: list[str] = []
        index = line - 2
        while index >= 0 and self.lines[index].strip().startswith("#"):
            found.insert(0, self.lines[index].strip().lstrip("# "))
            index -= 1
        return tuple(found)

    def error(self, node: ast.AST, message: str) -> ShaderError:
        """An error that names the file, the line and the text of a node."""
        line = getattr(node, "lineno", self.first)
        text = ast.unparse(node).splitlines()[0]
        return ShaderError(f"{self.file}:{line}: `{text}`: {message}")


class _Parsed(NamedTuple):
    """The functions of a file by name and first line, decorators included: their syntax trees, and
    what the code of all that stands there does."""

    functions: dict[tuple[str, int], ast.FunctionDef]
    code: dict[tuple[str, int], list[str]]


@functools.lru_cache(maxsize=64)
def _parsed(text: str) -> _Parsed:
    found = _Parsed({}, {})
    try:
        tree = ast.parse(text)
        # a cell of a notebook may await something
        flags = ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
        left = [compile(tree, "", "exec", flags, dont_inherit=True)]
    except (SyntaxError, ValueError):
        return found
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
            found.functions[node.name, first] = node
    while left:
        code = left.pop()
        found.code.setdefault((code.co_name, code.co_firstlineno), []).append(code_text(code))
        left += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    return found


def code_text(code: CodeType) -> str:
    """What code does, without files and lines, so that moving a file changes no key.

    Not `marshal`, whose bytes depend on how often objects are referred to in this process.
    """
    within = [code_text(each) if isinstance(each, CodeType) else each for each in code.co_consts]
    parts = (code.co_code, within, code.co_names, code.co_varnames, code.co_freevars)
    return repr(parts)


def _as_32_bits(shader_: Shader[..., Any]) -> tuple[Callable[..., Any], dict[str, Any]]:
    """The same function with literals, conversions and loop counters 32 bits wide.

    And what is put into it, by name: the numbers that it names, and all that encloses it.
    """
    source = shader_.source
    rewriting = _Rewriting(shader_)
    body = rewriting.visit(copy.deepcopy(source.tree))
    body.decorator_list = []
    body.returns = None
    for argument in body.args.args:
        argument.annotation = None
    names = list(rewriting.captured)
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
    made: Callable[..., Any] = scope["_factory"](*rewriting.captured.values())
    made.__defaults__ = shader_.function.__defaults__
    return made, rewriting.numbers


def _int_range(*bounds: Any) -> Iterator[Any]:
    return map(np.int32, range(*map(int, bounds)))


class _Rewriting(ast.NodeTransformer):
    """Numbers become captured float32 and int32 values; `float`, `int`, `range` … our own."""

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
            raise self.shader.source.error(node, "an int has 32 bits; this number has more")
        wide = np.float32(value) if isinstance(value, float) else np.int32(value)
        return self._capture(f"_number_{len(self.captured)}", wide, node)

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
        if any(value is known for known in (float, int, len, min, max)):
            return self._capture(f"_{node.id}", INTRINSICS[node.id].python, node)
        if node.id in self.shader.function.__code__.co_freevars:
            self.numbers[node.id] = value
            return self._capture(node.id, value, node)
        return node
