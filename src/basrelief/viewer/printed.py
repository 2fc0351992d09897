"""Programs as a page holds them: every piece of WGSL once, each program as a list of pieces.

Pieces are told apart by their text, so what many programs share is stored once. The programs are
those of a material that has every map; a page gives a single texel for a map that is missing, so
that they are the same for every material, and are kept on disk once they are printed.
"""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import os
import queue
import re
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import basrelief
from basrelief._version import __version__
from basrelief.engine import cache
from basrelief.errors import EngineError
from basrelief.lang.program import Program
from basrelief.lang.resources import buffer_record
from basrelief.lang.types import is_record
from basrelief.lang.wgsl import bindings, print_wgsl
from basrelief.material import Map, Material
from basrelief.programs import program_of
from basrelief.scene import SHAPES, Object, Scene
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.viewer.bakes import bake_programs
from basrelief.viewer.layouts import record_names

CHOICES: dict[str, tuple[str, ...]] = {
    "technique": tuple(TECHNIQUES),
    "shape": SHAPES,
    "shadows": ("none", "hard", "soft"),
    "projection": ("full", "biased", "limited"),
    "shading_model": ("ggx", "phong"),
}
"""What makes a program of its own, in the order of a program's key; all else is a number."""
_MOST_PROCESSES = 8
_PIECE = re.compile(r"\n(?=(?://[^\n]*\n)*(?:fn |struct |@group|@compute))")
_SAYING = (
    "lang", "shaders", "scene", "programs.py", "viewer/printed.py", "viewer/layouts.py",
    "viewer/bakes.py",
)  # fmt: skip
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
    """Print them all, on all cores: each works through its share and hands over line by line."""
    whole = len(list(choices()))
    made, numbers = Printed(), dict[str, int]()
    for key, program in bake_programs().items():
        _add(made, numbers, {"key": key, **_shown(program)})
    found: dict[str, dict[str, Any]] = {}
    for each in _from_all_cores():
        found[each["key"]] = each
        if progress is not None:
            progress(len(found) / whole)
    # in one order, however the cores took turns
    for chosen in choices():
        _add(made, numbers, found[key_of(chosen)])
    return made


def _from_all_cores() -> Iterator[dict[str, Any]]:
    """Every program's text and bindings, in any order."""
    count = min(os.cpu_count() or 1, _MOST_PROCESSES)
    if count == 1 or not sys.executable:
        yield from _share(0, 1)
        return
    home = str(Path(basrelief.__file__).parent.parent)
    told = {**os.environ, "PYTHONPATH": os.pathsep.join([home, os.environ.get("PYTHONPATH", "")])}
    arguments = ("-c", "import sys; from basrelief.viewer.printed import work; work(*sys.argv[1:])")
    heard: queue.SimpleQueue[str | None] = queue.SimpleQueue()
    with contextlib.ExitStack() as stack:
        for number in range(count):
            worker = subprocess.Popen(
                [sys.executable, *arguments, str(number), str(count)],
                stdout=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                env=told,
            )
            listener = threading.Thread(target=_hear, args=(worker, heard), daemon=True)
            stack.callback(listener.join)
            stack.callback(worker.wait)
            stack.callback(worker.kill)
            listener.start()
        left = count
        done = 0
        while left:
            line = heard.get()
            if line is None:
                left -= 1
                continue
            done += 1
            yield json.loads(line)
    if done != len(list(choices())):
        raise EngineError("printing the programs failed in another process; see what it said")


def _hear(worker: subprocess.Popen[str], heard: queue.SimpleQueue[str | None]) -> None:
    assert worker.stdout is not None
    with worker.stdout:
        for line in worker.stdout:
            heard.put(line)
    heard.put(None)


def work(number: str, count: str) -> None:
    """One process's share of the programs, a line of JSON each on standard output."""
    for each in _share(int(number), int(count)):
        sys.stdout.write(json.dumps(each) + "\n")


def _share(number: int, count: int) -> Iterator[dict[str, Any]]:
    for chosen in itertools.islice(choices(), number, None, count):
        yield {"key": key_of(chosen), **_shown(_program(chosen))}


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


def _shown(program: Program) -> dict[str, Any]:
    """What a program is, as JSON has it."""
    return {
        "text": print_wgsl(program.module, program.edge),
        "bindings": [
            {"kind": each.kind, "name": each.name, "type": _type_name(each.type)}
            for each in bindings(program.module)
        ],
    }


def _add(made: Printed, numbers: dict[str, int], shown: Mapping[str, Any]) -> None:
    listed = []
    for piece in _PIECE.split(shown["text"]):
        if piece not in numbers:
            numbers[piece] = len(made.pieces)
            made.pieces.append(piece)
        listed.append(numbers[piece])
    made.programs[shown["key"]] = {"pieces": listed, "bindings": shown["bindings"]}


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
