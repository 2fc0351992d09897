"""Linking of programs from a library's pieces, as the page's `web/link.js` does it."""

from __future__ import annotations

import functools
import re

from basrelief.lang.library import ELSE, END, IF, NAME, THEN, Library
from basrelief.lang.program import Program
from basrelief.lang.tree import holds

_STATIC = re.compile(f"{IF}(\\d+){THEN}([^{IF}-{END}]*){ELSE}([^{IF}-{END}]*){END}")
"""Two texts under a static condition, without nested ones."""


def linked(library: Library, program: Program) -> str:
    """The WGSL of a program: all that its entry uses, with bound slots and decided conditions."""
    bound = library.bound_names(program.bindings)

    def decided(text: str) -> str:
        count = 1
        while count:
            text, count = _STATIC.subn(lambda m: m[2] if truth(int(m[1])) else m[3], text)
        return text

    @functools.cache
    def truth(number: int) -> bool:
        return holds(library.conditions[number], program.static_value)

    texts = [decided(library.entries[program.entry.name])]
    included: set[str] = set()
    for text in texts:  # including those that are appended
        for name in text.split(NAME)[1::2]:
            if name not in included:
                included.add(name)
                options = library.slots.get(name)
                piece = library.pieces[name] if options is None else options[bound[name]]
                texts.append(decided(piece))
    return "\n".join(texts).replace(NAME, "")
