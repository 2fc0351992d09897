"""What was drawn, pixel by pixel, and how objects are laid over one another in it."""

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
    """A picture: `pixels` (height, width, 4) float32, linear Rec. 709, alpha last."""

    pixels: NDArray[np.float32]

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the picture, whole or not at all; the suffix says the format.

        PNG (8 bits a channel, or 16), JPEG and WebP in sRGB; EXR and HDR linear. Raises InputError
        for another suffix or a folder that cannot be written. Returns the path.
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
    """What was drawn, pixel by pixel; arrays are (height, width, …), row 0 at the top.

    `color` (…, 4) float32 is linear with coverage, over the background; `distance` float32 is that
    from the camera along the ray in world units, infinite where nothing is hit; `uv` (…, 2) float32
    are the displaced texture coordinates; `hit` bool; `reads` int32 is the number of heights read.
    All but the colour are those of the first sample, in the middle of the pixel. `device` says on
    what.
    """

    color: NDArray[np.float32]
    distance: NDArray[np.float32]
    uv: NDArray[np.float32]
    hit: NDArray[np.bool_]
    reads: NDArray[np.int32]
    device: str

    def rows(self, first: int, last: int) -> Frame:
        """The same frame's rows first … last − 1, as views."""
        some = slice(first, last)
        return Frame(
            self.color[some],
            self.distance[some],
            self.uv[some],
            self.hit[some],
            self.reads[some],
            self.device,
        )

    def take(self, other: Frame) -> None:
        """Copy what another frame of the same size holds into this one."""
        for name in ("color", "distance", "uv", "hit", "reads"):
            np.copyto(getattr(self, name), getattr(other, name))

    @property
    def mean_reads(self) -> float:
        """The mean number of heights read at the pixels that are covered."""
        return float(self.reads[self.hit].mean()) if self.hit.any() else 0.0

    @property
    def image(self) -> Image:
        """The picture."""
        return Image(self.color)

    def __repr__(self) -> str:
        height, width = self.distance.shape
        return f"<Frame {width} × {height}, {self.device}>"

    def save(self, path: str | Path, *, bits: int | None = None, quality: int = 95) -> Path:
        """Write the picture; see `Image.save`."""
        return self.image.save(path, bits=bits, quality=quality)

    def _repr_png_(self) -> bytes:
        return self.image._repr_png_()


def composite(frame: Frame, planes: Planes) -> None:
    """Put an object's planes where they are nearer than what is there.

    What is mostly see-through leaves the depth as it is, and so hides nothing that comes later.
    """
    np.add(frame.reads, planes["reads"], out=frame.reads)
    nearer = (planes["hit"] != 0) & (planes["distance"] < frame.distance)
    coverage = np.where(nearer, planes["color.w"], np.float32(0.0))
    rest = np.float32(1.0) - coverage
    for channel, name in enumerate(("color.x", "color.y", "color.z")):
        plane = frame.color[:, :, channel]
        np.multiply(plane, rest, out=plane)
        plane += planes[name] * coverage
    alpha = frame.color[:, :, 3]
    np.multiply(alpha, rest, out=alpha)
    alpha += coverage
    solid = coverage >= SOLID
    np.copyto(frame.distance, planes["distance"], where=solid)
    np.copyto(frame.uv[:, :, 0], planes["uv.x"], where=solid)
    np.copyto(frame.uv[:, :, 1], planes["uv.y"], where=solid)
    np.logical_or(frame.hit, solid, out=frame.hit)
