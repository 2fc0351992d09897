"""Shaders printed as WGSL one by one, to be linked where they run.

A printed program has its slots bound. A library has each shader once, whatever is bound: a slot is
a function of its own name that calls the shader bound to it, and a type slot is an alias. Text
under a static condition is marked, for the linker to keep or drop, and so is each name of a piece
where it is used. A few pieces thus make any number of programs; the linker of a page,
`viewer/web/link.js`, follows the names that an entry uses.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from basrelief.lang import tree
from basrelief.lang.bindings import Binding, bindings
from basrelief.lang.frontend import analyse_library
from basrelief.lang.layout import align_and_size
from basrelief.lang.resources import flatten_parameter
from basrelief.lang.shader import Shader, accepted_parameters
from basrelief.lang.slots import Bindings, bound_types
from basrelief.lang.targets.wgsl import WgslPrinter

IF, THEN, ELSE, END = "\ue000", "\ue001", "\ue002", "\ue003"
"""Delimiters of a static condition's number and its two texts: private-use characters."""
NAME = "\ue004"
"""Delimiter on both sides of the name of a piece or slot where it is used."""


_PAGE_FIELDS = {"map.sampling": "texel"}
"""Static fields that are the same in all programs of a library: pages read texels, so that they
draw the same in every browser."""


@dataclass
class Library:
    """WGSL texts to link, with marks for static conditions, which are numbered, and names.

    Attributes
    ----------
    pieces
        Functions, records and helpers by name.
    slots
        For each slot by name, its text by the name of the shader or record bound to it.
    entries
        Entry points with their resource bindings, by name.
    conditions
        The static conditions, in the order of their numbers.
    bindings
        The resource bindings of each entry, whatever is bound to its slots.
    names
        The WGSL names of shaders, slots, records and type slots.
    """

    pieces: dict[str, str] = field(default_factory=dict)
    slots: dict[str, dict[str, str]] = field(default_factory=dict)
    entries: dict[str, str] = field(default_factory=dict)
    conditions: list[tree.Condition] = field(default_factory=list)
    bindings: dict[str, list[Binding]] = field(default_factory=dict)
    names: dict[Any, str] = field(default_factory=dict)

    def bound_names(self, bindings: Bindings) -> dict[str, str]:
        """Name of the shader or record that is bound to each slot and type slot, by its name."""
        bound: dict[Any, Any] = {**bindings, **bound_types(bindings)}
        return {self.names[slot]: self.names[target] for slot, target in bound.items()}


def library_of(
    entries: Sequence[Shader[..., Any]],
    options: Mapping[Shader[..., Any], Iterable[Shader[..., Any]]],
) -> Library:
    """Library of several entries; `options` are the shaders that each slot can be bound to.

    Raises ShaderError for source outside the subset, and for a shader that does not fit its slot.
    """
    return _LibraryBuilder(entries, options).library


class _Printer(WgslPrinter):
    """Printer that marks static conditions and names."""

    def __init__(
        self, functions: Sequence[tree.Function], entries: Sequence[tree.Function]
    ) -> None:
        super().__init__(functions, entries, None)
        self.conditions: dict[tree.Condition, int] = {}
        """Static conditions and their numbers."""

    def static(self, condition: tree.Condition, then: str, otherwise: str) -> str:
        number = self.conditions.setdefault(condition, len(self.conditions))
        return f"{IF}{number}{THEN}{then}{ELSE}{otherwise}{END}"

    def reference(self, obj: Any) -> str:
        return f"{NAME}{self.scope[obj]}{NAME}"


