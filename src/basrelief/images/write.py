"""Atomic writing of picture files, which are encoded in memory.

Arrays are (height, width, channels), row 0 at the top. PNG, JPEG and WebP are encoded to sRGB; EXR,
HDR and TIFF store linear light.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images.color import encode_light
from basrelief.images.encode import encoded
from basrelief.images.files import check_writable, write_bytes
from basrelief.images.read import Pixels
from basrelief.timings import step


@dataclass(frozen=True)
class _Format:
    """Properties of a format: bit depths, default first; channels; whether it is sRGB-encoded."""

    bits: tuple[int, ...]
    max_channels: int
    encoded: bool


_FORMATS = {
    ".png": _Format(bits=(8, 16), max_channels=4, encoded=True),
    ".jpg": _Format(bits=(8,), max_channels=3, encoded=True),
    ".jpeg": _Format(bits=(8,), max_channels=3, encoded=True),
    ".webp": _Format(bits=(8,), max_channels=4, encoded=True),
    ".exr": _Format(bits=(16, 32), max_channels=4, encoded=False),
    ".hdr": _Format(bits=(32,), max_channels=3, encoded=False),
    ".tif": _Format(bits=(32, 16), max_channels=4, encoded=False),
    ".tiff": _Format(bits=(32, 16), max_channels=4, encoded=False),
}

_QUICK_PNG = {"png:compressionLevel": 1, "png:filter": 0x40}
"""Options of PNG pictures: the fastest level, and one filter for all rows, `PNG_FILTER_AVG`. A
rendered material of 1920 × 1080 takes 56 ms in place of 345, and 8 % more bytes; maps, which are
kept and sent, take the usual ones."""

_WEBP_METHOD = 2
"""Effort of libwebp, of 0 to 6. The usual 4 takes twice as long, and 6, OpenImageIO's, five times.
Rendered materials of 960 × 540 are then 2 and 6 % smaller, and 0.2 dB nearer to the original."""

WRITABLE = tuple(_FORMATS)
"""Suffixes that `write_picture` supports."""


def write_picture(
    path: str | os.PathLike[str],
    linear: NDArray[np.floating],
    *,
    bits: int | None = None,
    quality: int = 95,
) -> Path:
    """Write linear light to a picture file.

    PNG, JPEG and WebP are clipped to 0 … 1, encoded to sRGB and rounded to the nearest code,
    without dither. An existing file is replaced once the new one is complete.

    Parameters
    ----------
    path
        The file; its suffix decides the format.
    linear
        (height, width, 3 or 4), alpha from 0 to 1 and not premultiplied. JPEG and HDR drop alpha.
    bits
        Bits per channel: PNG 8 (default) or 16; JPEG and WebP 8; EXR 16 (half floats, default) or
        32; TIFF 32 (default) or 16, floats; HDR 32.
    quality
        1 to 100, for JPEG and WebP; 100 is lossless WebP.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        For an unknown suffix, unsupported bits, or a path that cannot be written.
    """
    path = Path(path)
    write_bytes(path, _picture(path, linear, bits, quality))
    return path


def write_codes(
    path: str | os.PathLike[str], codes: NDArray[np.uint8 | np.uint16], *, quality: int = 95
) -> Path:
    """Write sRGB codes, (height, width, 3 or 4), as `encode_light` gives them, to PNG, JPEG or
    WebP. Raises InputError as `write_picture` does."""
    path = Path(path)
    write_bytes(path, _coded_picture(path, codes, quality))
    return path


def code_bits(path: str | os.PathLike[str], bits: int | None) -> int | None:
    """The bits of the sRGB codes in a picture file; None for a format of linear light.

    Raises InputError as `write_picture` does.
    """
    file_format, bits = _checked(Path(path), bits)
    return bits if file_format.encoded else None


def check_target(path: str | os.PathLike[str], bits: int | None = None) -> None:
    """Raise InputError if `write_picture` would refuse a path, to check it before the work."""
    _checked(Path(path), bits)
    check_writable(Path(path))


def write_data(path: str | os.PathLike[str], pixels: Pixels) -> Path:
    """Write a map, (height, width, 1 to 4) of uint8, uint16 or float32, without encoding.

    PNG and TIFF take integers, EXR and TIFF floats. Raises InputError as `write_picture` does.
    """
    path = Path(path)
    stored = {"uint8": "uint8", "uint16": "uint16", "float32": "float"}.get(str(pixels.dtype))
    fits = {"uint8": (".png", ".tif", ".tiff"), "float": (".exr", ".tif", ".tiff")}
    suffixes = fits["float" if stored == "float" else "uint8"]
    if stored is None or pixels.ndim != 3 or not 1 <= pixels.shape[2] <= 4 or pixels.size == 0:
        raise InputError(f"{path}: cannot store an array of {pixels.dtype}, shape {pixels.shape}")
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: {stored} data can be written only to {', '.join(suffixes)}")
    write_bytes(path, lambda: _encode(path, pixels, stored, 100))
    return path


def encode_png(pixels: NDArray[Any], *, bits: int = 8) -> bytes:
    """Bytes of the PNG file of linear light, or of codes of 8 bits, for notebooks and pages."""
    path = Path("picture.png")
    if pixels.dtype == np.uint8:
        return _coded_picture(path, pixels, 100)()
    return _picture(path, pixels, bits, 100)()


# --- encoding ------------------------------------------------------------------------------------


def _picture(
    path: Path, linear: NDArray[np.floating], bits: int | None, quality: int
) -> Callable[[], bytes]:
    """The function that encodes linear light for a file; the arguments are checked at once."""
    file_format, bits = _checked(path, bits, quality)
    if linear.ndim != 3 or linear.shape[2] not in (3, 4) or linear.size == 0:
        raise InputError(
            f"{path}: a picture must have 3 or 4 channels and a size, not {linear.shape}"
        )
    linear = linear[:, :, : file_format.max_channels]

    def encode() -> bytes:
        if file_format.encoded:
            stored = {8: "uint8", 16: "uint16"}[bits]
            with step("encode"):
                pixels = encode_light(linear, bits)
            return _encode(path, pixels, stored, quality, _QUICK_PNG)
        pixels = linear.astype(np.float32)
        if path.suffix.lower() == ".exr" and pixels.shape[2] == 4:
            pixels[:, :, :3] *= pixels[:, :, 3:]  # OpenEXR is defined with premultiplied alpha
        return _encode(path, pixels, {16: "half", 32: "float"}[bits], quality)

    return encode


def _coded_picture(
    path: Path, codes: NDArray[np.uint8 | np.uint16], quality: int
) -> Callable[[], bytes]:
    """The function that encodes sRGB codes for a file; the arguments are checked at once."""
    file_format, _ = _checked(path, 8 * codes.itemsize, quality)
    pixels = codes[:, :, : file_format.max_channels]
    return lambda: _encode(path, pixels, str(codes.dtype), quality, _QUICK_PNG)


def _checked(path: Path, bits: int | None, quality: int = 95) -> tuple[_Format, int]:
    """Format of a suffix, and the bits per channel to write."""
    if not 1 <= quality <= 100:
        raise InputError(f"{path}: quality is 1 to 100, not {quality}")
    file_format = _FORMATS.get(path.suffix.lower())
    if file_format is None:
        suffix = f"the suffix {path.suffix}" if path.suffix else "a name without suffix"
        raise InputError(f"{path}: {suffix} names no known format; use one of {' '.join(WRITABLE)}")
    chosen = file_format.bits[0] if bits is None else bits
    if chosen not in file_format.bits:
        known = " or ".join(str(depth) for depth in sorted(file_format.bits))
        raise InputError(f"{path}: {path.suffix} holds {known} bits a channel, not {bits}")
    return file_format, chosen


def _encode(
    path: Path,
    pixels: Pixels,
    stored: str,
    quality: int,
    png_options: Mapping[str, int] = MappingProxyType({}),
) -> bytes:
    """The bytes of a file, in the format of the path's suffix."""
    suffix = path.suffix.lower()
    attributes: dict[str, int | str] = {}
    lossy = {".jpg": "jpeg", ".jpeg": "jpeg", ".webp": "webp"}.get(suffix)
    if lossy:
        lossless = lossy == "webp" and quality == 100
        attributes["compression"] = "lossless" if lossless else f"{lossy}:{quality}"
        attributes["jpeg:subsampling"] = "4:4:4"
        attributes["webp:method"] = _WEBP_METHOD
    if suffix == ".png":
        attributes |= png_options
    with step("encode"):
        return encoded(suffix, pixels, stored, attributes)
