"""Shader cameras from positions and angles, in degrees; the world has y up.

Computed in float64; the shaders' `Camera` holds float32.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.scene.checks import MIN_FIELD_OF_VIEW
from basrelief.shading.camera import Camera

__all__ = ["look_at", "orbit"]

_Vector = NDArray[np.float64]


def look_at(
    position: Sequence[float],
    target: Sequence[float],
    up: Sequence[float] = (0.0, 1.0, 0.0),
    *,
    size: tuple[int, int],
    field_of_view: float | None = None,
    orthographic_height: float | None = None,
) -> Camera:
    """The camera at `position` with `target` in the middle of the picture.

    `up` is the world direction that points upwards in the picture. `size` is the picture's width
    and height in pixels; pixels are square. Exactly one is required of `field_of_view`, the
    vertical angle of a perspective camera in degrees (above 0, below 180), and
    `orthographic_height`, the height of the picture in world units.

    Raises InputError for values that do not define a camera.
    """
    width, height = size
    if width < 1 or height < 1:
        raise InputError(f"a picture of {width} × {height} pixels: give at least 1 × 1")
    half_height = _half_height(field_of_view, orthographic_height)
    eye = _vector(position, "position")
    forward = _unit(
        _vector(target, "target") - eye,
        "position and target are the same point; move the camera away from what it looks at",
    )
    right = _unit(
        _cross(forward, _unit(_vector(up, "up"), "up has no length")),
        "`up` is parallel to the view direction; choose another",
    )
    down = _cross(forward, right)
    pixel = 2.0 * half_height / height
    corner = -(right * width + down * height) * (pixel / 2.0)
    perspective = orthographic_height is None
    return Camera(
        position=Vec3(*eye),
        corner=Vec3(*(corner + forward if perspective else corner)),
        right=Vec3(*(right * pixel)),
        down=Vec3(*(down * pixel)),
        forward=Vec3(*forward),
        perspective=float(perspective),
    )


def orbit(
    target: Sequence[float],
    distance: float,
    azimuth: float,
    elevation: float,
    *,
    size: tuple[int, int],
    field_of_view: float | None = None,
    orthographic_height: float | None = None,
) -> Camera:
    """The camera `distance` world units from `target`, looking at it.

    `azimuth` 0 is a camera towards +z of the target, 90 one towards +x; `elevation` 90 is straight
    above. Both are in degrees. Other parameters are those of `look_at`.
    """
    if not distance > 0.0:
        raise InputError(
            f"a camera at distance {distance} from its target: give a distance above 0"
        )
    azimuth_radians, elevation_radians = math.radians(azimuth), math.radians(elevation)
    horizontal = np.array([math.sin(azimuth_radians), 0.0, math.cos(azimuth_radians)])
    y = np.array([0.0, 1.0, 0.0])
    away = horizontal * math.cos(elevation_radians) + y * math.sin(elevation_radians)
    # the derivative of `away` by the elevation: perpendicular to the view at the poles too
    up = y * math.cos(elevation_radians) - horizontal * math.sin(elevation_radians)
    middle = _vector(target, "target")
    return look_at(
        list(middle + away * distance),
        list(middle),
        list(up),
        size=size,
        field_of_view=field_of_view,
        orthographic_height=orthographic_height,
    )


def _cross(a: _Vector, b: _Vector) -> _Vector:
    """The cross product; that of NumPy takes ten times as long for single vectors."""
    x, y, z = a.tolist()
    u, v, w = b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def _half_height(field_of_view: float | None, orthographic_height: float | None) -> float:
    """Half the picture's height, at distance 1 (perspective) or in world units."""
    if (field_of_view is None) == (orthographic_height is None):
        raise InputError(
            "a camera needs either field_of_view or orthographic_height; give one of them"
        )
    if field_of_view is not None:
        if not MIN_FIELD_OF_VIEW <= field_of_view < 180.0:
            raise InputError(
                f"field_of_view is {field_of_view}: give degrees between 0 and 180, "
                f"{MIN_FIELD_OF_VIEW:g} at least"
            )
        return math.tan(math.radians(field_of_view) / 2.0)
    assert orthographic_height is not None
    if not 0.0 < orthographic_height < math.inf:
        raise InputError(f"orthographic_height is {orthographic_height}: give a height above 0")
    return orthographic_height / 2.0


def _vector(values: Sequence[float], name: str) -> _Vector:
    vector = np.array([float(v) for v in values], np.float64)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(f"{name} is {values}: give three finite numbers")
    return vector


def _unit(vector: _Vector, message: str) -> _Vector:
    length = float(np.linalg.norm(vector))
    if length < 1e-9:
        raise InputError(message)
    return vector / length
