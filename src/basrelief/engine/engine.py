"""Interface of all engines, and the packing and checking of values that they share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import DeviceError
from basrelief.lang.program import Program
from basrelief.lang.resources import Buffer, HeightField, Sampling, Texture, buffer_record
from basrelief.lang.types import leaf_values, leaves, type_name

Planes = dict[str, NDArray[Any]]
"""Planes of a picture, one for each scalar of a program's result, by dotted name: (H, W) float32,
or int32 for ints and bools."""

Words = NDArray[np.int32]
_T = TypeVar("_T")


class PlaneBuffer(Buffer[_T]):
    """Planes of a canvas as a buffer, row by row, for the programs of the engine that made it; or
    an array, for those of any engine.

    A record has four scalars, the size to which a GPU aligns records; up to three words after the
    last whole record are left out.

    Attributes
    ----------
    shape
        Number of rows of all planes, and of words from one row to the next.
    stored
        The planes: an array of int32, or what the engine knows them by.
    """

    def __init__(self, record: type[_T], shape: tuple[int, int], stored: Any) -> None:
        self.record, self.shape, self.stored = record, shape, stored

    def __len__(self) -> int:
        return self.shape[0] * self.shape[1] // 4


class Canvas(Protocol):
    """Planes of a picture that stay on the device, for programs with one result record.

    Attributes
    ----------
    size
        Width and height in pixels.
    """

    size: tuple[int, int]

    def read(self, name: str, count: int = 1, *, interleaved: bool = False) -> NDArray[Any]:
        """The plane of a scalar, by its dotted name, and the next ones: (count, H, W), as in
        `Planes`. The array may be a view of the canvas, unless it is `interleaved`, (H, W, count).
        """

    def buffer(self, name: str, record: type[_T], count: int = 1) -> PlaneBuffer[_T] | None:
        """The plane of a scalar, and the next ones, as a buffer of records of four such scalars;
        None where they are too large for one. What is drawn on the canvas later may change it."""


class Engine(Protocol):
    """Runs programs on a device.

    Attributes
    ----------
    name
        "cpu" or "gpu".
    adapter
        The processor or graphics card.
    rounding
        Identifies the arithmetic: engines with the same value compute the same planes, bit for bit.
    is_lost
        Whether the device was lost. Such an engine raises DeviceError, and so does reading its
        canvases.
    """

    name: str
    adapter: str
    rounding: str
    is_lost: bool

    @property
    def filtered_format(self) -> str | None:
        """WebGPU's name of the format of heights that the device's own filter reads; None for a
        device without such a filter."""

    def compile(self, program: Program) -> None:
        """Compile the program, or load it from the cache."""

    def canvas(self, program: Program, size: tuple[int, int]) -> Canvas:
        """New planes for the results of a program; what they hold is undefined."""

    def draw(
        self,
        program: Program,
        values: Mapping[str, Any],
        canvas: Any,
        rows: tuple[int, int] | None = None,
    ) -> None:
        """Run a program for the pixels of a canvas of this engine, over what it holds.

        `rows` are the first row, and the last row + 1; None for all. Raises DeviceError for a
        missing value, or one of another type.
        """

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Planes:
        """Run the program for every pixel of a picture.

        Parameters
        ----------
        program
            The program.
        values
            The value of each entry parameter after the pixel, by name: records, maps and buffers.
            Values that the program does not read may be missing.
        size
            Width and height of the picture in pixels.
        rows
            First row, and last row + 1, to compute and return; None for all.

        Returns
        -------
        Planes
            Arrays of shape (rows, width).

        Raises
        ------
        DeviceError
            For a missing value, or one of another type.
        """


def check_sampling(sampling: Sampling, engine: Engine) -> None:
    """Raise DeviceError for reads by the filter of a GPU on an engine that has none."""
    if sampling == "hardware" and engine.filtered_format is None:
        raise DeviceError("filter hardware needs a GPU: use --device gpu, or --filter texel")


def value_of(program: Program, name: str, values: Mapping[str, Any]) -> Any:
    """Value of a parameter. Raises DeviceError if it is missing or of another type."""
    if name not in values:
        raise DeviceError(f"the program {program.entry.name} needs a value for {name}")
    value, expected = values[name], program.parameters[name]
    record = buffer_record(expected)
    if record is not None:
        fits = isinstance(value, Buffer) and value.record is record
    else:
        fits = isinstance(value, expected)
    if not fits:
        raise DeviceError(f"{name}: expected {type_name(expected)}, not {type(value).__name__}")
    if isinstance(value, HeightField | Texture) and value.edge != program.edge:
        raise DeviceError(
            f"{name}: the edge is {value.edge}, that of the program is {program.edge}"
        )
    return value


def pack_uniforms(program: Program, names: Iterable[str], values: Mapping[str, Any]) -> Words:
    """Scalars of records in order, 32 bits each."""
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
    """Records of a buffer, (items, scalars), 32 bits each; a record of zeros if it is empty."""
    if not len(buffer):
        return np.zeros((1, sum(1 for _ in leaves(buffer.record))), np.int32)
    return np.array([_words(item, buffer.record) for item in buffer.items], np.int32)
