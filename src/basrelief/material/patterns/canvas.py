"""The periodic canvas that patterns are drawn on, with periodic noise.

x runs from 0 to 1 across the picture, y downwards in the same unit, so a picture twice as high as
wide has y from 0 to 2. Everything repeats at the edges. Each sequence of random numbers has its own
name and does not depend on the size: a larger picture shows the same pattern in finer detail.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Plane = NDArray[np.float32]
"""One number per texel, (height, width)."""

Color = tuple[float, float, float]
"""Red, green, blue as sRGB code values, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Relief:
    """A drawn pattern, from which the maps of a material are derived. Planes are (height, width).

    `height` has any range; `color` (height, width, 3) is sRGB, 0 to 1; `roughness`, `metallic` and
    `opacity` are 0 to 1. `depth` and `tile`, in metres, are the full height range and the width.
    `detail` marks a detail map, of which only colour and normals are used.
    """

    height: Plane
    color: NDArray[np.float32]
    roughness: Plane
    depth: float
    tile: float
    metallic: Plane | None = None
    opacity: Plane | None = None
    detail: bool = False


@dataclass(frozen=True, eq=False)
class Window:
    """The texels around a point, each of them once.

    `texels` indexes a plane; `x` (1, w) and `y` (h, 1) are the offsets of the texels from the
    point, in widths of the picture.
    """

    texels: tuple[NDArray[np.intp], ...]
    x: Plane
    y: Plane

    def to_segment(self, x: float, y: float) -> Plane:
        """The distance from the segment between the point and the point at offset (x, y)."""
        square = max(x * x + y * y, 1e-12)
        along = np.clip(
            (self.x * np.float32(x) + self.y * np.float32(y)) / np.float32(square), 0, 1
        )
        distance: Plane = np.hypot(self.x - along * np.float32(x), self.y - along * np.float32(y))
        return distance

    def to_box(self, x: float, y: float) -> Plane:
        """The signed distance from a box around the point with half sides x and y."""
        out_x, out_y = np.abs(self.x) - np.float32(x), np.abs(self.y) - np.float32(y)
        outside = np.hypot(np.maximum(out_x, 0), np.maximum(out_y, 0))
        distance: Plane = outside + np.minimum(np.maximum(out_x, out_y), 0)
        return distance


@dataclass(frozen=True)
class Canvas:
    """A periodic picture of `height` × `width` texels with a random `seed`."""

    height: int
    width: int
    seed: int

    @cached_property
    def x(self) -> Plane:
        """Texel centres, (1, width), 0 to 1."""
        return self._centres(self.width)[None, :]

    @cached_property
    def y(self) -> Plane:
        """Texel centres, (height, 1), 0 to height/width."""
        return self._centres(self.height)[:, None]

    def _centres(self, count: int) -> Plane:
        return ((np.arange(count) + 0.5) / self.width).astype(np.float32)

    def rows(self, columns: int, *, even: bool = False) -> int:
        """Number of rows of about square cells for `columns` cells across."""
        step = 2 if even else 1
        return max(step, step * round(columns * self.height / self.width / step))

    @property
    def aspect(self) -> float:
        """Height ÷ width, the largest y."""
        return self.height / self.width

    def around(self, x: float, y: float, reach: float, reach_y: float | None = None) -> Window:
        """The texels within `reach` of the point (x, y) along x and y, across the edges too."""
        reach_y = reach if reach_y is None else reach_y
        columns = _near(x * self.width, reach * self.width, self.width)
        rows = _near(y * self.width, reach_y * self.width, self.height)
        return Window(
            np.ix_(rows % self.height, columns % self.width),
            ((columns + 0.5) / self.width - x).astype(np.float32)[None, :],
            ((rows + 0.5) / self.width - y).astype(np.float32)[:, None],
        )

    def softness(self, width: float) -> float:
        """Width of a soft edge, at least a texel to avoid aliasing."""
        return max(width, 1 / self.width)

    def random(self, name: str) -> np.random.Generator:
        """An independent random generator for each name."""
        return np.random.default_rng([self.seed, zlib.crc32(name.encode())])

    def noise(self, name: str, cells: int, *, octaves: int = 1, gain: float = 0.5) -> Plane:
        """Smooth periodic noise, mean 0 and standard deviation about 1.

        A cubic B-spline through random values on a lattice of `cells` across; each further octave
        has twice the cells and `gain` times the weight. Octaves finer than two texels are
        omitted, so that a small picture is a smooth version of a large one.
        """
        total = np.zeros((self.height, self.width), np.float64)
        for octave in range(octaves):
            across = cells << octave
            if octave and across > self.width // 2:
                break
            down = self.rows(across)
            lattice = self.random(f"{name} {octave}").uniform(-1, 1, (down, across))
            vertical = _spline(self.height, down)
            total += gain**octave * (vertical @ lattice @ _spline(self.width, across).T)
        weight = sum(gain ** (2 * octave) for octave in range(octaves))
        unit: Plane = (total * (_TO_UNIT_DEVIATION / weight**0.5)).astype(np.float32)
        return unit


def _near(middle: float, reach: float, count: int) -> NDArray[np.intp]:
    """Texels within reach of a position on a periodic line of `count`, each of them once."""
    if 2 * reach + 2 >= count:
        return int(np.floor(middle - count / 2)) + np.arange(count)
    return np.arange(int(np.floor(middle - reach)), int(np.floor(middle + reach)) + 2)


_TO_UNIT_DEVIATION = 3**0.5 / 0.4794
"""Uniform −1…1 deviates by 1/√3; a cubic B-spline keeps 151/315 of the variance per axis."""


def _spline(texels: int, cells: int) -> NDArray[np.float64]:
    """Weights (texels, cells) of a periodic uniform cubic B-spline at the texel centres."""
    at = (np.arange(texels) + 0.5) / texels * cells
    cell = np.floor(at).astype(int)
    t = at - cell
    pieces = ((1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3)
    weights = np.zeros((texels, cells))
    for offset, piece in zip((-1, 0, 1, 2), pieces, strict=True):
        np.add.at(weights, (np.arange(texels), (cell + offset) % cells), piece / 6)
    return weights


def to_unit(values: NDArray[Any]) -> NDArray[np.float64]:
    """Values stretched to 0…1; all ½ if they are equal."""
    values = values.astype(np.float64)
    low, high = values.min(), values.max()
    return (values - low) / (high - low) if high > low else np.full_like(values, 0.5)


def smoothstep(low: float, high: float, values: Any) -> Plane:
    """0 below `low`, 1 above `high`, and a smooth cubic between."""
    t = np.clip((values - np.float32(low)) / np.float32(high - low), 0, 1)
    curve: Plane = (t * t * (3 - 2 * t)).astype(np.float32)
    return curve


def mix(a: Any, b: Any, t: Any) -> NDArray[np.float32]:
    """Linear interpolation from `a` at `t` = 0 to `b` at 1: numbers, planes or colours.

    A colour is three numbers, or three for each texel.
    """
    a, b, t = (np.asarray(value, np.float32) for value in (a, b, t))
    if t.ndim == 2 and {a.ndim, b.ndim} & {1, 3}:
        t = t[:, :, None]
    mixed: NDArray[np.float32] = a + (b - a) * t
    return mixed


def shade(color: NDArray[np.float32], factor: Any) -> NDArray[np.float32]:
    """Colours multiplied by a plane of factors."""
    shaded: NDArray[np.float32] = color * np.asarray(factor, np.float32)[:, :, None]
    return shaded
