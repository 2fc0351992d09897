"""Shaders printed as WGSL one by one, to be put together where they run.

A printed program has its slots bound. A library has each shader once, whatever is bound: a slot is
a function of its own name, which hands on to the shader bound to it, and a type slot is an alias.
Lines under a static condition are marked, to be kept or not. So few pieces make any number of
programs: a page's own few lines (`viewer/web/link.js`) follow what an entry uses.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from basrelief.lang.frontend import Bindings, analyse_apart, bound_types
from basrelief.lang.layout import align_and_size
from basrelief.lang.resources import flat_names
from basrelief.lang.shader import Shader, taken_parameters
from basrelief.lang.tree import Condition
from basrelief.lang.types import ShaderError
from basrelief.lang.wgsl import Binding, ModulePrinter, bindings


@dataclass
class Library:
    """Texts: `pieces` by name; `slots` by name, then by the name of what is bound; `entries` by
    name. Their static conditions are numbered."""

    pieces: dict[str, str] = field(default_factory=dict)
    slots: dict[str, dict[str, str]] = field(default_factory=dict)
    entries: dict[str, str] = field(default_factory=dict)
    conditions: list[Condition] = field(default_factory=list)
    bindings: dict[str, list[Binding]] = field(default_factory=dict)
    """What each entry binds, all of it whatever is bound to the slots."""
    names: dict[Any, str] = field(default_factory=dict)
    """Shaders, slots, records and type slots, and what they are called here."""

    def bound_names(self, bindings: Bindings) -> dict[str, str]:
        """Slots and type slots by name, and the names of what bindings bind them to."""
        found: dict[Any, Any] = {**bindings, **bound_types(bindings)}
        return {self.names[slot]: self.names[bound] for slot, bound in found.items()}


def library_of(
    entries: Sequence[Shader[..., Any]],
    options: Mapping[Shader[..., Any], Iterable[Shader[..., Any]]],
) -> Library:
    """The library of several entries, with all that may be bound to each of their slots.

    Raises ShaderError for what is outside the subset, or does not fit its slot.
    """
    return _Printing(entries, options).library


class _Printing:
    """Names first, since all pieces share them; then texts; then which uses which."""

    def __init__(
        self,
        entries: Sequence[Shader[..., Any]],
        options: Mapping[Shader[..., Any], Iterable[Shader[..., Any]]],
    ) -> None:
        self.options = {slot: list(shaders) for slot, shaders in options.items()}
        every = [*entries, *self.options, *(s for each in self.options.values() for s in each)]
        self.done = analyse_apart(every)
        tops = [self.done[entry] for entry in entries]
        self.check_slots()
        self.printer = ModulePrinter(list(self.done.values()), tops, None)
        self.types = self.types_bound()
        for slot, records in self.types.items():
            self.printer.claim(slot, slot.__name__)
            for record in records:
                self.printer.note_shared(record)
        scope = self.printer.scope
        shaders = {shader: scope[function] for shader, function in self.done.items()}
        self.library = Library(names={**scope, **shaders})
        self.fill(entries)

    def check_slots(self) -> None:
        """Refuse a slot that nothing could be bound to."""
        for shader in self.done:
            if shader.is_slot and not self.options.get(shader):
                raise ShaderError(
                    f"{shader.location}: nothing can be bound to the slot {shader.name}; "
                    "say what its options are"
                )

    def types_bound(self) -> dict[type, list[type]]:
        """The records that each type slot may stand for."""
        found: dict[type, list[type]] = {}
        for slot, shaders in self.options.items():
            for shader in shaders:
                for asked, record in bound_types({slot: shader}).items():
                    if record not in found.setdefault(asked, []):
                        align_and_size(record)  # refuses what a GPU cannot be given
                        found[asked].append(record)
        return found

    def forwarding(self, slot: Shader[..., Any], shader: Shader[..., Any]) -> str:
        """The function of a slot that hands on to a shader."""
        m, taken = self.printer, taken_parameters(slot, shader) or ()
        function = self.done[slot]
        names = m.parameter_names(function)
        given = ", ".join(f"{names[n]}: {m.type(function.parameters[n])}" for n in names)
        given_by = slot.signature[0]
        flat = (each for name in taken for each in flat_names(name, given_by[name]))
        handed = ", ".join(names[name] for name in flat if name in names)
        doc = "".join(f"// {line}".rstrip() + "\n" for line in function.doc.splitlines())
        return (
            f"{doc}fn {m.scope[function]}({given}) -> {m.type(function.result)} {{\n"
            f"  return {m.scope[self.done[shader]]}({handed});\n}}\n"
        )

    def fill(self, entries: Sequence[Shader[..., Any]]) -> None:
        m, made = self.printer, self.library
        whole = {
            entry: m.bound_text(self.done[entry]) + "\n" + m.main_text(self.done[entry])
            for entry in entries
        }
        slots = self.slot_texts()
        texts = {}
        # helpers last: what is printed says which are needed; a slot has no text of its own
        for text in (*m.record_texts(), *m.function_texts(), *m.helper_texts()):
            if _declared(text) not in slots:
                texts[_declared(text)] = text
        made.pieces, made.slots, made.conditions = texts, slots, list(m.conditions)
        for entry, text in whole.items():
            made.entries[entry.name] = text
            made.bindings[entry.name] = bindings(self.done[entry])

    def slot_texts(self) -> dict[str, dict[str, str]]:
        """What each slot is, by the name of what is bound to it; type slots too."""
        m = self.printer
        slots = {
            m.scope[self.done[slot]]: {
                m.scope[self.done[shader]]: self.forwarding(slot, shader) for shader in shaders
            }
            for slot, shaders in self.options.items()
        }
        for asked, records in self.types.items():
            name = m.scope[asked]
            slots[name] = {m.scope[r]: f"alias {name} = {m.scope[r]};\n" for r in records}
        return slots


def _declared(text: str) -> str:
    """The name of the one thing that a text declares."""
    found = re.search(r"^(?:fn|struct|alias) (\w+)", text, re.MULTILINE)
    assert found is not None
    return found[1]
