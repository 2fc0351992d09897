"""Memory layout of what compiled programs read: records on a GPU, and resources on the CPU.

Records on a GPU have WGSL's host-shareable layout. The rules of the uniform address space apply
everywhere, so that one layout serves uniforms and storage: a record within a record starts at a
multiple of 16 bytes (W3C, WebGPU Shading Language, 2024, §14.4).
"""

from __future__ import annotations

import functools
import struct
from collections.abc import Iterator
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.lang.resources import Buffer, Map
from basrelief.lang.types import ShaderError, fields_of, is_record, leaf_values, leaves
from basrelief.lang.values import IVec2, Mat3, Vec2, Vec3, Vec4

_ALIGN_AND_SIZE: dict[Any, tuple[int, int]] = {
    float: (4, 4),
    int: (4, 4),
    Vec2: (8, 8),
    IVec2: (8, 8),
    Vec3: (16, 12),
    Vec4: (16, 16),
    Mat3: (16, 48),
}


def _round_up(offset: int, align: int) -> int:
    return -(-offset // align) * align


def align_and_size(t: Any) -> tuple[int, int]:
    """Alignment and size of a type in bytes. Raises ShaderError for a bool, which has neither."""
    if is_record(t):
        align, end = 16, 4  # a record without fields has a dummy member
        for _, offset, field_type in offsets(t):
            end = offset + align_and_size(field_type)[1]
        return align, _round_up(end, align)
    if t not in _ALIGN_AND_SIZE:
        raise ShaderError(
            f"a record that a GPU reads cannot contain a {t.__name__}; use an int, 0 or 1"
        )
    return _ALIGN_AND_SIZE[t]


def offsets(record: type) -> Iterator[tuple[str, int, Any]]:
    """Fields of a record: name, offset in bytes, type."""
    offset = 0
    for name, t in fields_of(record).items():
        align, size = align_and_size(t)
        offset = _round_up(offset, align)
        yield name, offset, t
        offset += size


def words(t: Any, start: int = 0) -> Iterator[int]:
    """Offsets of the scalars of a type in 32-bit words, in the order of `leaves`."""
    if is_record(t):
        for _, offset, field_type in offsets(t):
            yield from words(field_type, start + offset // 4)
    elif t is Mat3:
        yield from (start + 4 * column + row for column in range(3) for row in range(3))
    else:
        yield from range(start, start + sum(1 for _ in leaves(t)))


def pack(value: Any, t: Any) -> NDArray[np.int32]:
    """A value of type t as 32-bit words in this layout."""
    return np.frombuffer(_packing(t).pack(*leaf_values(value, t)), np.int32)


@functools.cache
def _packing(t: Any) -> struct.Struct:
    """The layout of a type for Python's `struct`; gaps are zeros."""
    form, end = "<", 0
    for word, (_, kind) in zip(words(t), leaves(t), strict=True):
        form += f"{4 * (word - end)}x{'f' if kind is float else 'i'}"
        end = word + 1
    return struct.Struct(f"{form}{align_and_size(t)[1] - 4 * end}x")


def pack_list(buffer: Buffer[Any]) -> NDArray[np.int32]:
    """Count of a buffer, padded to the alignment of items, and items; zeros if empty."""
    align, size = align_and_size(buffer.record)
    items = [pack(item, buffer.record) for item in buffer.items]
    head = np.zeros(align // 4, np.int32)
    head[0] = len(buffer)
    return np.concatenate([head, *(items or [np.zeros(size // 4, np.int32)])])


# --- resources on the CPU ------------------------------------------------------------------------


class HeaderWord(IntEnum):
    """Words of 32 bits in the header of a resource on the CPU; the first two are the address of its
    data. A buffer has those up to `LAST`, and of a map the offsets of all levels follow."""

    COUNT = 2
    """Number of levels or items."""
    LAST = 3
    """Index of the last item, 0 for none."""
    WIDTH = 4
    HEIGHT = 5
    OFFSETS = 6
    """Offset of each level in texels."""


def header(value: Map | Buffer[Any], address: int) -> NDArray[np.int32]:
    """Header of a resource whose data is at an address."""
    if isinstance(value, Buffer):
        words = [len(value), max(0, len(value) - 1)]
    else:
        height, width = value.shape
        words = [len(value.levels), 0, width, height, *value.offsets]
    return np.concatenate(
        [np.array([address], np.uint64).view(np.int32), np.array(words, np.int32)]
    )
