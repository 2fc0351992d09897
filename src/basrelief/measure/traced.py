"""One ray with every read of its technique, and where it should have ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, assert_never

import numpy as np
from numpy.typing import NDArray

from basrelief.lang.resources import Edge
from basrelief.techniques.ray import Hit

Floats = NDArray[np.float64]
Kind = Literal["height", "cell", "record"]


@dataclass(frozen=True)
class Sample:
    """One read. `kind` says of what: a "height" of the surface, a "cell" between four texels that
    was solved as a whole, or a "record" of what is baked.

    `uv` is where, `ray` the ray's height there, `surface` the surface's, both 0 to 1.
    """

    kind: Kind
    uv: tuple[float, float]
    ray: float
    surface: float

    @property
    def above(self) -> bool:
        """Whether the ray is above the surface here."""
        return self.ray > self.surface


@dataclass(frozen=True, eq=False)
class TracedRay:
    """The ray of one pixel, what a technique read along it, and where it should have ended.

    `uv` is where the ray meets the polygon, at height `reference_height`; while it falls from
    height 1 to 0 it moves by `travel`, in texture coordinates. `hit` is the technique's own;
    `true_uv` and `true_height` are those of the first hit in float64, on the bilinear surface, or
    on columns where the technique draws columns. `heights` is the map, (height, width) float64.
    """

    material: str
    technique: str
    settings: Mapping[str, float]
    pixel: tuple[int, int]
    uv: tuple[float, float]
    travel: tuple[float, float]
    reference_height: float
    samples: tuple[Sample, ...]
    hit: Hit
    true_uv: tuple[float, float]
    true_height: float
    heights: Floats = field(repr=False)
    edge: Edge
    columns: bool

    @property
    def texels(self) -> Floats:
        """The width and the height of the map in texels."""
        return np.array(self.heights.shape[::-1], np.float64)

    @property
    def length(self) -> float:
        """How far the ray moves over the map while it falls from height 1 to 0, in texels."""
        return float(np.linalg.norm(np.array(self.travel) * self.texels))

    @property
    def error(self) -> float:
        """How far from the true hit the technique ended, over the map, in texels."""
        apart = np.array([*self.hit.uv], np.float64) - self.true_uv
        return float(np.linalg.norm(apart * self.texels))

    def along(self, uv: Any) -> Floats:
        """How far texture coordinates, (…, 2), lie along the ray's way over the map, in texels from
        where it meets the polygon."""
        moved: Floats = (np.asarray(uv, np.float64) - self.uv) * self.texels
        return moved @ self.direction

    @property
    def direction(self) -> Floats:
        """The ray's way over the map in texels, of length 1; along u where there is none."""
        way: Floats = np.array(self.travel) * self.texels
        length = float(np.linalg.norm(way))
        return way / length if length > 1e-9 else np.array([1.0, 0.0])

    def surface(self, uv: Any) -> Floats:
        """The surface's heights at texture coordinates, (n, 2)."""
        return surface_heights(self.heights, np.asarray(uv, np.float64), self.edge, self.columns)

    @property
    def told(self) -> str:
        """The technique with its settings."""
        return ", ".join(
            [self.technique, *(f"{name} {value:g}" for name, value in self.settings.items())]
        )

    @property
    def verdict(self) -> str:
        """How it went, in a few words."""
        reads = int(self.hit.reads)
        often = "1 read" if reads == 1 else f"{reads or 'no'} reads"
        met = "" if self.hit.found else ", nothing found"
        return f"{self.technique}: {often}{met}, {self.error:.2f} texels from the true hit"

    @property
    def summary(self) -> str:
        """The same with what was explained, in one line."""
        x, y = self.pixel
        return f"{self.material}, pixel {x},{y}: {self.verdict} ({self.told})"

    def table(self) -> str:
        """All reads as a table: number, of what, u, v, the ray's and the surface's height."""
        lines = [f"{'':>4}  {'read':<6} {'u':>9} {'v':>9} {'ray':>8} {'surface':>8}  the ray is"]
        for n, one in enumerate(self.samples, 1):
            where = "above" if one.above else "below" if one.ray < one.surface else "on it"
            lines.append(
                f"{n:>4}  {one.kind:<6} {one.uv[0]:>9.5f} {one.uv[1]:>9.5f} "
                f"{one.ray:>8.5f} {one.surface:>8.5f}  {where}"
            )
        for name, uv, height in (
            ("ends", [float(c) for c in self.hit.uv], float(self.hit.height)),
            ("true", self.true_uv, self.true_height),
        ):
            lines.append(f"{'':>4}  {name:<6} {uv[0]:>9.5f} {uv[1]:>9.5f} {height:>8.5f}")
        return "\n".join(lines)


def surface_heights(heights: Floats, uv: Floats, edge: Edge, columns: bool) -> Floats:
    """Heights at texture coordinates (n, 2): bilinear, or the texels' own."""
    size = np.array(heights.shape[::-1])
    place = uv * size - (0.0 if columns else 0.5)
    first = np.floor(place).astype(np.int64)

    def read(right: int, down: int) -> Floats:
        x, y = (first + np.array([right, down])).T
        match edge:
            case "wrap":
                x, y = x % size[0], y % size[1]
            case "clamp":
                x, y = np.clip(x, 0, size[0] - 1), np.clip(y, 0, size[1] - 1)
            case _:
                assert_never(edge)
        found: Floats = heights[y, x]
        return found

    if columns:
        return read(0, 0)
    x, y = (place - first).T
    upper = read(0, 0) * (1 - x) + read(1, 0) * x
    lower = read(0, 1) * (1 - x) + read(1, 1) * x
    mixed: Floats = upper * (1 - y) + lower * y
    return mixed
