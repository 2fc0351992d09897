"""WGSL: a child of the C-like base, with its resources and its entry point.

Maps are textures read texel by texel: heights as `texture_2d<f32>`, other maps as `texture_2d<u32>`
of 16-bit fractions. The shaders interpolate, so that all engines filter alike; `sampled`
alone leaves it to the GPU. Records are uniform buffers; a `Buffer` is a storage buffer that starts
with its count. `bindings.py` describes them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, assert_never

from basrelief.lang import tree
from basrelief.lang.bindings import GROUP, MAP_FORMATS, RUN, bindings
from basrelief.lang.layout import align_and_size
from basrelief.lang.resources import Edge, buffer_record
from basrelief.lang.targets.clike import FunctionPrinter, ModulePrinter, is_finest
from basrelief.lang.types import VECTORS, fields_of, is_record, leaves
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4

_TYPES: dict[Any, str] = {
    float: "f32",
    int: "i32",
    bool: "bool",
    Vec2: "vec2f",
    Vec3: "vec3f",
    Vec4: "vec4f",
    IVec2: "vec2i",
    Mat3: "mat3x3f",
    **{kind: form.wgsl for kind, form in MAP_FORMATS.items()},
}


def print_wgsl(module: tree.Module, edge: Edge) -> str:
    """WGSL of a program: a compute shader, entry point `main`, one invocation for each pixel."""
    printer = WgslPrinter(module.functions, [module.entry], edge)
    body = "\n".join(printer.declarations().values())
    return "\n".join([printer.bindings_text(module.entry), body, printer.main_text(module.entry)])


class _FunctionPrinter(FunctionPrinter):
    """Prints one function as WGSL."""

    language = "wgsl"

    def head(self, name: str, parameters: str, result: Any) -> str:
        return f"fn {name}({parameters}) -> {self.module.type(result)}"

    def parameter(self, name: str, t: Any) -> str:
        return f"{name}: {self.module.type(t)}"

    def declaration(self, name: str, t: Any, value: str | None, constant: bool = False) -> str:
        if value is None:
            return f"var {name}: {self.module.type(t)}"
        return f"{'let' if constant else 'var'} {name} = {value}"

    def long_step_loop(self, name: str, stop: str, node: tree.For) -> None:
        last = self.fresh(f"{name}_last")
        self.emit("{")
        self.emit(f"var {name} = {self.value(node.start)};")
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

    def argument(self, node: tree.Expression) -> str:
        """Text of an argument; comparisons need parentheses: `f(a < b, c > d)` is a template."""
        text = self.value(node)
        return f"({text})" if isinstance(node, tree.Compare | tree.Logic) else text

    def select(self, node: tree.Select) -> str:
        word = "select"
        if node.type is Mat3 or is_record(node.type):
            self.module.selected_types[node.type] = None
            word = self.module.reference(self.module.select_function(node.type))
        return f"{word}({self.arguments((node.otherwise, node.then, node.test))})"

    def item(self, node: tree.Item) -> str:
        items = self.module.buffers[buffer_record(node.buffer.type)]
        return f"{items}.items[{self.value(node.index)}]"

    def cell_as_floats(self, cell: tree.Expression) -> str:
        """Text of a cell as floats, without the conversion if it was made from floats."""
        if isinstance(cell, tree.Construct) and len(cell.parts) == 2:
            casts = [p for p in cell.parts if isinstance(p, tree.IntrinsicCall) and p.name == "int"]
            floats = [self.value(p.arguments[0]) for p in casts if p.arguments[0].type is float]
            if len(floats) == 2:
                return f"vec2f({', '.join(floats)})"
        return f"vec2f({self.value(cell)})"

    def intrinsic_call(self, node: tree.IntrinsicCall, texts: list[str]) -> str:
        written, arguments = self.module.written, node.arguments
        match node.name:
            case "len":
                return f"{self.module.buffers[buffer_record(arguments[0].type)]}.count"
            case "corners" if is_finest(arguments[2]):
                passed = [texts[0], self.cell_as_floats(arguments[1])]
                return self.call(written["corners_of_finest"], passed)
            case "size" if not is_finest(arguments[1]):
                finest = super().intrinsic_call(node, texts)
                levels = tree.IntrinsicCall(int, "levels", arguments[:1])
                count = super().intrinsic_call(levels, texts)
                return self.call(written["size_of_level"], [finest, count, texts[1]])
        return super().intrinsic_call(node, texts)


class WgslPrinter(ModulePrinter):
    """Prints a module as WGSL.

    `edge` is the edge of all maps, None in a library, where it is a static condition.
    """

    types = _TYPES
    function_printer = _FunctionPrinter

    def __init__(
        self,
        functions: Sequence[tree.Function],
        entries: Sequence[tree.Function],
        edge: Edge | None,
    ) -> None:
        bound = [binding for entry in entries for binding in bindings(entry)]
        super().__init__(functions, edge, [binding.variable for binding in bound])
        self.selected_types: dict[Any, None] = {}
        """Matrices and records that are selected by a condition; WGSL's `select` takes neither."""
        self.shared: set[Any] = set()
        """Records in buffers, which have the layout of `layout.py`."""
        for binding in bound:
            self.add_shared(buffer_record(binding.type) or binding.type)
        self.buffers = {buffer_record(b.type): b.variable for b in bound if b.kind == "buffer"}

    def add_shared(self, t: Any) -> None:
        if is_record(t):
            self.shared.add(t)
            for field in fields_of(t).values():
                self.add_shared(field)

    def record_text(self, record: Any) -> str:
        fields = fields_of(record)
        lines = [f"struct {self.scope[record]} {{"]
        for name, t in fields.items():
            first = record in self.shared and name == next(iter(fields))
            align = "@align(16) " if first or is_record(t) else ""
            lines.append(f"  {align}{self.field(name)}: {self.type(t)},")
        if not fields:
            lines.append("  @align(16) unused: f32,")  # WGSL has no empty structures
        return "\n".join([*lines, "}", ""])

    def declarations(self) -> dict[str, str]:
        texts = super().declarations()
        for t in self.selected_types:
            name, kind = self.scope[self.select_function(t)], self.type(t)
            texts[name] = _SELECT_FUNCTION.replace("NAME", name).replace("TYPE", kind)
        return texts

    def select_function(self, t: Any) -> Any:
        """Key in `scope` of the function that selects one of two values of a type."""
        key = ("select", t)
        if key not in self.scope:
            self.assign_name(key, f"select_{t.__name__}")
        return key

    def bindings_text(self, entry: tree.Function) -> str:
        """Text of the resource bindings of a program with this entry."""
        words = "\n".join(f"  {word}: u32," for word in RUN)
        run = f"// The rows of the picture that a dispatch computes.\nstruct Run {{\n{words}\n}}\n"
        return "\n".join([run, *self._binding_texts(entry)])

    def _binding_texts(self, entry: tree.Function) -> Iterator[str]:
        for number, binding in enumerate(bindings(entry)):
            where = f"@group(0) @binding({number}) var"
            match binding.kind:
                case "run":
                    yield f"{where}<uniform> run: Run;"
                case "planes":
                    yield f"{where}<storage, read_write> planes: array<u32>;"
                case "sampler":
                    yield f"{where} {binding.variable}: sampler;"
                case "uniform":
                    if is_record(binding.type):
                        align_and_size(binding.type)  # refuses a bool
                    yield f"{where}<uniform> {binding.variable}: {self.type(binding.type)};"
                case "map":
                    yield f"{where} {binding.variable}: {self.type(binding.type)};"
                case "buffer":
                    record = buffer_record(binding.type)
                    assert record is not None
                    item = self.type(record)
                    buffer = self.assign_name(("buffer", record), f"{self.scope[record]}Buffer")
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

    def stored(self, t: Any, index: Iterator[int]) -> str:
        """WGSL expression of a value that the planes hold, from the plane of the next index on."""
        if t is float or t is int:
            return f"bitcast<{self.type(t)}>({_word(next(index))})"
        if t is bool:
            return f"{_word(next(index))} != 0u"
        parts = fields_of(t).values() if is_record(t) else [leaf for _, leaf in leaves(t)]
        return f"{self.type(t)}({', '.join(self.stored(part, index) for part in parts)})"

    def main_text(self, entry: tree.Function) -> str:
        """Text of the entry point, which runs for each pixel."""
        variables = {b.name: b.variable for b in bindings(entry) if b.kind != "buffer"}
        arguments = ["vec2i(at)"]
        for name, t in list(entry.parameters.items())[1:]:
            if t is entry.result:
                arguments.append(self.stored(t, itertools.count()))
            elif name in variables:
                arguments.append(variables[name])
        lines = [f"  let result = {self.reference(entry)}({', '.join(arguments)});"]
        for index, (value, t) in enumerate(self.scalars("result", entry.result)):
            word = f"u32({value})" if t is bool else f"bitcast<u32>({value})"
            lines.append(f"  {_word(index)} = {word};")
        return _ENTRY.replace("GROUP", f"{GROUP[0]}, {GROUP[1]}").replace("BODY", "\n".join(lines))


