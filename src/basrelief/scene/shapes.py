"""Properties of each shape in object space; its shader is in `shading.shapes`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from basrelief.settings.kinds import ShapeKind


@dataclass(frozen=True)
class ShapeFacts:
    """Properties of a shape.

    Attributes
    ----------
    bounding_points : ndarray of float64, shape (n, 3)
        Points whose convex hull encloses the shape.
    contains : callable
        Whether a point (x, y, z) lies inside the shape.
    tiles : (float, float)
        Default tiles along u and v, which leave square tiles about square.
    flat : bool
        Whether the shape has no inside but a back, and lies on the ground by default.
    round : bool
        Whether u runs around the y axis.
    """

    bounding_points: NDArray[np.float64]
    contains: Callable[[float, float, float], bool]
    tiles: tuple[float, float] = (1.0, 1.0)
    flat: bool = False
    round: bool = False

    @property
    def width(self) -> float:
        """Length of u from 0 to 1: a side, or the circumference."""
        return math.pi if self.round else 1.0


def _circles(heights: Sequence[float], radii: Sequence[float]) -> NDArray[np.float64]:
    """Points on circles around the y axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    return np.concatenate(
        [
            np.stack([r * np.sin(angle), np.full(24, y), r * np.cos(angle)], 1)
            for y, r in zip(heights, radii, strict=True)
        ]
    )


_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FROM_POLE = np.linspace(0.0, np.pi, 13)
SHAPES: dict[ShapeKind, ShapeFacts] = {
    "plane": ShapeFacts(
        _CORNERS * (1.0, 1.0, 0.0), lambda x, y, z: max(abs(x), abs(y)) <= 0.5, flat=True
    ),
    "box": ShapeFacts(_CORNERS, lambda x, y, z: max(abs(x), abs(y), abs(z)) <= 0.5),
    "sphere": ShapeFacts(
        _circles([*np.cos(_FROM_POLE) / 2], [*np.sin(_FROM_POLE) / 2]),
        lambda x, y, z: math.hypot(x, y, z) <= 0.5,
        tiles=(4.0, 2.0),
        round=True,
    ),
    "cylinder": ShapeFacts(
        _circles((-0.5, 0.5), (0.5, 0.5)),
        lambda x, y, z: math.hypot(x, z) <= 0.5 and abs(y) <= 0.5,
        tiles=(3.0, 1.0),
        round=True,
    ),
}
