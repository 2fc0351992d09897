"""Programs as a page holds them: every piece of WGSL once, each program as a list of pieces.

Pieces are told apart by their text, so what many programs share is stored once. The programs are
those of a material that has every map; a page gives a single texel for a map that is missing, so
that they are the same for every material, and are kept on disk once they are printed.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import basrelief
from basrelief._version import __version__
from basrelief.engine import cache
from basrelief.lang.program import Program
from basrelief.lang.resources import buffer_record
from basrelief.lang.types import is_record
from basrelief.lang.wgsl import bindings, print_wgsl
from basrelief.material import Map, Material
from basrelief.programs import program_of
from basrelief.scene import SHAPES, Object, Scene
from basrelief.shaders.bakes.texels import normals
from basrelief.shaders.edge import edges_of
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.viewer.layouts import record_names

CHOICES: dict[str, tuple[str, ...]] = {
    "technique": tuple(TECHNIQUES),
    "shape": SHAPES,
    "shadows": ("none", "hard", "soft"),
    "projection": ("full", "biased", "limited"),
    "shading_model": ("ggx", "phong"),
}
"""What makes a program of its own, in the order of a program's key; all else is a number."""
BAKED_NORMALS = "normals"
"""The key of the program that makes normals of heights."""
_PIECE = re.compile(r"\n(?=(?://[^\n]*\n)*(?:fn |struct |@group|@compute))")
_SAYING = ("lang", "shaders", "scene", "viewer", "programs.py")
"""The parts of the package whose source says what a program's text is."""


@dataclass
class Printed:
    """`pieces` of WGSL; `programs` by key: the numbers of their pieces, and what they bind."""

    pieces: list[str] = field(default_factory=list)
    programs: dict[str, dict[str, Any]] = field(default_factory=dict)

    def text(self, key: str) -> str:
        """A program's whole WGSL."""
        return "\n".join(self.pieces[number] for number in self.programs[key]["pieces"])


def printed(progress: Callable[[float], None] | None = None) -> Printed:
    """Every program that a page can choose; from disk where they were printed before."""
    key = f"viewer-{_source()}"
    found = cache.read(key)
    if found is not None:
        return Printed(**json.loads(found[1]))
    made = _print(progress)
    cache.write(key, {}, json.dumps(vars(made)).encode())
    return made


def choices() -> Iterator[dict[str, str]]:
    """Every combination of what a page can choose."""
    for values in itertools.product(*CHOICES.values()):
        yield dict(zip(CHOICES, values, strict=True))


def key_of(chosen: Mapping[str, str]) -> str:
    """A program's key in a page."""
    return "|".join(chosen[name] for name in CHOICES)


def _print(progress: Callable[[float], None] | None) -> Printed:
    made, numbers = Printed(), dict[str, int]()
    whole = list(choices())
    _add(made, numbers, BAKED_NORMALS, Program(normals, edges_of("wrap"), "wrap"))
    for done, chosen in enumerate(whole):
        _add(made, numbers, key_of(chosen), _program(chosen))
        if progress is not None:
            progress((done + 1) / len(whole))
    return made


def _program(chosen: Mapping[str, str]) -> Program:
    """The program of one combination, for a material that has every map."""
    of_object = {name: chosen[name] for name in ("technique", "shape", "projection")}
    of_scene: dict[str, Any] = {name: chosen[name] for name in ("shadows", "shading_model")}
    thing = Object(_whole_material(), **of_object)  # type: ignore[arg-type]
    return program_of(thing, Scene((thing,), **of_scene))


def _whole_material() -> Material:
    def one(channels: int) -> Map:
        return Map(np.ones((1, 1, channels), np.float32), False, "one texel")

    return Material(
        "any", height=one(1), base_color=one(3), normal=one(3), occlusion=one(1), emission=one(3)
    )


def _add(made: Printed, numbers: dict[str, int], key: str, program: Program) -> None:
    listed = []
    for piece in _PIECE.split(print_wgsl(program.module, program.edge)):
        if piece not in numbers:
            numbers[piece] = len(made.pieces)
            made.pieces.append(piece)
        listed.append(numbers[piece])
    made.programs[key] = {
        "pieces": listed,
        "bindings": [
            {"kind": each.kind, "name": each.name, "type": _type_name(each.type)}
            for each in bindings(program.module)
        ],
        "planes": len(program.planes),
    }


def _type_name(t: Any) -> str:
    record = buffer_record(t) or t
    if is_record(record):
        return record_names()[record]
    return getattr(record, "__name__", "")


def _source() -> str:
    """A digest of the source that the programs are printed from."""
    home = Path(basrelief.__file__).parent
    digest = hashlib.sha256(__version__.encode())
    for part in _SAYING:
        place = home / part
        files = [place] if place.is_file() else sorted(place.rglob("*.py"))
        for file in files:
            digest.update(file.read_bytes())
    return digest.hexdigest()
