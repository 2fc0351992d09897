"""Where a scene is seen from; `basrelief.scene.cameras` works out the numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.scene.cameras import look, orbit
from basrelief.scene.checks import FAR
from basrelief.shading.camera import Camera

FRAME_FILL = 0.92
"""How much of the picture's width or height an object fills when it is framed."""


@dataclass(frozen=True)
class Orbit:
    """A camera on a sphere around its target; see `basrelief.scene.cameras.orbit`.

    With `orthographic_height` it is orthographic, and `field_of_view` (vertical) does not matter.
    Without a `distance` it stands as far as shows the scene's first object whole.
    """

    azimuth: float = 30.0
    elevation: float = 35.0
    distance: float | None = None
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    field_of_view: float = 30.0
    orthographic_height: float | None = None

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        lens = _lens(self.field_of_view, self.orthographic_height)
        distance = 2.0 if self.distance is None else self.distance
        _in_reach(self.azimuth, self.elevation, distance, *self.target)
        return orbit(self.target, distance, self.azimuth, self.elevation, size=size, **lens)

    def framing(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera as near as shows all of the points, (n, 3)."""
        near = replace(self, distance=1.0).camera(size)
        right, down, forward = (
            np.array([*v], np.float64) for v in (near.right, near.down, near.forward)
        )
        offsets = points - np.array(self.target, np.float64)
        closer = -(offsets @ forward)
        if self.orthographic_height is not None:
            return replace(self, distance=float(closer.max()) + 1.0)
        # a point is in view where its way from the axis is within its depth times the half angle
        halves = np.array(size) * FRAME_FILL / 2.0
        needed = [
            closer + np.abs(offsets @ axis) / (axis @ axis) / half
            for axis, half in zip((right, down), halves, strict=True)
        ]
        return replace(self, distance=float(np.max(needed)))

    def framing_all_azimuths(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera as near as shows all of the points, (n, 3), from every azimuth.

        The distance is the largest that `framing` finds on the way round, worked out, not searched.
        """
        offsets = points - np.array(self.target, np.float64)
        away, above = np.hypot(offsets[:, 0], offsets[:, 2]), offsets[:, 1]
        s, c = math.sin(math.radians(self.elevation)), math.cos(math.radians(self.elevation))
        # as the camera goes round, a point comes nearer by away · c · cos x, goes across the
        # picture by away · sin x and along it by above · c − away · s · cos x
        if self.orthographic_height is not None:
            return replace(self, distance=float((away * abs(c) + above * s).max()) + 1.0)
        tangent = math.tan(math.radians(self.field_of_view) / 2.0) * FRAME_FILL
        across = np.hypot(c, size[1] / size[0] / tangent) * away + above * s
        # convex in cos x, so largest at one of its ends
        along = [
            turn * away * c + above * s + np.abs(above * c - turn * away * s) / tangent
            for turn in (-1.0, 1.0)
        ]
        return replace(self, distance=float(np.max([across, *along])))


@dataclass(frozen=True)
class LookAt:
    """A camera that stands somewhere and looks at something; see `basrelief.scene.cameras.look`."""

    position: tuple[float, float, float]
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    field_of_view: float = 30.0
    orthographic_height: float | None = None

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        lens = _lens(self.field_of_view, self.orthographic_height)
        _in_reach(*self.position, *self.target)
        return look(self.position, self.target, self.up_direction, size=size, **lens)

    @property
    def up_direction(self) -> tuple[float, float, float]:
        """The direction of the world that points upwards in the picture: `up` where it can be."""
        along_y = self.position[0] == self.target[0] and self.position[2] == self.target[2]
        # straight up or down no other y would do: the picture's top is then where −z is
        return (0.0, 0.0, -1.0) if along_y and self.up == (0.0, 1.0, 0.0) else self.up


def _in_reach(*numbers: float) -> None:
    """Raise InputError where a camera stands, or is turned, further than 32 bits can follow."""
    for number in numbers:
        if not abs(number) <= FAR:
            raise InputError(f"a camera at {number:g}: give angles and places up to {FAR:g}")


def _lens(field_of_view: float, orthographic_height: float | None) -> dict[str, float]:
    if orthographic_height is not None:
        return {"orthographic_height": orthographic_height}
    return {"field_of_view": field_of_view}
