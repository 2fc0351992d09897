"""Normals → heights."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.normal import Normals, normal_map
from basrelief.baking.texels import Heights, checked_edge
from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.lang.resources import Edge

STEEPEST = 50.0
"""The steepest slope that is taken from a normal: 8 bits hold none beyond it that is not noise."""
_SMOOTH = 1e-4
"""How much less a wave is wanted that central differences hardly see, the checker above all."""


@dataclass(frozen=True, eq=False)
class Integrated:
    """Heights (h, w), 0 to 1, the scale that goes with them, and how well they fit.

    `residual` is the root of the mean square angle, in degrees, between the normals that were given
    and `normal_map(heights, edge, scale)`.
    """

    heights: Heights
    scale: float
    residual: float


def height_map(normals: Normals, edge: Edge, device: str | Engine = "cpu") -> Integrated:
    """The heights whose `normal_map` comes closest to normals (h, w, 3): x right, y up, z out.

    Least squares of the slopes, by FFT: on the torus for the edge "wrap", on the map with its
    mirror images for "clamp". What no height map has, a swirl, and on a torus a lean of the whole
    map, is left out and stands in the residual. The heights fill 0 to 1; `scale` is their range
    as a fraction of the map's width. Slopes are held to 50. The normals that the
    residual compares are computed on `device`, as in `render`. After R. T. Frankot and R.
    Chellappa, A Method for Enforcing Integrability in Shape from Shading Algorithms, 1988, with
    central differences in place of derivatives.
    Raises InputError for other arrays and edges.
    """
    normals = np.asarray(normals, np.float32)
    if normals.ndim != 3 or normals.shape[2] != 3 or normals.size == 0:
        raise InputError(f"normals are an array of (rows, columns, 3), not {normals.shape}")
    if not np.isfinite(normals).all():
        raise InputError("some normals are NaN or infinite; mend the map")
    checked_edge(edge)
    rows, columns = normals.shape[:2]
    raised = _integrated(*_slopes(normals), edge)
    low, high = float(raised.min()), float(raised.max())
    reach = high - low
    shares = (raised - low) / reach if reach > 0.0 else np.zeros((rows, columns))
    heights: Heights = np.clip(shares, 0.0, 1.0).astype(np.float32)
    scale = reach / columns
    return Integrated(heights, scale, _residual(normals, normal_map(heights, edge, scale, device)))


def _slopes(normals: Normals) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The rise from texel to texel to the right and downwards, in widths of a texel."""
    x, y, z = (normals[:, :, k].astype(np.float64) for k in range(3))
    upright = np.maximum(z, np.hypot(x, y) / STEEPEST)
    upright[upright <= 0.0] = 1.0  # no normal at all, or one straight down
    return -x / upright, y / upright


def _integrated(
    right: NDArray[np.float64], down: NDArray[np.float64], edge: Edge
) -> NDArray[np.float64]:
    rows, columns = right.shape
    match edge:
        case "wrap":
            pass
        case "clamp":
            # the heights are mirrored: the slope across the mirror turns round
            right, down = _mirrored(right, 1, -1.0), _mirrored(down, 1, 1.0)
            right, down = _mirrored(right, 0, 1.0), _mirrored(down, 0, -1.0)
        case _:
            assert_never(edge)
    wave_v = 2.0 * math.pi * np.fft.fftfreq(right.shape[0])[:, None]
    wave_u = 2.0 * math.pi * np.fft.rfftfreq(right.shape[1])[None, :]
    # what a central difference makes of a wave
    seen_u, seen_v = np.sin(wave_u), np.sin(wave_v)
    weight = seen_u**2 + seen_v**2 + _SMOOTH * (np.sin(wave_u / 2) ** 2 + np.sin(wave_v / 2) ** 2)
    weight[0, 0] = 1.0
    found = -1j * (seen_u * np.fft.rfft2(right) + seen_v * np.fft.rfft2(down)) / weight
    found[0, 0] = 0.0
    return np.fft.irfft2(found, right.shape)[:rows, :columns]


def _mirrored(values: NDArray[np.float64], axis: int, sign: float) -> NDArray[np.float64]:
    return np.concatenate([values, sign * np.flip(values, axis)], axis)


def _residual(given: Normals, made: Normals) -> float:
    length = np.linalg.norm(given, axis=2)
    apart = np.linalg.norm(given / np.maximum(length, 1e-9)[:, :, None] - made, axis=2)
    # the angle from the chord: exact where it is small
    angles = 2.0 * np.arcsin(np.clip(apart / 2.0, 0.0, 1.0))
    return float(np.degrees(np.sqrt(np.mean(np.square(angles, dtype=np.float64)))))
