"""The programs as a page holds them: each shader once, with its static conditions left open.

A page links what it draws from these pieces (`web/link.js`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from basrelief.lang import Shader
from basrelief.lang.library import Library, library_of
from basrelief.lang.resources import buffer_record, members_of
from basrelief.rendering.programs import SURFACES
from basrelief.scene import Object
from basrelief.shading.kinds import menus_of
from basrelief.shading.missed_hit import missed_hit
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.surface import SurfaceMaps, surface_at
from basrelief.shading.variant import Variant
from basrelief.techniques import TECHNIQUES, Technique, displace
from basrelief.viewer.bakes import PROGRAMS

MENUS: dict[str, tuple[str, ...]] = {
    name: values
    for name, values in (menus_of(Object) | menus_of(Variant)).items()
    # shadows on one another are those of several objects, of which a page has one
    if name not in ("casts", "shadows_on")
}
"""What a page chooses by name, as `Object` and `Scene` have it."""
AnyShader = Shader[..., Any]
ENTRIES: tuple[AnyShader, ...] = (pixel, missed_hit, *PROGRAMS)
Techniques = Mapping[str, Technique[..., Any]]


@dataclass(frozen=True)
class ProgramLibrary:
    """The library of all programs, and what its slots are bound to: `bound[menu][name]`."""

    library: Library
    bound: dict[str, dict[str, dict[str, str]]]

    def to_dict(self) -> dict[str, Any]:
        """Both as JSON has them."""
        made = self.library
        return {
            "pieces": made.pieces,
            "slots": made.slots,
            "entries": made.entries,
            "conditions": made.conditions,
            "bindings": {
                name: [
                    {
                        "kind": each.kind,
                        # a page has its maps by their own names
                        "name": each.name.removeprefix("maps_"),
                        "type": _type_name(each.type, made.names),
                    }
                    for each in found
                ]
                for name, found in made.bindings.items()
            },
            "bound": self.bound,
            "maps": [*members_of(SurfaceMaps)],
        }


def program_library(techniques: Techniques = TECHNIQUES) -> ProgramLibrary:
    """Every program that a page can choose, with these techniques by name.

    Raises ShaderError for a technique that is outside the subset.
    """
    chosen: dict[str, tuple[AnyShader, Mapping[str, AnyShader]]] = {
        "technique": (displace, techniques),
        "surface": (surface_at, SURFACES),
    }
    library = library_of(ENTRIES, {slot: options.values() for slot, options in chosen.values()})
    bound = {
        menu: {name: library.bound_names({slot: made}) for name, made in options.items()}
        for menu, (slot, options) in chosen.items()
    }
    return ProgramLibrary(library, bound)


def _type_name(t: Any, names: Mapping[Any, str]) -> str:
    named = buffer_record(t) or t
    return names.get(named) or str(getattr(named, "__name__", ""))
