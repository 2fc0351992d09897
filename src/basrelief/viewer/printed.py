"""Library of programs for a page: each shader once, with its static conditions undecided.

A page links its programs from these pieces (`web/link.js`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from basrelief.lang import Shader
from basrelief.lang.bindings import GROUP, MAP_FORMATS, RUN
from basrelief.lang.library import Library, library_of
from basrelief.lang.resources import buffer_record, members_of
from basrelief.rendering.programs import SURFACES
from basrelief.scene import Object, Scene
from basrelief.settings import settings_of
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.missed_hit import missed_hit
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.surface import surface_at
from basrelief.techniques import TECHNIQUES, Technique, displace
from basrelief.viewer.bakes import PROGRAMS

MENUS: dict[str, tuple[str, ...]] = {
    name: declared.choices
    for record in (Object, Scene)
    for name, declared in settings_of(record).items()
    # shadows between objects need several objects, of which a page has one; it reads texels
    if declared.choices and name not in ("casts", "shadows_on", "filter")
}
"""Values of the menus of a page, by the fields of `Object` and `Scene`."""
AnyShader = Shader[..., Any]
ENTRIES: tuple[AnyShader, ...] = (pixel, missed_hit, *PROGRAMS)
Techniques = Mapping[str, Technique[..., Any]]


@dataclass(frozen=True)
class ProgramLibrary:
    """The library of all programs, and the bindings of its slots: `bound[menu][name]`."""

    library: Library
    bound: dict[str, dict[str, dict[str, str]]]

    def to_dict(self) -> dict[str, Any]:
        """The library and the bindings for JSON."""
        library = self.library
        return {
            "pieces": library.pieces,
            "slots": library.slots,
            "entries": library.entries,
            "conditions": library.conditions,
            "bindings": {
                name: [
                    {
                        "kind": binding.kind,
                        # pages name maps without the prefix of their group
                        "name": binding.name.removeprefix("maps_"),
                        "type": _type_name(binding.type, library.names),
                        "access": binding.access,
                    }
                    for binding in bindings
                ]
                for name, bindings in library.bindings.items()
            },
            "bound": self.bound,
            "maps": [*members_of(SurfaceMaps)],
            "group": GROUP,
            "run": RUN,
            "formats": {
                kind.__name__: [form.texels, form.texel_bytes] for kind, form in MAP_FORMATS.items()
            },
        }


def program_library(techniques: Techniques = TECHNIQUES) -> ProgramLibrary:
    """Print all programs that a page can choose, with techniques by name.

    Raises ShaderError for a technique that is outside the subset.
    """
    menus: dict[str, tuple[AnyShader, Mapping[str, AnyShader]]] = {
        "technique": (displace, techniques),
        "surface": (surface_at, SURFACES),
    }
    library = library_of(ENTRIES, {slot: options.values() for slot, options in menus.values()})
    bound = {
        menu: {name: library.bound_names({slot: shader}) for name, shader in options.items()}
        for menu, (slot, options) in menus.items()
    }
    return ProgramLibrary(library, bound)


def _type_name(t: Any, names: Mapping[Any, str]) -> str:
    named = buffer_record(t) or t
    return names.get(named) or str(getattr(named, "__name__", ""))
