"""Affine transforms of objects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.scene.checks import FAR, NEAR

Transform = NDArray[np.float64]
"""An affine transform from object to world space, (4, 4), for column vectors."""
Axis = Literal["x", "y", "z"]
"""An axis of the world."""


def rotated(axis: Axis, degrees: float) -> Transform:
    """Rotation about a world axis.

    Parameters
    ----------
    axis : {"x", "y", "z"}
        Axis of the rotation.
    degrees : float
        Angle in degrees, counterclockwise for a viewer towards whom the axis points.

    Returns
    -------
    ndarray of float64, shape (4, 4)
        Transform from object to world space.
    """
    a, b = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    matrix = np.eye(4)
    matrix[a, a] = matrix[b, b] = c
    matrix[a, b], matrix[b, a] = -s, s
    return matrix


def placed(
    position: Sequence[float] = (0.0, 0.0, 0.0), scale: float | Sequence[float] = 1.0
) -> Transform:
    """Scaling followed by a translation.

    Parameters
    ----------
    position : (float, float, float), default (0, 0, 0)
        Translation in world units.
    scale : float or (float, float, float), default 1.0
        One factor, or one per axis.

    Returns
    -------
    ndarray of float64, shape (4, 4)
        Transform from object to world space.
    """
    matrix = np.diag([*np.broadcast_to(scale, 3), 1.0]).astype(np.float64)
    matrix[:3, 3] = position
    return matrix


def is_valid_transform(transform: Transform) -> bool:
    """Whether a transform is finite and affine, and invertible in 32 bits."""
    if transform.shape != (4, 4) or not (np.abs(transform) <= FAR).all():
        return False
    sizes = np.linalg.svd(transform[:3, :3], compute_uv=False)
    return bool(sizes[-1] >= NEAR and (transform[3] == (0.0, 0.0, 0.0, 1.0)).all())


LYING = rotated("x", -90.0)
"""Rotation of a plane to face up, with the picture's top away from a camera at azimuth 0."""
