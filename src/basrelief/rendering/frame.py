"""Rendered frames, whose planes are read from the device when they are used."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Canvas, Engine, PlaneBuffer
from basrelief.images import code_bits, encode_light, encode_png, write_codes, write_picture
from basrelief.lang import Vec4
from basrelief.rendering.codes16 import read_codes16
from basrelief.shading.codes16 import FourLights
from basrelief.timings import step

_T = TypeVar("_T")
_Code = TypeVar("_Code", np.uint8, np.uint16)


@dataclass(frozen=True, eq=False)
class Image:
    """A picture.

    Attributes
    ----------
    pixels : ndarray of float32, shape (height, width, 4)
        Linear Rec. 709 colours and straight alpha, row 0 at the top.
    """

    pixels: NDArray[np.float32]

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the picture atomically, in the format of the suffix.

        Parameters
        ----------
        path : path or str
            File to write. PNG, JPEG and WebP are encoded in sRGB; EXR and HDR are linear.
        bits : int, optional
            Bits per channel; PNG has 8 by default, or 16.
        quality : int, default 95
            Quality of JPEG and WebP, 1 to 100.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            For another suffix, options that the format does not have, and a file that cannot be
            written.
        """
        write_picture(path, self._for_file(Path(path)), bits=bits, quality=quality)
        return Path(path)

    def _for_file(self, path: Path) -> NDArray[np.float32]:
        opaque = bool((self.pixels[:, :, 3] >= 1.0).all())
        return self.pixels[:, :, :3] if opaque else self.pixels

    def _repr_png_(self) -> bytes:
        return encode_png(self._for_file(Path()))


