"""Records as a page writes them: where each field lies, what it means, and its range.

Read off the records themselves, so that a page has no copy of its own to keep.
"""

from __future__ import annotations

import functools
from dataclasses import MISSING, fields
from typing import Any

from basrelief.lang.layout import align_and_size, offsets
from basrelief.lang.types import VECTORS, fields_of, is_record, leaf_values
from basrelief.scene import SURFACES
from basrelief.shaders.bakes.bounds import Blocks, Overlap
from basrelief.shaders.bakes.cones import Octave, Sector
from basrelief.shaders.bakes.texels import Relief
from basrelief.shaders.bakes.windows import Windows
from basrelief.shaders.fog import Fog
from basrelief.shaders.height import Smoothing
from basrelief.shaders.lighting import Light, Shading
from basrelief.shaders.meeting import Placement, View
from basrelief.shaders.relief import Depth
from basrelief.shaders.shadow import Shadowing
from basrelief.shaders.surfaces.surface import MapPlaces
from basrelief.shaders.techniques import TECHNIQUES

_ROOTS = (
    View, Placement, Depth, Smoothing, MapPlaces, Shading, Shadowing, Fog, Light,
    Relief, Blocks, Overlap, Windows, Octave, Sector,
)  # fmt: skip


@functools.cache
def record_names() -> dict[type, str]:
    """Every record that a page may write, and a name that no other has."""
    found: dict[type, str] = {}

    def visit(t: Any) -> None:
        if is_record(t) and t not in found:
            for each in fields_of(t).values():
                visit(each)
            taken = set(found.values())
            name = t.__name__
            while name in taken:
                name += "_"
            found[t] = name

    settings = [made.settings for made in TECHNIQUES.values()]
    for root in (*_ROOTS, *SURFACES.values(), *settings):
        visit(root)
    return found


def layouts() -> dict[str, Any]:
    """Each record by name: its size in words, and its fields: name, type, offset in words."""
    return {
        name: {
            "words": align_and_size(record)[1] // 4,
            "align": align_and_size(record)[0] // 4,
            "fields": [
                [each, record_names().get(t, t.__name__), offset // 4]
                for each, offset, t in offsets(record)
            ],
        }
        for record, name in record_names().items()
    }


def settings_of(record: type) -> list[dict[str, Any]]:
    """The settings of a record: name, meaning, range, default, and whether it is a whole number."""
    return [
        {
            "name": each.name,
            "doc": each.metadata["doc"],
            "low": each.metadata["low"],
            "high": each.metadata["high"],
            "default": plain(each.default),
            "whole": fields_of(record)[each.name] is int,
        }
        for each in fields(record)
        if "doc" in each.metadata and each.default is not MISSING
    ]


def plain(value: Any) -> Any:
    """A value of the subset as JSON has it: a number, a list of them, or a record as a mapping.

    Matrices are lists of nine, column by column.
    """
    t = type(value)
    if is_record(t):
        return {name: plain(getattr(value, name)) for name in fields_of(t)}
    if t.__name__ == "Mat3" or t in VECTORS:
        return [_short(leaf) for leaf in leaf_values(value, t)]
    return _short(value)


def _short(value: Any) -> float | int:
    """A number with as many digits as its 32 bits have: 0.1, not 0.10000000149."""
    return value if isinstance(value, int) else float(str(value))
