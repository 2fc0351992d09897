"""What a surface is made of: its maps, checked, in one convention, with the decisions behind them.

Arrays are (height, width, channels), row 0 on top. Normals have green up (OpenGL, glTF); a height
of 1 is the highest; base colour and emission are the only maps that may be encoded in sRGB.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_decode

MAPS = {
    "base_color": 3,
    "normal": 3,
    "height": 1,
    "occlusion": 1,
    "roughness": 1,
    "metallic": 1,
    "emission": 3,
    "opacity": 1,
    "layer_mask": 1,
}
"""The maps of a material, and how many channels each has."""

_MOST = {"uint8": 255, "uint16": 65535}


@dataclass(frozen=True)
class Note:
    """One decision: `what` was done, and `why`."""

    what: str
    why: str

    def __str__(self) -> str:
        return f"{self.what}: {self.why}"


@dataclass(frozen=True, eq=False, repr=False)
class Map:
    """One map: `pixels` (height, width, channels) of uint8, uint16 or float32.

    Integers stand for 0 to 1, the largest for 1. With `srgb` they are sRGB code values of colours.
    `source` says where the map comes from, for people. Raises InputError for any other array, for
    one without pixels, and for floats that are not finite.
    """

    pixels: NDArray[Any]
    srgb: bool
    source: str

    def __post_init__(self) -> None:
        if self.pixels.ndim != 3 or self.pixels.size == 0:
            shape = "×".join(str(each) for each in self.pixels.shape)
            raise InputError(f"{self.source}: a map is (height, width, channels), not {shape}")
        if str(self.pixels.dtype) not in ("uint8", "uint16", "float32"):
            kind = self.pixels.dtype
            raise InputError(f"{self.source}: a map is uint8, uint16 or float32, not {kind}")
        if self.pixels.dtype == np.float32 and not np.isfinite(self.pixels).all():
            bad = int((~np.isfinite(self.pixels)).any(axis=2).sum())
            raise InputError(
                f"{self.source}: {bad} of its texels are NaN or infinite; mend the picture"
            )

    def __repr__(self) -> str:
        return f"<Map {self.source}, {self.width}×{self.height}×{self.channels}, {self.bits} bit>"

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.pixels.shape[0])

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.pixels.shape[1])

    @property
    def channels(self) -> int:
        """Numbers per texel."""
        return int(self.pixels.shape[2])

    @property
    def bits(self) -> int:
        """Bits per number: 8, 16, or 32 for floats."""
        return int(self.pixels.dtype.itemsize * 8)

    @property
    def flat(self) -> bool:
        """Is this a single texel, which fits any other map's proportions?"""
        return self.height == self.width == 1

    def range(self) -> tuple[float, float]:
        """The least and the greatest stored value, integers as 0 to 1."""
        most = _MOST.get(str(self.pixels.dtype), 1)
        return float(self.pixels.min()) / most, float(self.pixels.max()) / most

    def linear(self) -> NDArray[np.float32]:
        """The map as linear float32, (height, width, channels): what the shaders read."""
        most = _MOST.get(str(self.pixels.dtype))
        if most is None:
            values = srgb_decode(self.pixels) if self.srgb else self.pixels
            return values.astype(np.float32)
        codes = np.arange(most + 1, dtype=np.float64) / most
        table = (srgb_decode(codes) if self.srgb else codes).astype(np.float32)
        linear: NDArray[np.float32] = table[self.pixels]
        return linear


@dataclass(frozen=True, eq=False, repr=False)
class Material:
    """A surface as up to nine maps that lie over each other, each stretched over the whole tile.

    `base_color` and `emission` (3 channels, colours), `normal` (3: x, y, z from −1…1 stored as
    0…1, green up), `height` (1: 0…1, 1 the highest), `occlusion`, `roughness`, `metallic`,
    `opacity`, and `layer_mask`, how much there is of a second layer (1: 0…1). A map that is missing
    is None. `depth` is how far the heights reach, from 0 to 1, and `tile` how wide the maps are
    (along u), both in metres. `notes` are the decisions taken on the way. Maps may differ in size,
    not in proportions; single texels fit everywhere.

    Raises InputError, naming the map's source, when a map has the wrong number of channels, when
    heights leave 0…1, when proportions disagree, and when depth or tile is not positive.
    """

    name: str
    base_color: Map | None = None
    normal: Map | None = None
    height: Map | None = None
    occlusion: Map | None = None
    roughness: Map | None = None
    metallic: Map | None = None
    emission: Map | None = None
    opacity: Map | None = None
    layer_mask: Map | None = None
    depth: float | None = None
    tile: float | None = None
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        for kind, each in self.maps():
            if each.channels != MAPS[kind]:
                raise InputError(
                    f"{each.source}: the {kind} map has {each.channels} channels, not {MAPS[kind]}"
                )
        self._check_heights()
        self._check_proportions()
        for what, metres in (("depth", self.depth), ("tile", self.tile)):
            if metres is not None and not (math.isfinite(metres) and metres > 0):
                raise InputError(f"{self.name}: {what} is a length above 0 metres, not {metres}")

    def __repr__(self) -> str:
        kinds = ", ".join(kind for kind, _ in self.maps())
        return f"<Material {self.name}: {kinds or 'no maps'}>"

    def maps(self) -> Iterator[tuple[str, Map]]:
        """The maps that are there, by name."""
        for kind in MAPS:
            each = getattr(self, kind)
            if each is not None:
                yield kind, each

    @property
    def scale(self) -> float | None:
        """The whole height range as a fraction of the tile's width; None unless both are known."""
        if self.depth is None or self.tile is None:
            return None
        return self.depth / self.tile

    @property
    def proportion(self) -> float:
        """Width ÷ height of the maps in texels; 1 where there is none but single texels."""
        shaped = [each for _, each in self.maps() if not each.flat]
        largest = max(shaped, key=lambda each: each.width * each.height, default=None)
        return 1.0 if largest is None else largest.width / largest.height

    @property
    def height_range(self) -> tuple[float, float] | None:
        """The lowest and the highest height in use, within 0 to 1."""
        return None if self.height is None else self.height.range()

    def _check_heights(self) -> None:
        if self.height is None:
            return
        low, high = self.height.range()
        if low < 0 or high > 1:
            raise InputError(
                f"{self.height.source}: heights reach from {low:g} to {high:g}, not within 0 to 1;"
                " stretch them"
            )

    def _check_proportions(self) -> None:
        shaped = [(kind, each) for kind, each in self.maps() if not each.flat]
        for kind, each in shaped[1:]:
            first_kind, first = shaped[0]
            if not _same_proportions(first, each):
                raise InputError(
                    f"{each.source}: the {kind} map, {each.width}×{each.height}, has other"
                    f" proportions than the {first_kind} map, {first.width}×{first.height};"
                    " scale or crop one of them"
                )


def _same_proportions(one: Map, other: Map) -> bool:
    """Could one be the other scaled, each side rounded up or down to whole texels?"""
    difference = abs(one.width * other.height - other.width * one.height)
    return difference <= max(one.width, one.height, other.width, other.height)
