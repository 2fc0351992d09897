"""One ray with the reads of a technique along it, and its true hit."""

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
class Read:
    """One read at texture coordinates `uv`.

    `kind` is "height" (of the surface), "cell" (between four texels, solved as a whole) or "record"
    (of a bake). `ray` and `surface` are the heights of the ray and of the surface there, 0 to 1.
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
    """The ray of one pixel, the reads of a technique along it, and the true hit.

    `Explanation` describes the fields. The true hit is that of the oracle in float64, on the
    bilinear surface, or on columns where the technique draws columns.
    """

    material: str
    technique: str
    settings: Mapping[str, float]
    pixel: tuple[int, int]
    uv: tuple[float, float]
    travel: tuple[float, float]
    reference_height: float
    reads: tuple[Read, ...]
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
        """Length of the travel over the map, in texels."""
        return float(np.linalg.norm(np.array(self.travel) * self.texels))

    @property
    def error(self) -> float:
        """Distance over the map from the true hit to the technique's, in texels."""
        difference = np.array([*self.hit.uv], np.float64) - self.true_uv
        return float(np.linalg.norm(difference * self.texels))

    def along(self, uv: Any) -> Floats:
        """Positions of texture coordinates, (…, 2), along the ray over the map, in texels from its
        intersection with the polygon."""
        moved: Floats = (np.asarray(uv, np.float64) - self.uv) * self.texels
        return moved @ self.direction

    @property
    def direction(self) -> Floats:
        """Unit direction of the travel in texels; along u where there is none."""
        travel: Floats = np.array(self.travel) * self.texels
        length = float(np.linalg.norm(travel))
        return travel / length if length > 1e-9 else np.array([1.0, 0.0])

    def surface(self, uv: Any) -> Floats:
        """Heights of the surface at texture coordinates, (n, 2)."""
        return surface_heights(self.heights, np.asarray(uv, np.float64), self.edge, self.columns)

    @property
    def technique_text(self) -> str:
        """Name and settings of the technique."""
        return ", ".join(
            [self.technique, *(f"{name} {value:g}" for name, value in self.settings.items())]
        )

    @property
    def verdict(self) -> str:
        """Reads and error of the technique, in a few words."""
        reads = int(self.hit.reads)
        count = "1 read" if reads == 1 else f"{reads or 'no'} reads"
        no_hit = "" if self.hit.found else ", nothing found"
        return f"{self.technique}: {count}{no_hit}, {self.error:.2f} texels from the true hit"

    @property
    def summary(self) -> str:
        """Material, pixel, technique and verdict, in one line."""
        x, y = self.pixel
        return f"{self.material}, pixel {x},{y}: {self.verdict} ({self.technique_text})"

    def table(self) -> str:
        """All reads as a table: number, kind, u, v, the heights of ray and surface."""
        lines = [f"{'':>4}  {'read':<6} {'u':>9} {'v':>9} {'ray':>8} {'surface':>8}  the ray is"]
        for n, read in enumerate(self.reads, 1):
            side = "above" if read.above else "below" if read.ray < read.surface else "on it"
            lines.append(
                f"{n:>4}  {read.kind:<6} {read.uv[0]:>9.5f} {read.uv[1]:>9.5f} "
                f"{read.ray:>8.5f} {read.surface:>8.5f}  {side}"
            )
        for name, uv, height in (
            ("ends", [float(c) for c in self.hit.uv], float(self.hit.height)),
            ("true", self.true_uv, self.true_height),
        ):
            lines.append(f"{'':>4}  {name:<6} {uv[0]:>9.5f} {uv[1]:>9.5f} {height:>8.5f}")
        return "\n".join(lines)


def surface_heights(heights: Floats, uv: Floats, edge: Edge, columns: bool) -> Floats:
    """Heights at texture coordinates, (n, 2): bilinear, or those of columns."""
    size = np.array(heights.shape[::-1])
    position = uv * size - (0.0 if columns else 0.5)
    first = np.floor(position).astype(np.int64)

    def read(right: int, down: int) -> Floats:
        x, y = (first + np.array([right, down])).T
        match edge:
            case "wrap":
                x, y = x % size[0], y % size[1]
            case "clamp":
                x, y = np.clip(x, 0, size[0] - 1), np.clip(y, 0, size[1] - 1)
            case _:
                assert_never(edge)
        texels: Floats = heights[y, x]
        return texels

    if columns:
        return read(0, 0)
    x, y = (position - first).T
    upper = read(0, 0) * (1 - x) + read(1, 0) * x
    lower = read(0, 1) * (1 - x) + read(1, 1) * x
    interpolated: Floats = upper * (1 - y) + lower * y
    return interpolated
