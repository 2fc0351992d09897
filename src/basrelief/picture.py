"""Pictures on disk: reading and writing them, whole or not at all, and the sRGB curve.

Arrays are (height, width, channels), row 0 on top. Reading never changes a value: no colour
transform, no division by alpha. Writing encodes linear light to sRGB for the formats that are
meant for the eye (PNG, JPEG, WebP) and leaves it linear for the others (EXR, HDR, TIFF).
"""

from __future__ import annotations

import os
import secrets
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError

__all__ = [
    "LOSSY",
    "READABLE",
    "WRITABLE",
    "Picture",
    "PictureSize",
    "check_place",
    "encode_light",
    "encode_png",
    "picture_size",
    "read_picture",
    "srgb_decode",
    "srgb_encode",
    "write_data",
    "write_picture",
    "write_whole",
]

LOSSY = frozenset({".jfif", ".jp2", ".jpeg", ".jpg", ".webp"})
"""Suffixes of formats that usually lose something."""

READABLE = LOSSY | frozenset(
    {".bmp", ".dds", ".dpx", ".exr", ".gif", ".hdr", ".jxl", ".pbm", ".pfm", ".pgm", ".png"}
    | {".pnm", ".ppm", ".psd", ".sgi", ".tga", ".tif", ".tiff", ".tx"}
)
"""Suffixes that are taken for pictures when a folder is searched."""

Pixels = NDArray[Any]


# --- the sRGB curve ------------------------------------------------------------------------------


def srgb_encode(linear: NDArray[np.floating]) -> NDArray[np.floating]:
    """Linear light, 0 to 1, to sRGB code values, 0 to 1, by the exact piecewise curve.

    Source: IEC 61966-2-1:1999, *Default RGB colour space, sRGB*, with its four printed constants.
    Values below 0 follow the straight piece, values above 1 the power.
    """
    power = 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, power)


def srgb_decode(encoded: NDArray[np.floating]) -> NDArray[np.floating]:
    """The inverse of `srgb_encode`: sRGB code values, 0 to 1, to linear light, 0 to 1."""
    power = ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, encoded / 12.92, power)


# --- reading -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture as its file stores it.

    `pixels` is (height, width, channels) of uint8, uint16 or float32; half floats and other
    widths arrive as float32. `channels` names the last axis, for instance ("R", "G", "B", "A") or
    ("Y",); an alpha is never multiplied into the colours, nor divided out of them.
    """

    pixels: Pixels
    channels: tuple[str, ...]
    path: Path

    @property
    def alpha(self) -> Pixels | None:
        """The alpha channel, (height, width, 1), or None."""
        if "A" not in self.channels:
            return None
        at = self.channels.index("A")
        return self.pixels[:, :, at : at + 1]

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
    """What a picture's header says: size in pixels, channels, bits per channel (32: float)."""

    width: int
    height: int
    channels: int
    bits: int


def picture_size(path: str | os.PathLike[str]) -> PictureSize:
    """Read a picture's header alone. Raises InputError like `read_picture`."""
    path = Path(path)
    source = _open(path)
    spec = source.spec()
    source.close()
    return PictureSize(spec.width, spec.height, spec.nchannels, _bits(spec))