class _LibraryBuilder:
    """Builds a library: names first, since all pieces share them, then texts."""

    def __init__(
        self,
        entries: Sequence[Shader[..., Any]],
        options: Mapping[Shader[..., Any], Iterable[Shader[..., Any]]],
    ) -> None:
        self.options = {slot: list(shaders) for slot, shaders in options.items()}
        every = [*entries, *self.options, *(s for bound in self.options.values() for s in bound)]
        self.functions = analyse_library(every, _PAGE_FIELDS.get)
        tops = [self.functions[entry] for entry in entries]
        self.check_slots()
        self.check_reads()
        self.printer = _Printer(list(self.functions.values()), tops)
        self.types = self.bound_records()
        for slot, records in self.types.items():
            self.printer.assign_name(slot, slot.__name__)
            for record in records:
                self.printer.add_shared(record)
        scope = self.printer.scope
        shaders = {shader: scope[function] for shader, function in self.functions.items()}
        self.library = Library(names={**scope, **shaders})
        self.print_pieces(entries)

    def check_slots(self) -> None:
        """Raise ShaderError for a slot without options."""
        for shader in self.functions:
            if shader.is_slot and not self.options.get(shader):
                raise shader.error(
                    f"the slot {shader.name} has no options; list the shaders that it can be bound "
                    "to"
                )

    def check_reads(self) -> None:
        """Raise ShaderError for a read by the filter of the GPU."""
        for shader, function in self.functions.items():
            for node in tree.expressions(function.body):
                if isinstance(node, tree.IntrinsicCall) and node.name == "sampled":
                    raise shader.error(
                        f"{shader.name} reads by the filter of the GPU (sampled), which a page "
                        "does not; read by height_under"
                    )

    def bound_records(self) -> dict[type, list[type]]:
        """Records that each type slot can be replaced by."""
        records: dict[type, list[type]] = {}
        for slot, shaders in self.options.items():
            for shader in shaders:
                for type_slot, record in bound_types({slot: shader}).items():
                    if record not in records.setdefault(type_slot, []):
                        align_and_size(record)  # refuses a bool
                        records[type_slot].append(record)
        return records

    def forwarding_function(self, slot: Shader[..., Any], shader: Shader[..., Any]) -> str:
        """Function of a slot that calls the shader bound to it."""
        m, accepted = self.printer, accepted_parameters(slot, shader) or ()
        function = self.functions[slot]
        names = m.parameter_names(function)
        parameters = ", ".join(f"{names[n]}: {m.type(function.parameters[n])}" for n in names)
        types = slot.signature[0]
        flat = (path for name in accepted for path in flatten_parameter(name, types[name]))
        passed = ", ".join(names[name] for name in flat if name in names)
        doc = "".join(f"// {line}".rstrip() + "\n" for line in function.doc.splitlines())
        return (
            f"{doc}fn {m.scope[function]}({parameters}) -> {m.type(function.result)} {{\n"
            f"  return {m.reference(self.functions[shader])}({passed});\n}}\n"
        )

    def print_pieces(self, entries: Sequence[Shader[..., Any]]) -> None:
        m, library = self.printer, self.library
        entry_texts = {
            entry: m.bindings_text(self.functions[entry])
            + "\n"
            + m.main_text(self.functions[entry])
            for entry in entries
        }
        library.slots = self.slot_texts()
        texts = m.declarations()
        library.pieces = {name: text for name, text in texts.items() if name not in library.slots}
        library.conditions = list(m.conditions)
        for entry, text in entry_texts.items():
            library.entries[entry.name] = text
            library.bindings[entry.name] = bindings(self.functions[entry])

    def slot_texts(self) -> dict[str, dict[str, str]]:
        """Texts of slots and type slots, by the name of the shader or record bound to them."""
        m = self.printer
        slots = {
            m.scope[self.functions[slot]]: {
                m.scope[self.functions[shader]]: self.forwarding_function(slot, shader)
                for shader in shaders
            }
            for slot, shaders in self.options.items()
        }
        for type_slot, records in self.types.items():
            name = m.scope[type_slot]
            slots[name] = {m.scope[r]: f"alias {name} = {m.reference(r)};\n" for r in records}
        return slots
