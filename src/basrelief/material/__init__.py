"""Materials: loaded from files by their naming conventions, or procedural."""

from basrelief.material.hole import hole
from basrelief.material.load import load
from basrelief.material.material import MAPS, Map, Material, Note
from basrelief.material.report import describe, report
from basrelief.material.samples import SAMPLES, sample

__all__ = [
    "MAPS",
    "SAMPLES",
    "Map",
    "Material",
    "Note",
    "describe",
    "hole",
    "load",
    "report",
    "sample",
]
