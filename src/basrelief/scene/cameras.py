"""Cameras from where they stand and what they look at: angles in degrees, the world with y up.

The numbers are worked out in float64; the shaders' `Camera` holds them as float32.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.shading.camera import Camera

__all__ = ["look", "orbit"]

NARROWEST = 1e-3
"""The least field of view in degrees: below it a pixel's width is lost in 32 bits."""

_Vector = NDArray[np.float64]


def look(
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
    and height in pixels; pixels are square. Either `field_of_view`, the vertical angle of a
    perspective camera in degrees (above 0, below 180), or `orthographic_height`, the height of
    the picture in world units, is given.

    Raises InputError where these do not make a camera.
    """
    width, height = size
    if width < 1 or height < 1:
        raise InputError(f"a picture of {width} × {height} pixels: give at least 1 × 1")
    half_height = _half_height(field_of_view, orthographic_height)
    place = _vector(position, "position")
    forward = _unit(
        _vector(target, "target") - place,
        "position and target are the same point; move the camera away from what it looks at",
    )
    right = _unit(
        np.cross(forward, _unit(_vector(up, "up"), "up has no length")),
        "up points along the view; give an up that stands across it",
    )
    down = np.cross(forward, right)
    pixel = 2.0 * half_height / height
    corner = -(right * width + down * height) * (pixel / 2.0)
    perspective = orthographic_height is None
    return Camera(
        position=Vec3(*place),
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

    `azimuth` 0 looks from +z; above 0 the camera stands further towards +x. `elevation` lifts it
    towards +y, 90 looking straight down. Both in degrees. The rest as in `look`.
    """
    if not distance > 0.0:
        raise InputError(f"a camera at distance {distance} from its target: give one above 0")
    around, above = math.radians(azimuth), math.radians(elevation)
    level = np.array([math.sin(around), 0.0, math.cos(around)])
    y = np.array([0.0, 1.0, 0.0])
    away = level * math.cos(above) + y * math.sin(above)
    # the way the camera moves with the elevation: stands across the view at the poles too
    up = y * math.cos(above) - level * math.sin(above)
    middle = _vector(target, "target")
    return look(
        list(middle + away * distance),
        list(middle),
        list(up),
        size=size,
        field_of_view=field_of_view,
        orthographic_height=orthographic_height,
    )


def _half_height(field_of_view: float | None, orthographic_height: float | None) -> float:
    """Half the picture's height, one unit away (perspective) or in world units."""
    if (field_of_view is None) == (orthographic_height is None):
        raise InputError("give a camera either field_of_view or orthographic_height")
    if field_of_view is not None:
        if not NARROWEST <= field_of_view < 180.0:
            raise InputError(
                f"field_of_view is {field_of_view}: give degrees between 0 and 180, "
                f"{NARROWEST:g} at least"
            )
        return math.tan(math.radians(field_of_view) / 2.0)
    assert orthographic_height is not None
    if not 0.0 < orthographic_height < math.inf:
        raise InputError(f"orthographic_height is {orthographic_height}: give one above 0")
    return orthographic_height / 2.0


def _vector(values: Sequence[float], what: str) -> _Vector:
    made = np.array([float(v) for v in values], np.float64)
    if made.shape != (3,) or not np.isfinite(made).all():
        raise InputError(f"{what} is {values}: give three finite numbers")
    return made


def _unit(vector: _Vector, complaint: str) -> _Vector:
    length = float(np.linalg.norm(vector))
    if length < 1e-9:
        raise InputError(complaint)
    return vector / length
