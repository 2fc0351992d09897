"""Perceptually even colour maps: equal steps of a number look like equal steps of colour.

Each map is a path through OKLab, sampled at equal distances (B. Ottosson, A perceptual color space
for image processing, 2020, with its matrices). Dark means no error in all of them.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
COUNT = 256
"""Colours in a map."""

_HEAT = (
    (0.16, 0.03, 275), (0.32, 0.12, 285), (0.47, 0.17, 330), (0.6, 0.18, 20), (0.73, 0.15, 60),
    (0.86, 0.14, 95), (0.97, 0.06, 110),
)  # fmt: skip
_POSITIVE = ((0.16, 0.0, 50), (0.4, 0.1, 45), (0.62, 0.16, 48), (0.8, 0.14, 70), (0.93, 0.07, 90))
_NEGATIVE = (
    (0.16, 0.0, 260), (0.38, 0.12, 262), (0.6, 0.14, 250), (0.8, 0.1, 225), (0.93, 0.05, 205)
)  # fmt: skip
"""Paths as lightness, chroma and hue in degrees, within what a screen can show."""

PASSED, SHORT = (0.86, 0.30, 0.05), (0.07, 0.32, 0.85)
"""Linear colours of hits that passed and that stopped short, near the ends of `signed`."""


def heat(share: ArrayLike) -> NDArray[np.float32]:
    """Linear colours, (…, 3), of numbers from 0 (dark) to 1 (pale); others are clamped to these."""
    return _lookup(_path(_HEAT), share)


def signed(share: ArrayLike) -> NDArray[np.float32]:
    """Linear colours, (…, 3), of numbers from −1 (pale blue) over 0 (dark) to 1 (pale orange)."""
    whole = np.concatenate([_path(_NEGATIVE)[::-1], _path(_POSITIVE)[1:]])
    return _lookup(whole, (np.asarray(share, np.float64) + 1.0) / 2.0)


def lab_to_linear(lab: ArrayLike) -> Floats:
    """OKLab to linear Rec. 709, (…, 3)."""
    to_cones = np.array(
        [
            [1.0, 0.3963377774, 0.2158037573],
            [1.0, -0.1055613458, -0.0638541728],
            [1.0, -0.0894841775, -1.2914855480],
        ]
    )
    to_light = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    light: Floats = (np.asarray(lab, np.float64) @ to_cones.T) ** 3 @ to_light.T
    return light


@functools.cache
def path_in_lab(stops: Sequence[tuple[float, float, float]]) -> Floats:
    """A path through the stops in OKLab, (COUNT, 3), in steps of equal length."""
    lab_stops = np.array(
        [
            (light, chroma * math.cos(math.radians(hue)), chroma * math.sin(math.radians(hue)))
            for light, chroma, hue in stops
        ]
    )
    fine = np.linspace(0.0, len(stops) - 1.0, 64 * COUNT)
    line = np.stack([np.interp(fine, range(len(stops)), column) for column in lab_stops.T], -1)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    positions = np.linspace(0.0, length[-1], COUNT)
    return np.stack([np.interp(positions, length, column) for column in line.T], -1)


def _path(stops: Sequence[tuple[float, float, float]]) -> Floats:
    return np.clip(lab_to_linear(path_in_lab(tuple(stops))), 0.0, 1.0)


def _lookup(colors: Floats, share: ArrayLike) -> NDArray[np.float32]:
    position = np.nan_to_num(np.asarray(share, np.float64), nan=0.0)
    index = np.rint(np.clip(position, 0.0, 1.0) * (len(colors) - 1)).astype(int)
    looked_up: NDArray[np.float32] = colors[index].astype(np.float32)
    return looked_up