def read_picture(path: str | os.PathLike[str]) -> Picture:
    """Read one picture: its first part, at full size, upright.

    Palettes are expanded, 8 and 16 bits stay as they are, everything else becomes float32 (other
    integers divided by their largest value). The `Orientation` of a camera is applied.
    Raises InputError, naming the file, when it is missing, no picture, damaged or cut off.
    """
    path = Path(path)
    source = _open(path)
    spec = source.spec()
    try:
        pixels = source.read_image({8: "uint8", 16: "uint16"}.get(_bits(spec), "float"))
    except MemoryError as error:
        size = f"{spec.width}×{spec.height}×{spec.nchannels}"
        raise InputError(f"{path}: {size} does not fit in memory; scale it down") from error
    trouble = _complaint(source)
    source.close()
    if pixels is None or trouble:
        raise InputError(_damaged(path, trouble))
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
        trouble = _png_trouble(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check its rights") from error
    if trouble:
        raise InputError(_damaged(path, trouble))
    as_stored = OpenImageIO.ImageSpec()
    as_stored.attribute("oiio:UnassociatedAlpha", 1)
    source = OpenImageIO.ImageInput.open(str(path), as_stored)
    if source is None:
        why = _first_line(_complaint(OpenImageIO))
        raise InputError(f"{path}: is not a picture that can be read ({why}); replace the file")
    spec = source.spec()
    if min(spec.width, spec.height, spec.nchannels) < 1 or spec.deep:
        raise InputError(f"{path}: has no pixels; replace the file")
    return source


def _bits(spec: Any) -> int:
    return {"uint8": 8, "uint16": 16}.get(str(spec.format), 32)


def _channel_names(spec: Any) -> tuple[str, ...]:
    """Names as stored, with "A" for the alpha, also where a two-channel file calls it otherwise."""
    try:
        names = [str(name) for name in spec.channelnames]
    except UnicodeDecodeError:
        names = [f"channel {number}" for number in range(spec.nchannels)]
    if spec.alpha_channel >= 0:
        names[spec.alpha_channel] = "A"
    return tuple(names)


def _upright(pixels: Pixels, spec: Any) -> Pixels:
    """Turn and mirror as the `Orientation` tag (TIFF 6.0, 1992, p. 36) asks: 1 is upright."""
    orientation = spec.get_int_attribute("Orientation", 1)
    if orientation in (5, 6, 7, 8):
        pixels = pixels.transpose(1, 0, 2)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)


def _png_trouble(path: Path) -> str | None:
    """What is wrong with the chunks of a PNG file, before libpng complains on standard error."""
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


def _damaged(path: Path, why: str) -> str:
    return f"{path}: the picture is damaged or cut off ({_first_line(why)}); get the file again"


def _complaint(source: Any) -> str:
    """Fetch, and so clear, what OpenImageIO holds against a file; it may quote the file's bytes."""
    try:
        return str(source.geterror())
    except UnicodeDecodeError:
        return "its header makes no sense"


def _first_line(text: str) -> str:
    return text.strip().splitlines()[0].rstrip(".") if text.strip() else "no reason given"


# --- writing -------------------------------------------------------------------------------------


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
    check_place(Path(path))


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


def _format_for(path: Path) -> _Format:
    kind = _FORMATS.get(path.suffix.lower())
    if kind is None:
        suffix = f"the suffix {path.suffix}" if path.suffix else "a name without suffix"
        raise InputError(f"{path}: {suffix} names no known format; use one of {' '.join(WRITABLE)}")
    return kind


def _checked(path: Path, bits: int | None) -> tuple[_Format, int]:
    """What the suffix's format can hold, and the bits to write."""
    kind = _format_for(path)
    chosen = kind.bits[0] if bits is None else bits
    if chosen not in kind.bits:
        known = " or ".join(str(each) for each in sorted(kind.bits))
        raise InputError(f"{path}: {path.suffix} holds {known} bits a channel, not {bits}")
    return kind, chosen


def encode_light(linear: NDArray[np.floating], bits: int = 8) -> Pixels:
    """Light to integer codes: colours through the sRGB curve, the alpha straight; NaN is black."""
    most = 2**bits - 1
    light = np.clip(np.nan_to_num(linear, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    light[:, :, :3] = srgb_encode(light[:, :, :3])
    codes: Pixels = np.rint(light * most).astype(np.uint8 if bits == 8 else np.uint16)
    return codes


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
        raise OSError(_first_line(_complaint(OpenImageIO)))
    done = target.open(str(path), spec) and target.write_image(np.ascontiguousarray(pixels))
    closed = target.close()
    trouble = _complaint(target) or _complaint(OpenImageIO)
    if not (done and closed):
        raise OSError(_first_line(trouble))


def check_place(path: Path) -> None:
    """Raise InputError where no file of that name can be made."""
    folder = path.parent
    if not os.path.isdir(folder):
        raise InputError(f"{path}: the folder {folder} does not exist; make it first")
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder; name a file")
    if not os.access(folder, os.W_OK):
        raise InputError(f"{path}: the folder {folder} cannot be written; choose another place")


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` make a file beside `path`, then move it there: the old file or the new, whole.

    Raises InputError where the place, or an OSError of `write`, does not let it.
    """
    check_place(path)
    partial = path.parent / f".{path.stem[:40]}-{secrets.token_hex(4)}{path.suffix}"
    try:
        write(partial)
        os.replace(partial, path)
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{path}: cannot be written ({why}); choose another place") from error
    finally:
        partial.unlink(missing_ok=True)
