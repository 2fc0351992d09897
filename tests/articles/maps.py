"""Maps of noise as a file holds them, and their reading in float64 as a texture unit does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Codes = NDArray[np.uint16]

CODE = 65535
"""The 16-bit code of 1."""


# --- maps of noise --------------------------------------------------------------------------------


def noise(columns: int, rows: int, seed: int, contrast: float = 0.25) -> Codes:
    """Noise on waves that are different along u and v, (rows, columns), as 16-bit codes."""
    random = np.random.default_rng(seed)
    y, x = (np.mgrid[0:rows, 0:columns] + 0.5) / np.array([rows, columns])[:, None, None]
    u_count, v_count, phase = 2 + seed % 3, 1 + seed % 2, 0.7 * seed
    waves = np.sin(2 * np.pi * (u_count * x + 0.3) + phase) * np.cos(2 * np.pi * (v_count * y + x))
    values = 0.5 + 0.36 * waves + contrast * (random.random((rows, columns)) - 0.5)
    return as_codes(values)


def colors(columns: int, rows: int, seed: int) -> Codes:
    """Three channels of noise, (rows, columns, 3)."""
    return np.stack([noise(columns, rows, seed + channel) for channel in range(3)], -1)


def slopes(columns: int, rows: int, seed: int) -> Codes:
    """Two channels: x and y of unit normals up to 55 degrees off the surface's, as codes."""
    values = [noise(columns, rows, seed + axis, 0.2) / CODE for axis in range(2)]
    return as_codes(np.stack([0.5 + 0.6 * (value - 0.5) for value in values], -1))


def normals(columns: int, rows: int, seed: int) -> Codes:
    """Three channels: unit normals as codes of −1 to 1."""
    xy = slopes(columns, rows, seed)
    signed = xy / CODE * 2.0 - 1.0
    z = np.sqrt(1.0 - (signed**2).sum(-1, keepdims=True))
    return np.concatenate([xy, as_codes(z * 0.5 + 0.5)], -1)


def as_codes(values: Floats) -> Codes:
    """Values from 0 to 1 as 16-bit codes."""
    return np.rint(np.clip(values, 0.0, 1.0) * CODE).astype(np.uint16)


def decoded(codes: Codes) -> Floats:
    """Linear light of codes in sRGB (IEC 61966-2-1)."""
    values = codes / CODE
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


# --- reading --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sampler:
    """A map that repeats, with its mip levels: (rows, columns, channels) each."""

    levels: tuple[Floats, ...]

    @property
    def size(self) -> Floats:
        """Columns and rows of the map."""
        rows, columns, _ = self.levels[0].shape
        return np.array([columns, rows], np.float64)

    def at(self, uv: Floats, level: int = 0) -> Floats:
        """The bilinear surface of a level at n texture coordinates, (n, channels)."""
        texels = self.levels[min(level, len(self.levels) - 1)]
        rows, columns, _ = texels.shape
        x, y = (uv * (columns, rows) - 0.5).T
        left, top = np.floor(x).astype(int), np.floor(y).astype(int)
        a, b = (x - left)[:, None], (y - top)[:, None]
        upper, lower = (
            texels[row % rows, left % columns] * (1 - a)
            + texels[row % rows, (left + 1) % columns] * a
            for row in (top, top + 1)
        )
        return upper * (1 - b) + lower * b

    def at_lod(self, uv: Floats, lod: Floats) -> Floats:
        """Between the two levels around each of n levels of detail, (n, channels)."""
        finer = np.floor(lod).astype(int)
        result = np.empty((len(uv), self.levels[0].shape[2]))
        for level in np.unique(finer):
            chosen = finer == level
            weight = (lod[chosen] - level)[:, None]
            result[chosen] = (
                self.at(uv[chosen], level) * (1 - weight) + self.at(uv[chosen], level + 1) * weight
            )
        return result

    def lod(self, gradients: Floats) -> Floats:
        """The level of detail of n pixels whose coordinates change by `gradients`, (2, n, 2), to
        the right and down: log2 of the longer change in texels, at least 0."""
        longer = np.hypot(*np.moveaxis(gradients * self.size, -1, 0)).max(0)
        return np.log2(np.maximum(longer, 1.0))

    def grad(self, uv: Floats, gradients: Floats) -> Floats:
        """Filtered to the pixel: between the levels of its gradients."""
        return self.at_lod(uv, self.lod(gradients))


def sampler(values: Floats) -> Sampler:
    """The map with all its mip levels; (rows, columns) is one channel."""
    levels = [values if values.ndim == 3 else values[:, :, None]]
    while max(levels[-1].shape[:2]) > 1:
        rows, columns, _ = levels[-1].shape
        by_rows = np.tensordot(averages(rows), levels[-1], 1)
        levels.append(np.tensordot(by_rows, averages(columns), (1, 1)).swapaxes(1, 2))
    return Sampler(tuple(levels))


def averages(count: int) -> Floats:
    """The weights, (⌊n ÷ 2⌋, n), of the area average of n texels in half as many."""
    half = max(count // 2, 1)
    edges = np.arange(half + 1) * count / half
    texel = np.arange(count)
    overlap = np.minimum(edges[1:, None], texel + 1) - np.maximum(edges[:-1, None], texel)
    return np.maximum(overlap, 0.0) * half / count
