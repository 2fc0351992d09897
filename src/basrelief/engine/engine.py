"""The interface that all engines share, and what they check alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import DeviceError
from basrelief.lang.program import Program
from basrelief.lang.resources import Buffer, HeightField, Texture, buffer_record
from basrelief.lang.types import leaf_values, leaves, type_name

Planes = dict[str, NDArray[Any]]
"""The leaves of a program's result by dotted name: arrays (H, W), float32, or int32 for ints and
bools."""

Words = NDArray[np.int32]


class Engine(Protocol):
    """Runs programs. `name` is "cpu" or "gpu"; `adapter` describes the processor or graphics card.

    `rounding` names how numbers round: engines with the same compute the same planes, bit for bit.
    """

    name: str
    adapter: str
    rounding: str

    def compile(self, program: Program) -> None:
        """Make the program ready, from the cache where it was compiled before."""

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Planes:
        """Run the program for every pixel of a picture of (width, height).

        With `rows`, first and last + 1, only those are computed and returned.
        `values` gives each parameter of the entry after the pixel, by name: records, maps, lists.
        Values that the program does not use may be missing.
        """


def value_of(program: Program, name: str, values: Mapping[str, Any]) -> Any:
    """The value of a parameter; raises DeviceError where it is missing or of another type."""
    if name not in values:
        raise DeviceError(f"the program {program.entry.name} needs a value for {name}")
    value, wanted = values[name], program.parameters[name]
    record = buffer_record(wanted)
    if record is not None:
        fits = isinstance(value, Buffer) and value.record is record
    else:
        fits = isinstance(value, wanted)
    if not fits:
        raise DeviceError(f"{name}: expected {type_name(wanted)}, not {type(value).__name__}")
    if isinstance(value, HeightField | Texture) and value.edge != program.edge:
        raise DeviceError(f"{name}: its edge is {value.edge}, the program's is {program.edge}")
    return value


def pack_uniforms(program: Program, names: Iterable[str], values: Mapping[str, Any]) -> Words:
    """The leaves of records, 32 bits each, in order."""
    words: list[np.int32] = []
    for name in names:
        words.extend(_words(value_of(program, name, values), program.parameters[name]))
    return np.array(words or [np.int32(0)], np.int32)


def _words(value: Any, t: Any) -> list[np.int32]:
    return [
        leaf.view(np.int32) if isinstance(leaf, np.float32) else np.int32(leaf)
        for leaf in leaf_values(value, t)
    ]


def pack_buffer(buffer: Buffer[Any]) -> Words:
    """A buffer's records, (items, leaves), 32 bits each; one of zeros if there is none."""
    if not len(buffer):
        return np.zeros((1, sum(1 for _ in leaves(buffer.record))), np.int32)
    return np.array([_words(item, buffer.record) for item in buffer.items], np.int32)
