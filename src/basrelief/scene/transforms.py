"""Transforms of objects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.scene.checks import FAR, NEAR

Transform = NDArray[np.float64]
"""An affine map from object to world space, (4, 4), acting on columns."""


def rotated(axis: Literal["x", "y", "z"], degrees: float) -> Transform:
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


LYING = rotated("x", -90.0)
"""Lays a plane flat: it faces up, the picture's top away from a camera at azimuth 0."""
