"""Materials: loaded from files by their naming conventions, or procedural.

Names are imported on first use, since the command line's help reads `material.options`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basrelief.lazy import lazy_names

if TYPE_CHECKING:
    from basrelief.material.loading import load
    from basrelief.material.material import Map, Material, Note
    from basrelief.material.opening import hole, opened
    from basrelief.material.options import MAPS
    from basrelief.material.reporting import describe, report
    from basrelief.material.samples import SAMPLES, sample

__getattr__ = lazy_names(
    __name__,
    {
        "loading": ("load",),
        "material": ("Map", "Material", "Note"),
        "options": ("MAPS",),
        "reporting": ("describe", "report"),
        "samples": ("SAMPLES", "sample"),
        "opening": ("hole", "opened"),
    },
)

__all__ = [
    "MAPS",
    "SAMPLES",
    "Map",
    "Material",
    "Note",
    "describe",
    "hole",
    "load",
    "opened",
    "report",
    "sample",
]
