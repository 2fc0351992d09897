"""Transforms of objects, and how far each shape reaches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.scene.checks import FAR, NEAR
from basrelief.shading.kinds import ShapeKind

Transform = NDArray[np.float64]
"""An affine map from object to world space, (4, 4), acting on columns."""


def turned(axis: Literal["x", "y", "z"], degrees: float) -> Transform:
    """A rotation about an axis of the world, counterclockwise seen against the axis."""
    a, b = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    made = np.eye(4)
    made[a, a] = made[b, b] = c
    made[a, b], made[b, a] = -s, s
    return made


def placed(
    position: Sequence[float] = (0.0, 0.0, 0.0), scale: float | Sequence[float] = 1.0
) -> Transform:
    """A scaling, one factor or one for each axis, and then a move."""
    made = np.diag([*np.broadcast_to(scale, 3), 1.0]).astype(np.float64)
    made[:3, 3] = position
    return made


def sound(transform: Transform) -> bool:
    """Whether it is affine, and shaders in 32 bits can go there and back."""
    if transform.shape != (4, 4) or not (np.abs(transform) <= FAR).all():
        return False
    sizes = np.linalg.svd(transform[:3, :3], compute_uv=False)
    return bool(sizes[-1] >= NEAR and (transform[3] == (0.0, 0.0, 0.0, 1.0)).all())


def _round(heights: Sequence[float], radii: Sequence[float]) -> NDArray[np.float64]:
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
OUTLINES: dict[ShapeKind, NDArray[np.float64]] = {
    "plane": _CORNERS * (1.0, 1.0, 0.0),
    "box": _CORNERS,
    "sphere": _round([*np.cos(_FROM_POLE) / 2], [*np.sin(_FROM_POLE) / 2]),
    "cylinder": _round((-0.5, 0.5), (0.5, 0.5)),
}
"""Points of each shape that reach as far as it does."""

LYING = turned("x", -90.0)
"""Lays a plane flat: it faces up, the picture's top away from a camera at azimuth 0."""