class Frame:
    """A rendered frame: planes of equal size, row 0 at the top.

    All planes but the colour are those of the first sample, at the centre of the pixel. The planes
    of a frame that was drawn stay on the device until they are used for the first time; if the
    device is lost before, that raises DeviceError.

    Attributes
    ----------
    color : ndarray of float32, shape (height, width, 4)
        Linear colour over the background, and coverage.
    codes : ndarray of uint8, shape (height, width, 4)
        The colour in sRGB, 0 to 255, and alpha; of the array `color`, once that has been read.
    distance : ndarray of float32, shape (height, width)
        Distance from the camera along the ray in world units; infinite where nothing is hit.
    uv : ndarray of float32, shape (height, width, 2)
        Displaced texture coordinates.
    hit : ndarray of bool, shape (height, width)
        Whether the pixel shows an object.
    reads : ndarray of int32, shape (height, width)
        Number of heights read.
    size : (int, int)
        Width and height in pixels.
    device : str
        Device that drew the frame, and its adapter.
    """

    _engine: Engine
    _canvas: Canvas
    _prefix: str
    is_opaque = False
    """Whether every pixel is known to be covered."""

    def __init__(
        self,
        color: NDArray[np.float32],
        distance: NDArray[np.float32],
        uv: NDArray[np.float32],
        hit: NDArray[np.bool_],
        reads: NDArray[np.int32],
        device: str,
    ) -> None:
        self.color, self.distance, self.uv, self.hit, self.reads = color, distance, uv, hit, reads
        self.size = (distance.shape[1], distance.shape[0])
        self.device = device

    @classmethod
    def drawn(cls, engine: Engine, canvas: Canvas, prefix: str, *, opaque: bool) -> Frame:
        """The frame whose planes a canvas holds, under their names after a prefix.

        `opaque` says that every pixel is covered."""
        frame = cls.__new__(cls)
        frame._canvas, frame._prefix, frame.is_opaque = canvas, prefix, opaque
        frame._engine = engine
        frame.size, frame.device = canvas.size, f"{engine.name}: {engine.adapter}"
        return frame

    @step("draw")
    def _planes(self, name: str, count: int = 1, *, interleaved: bool = False) -> NDArray[Any]:
        """Planes of scalars from the device; see `Canvas.read`."""
        return self._canvas.read(f"{self._prefix}{name}", count, interleaved=interleaved)

    def on_device(
        self, name: str, record: type[_T], count: int = 1
    ) -> tuple[Engine, PlaneBuffer[_T]] | None:
        """The engine that drew the frame, and planes of its colour or codes as its buffer.

        None for a frame of arrays, and for one whose colour or codes were read, since they may have
        been changed; and for planes that are too large for a buffer.
        """
        if {"color", "_codes"} & vars(self).keys():
            return None
        buffer = self._canvas.buffer(f"{self._prefix}{name}", record, count)
        return None if buffer is None else (self._engine, buffer)

    @functools.cached_property
    def color(self) -> NDArray[np.float32]:
        return self._planes("color.x", 4, interleaved=True)

    @property
    def codes(self) -> NDArray[np.uint8]:
        # a colour that was read may have been changed since
        if "color" not in self.__dict__:
            return self._codes
        with step("encode"):
            return encode_light(self.color)

    @functools.cached_property
    def _codes(self) -> NDArray[np.uint8]:
        words = np.ascontiguousarray(self._planes("codes")[0], "<i4")
        return words.view(np.uint8).reshape(*words.shape, 4)

    @functools.cached_property
    def distance(self) -> NDArray[np.float32]:
        return np.where(self.hit, self._planes("distance")[0], np.float32(np.inf))

    @functools.cached_property
    def uv(self) -> NDArray[np.float32]:
        return self._planes("uv.x", 2, interleaved=True)

    @functools.cached_property
    def hit(self) -> NDArray[np.bool_]:
        hit: NDArray[np.bool_] = self._planes("hit")[0] != 0
        return hit

    @functools.cached_property
    def reads(self) -> NDArray[np.int32]:
        return np.ascontiguousarray(self._planes("reads")[0])

    def __reduce__(self) -> tuple[Any, ...]:
        """All planes, to be pickled: a canvas stays in its process."""
        return Frame, (self.color, self.distance, self.uv, self.hit, self.reads, self.device)

    @property
    def mean_reads(self) -> float:
        """Mean number of heights read at the pixels that show an object."""
        return float(self.reads[self.hit].mean()) if self.hit.any() else 0.0

    @property
    def image(self) -> Image:
        """The colour as an image."""
        return Image(self.color)

    def __repr__(self) -> str:
        return f"<Frame {self.size[0]} × {self.size[1]}, {self.device}>"

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the colour as a picture; see `Image.save`."""
        return self.picture_writer(path, bits)(Path(path), quality)

    def picture_writer(self, path: str | Path, bits: int | None) -> Callable[[Path, int], Path]:
        """A function that writes the present colour to a file, in the format of `path` and with a
        quality, whatever becomes of the frame."""
        depth = code_bits(path, bits)
        if depth is None:
            image = Image(self.color.copy())
            return lambda file, quality: image.save(file, bits=bits, quality=quality)
        codes: Any = _without_alpha(self.codes if depth == 8 else self._codes16())
        return lambda file, quality: write_codes(file, codes, quality=quality)

    def _codes16(self) -> NDArray[np.uint16]:
        """The colour as `codes`, in 16 bits."""
        on_device = self.on_device("color.x", FourLights, 4)
        if on_device is not None:
            return read_codes16(*on_device, self.size)
        with step("encode"):
            return encode_light(self.color, 16)

    def _repr_png_(self) -> bytes:
        return encode_png(_without_alpha(self.codes))


def _without_alpha(codes: NDArray[_Code]) -> NDArray[_Code]:
    """Codes (h, w, 4) for a file: without alpha where all of it is opaque."""
    return codes[:, :, :3] if (codes[:, :, 3] == np.iinfo(codes.dtype).max).all() else codes


def empty_frame(size: tuple[int, int], backdrop: Vec4, device: str) -> Frame:
    """The frame of a scene without objects."""
    shape = (size[1], size[0])
    return Frame(
        np.full((*shape, 4), [*backdrop], np.float32),
        np.full(shape, np.inf, np.float32),
        np.zeros((*shape, 2), np.float32),
        np.zeros(shape, np.bool_),
        np.zeros(shape, np.int32),
        device,
    )
