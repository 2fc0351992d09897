"""The interface that all engines share, and what they check alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import EngineError
from basrelief.lang.program import Program
from basrelief.lang.resources import Buffer, HeightField, Texture, buffer_record
from basrelief.lang.types import leaf_values

Planes = dict[str, NDArray[Any]]
"""The leaves of a program's result by dotted name: arrays (H, W), float32, or int32 for ints and
bools."""

Progress = Callable[[float], None]
"""Called now and then with the finished share of a run, 0 to 1."""


class Engine(Protocol):
    """Runs programs. `name` is "cpu" or "gpu"; `device` says on what."""

    name: str
    device: str

    def compile(self, program: Program) -> None:
        """Make the program ready, from the cache where it was compiled before."""

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        progress: Progress | None = None,
    ) -> Planes:
        """Run the program for every pixel of a picture of (width, height).

        `values` gives each parameter of the entry after the pixel, by name: records, maps, lists.
        Values that the program does not use may be missing.
        """


def pack_uniforms(program: Program, values: Mapping[str, Any]) -> NDArray[np.int32]:
    """The leaves of a program's records, 32 bits each, in order."""
    words: list[np.int32] = []
    for name, t in program.uniforms.items():
        if name not in values:
            raise EngineError(f"the program {program.entry.name} needs a value for {name}")
        words.extend(_words(values[name], t))
    return np.array(words or [0], np.int32)


def _words(value: Any, t: Any) -> list[np.int32]:
    if not isinstance(value, t):
        raise EngineError(f"expected a {t.__name__}, not a {type(value).__name__}")
    return [
        leaf.view(np.int32) if isinstance(leaf, np.float32) else np.int32(leaf)
        for leaf in leaf_values(value, t)
    ]


def pack_buffer(buffer: Buffer[Any]) -> NDArray[np.int32]:
    """A buffer's records one after another, (items, leaves), 32 bits each; one of zeros if empty."""
    if not len(buffer):
        return np.zeros((1, 64), np.int32)
    return np.array([_words(item, buffer.record) for item in buffer.items], np.int32)


def check_resource(program: Program, name: str, value: Any) -> None:
    """Raise EngineError where a resource is not what the program takes by that name."""
    wanted = program.parameters[name]
    record = buffer_record(wanted)
    if record is not None:
        fits = isinstance(value, Buffer) and value.record is record
    else:
        fits = isinstance(value, wanted)
    if not fits:
        raise EngineError(f"{name}: expected {wanted}, not {type(value).__name__}")
    if isinstance(value, HeightField | Texture) and value.edge != program.edge:
        raise EngineError(f"{name}: its edge is {value.edge}, the program's is {program.edge}")
