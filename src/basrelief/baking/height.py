"""Bake: normals → heights."""

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
"""Slopes of normals are clamped to this; steeper ones in 8-bit maps are noise."""
_REGULARIZATION = 1e-4
"""Weight of a penalty on waves that central differences hardly see, the checkerboard above all."""


@dataclass(frozen=True, eq=False)
class Integrated:
    """Heights that were integrated from normals.

    Attributes
    ----------
    heights
        (h, w) float32, 0 to 1.
    scale
        The height range as a fraction of the map's width.
    residual
        Root mean square angle, in degrees, between the input normals and
        `normal_map(heights, edge, scale)`.
    """

    heights: Heights
    scale: float
    residual: float


def height_map(normals: Normals, edge: Edge, device: str | Engine = "cpu") -> Integrated:
    """Integrate normals to the heights whose `normal_map` is closest to them.

    Least squares of the slopes by FFT: periodic for the edge "wrap", mirrored for "clamp". Parts of
    the slopes that no height map has, such as a swirl or, for "wrap", a mean slope, are dropped and
    show in the residual. Slopes are clamped to 50.

    Parameters
    ----------
    normals
        (h, w, 3): x right, y up in the picture, z out of it.
    edge
        "wrap" or "clamp".
    device
        Where the normals for the residual are computed; as in `render`.

    Returns
    -------
    Integrated
        Heights that fill 0 to 1, their scale and the residual.

    Raises
    ------
    InputError
        For other arrays and edges.

    References
    ----------
    R. T. Frankot and R. Chellappa, A Method for Enforcing Integrability in Shape from Shading
    Algorithms, 1988; here with central differences in place of derivatives.
    """
    normals = np.asarray(normals, np.float32)
    if normals.ndim != 3 or normals.shape[2] != 3 or normals.size == 0:
        raise InputError(f"normals must be an array of (rows, columns, 3), not {normals.shape}")
    if not np.isfinite(normals).all():
        raise InputError("some normals are NaN or infinite; repair the map")
    checked_edge(edge)
    rows, columns = normals.shape[:2]
    integrated = _integrate(*_slopes(normals), edge)
    low, high = float(integrated.min()), float(integrated.max())
    height_range = high - low
    normalized = (
        (integrated - low) / height_range if height_range > 0.0 else np.zeros((rows, columns))
    )
    heights: Heights = np.clip(normalized, 0.0, 1.0).astype(np.float32)
    scale = height_range / columns
    return Integrated(heights, scale, _residual(normals, normal_map(heights, edge, scale, device)))


def _slopes(normals: Normals) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Slopes to the right and downwards: the rise from texel to texel, in texel widths."""
    x, y, z = (normals[:, :, k].astype(np.float64) for k in range(3))
    clamped_z = np.maximum(z, np.hypot(x, y) / STEEPEST)
    clamped_z[clamped_z <= 0.0] = 1.0  # a zero normal, or one that points straight down
    return -x / clamped_z, y / clamped_z


def _integrate(
    right: NDArray[np.float64], down: NDArray[np.float64], edge: Edge
) -> NDArray[np.float64]:
    rows, columns = right.shape
    match edge:
        case "wrap":
            pass
        case "clamp":
            # mirrored heights: the slope across the mirror axis changes sign
            right, down = _mirror(right, 1, -1.0), _mirror(down, 1, 1.0)
            right, down = _mirror(right, 0, 1.0), _mirror(down, 0, -1.0)
        case _:
            assert_never(edge)
    wave_v = 2.0 * math.pi * np.fft.fftfreq(right.shape[0])[:, None]
    wave_u = 2.0 * math.pi * np.fft.rfftfreq(right.shape[1])[None, :]
    # the factor by which a central difference multiplies each wave
    response_u, response_v = np.sin(wave_u), np.sin(wave_v)
    weight = (
        response_u**2
        + response_v**2
        + _REGULARIZATION * (np.sin(wave_u / 2) ** 2 + np.sin(wave_v / 2) ** 2)
    )
    weight[0, 0] = 1.0
    spectrum = -1j * (response_u * np.fft.rfft2(right) + response_v * np.fft.rfft2(down)) / weight
    spectrum[0, 0] = 0.0
    return np.fft.irfft2(spectrum, right.shape)[:rows, :columns]


def _mirror(values: NDArray[np.float64], axis: int, sign: float) -> NDArray[np.float64]:
    return np.concatenate([values, sign * np.flip(values, axis)], axis)


def _residual(normals: Normals, baked: Normals) -> float:
    length = np.linalg.norm(normals, axis=2)
    chord = np.linalg.norm(normals / np.maximum(length, 1e-9)[:, :, None] - baked, axis=2)
    # the angle from the chord: exact where it is small
    angles = 2.0 * np.arcsin(np.clip(chord / 2.0, 0.0, 1.0))
    return float(np.degrees(np.sqrt(np.mean(np.square(angles, dtype=np.float64)))))
