"""Writing pictures, whole or not at all.

Arrays are (height, width, channels), row 0 at the top. PNG, JPEG and WebP, meant for the
eye, hold sRGB; EXR, HDR and TIFF hold linear light.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images.color import encode_light
from basrelief.images.files import check_writable, write_whole
from basrelief.images.read import Pixels, complaint, first_line


@dataclass(frozen=True)
class _Format:
    """What a file format can hold: its bit depths, the default first; channels; light or code."""

    bits: tuple[int, ...]
    most_channels: int
    encoded: bool


_FORMATS = {
    ".png": _Format(bits=(8, 16), most_channels=4, encoded=True),
    ".jpg": _Format(bits=(8,), most_channels=3, encoded=True),
    ".jpeg": _Format(bits=(8,), most_channels=3, encoded=True),
    ".webp": _Format(bits=(8,), most_channels=4, encoded=True),
    ".exr": _Format(bits=(16, 32), most_channels=4, encoded=False),
    ".hdr": _Format(bits=(32,), most_channels=3, encoded=False),
    ".tif": _Format(bits=(32, 16), most_channels=4, encoded=False),
    ".tiff": _Format(bits=(32, 16), most_channels=4, encoded=False),
}

WRITABLE = tuple(_FORMATS)
"""Suffixes that `write_picture` knows."""


def write_picture(
    path: str | os.PathLike[str],
    linear: NDArray[np.floating],
    *,
    bits: int | None = None,
    quality: int = 95,
) -> Path:
    """Write linear light, (height, width, 3 or 4), as the format that the suffix names.

    PNG (8 or 16 `bits`, 8 by default), JPEG and WebP (8) are clipped to 0…1, encoded to sRGB and
    rounded to the nearest code, without dither. EXR (16, half floats, by default, or 32), TIFF
    (32 or 16, floats) and HDR stay linear. The alpha, 0 to 1 and not multiplied into the colours,
    is dropped by JPEG and HDR. `quality`, 1 to 100, is for JPEG and WebP (100: WebP lossless).
    A file of that name is replaced, once the new one is complete. Returns the path.
    Raises InputError for an unknown suffix, impossible bits, or a place that cannot be written.
    """
    path = Path(path)
    kind, bits = _checked(path, bits)
    if linear.ndim != 3 or linear.shape[2] not in (3, 4) or linear.size == 0:
        raise InputError(f"{path}: a picture has 3 or 4 channels and a size, not {linear.shape}")
    if not 1 <= quality <= 100:
        raise InputError(f"{path}: quality is 1 to 100, not {quality}")
    linear = linear[:, :, : kind.most_channels]
    pixels = encode_light(linear, bits) if kind.encoded else linear.astype(np.float32)
    stored = {8: "uint8", 16: "uint16"}[bits] if kind.encoded else {16: "half", 32: "float"}[bits]
    if path.suffix.lower() == ".exr" and pixels.shape[2] == 4:
        pixels[:, :, :3] *= pixels[:, :, 3:]  # OpenEXR's alpha is multiplied in, by its definition
    write_whole(path, lambda partial: _write(partial, pixels, stored, quality))
    return path


def check_target(path: str | os.PathLike[str], bits: int | None = None) -> None:
    """Raise InputError where `write_picture` would refuse a path: before the work, not after."""
    _checked(Path(path), bits)
    check_writable(Path(path))


def write_data(path: str | os.PathLike[str], pixels: Pixels) -> Path:
    """Write numbers as they are, (height, width, 1 to 4) of uint8, uint16 or float32.

    For maps, not for light: nothing is encoded. The suffix must be able to hold them (PNG and TIFF
    integers, EXR and TIFF floats). Whole or not at all; raises InputError as `write_picture` does.
    """
    path = Path(path)
    stored = {"uint8": "uint8", "uint16": "uint16", "float32": "float"}.get(str(pixels.dtype))
    fits = {"uint8": (".png", ".tif", ".tiff"), "float": (".exr", ".tif", ".tiff")}
    suffixes = fits["float" if stored == "float" else "uint8"]
    if stored is None or pixels.ndim != 3 or not 1 <= pixels.shape[2] <= 4 or pixels.size == 0:
        raise InputError(f"{path}: cannot hold an array of {pixels.dtype}, shape {pixels.shape}")
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: {stored} data is written to {', '.join(suffixes)}")
    write_whole(path, lambda partial: _write(partial, pixels, stored, 100))
    return path


def encode_png(linear: NDArray[np.floating], *, bits: int = 8) -> bytes:
    """The bytes of the PNG file that `write_picture` would write; for notebooks and pages."""
    with tempfile.TemporaryDirectory() as folder:
        return write_picture(Path(folder) / "picture.png", linear, bits=bits).read_bytes()


def _checked(path: Path, bits: int | None) -> tuple[_Format, int]:
    """What the suffix's format can hold, and the bits to write."""
    kind = _FORMATS.get(path.suffix.lower())
    if kind is None:
        suffix = f"the suffix {path.suffix}" if path.suffix else "a name without suffix"
        raise InputError(f"{path}: {suffix} names no known format; use one of {' '.join(WRITABLE)}")
    chosen = kind.bits[0] if bits is None else bits
    if chosen not in kind.bits:
        known = " or ".join(str(each) for each in sorted(kind.bits))
        raise InputError(f"{path}: {path.suffix} holds {known} bits a channel, not {bits}")
    return kind, chosen


def _write(path: Path, pixels: Pixels, stored: str, quality: int) -> None:
    import OpenImageIO

    height, width, channels = pixels.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, stored)
    spec.attribute("oiio:UnassociatedAlpha", 1)
    spec.attribute("DateTime", "1970:01:01 00:00:00")  # the same pixels make the same bytes
    lossy = {".jpg": "jpeg", ".jpeg": "jpeg", ".webp": "webp"}.get(path.suffix.lower())
    if lossy:
        lossless = lossy == "webp" and quality == 100
        spec.attribute("compression", "lossless" if lossless else f"{lossy}:{quality}")
        spec.attribute("jpeg:subsampling", "4:4:4")
    target = OpenImageIO.ImageOutput.create(str(path))
    if target is None:
        raise OSError(first_line(complaint(OpenImageIO)))
    done = target.open(str(path), spec) and target.write_image(np.ascontiguousarray(pixels))
    closed = target.close()
    trouble = complaint(target) or complaint(OpenImageIO)
    if not (done and closed):
        raise OSError(first_line(trouble))
