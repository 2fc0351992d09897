"""Materials: checked maps in one convention, with notes of how they came about.

Arrays are (height, width, channels), row 0 at the top. Normals have green up (OpenGL, glTF). A
height of 1 is the highest. Only base colour and emission may be encoded in sRGB.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import look_up, srgb_decode
from basrelief.material.options import MAPS

_MAX_CODES = {"uint8": 255, "uint16": 65535}


@dataclass(frozen=True)
class Note:
    """One decision taken while loading: `what` was done, and `why`."""

    what: str
    why: str

    def __str__(self) -> str:
        return f"{self.what}: {self.why}"


@dataclass(frozen=True, eq=False, repr=False)
class Map:
    """One map of a material.

    Parameters
    ----------
    pixels : ndarray of uint8, uint16 or float32, shape (height, width, channels)
        Row 0 at the top. Integers represent 0 to 1, the largest code 1.
    srgb : bool
        Whether the values are colours encoded in sRGB; otherwise they are linear.
    source : str
        Where the map comes from, for messages.

    Raises
    ------
    InputError
        For arrays of another shape or type, without pixels, or with values that are not finite.
    """

    pixels: NDArray[Any]
    srgb: bool
    source: str

    def __post_init__(self) -> None:
        if self.pixels.ndim != 3 or self.pixels.size == 0:
            shape = "×".join(str(side) for side in self.pixels.shape)
            raise InputError(f"{self.source}: a map is (height, width, channels), not {shape}")
        if str(self.pixels.dtype) not in ("uint8", "uint16", "float32"):
            kind = self.pixels.dtype
            raise InputError(f"{self.source}: a map is uint8, uint16 or float32, not {kind}")
        if self.pixels.dtype == np.float32 and not np.isfinite(self.pixels).all():
            bad = int((~np.isfinite(self.pixels)).any(axis=2).sum())
            raise InputError(
                f"{self.source}: {bad} of its texels are NaN or infinite; repair the picture"
            )

    def __repr__(self) -> str:
        return f"<Map {self.source}, {self.width}×{self.height}×{self.channels}, {self.bits} bit>"

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self.pixels.shape[0])

    @property
    def width(self) -> int:
        """Number of columns."""
        return int(self.pixels.shape[1])

    @property
    def channels(self) -> int:
        """Number of channels."""
        return int(self.pixels.shape[2])

    @property
    def bits(self) -> int:
        """Bits per channel: 8, 16, or 32 for floats."""
        return int(self.pixels.dtype.itemsize * 8)

    @property
    def flat(self) -> bool:
        """Whether the map is a single texel, which fits maps of any proportions."""
        return self.height == self.width == 1

    def range(self) -> tuple[float, float]:
        """The smallest and the largest stored value, integers as 0 to 1."""
        max_code = _MAX_CODES.get(str(self.pixels.dtype), 1)
        return float(self.pixels.min()) / max_code, float(self.pixels.max()) / max_code

    def linear(self) -> NDArray[np.float32]:
        """The map as linear float32, (height, width, channels), as shaders read it."""
        max_code = _MAX_CODES.get(str(self.pixels.dtype))
        if max_code is None:
            values = srgb_decode(self.pixels) if self.srgb else self.pixels
            return values.astype(np.float32)
        codes = np.arange(max_code + 1, dtype=np.float64) / max_code
        table = (srgb_decode(codes) if self.srgb else codes).astype(np.float32)
        return look_up(table, self.pixels)


@dataclass(frozen=True)
class Origin:
    """Path and options that a material was loaded with, to write a command or a script.

    `path` is that of `load`, "sample:NAME", or None where every map was named; `options` are those
    of `load`, or of `sample`, that differ from the defaults.
    """

    path: str | None
    options: Mapping[str, Any]


@dataclass(frozen=True, eq=False, repr=False)
class Material:
    """A surface described by up to ten maps, each stretched over the whole tile.

    Maps may differ in size but not in proportions; single texels fit any map, and dust is
    stretched. A missing map is None.

    Parameters
    ----------
    name : str
        Name of the material, used in messages and file names.
    base_color, emission : Map, optional
        Colours, 3 channels; emission may exceed 1.
    normal : Map, optional
        Unit normals, 3 channels; x, y, z from −1 to 1 are stored as 0 to 1, with green up.
    height : Map, optional
        Heights, 1 channel, 0 (lowest) to 1 (highest).
    occlusion, roughness, metallic, opacity : Map, optional
        1 channel each, 0 to 1.
    layer_mask : Map, optional
        Weight of a second layer, 1 channel, 0 to 1.
    dust : Map, optional
        Dust on the surface, 1 channel, 0 to 1, by which a hole opens in the heights.
    depth : float, optional
        Full height range in metres, above 0.
    tile : float, optional
        Width of the maps along u in metres, above 0.
    notes : tuple of Note
        Decisions taken while the material was loaded.

    Raises
    ------
    InputError
        For a map with another number of channels, heights outside 0 to 1, maps of different
        proportions, and a depth or tile that is not positive.
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
    dust: Map | None = None
    depth: float | None = None
    tile: float | None = None
    notes: tuple[Note, ...] = ()
    origin: Origin | None = field(default=None, init=False)
    """Its source; None for a material that was made, or changed, in Python."""

    def with_origin(self, path: str | None, options: Mapping[str, Any]) -> Material:
        """Set the origin, and return the material itself."""
        object.__setattr__(self, "origin", Origin(path, options))
        return self

    def __post_init__(self) -> None:
        for kind, map in self.maps():
            wanted = MAPS[kind].channels
            if map.channels != wanted:
                raise InputError(
                    f"{map.source}: the {kind} map has {map.channels} channels, not {wanted}"
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
        """Names and values of the maps that are present."""
        for kind in MAPS:
            map = getattr(self, kind)
            if map is not None:
                yield kind, map

    @property
    def scale(self) -> float | None:
        """Height range as a fraction of the tile's width; None unless both lengths are known."""
        if self.depth is None or self.tile is None:
            return None
        return self.depth / self.tile

    @property
    def proportion(self) -> float:
        """Width ÷ height of the maps in texels; 1 if all are single texels."""
        shaped = [map for _, map in self._shaped_maps()]
        largest = max(shaped, key=lambda map: map.width * map.height, default=None)
        return 1.0 if largest is None else largest.width / largest.height

    @property
    def height_range(self) -> tuple[float, float] | None:
        """The lowest and the highest height, within 0 to 1; None without a height map."""
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

    def _shaped_maps(self) -> Iterator[tuple[str, Map]]:
        """The maps that have the material's proportions; dust is stretched over the heights."""
        return ((kind, map) for kind, map in self.maps() if not map.flat and kind != "dust")

    def _check_proportions(self) -> None:
        shaped = [*self._shaped_maps()]
        for kind, map in shaped[1:]:
            first_kind, first = shaped[0]
            if not _same_proportions(first, map):
                raise InputError(
                    f"{map.source}: the {kind} map, {map.width}×{map.height}, has other"
                    f" proportions than the {first_kind} map, {first.width}×{first.height};"
                    " scale or crop one of them"
                )


def _same_proportions(a: Map, b: Map) -> bool:
    """Whether one map could be the other one scaled, sides rounded to whole texels."""
    difference = abs(a.width * b.height - b.width * a.height)
    return difference <= max(a.width, a.height, b.width, b.height)
