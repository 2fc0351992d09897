"""PNG files with a chosen filter for every row (W3C, PNG Specification, 2003)."""

from __future__ import annotations

import itertools
import struct
import zlib
from collections.abc import Iterable, Sequence

import numpy as np

FILTERS = ("none", "sub", "up", "average", "paeth")
"""Names of the filters, by number."""


def png(
    codes: np.ndarray,
    type: int,
    bits: int,
    parts: dict[bytes, bytes] | None = None,
    *,
    rows: int | None = None,
    interlaced: int = 0,
    filters: Sequence[int] = (0, 1, 2, 3, 4),
    pieces: int = 1,
) -> bytes:
    """A PNG of (h, w, c) samples, whose rows cycle through the filters.

    `type` is the colour type, `parts` are further chunks, `rows` is the height in the header, and
    `pieces` the number of IDAT chunks.
    """
    height, width, count = codes.shape
    # samples of fewer than eight bits share bytes, and are filtered byte by byte
    pixel = max(count * bits // 8, 1)
    lines = []
    above = np.zeros(-(-width * count * bits // 8), np.uint8)
    for line, filter in zip(_rows(codes, bits), itertools.cycle(filters), strict=False):
        lines.append(bytes([filter]) + _filtered(line, above, pixel, filter).tobytes())
        above = line
    head = struct.pack(">IIBBBBB", width, rows or height, bits, type, 0, 0, interlaced)
    packed = zlib.compress(b"".join(lines))
    step = -(-len(packed) // pieces)
    idat = [(b"IDAT", packed[k : k + step]) for k in range(0, len(packed), step)]
    body = [(b"IHDR", head), *(parts or {}).items(), *idat, (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(*each) for each in body)


def _rows(codes: np.ndarray, bits: int) -> Iterable[np.ndarray]:
    """The bytes of each row."""
    if bits == 16:
        return codes.astype(">u2").reshape(len(codes), -1).view(np.uint8)
    flat = codes.astype(np.uint8).reshape(len(codes), -1)
    if bits == 8:
        return flat
    ones = (flat[:, :, None] >> np.arange(bits)[::-1]) & 1
    return np.packbits(ones.astype(np.uint8).reshape(len(codes), -1), axis=1)


def _filtered(line: np.ndarray, above: np.ndarray, pixel: int, filter: int) -> np.ndarray:
    left, corner = (
        np.concatenate([np.zeros(pixel, np.uint8), each])[: len(line)] for each in (line, above)
    )
    a, b, c = (each.astype(int) for each in (left, above, corner))
    # the first of the nearest: left, above, upper left
    near = np.stack([abs(b - c), abs(a - c), abs(a + b - 2 * c)]).argmin(0)
    guesses = (0 * a, a, b, (a + b) // 2, np.choose(near, (a, b, c)))
    # an unknown filter leaves rows unchanged
    return (line - (guesses[filter] if filter < len(guesses) else 0)).astype(np.uint8)


def _chunk(name: bytes, part: bytes) -> bytes:
    return struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part))


def filters_of(content: bytes, row: int) -> list[int]:
    """The filter of each row of a PNG with `row` bytes per row."""
    packed, at = b"", 8
    while at < len(content):
        length, name = struct.unpack(">I4s", content[at : at + 8])
        packed += content[at + 8 : at + 8 + length] if name == b"IDAT" else b""
        at += 12 + length
    return list(zlib.decompress(packed)[:: row + 1])
