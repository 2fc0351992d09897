"""Linking of programs from a library's pieces, as the page's `web/link.js` does it."""

from __future__ import annotations

import functools
import re

from basrelief.lang.library import Library
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import ELSE, END, IF, THEN
from basrelief.lang.tree import holds

_NAME = re.compile(r"(?<![.\w])[A-Za-z_]\w*(?!\w|\s*:)")
"""A used name: neither a field nor the name of a parameter."""
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
        for name in _used(text):
            options = library.slots.get(name)
            piece = library.pieces.get(name) if options is None else options[bound[name]]
            if piece is not None and name not in included:
                included.add(name)
                texts.append(decided(piece))
    return "\n".join(texts)


def _used(text: str) -> list[str]:
    """The distinct names in a text, without its comments."""
    return list(dict.fromkeys(_NAME.findall(re.sub(r"//[^\n]*", "", text))))
