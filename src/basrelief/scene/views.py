"""Camera records of scenes; `basrelief.scene.cameras` computes the shaders' cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basrelief.errors import InputError
from basrelief.scene.checks import FAR, MIN_FIELD_OF_VIEW, NEAR
from basrelief.settings import setting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basrelief.shading.camera import Camera

FRAME_FILL = 0.92
"""Fraction of the picture's width or height that a framed object fills."""
_AZIMUTH = {"low": -180.0, "high": 180.0, "step": 1.0}
_ELEVATION = {"low": -89.0, "high": 89.0, "step": 1.0}
_DISTANCE = {"low": 0.1, "high": 20.0, "step": 0.01}
_FIELD_OF_VIEW = {"low": 1.0, "high": 120.0, "step": 1.0}
_VIEW_HEIGHT = {"low": 0.05, "high": 10.0, "step": 0.01}


@dataclass(frozen=True)
class Orbit:
    """A camera on a sphere around its target.

    Parameters
    ----------
    azimuth : float, default 30.0
        Angle about the y axis in degrees; 0 is towards +z, 90 towards +x.
    elevation : float, default 35.0
        Angle above the horizontal in degrees; 90 is straight above.
    distance : float, optional
        Distance from the target in world units, above 0. By default the first object of the scene
        fits into the picture.
    target : (float, float, float), default (0, 0, 0)
        Point in the middle of the picture.
    field_of_view : float, default 30.0
        Vertical angle of a perspective camera in degrees, above 0 and below 180.
    orthographic_height : float, optional
        Height of the picture in world units, above 0. The camera is then orthographic, and
        `field_of_view` is unused.

    Raises
    ------
    InputError
        When the camera is used, for values out of range.
    """

    azimuth: float = setting(default=30.0, low=-FAR, high=FAR, control=_AZIMUTH)
    elevation: float = setting(default=35.0, low=-FAR, high=FAR, control=_ELEVATION)
    distance: float | None = setting(default=None, low=NEAR, high=FAR, control=_DISTANCE)
    target: tuple[float, float, float] = setting(default=(0.0, 0.0, 0.0), low=-FAR, high=FAR)
    field_of_view: float = setting(
        default=30.0, low=MIN_FIELD_OF_VIEW, high=179.99, control=_FIELD_OF_VIEW
    )
    orthographic_height: float | None = setting(
        default=None, low=NEAR, high=FAR, control=_VIEW_HEIGHT
    )

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        from basrelief.scene.cameras import orbit

        lens = _projection_parameters(self.field_of_view, self.orthographic_height)
        distance = 2.0 if self.distance is None else self.distance
        _check_coordinates(self.azimuth, self.elevation, distance, *self.target)
        return orbit(self.target, distance, self.azimuth, self.elevation, size=size, **lens)

    def framing(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera at the smallest distance that shows all points, (n, 3)."""
        import numpy as np

        unit_distance = replace(self, distance=1.0).camera(size)
        right, down, forward = (
            np.array([*v], np.float64)
            for v in (unit_distance.right, unit_distance.down, unit_distance.forward)
        )
        offsets = points - np.array(self.target, np.float64)
        toward_camera = -(offsets @ forward)
        if self.orthographic_height is not None:
            return replace(self, distance=float(toward_camera.max()) + 1.0)
        # a point is in view if its offset from the axis is at most its depth times tan(half angle)
        halves = np.array(size) * FRAME_FILL / 2.0
        distances = [
            toward_camera + np.abs(offsets @ axis) / (axis @ axis) / half
            for axis, half in zip((right, down), halves, strict=True)
        ]
        return replace(self, distance=float(np.max(distances)))

    def framing_all_azimuths(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera at the smallest distance that shows all points, (n, 3), at any azimuth.

        This is the maximum of `framing` over all azimuths, in closed form.
        """
        import numpy as np

        offsets = points - np.array(self.target, np.float64)
        radial, height = np.hypot(offsets[:, 0], offsets[:, 2]), offsets[:, 1]
        s, c = math.sin(math.radians(self.elevation)), math.cos(math.radians(self.elevation))
        # at the azimuth x, a point is nearer by radial · c · cos x, offset across the picture by
        # radial · sin x and along it by height · c − radial · s · cos x
        if self.orthographic_height is not None:
            return replace(self, distance=float((radial * abs(c) + height * s).max()) + 1.0)
        tangent = math.tan(math.radians(self.field_of_view) / 2.0) * FRAME_FILL
        across = np.hypot(c, size[1] / size[0] / tangent) * radial + height * s
        # convex in cos x, so largest at −1 or 1
        along = [
            sign * radial * c + height * s + np.abs(height * c - sign * radial * s) / tangent
            for sign in (-1.0, 1.0)
        ]
        return replace(self, distance=float(np.max([across, *along])))


@dataclass(frozen=True)
class LookAt:
    """A camera at a position, looking at a target.

    Parameters
    ----------
    position : (float, float, float)
        Position of the camera in world units.
    target : (float, float, float), default (0, 0, 0)
        Point in the middle of the picture.
    up : (float, float, float), default (0, 1, 0)
        World direction that points upwards in the picture; not parallel to the view direction. The
        default becomes −z for a camera that looks straight up or down.
    field_of_view : float, default 30.0
        Vertical angle of a perspective camera in degrees, above 0 and below 180.
    orthographic_height : float, optional
        Height of the picture in world units, above 0. The camera is then orthographic, and
        `field_of_view` is unused.

    Raises
    ------
    InputError
        When the camera is used, for values that define no camera.
    """

    position: tuple[float, float, float] = setting(low=-FAR, high=FAR)
    target: tuple[float, float, float] = setting(default=(0.0, 0.0, 0.0), low=-FAR, high=FAR)
    up: tuple[float, float, float] = setting(default=(0.0, 1.0, 0.0))
    field_of_view: float = setting(
        default=30.0, low=MIN_FIELD_OF_VIEW, high=179.99, control=_FIELD_OF_VIEW
    )
    orthographic_height: float | None = setting(
        default=None, low=NEAR, high=FAR, control=_VIEW_HEIGHT
    )

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        from basrelief.scene.cameras import look_at

        lens = _projection_parameters(self.field_of_view, self.orthographic_height)
        _check_coordinates(*self.position, *self.target)
        return look_at(self.position, self.target, self.up_direction, size=size, **lens)

    @property
    def up_direction(self) -> tuple[float, float, float]:
        """World direction that points upwards in the picture: `up`, unless that is undefined."""
        along_y = self.position[0] == self.target[0] and self.position[2] == self.target[2]
        # the default is parallel to a vertical view: the picture's top is then towards −z
        return (0.0, 0.0, -1.0) if along_y and self.up == (0.0, 1.0, 0.0) else self.up


def _check_coordinates(*numbers: float) -> None:
    """Raise InputError for camera coordinates or angles too large for 32 bits."""
    for number in numbers:
        if not abs(number) <= FAR:
            raise InputError(f"a camera at {number:g}: give angles and coordinates up to {FAR:g}")


def _projection_parameters(
    field_of_view: float, orthographic_height: float | None
) -> dict[str, float]:
    if orthographic_height is not None:
        return {"orthographic_height": orthographic_height}
    return {"field_of_view": field_of_view}
