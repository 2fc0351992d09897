"""Rendered frames, and the compositing of objects in them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Planes
from basrelief.images import encode_png, write_picture
from basrelief.shading.pixel import SOLID


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


@dataclass(frozen=True, eq=False, repr=False)
class Frame:
    """A rendered frame: planes of equal size, row 0 at the top.

    All planes but the colour are those of the first sample, at the centre of the pixel.

    Attributes
    ----------
    color : ndarray of float32, shape (height, width, 4)
        Linear colour over the background, and coverage.
    distance : ndarray of float32, shape (height, width)
        Distance from the camera along the ray in world units; infinite where nothing is hit.
    uv : ndarray of float32, shape (height, width, 2)
        Displaced texture coordinates.
    hit : ndarray of bool, shape (height, width)
        Whether the pixel shows an object.
    reads : ndarray of int32, shape (height, width)
        Number of heights read.
    device : str
        Device that drew the frame, and its adapter.
    """

    color: NDArray[np.float32]
    distance: NDArray[np.float32]
    uv: NDArray[np.float32]
    hit: NDArray[np.bool_]
    reads: NDArray[np.int32]
    device: str

    def rows(self, first: int, last: int) -> Frame:
        """Rows first … last − 1 of the frame, as views."""
        selection = slice(first, last)
        return Frame(
            self.color[selection],
            self.distance[selection],
            self.uv[selection],
            self.hit[selection],
            self.reads[selection],
            self.device,
        )

    def take(self, other: Frame) -> None:
        """Copy the planes of another frame of the same size into this one."""
        for name in ("color", "distance", "uv", "hit", "reads"):
            np.copyto(getattr(self, name), getattr(other, name))

    @property
    def mean_reads(self) -> float:
        """Mean number of heights read at the pixels that show an object."""
        return float(self.reads[self.hit].mean()) if self.hit.any() else 0.0

    @property
    def image(self) -> Image:
        """The colour as an image."""
        return Image(self.color)

    def __repr__(self) -> str:
        height, width = self.distance.shape
        return f"<Frame {width} × {height}, {self.device}>"

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the colour as a picture; see `Image.save`."""
        return self.image.save(path, bits=bits, quality=quality)

    def _repr_png_(self) -> bytes:
        return self.image._repr_png_()


def composite(frame: Frame, planes: Planes) -> None:
    """Composite an object's planes over a frame, where they are nearer.

    Coverage below `SOLID` leaves the distance unchanged, and so hides nothing that follows.
    """
    np.add(frame.reads, planes["reads"], out=frame.reads)
    is_nearer = (planes["hit"] != 0) & (planes["distance"] < frame.distance)
    coverage = np.where(is_nearer, planes["color.w"], np.float32(0.0))
    transmittance = np.float32(1.0) - coverage
    for channel, name in enumerate(("color.x", "color.y", "color.z")):
        plane = frame.color[:, :, channel]
        np.multiply(plane, transmittance, out=plane)
        plane += planes[name] * coverage
    alpha = frame.color[:, :, 3]
    np.multiply(alpha, transmittance, out=alpha)
    alpha += coverage
    is_solid = coverage >= SOLID
    np.copyto(frame.distance, planes["distance"], where=is_solid)
    np.copyto(frame.uv[:, :, 0], planes["uv.x"], where=is_solid)
    np.copyto(frame.uv[:, :, 1], planes["uv.y"], where=is_solid)
    np.logical_or(frame.hit, is_solid, out=frame.hit)
