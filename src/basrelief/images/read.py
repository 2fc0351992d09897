"""Reading of picture files, without changes to the stored values.

Arrays are (height, width, channels), row 0 at the top. There is no colour transform and no division
by alpha.
"""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError

LOSSY = frozenset({".jfif", ".jp2", ".jpeg", ".jpg", ".webp"})
"""Suffixes of formats with lossy compression."""

READABLE = LOSSY | frozenset(
    {".bmp", ".dds", ".dpx", ".exr", ".gif", ".hdr", ".jxl", ".pbm", ".pfm", ".pgm", ".png"}
    | {".pnm", ".ppm", ".psd", ".sgi", ".tga", ".tif", ".tiff", ".tx"}
)
"""Suffixes of pictures, for the search of a folder."""

Pixels = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Picture:
    """Picture with the values that its file stores.

    Attributes
    ----------
    pixels
        (height, width, channels) of uint8, uint16 or float32; half floats and integers of other
        widths become float32. Colours are neither multiplied nor divided by alpha.
    channels
        Names along the last axis, such as ("R", "G", "B", "A") or ("Y",).
    path
        The file.
    """

    pixels: Pixels
    channels: tuple[str, ...]
    path: Path

    @property
    def alpha(self) -> Pixels | None:
        """The alpha channel, (height, width, 1), or None."""
        if "A" not in self.channels:
            return None
        index = self.channels.index("A")
        return self.pixels[:, :, index : index + 1]

    @property
    def opaque(self) -> Pixels:
        """All channels but the alpha, (height, width, channels)."""
        if "A" not in self.channels:
            return self.pixels
        if self.channels[-1] == "A":
            return self.pixels[:, :, :-1]
        return np.delete(self.pixels, self.channels.index("A"), axis=2)


@dataclass(frozen=True)
class PictureSize:
    """Header of a picture file: size in pixels, channels, bits per channel (32 for floats)."""

    width: int
    height: int
    channels: int
    bits: int


def picture_size(path: str | os.PathLike[str]) -> PictureSize:
    """Read only the header of a picture. Raises InputError as `read_picture` does."""
    path = Path(path)
    source = _open(path)
    spec = source.spec()
    source.close()
    return PictureSize(spec.width, spec.height, spec.nchannels, _bits(spec))


def read_picture(path: str | os.PathLike[str]) -> Picture:
    """Read the first picture of a file, at full size and upright.

    Palettes are expanded. 8- and 16-bit integers are unchanged; other values become float32, where
    integers are divided by their largest value. The `Orientation` tag of cameras is applied.
    Raises InputError if the file is missing, is not a picture, is damaged or cut off.
    """
    path = Path(path)
    source = _open(path)
    spec = source.spec()
    try:
        pixels = source.read_image({8: "uint8", 16: "uint16"}.get(_bits(spec), "float"))
    except MemoryError as error:
        size = f"{spec.width}×{spec.height}×{spec.nchannels}"
        raise InputError(f"{path}: {size} does not fit in memory; scale it down") from error
    problem = take_error(source)
    source.close()
    if pixels is None or problem:
        raise InputError(_damaged_message(path, problem))
    if pixels.ndim == 2:
        pixels = pixels[:, :, None]
    return Picture(_upright(pixels, spec), _channel_names(spec), path)


def _open(path: Path) -> Any:
    import OpenImageIO

    if not os.path.exists(path):  # unlike Path.exists, False for impossible names
        raise InputError(f"{path}: there is no such file; check the name")
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder, not a picture; name a file in it")
    try:
        problem = _png_problem(path)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); check its permissions"
        ) from error
    if problem:
        raise InputError(_damaged_message(path, problem))
    as_stored = OpenImageIO.ImageSpec()
    as_stored.attribute("oiio:UnassociatedAlpha", 1)
    source = OpenImageIO.ImageInput.open(str(path), as_stored)
    if source is None:
        why = first_line(take_error(OpenImageIO))
        raise InputError(f"{path}: is not a picture that can be read ({why}); replace the file")
    spec = source.spec()
    if min(spec.width, spec.height, spec.nchannels) < 1 or spec.deep:
        raise InputError(f"{path}: has no pixels; replace the file")
    return source


def _bits(spec: Any) -> int:
    return {"uint8": 8, "uint16": 16}.get(str(spec.format), 32)


def _channel_names(spec: Any) -> tuple[str, ...]:
    """Channel names as stored, with "A" for alpha, which two-channel files may name differently."""
    try:
        names = [str(name) for name in spec.channelnames]
    except UnicodeDecodeError:
        names = [f"channel {number}" for number in range(spec.nchannels)]
    if 0 <= spec.alpha_channel < len(names):  # a GIF may name one that it does not have
        names[spec.alpha_channel] = "A"
    return tuple(names)


def _upright(pixels: Pixels, spec: Any) -> Pixels:
    """Rotate and mirror by the `Orientation` tag (TIFF 6.0, 1992, p. 36); 1 is upright."""
    orientation = spec.get_int_attribute("Orientation", 1)
    if orientation in (5, 6, 7, 8):
        pixels = pixels.transpose(1, 0, 2)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)


def _png_problem(path: Path) -> str | None:
    """Problem with the chunks of a PNG file, found before libpng prints to standard error."""
    with path.open("rb") as file:
        if file.read(8) != b"\x89PNG\r\n\x1a\n":
            return None
        while True:
            head = file.read(8)
            body = file.read(int.from_bytes(head[:4], "big") + 4)
            if len(head) < 8 or len(body) < int.from_bytes(head[:4], "big") + 4:
                return "it ends too early"
            if zlib.crc32(head[4:] + body[:-4]) != int.from_bytes(body[-4:], "big"):
                return "a checksum is wrong"
            if head[4:] == b"IEND":
                return None


def _damaged_message(path: Path, why: str) -> str:
    return f"{path}: the picture is damaged or cut off ({first_line(why)}); get the file again"


def take_error(source: Any) -> str:
    """Take the pending error message of OpenImageIO, which clears it."""
    try:
        return str(source.geterror())
    except UnicodeDecodeError:
        return "its header is invalid"


def first_line(text: str) -> str:
    """First line of a message, without a full stop at its end."""
    return text.strip().splitlines()[0].rstrip(".") if text.strip() else "no reason given"