# --- texts and names ---


def _word(index: int) -> str:
    """The word of a plane at the pixel."""
    return f"planes[place + {index}u * run.plane_stride]"


_SELECT_FUNCTION = """\
fn NAME(otherwise: TYPE, then: TYPE, test: bool) -> TYPE {
  if (test) {
    return then;
  }
  return otherwise;
}
"""

_ENTRY = """\
@compute @workgroup_size(GROUP)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let at = vec2u(id.x, id.y + run.first_row);
  if (at.x >= run.width || at.y >= run.last_row) {
    return;
  }
  let place = (at.y - run.plane_row) * run.width + at.x;
BODY
}
"""

# Keywords, reserved words (WGSL, §3.6 and §16.1), and predeclared names beside the intrinsics.
WgslPrinter.reserved_words = frozenset(
    """
    alias break case const const_assert continue continuing default diagnostic discard else
    enable false fn for if let loop override requires return struct switch true var while NULL
    Self abstract active alignas alignof as asm asm_fragment async attribute auto await become
    cast catch class co_await co_return co_yield coherent column_major common compile
    compile_fragment concept const_cast consteval constexpr constinit crate debugger decltype
    delete demote demote_to_helper do dynamic_cast enum explicit export extends extern
    external fallthrough filter final finally friend from fxgroup get goto groupshared highp
    impl implements import inline instanceof interface layout lowp macro macro_rules match
    mediump meta mod module move mut mutable namespace new nil noexcept noinline
    nointerpolation non_coherent noncoherent noperspective null nullptr of operator package
    packoffset partition pass patch pixelfragment precise precision premerge priv protected
    pub public readonly ref regardless register reinterpret_cast require resource restrict
    self set shared sizeof smooth snorm static static_assert static_cast std subroutine super
    target template this thread_local throw trait try type typedef typeid typename typeof
    union unless unorm unsafe unsized use using varying virtual volatile wgsl where with
    writeonly yield acos asin atan atan2 bitcast bool ceil f16 f32 i32 main planes round run
    select u32 vec2 vec3 vec4 vec2f vec3f vec4f vec2i vec2u mat3x3f array atomic ptr sampler
    texture_2d result place Run
    """.split()  # noqa: SIM905
)
WgslPrinter.declared_names = frozenset({"Run", "main", "id", "at"})
