"""Motions: changes of a scene during a film, as pure functions of the scene and the moment.

    Orbiting()(scene, Moment(fraction=0.25, seconds=1.0, size=(640, 360)))

A motion changes one part of the scene, so that several can be combined. It always starts from the
initial scene, never from the previous moment, so that any frame can be drawn by itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.scene import LookAt, Object, Orbit, Scene, rotated
from basrelief.scene.checks import check_settings
from basrelief.scene.lights import light_parameters
from basrelief.settings import setting
from basrelief.shading.lights import Light

__all__ = [
    "MOTIONS", "Lighting", "Moment", "Motion", "Opening", "Orbiting", "Scrolling",
    "apply_motions",
]  # fmt: skip

_LIMIT = 1e3
"""Limit of turns per film and of tiles per second, far beyond what the eye can follow."""
_SPEED_CONTROL = {"low": -1.0, "high": 1.0, "step": 0.01}
"""Range and step of the viewer's sliders."""


@dataclass(frozen=True)
class Moment:
    """A moment of a film.

    Attributes
    ----------
    fraction : float
        Elapsed fraction of the film, 0 or above and below 1, so that a film can loop.
    seconds : float
        Seconds since the beginning.
    size : (int, int)
        Width and height of the picture in pixels.
    """

    fraction: float
    seconds: float
    size: tuple[int, int]


class Motion(Protocol):
    """A function from the initial scene of a film to the scene at a moment."""

    def __call__(self, scene: Scene, now: Moment) -> Scene: ...


def apply_motions(scene: Scene, motions: Sequence[Motion], now: Moment) -> Scene:
    """Apply motions one after the other; returns the scene at a moment."""
    for motion in motions:
        scene = motion(scene, now)
    return scene


# --- the motions ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Orbiting:
    """Motion of the camera around the vertical axis through its target.

    An `Orbit` without a distance gets the smallest one that shows the first object at any azimuth.

    Parameters
    ----------
    turns : float, default 1.0
        Turns during the film, −1000 to 1000, towards growing azimuths if positive. A whole number
        makes a loop.

    Raises
    ------
    InputError
        For turns out of range.
    """

    turns: float = setting(default=1.0, low=-_LIMIT, high=_LIMIT)

    def __post_init__(self) -> None:
        check_settings(self)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with the camera of a moment."""
        camera, degrees = scene.camera, 360.0 * self.turns * now.fraction
        if isinstance(camera, LookAt):
            return scene.with_camera(_rotated_camera(camera, degrees))
        if camera.distance is None and scene.objects:
            # framed for each frame separately, the camera would move to and fro
            camera = camera.framing_all_azimuths(
                scene.objects[0].resolved.bounding_points(), now.size
            )
        return scene.with_camera(replace(camera, azimuth=camera.azimuth + degrees))


@dataclass(frozen=True)
class Lighting:
    """Motion of the first light around the vertical axis.

    A directional light keeps its elevation. A point or spot light moves around the vertical axis
    through the camera's target.

    Parameters
    ----------
    turns : float, default 1.0
        Turns during the film, as for `Orbiting`.

    Raises
    ------
    InputError
        For turns out of range, and when it is applied to a scene without lights.
    """

    turns: float = setting(default=1.0, low=-_LIMIT, high=_LIMIT)

    def __post_init__(self) -> None:
        check_settings(self)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with the first light of a moment."""
        if not scene.lights:
            raise InputError("a light cannot move: the scene has none; add one")
        first = _rotated_light(scene.lights[0], scene.camera, 360.0 * self.turns * now.fraction)
        return replace(scene, lights=(first, *scene.lights[1:]))


@dataclass(frozen=True)
class Scrolling:
    """Scrolling of all maps of all objects over their shapes.

    The film loops if a whole number of tiles passes.

    Parameters
    ----------
    u, v : float, default 0.25 and 0.0
        Speed in texture coordinates of the shape per second, −1000 to 1000: 1 is once around a
        sphere, or across a plane, whatever the tiling.

    Raises
    ------
    InputError
        For speeds out of range.

    References
    ----------
    E. Nordeus (Habrador), Advanced shaders in Unity, 3: Parallax mapping; the default speed is its
    `_Time[0] * 5`.
    """

    u: float = setting(default=0.25, low=-_LIMIT, high=_LIMIT, control=_SPEED_CONTROL)
    v: float = setting(default=0.0, low=-_LIMIT, high=_LIMIT, control=_SPEED_CONTROL)

    def __post_init__(self) -> None:
        check_settings(self)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with the map shifts of a moment."""
        offset = (self.u * now.seconds, self.v * now.seconds)
        return replace(scene, objects=tuple(_shifted(obj, offset) for obj in scene.objects))


@dataclass(frozen=True)
class Opening:
    """A hole that opens and closes in the first object: its `opening`, from 0 to 1 and back.

    Parameters
    ----------
    times : float, default 1.0
        Openings during the film, 0 to 1000. A whole number makes a loop.

    Raises
    ------
    InputError
        For times out of range, and when the first object has no height map, or an opening already.

    References
    ----------
    E. Nordeus (Habrador), Advanced shaders in Unity, 3: Parallax mapping.
    """

    times: float = setting(default=1.0, low=0.0, high=_LIMIT)

    def __post_init__(self) -> None:
        check_settings(self)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with the hole of a moment."""
        if not scene.objects or scene.objects[0].material.height is None:
            raise InputError("a hole cannot open: the first object needs a height map; give it one")
        first, *others = scene.objects
        if first.opening is not None:
            raise InputError(
                f"the motion opening replaces the opening {first.opening:g} of the first object; "
                "omit one of them"
            )
        opening = 0.5 - 0.5 * math.cos(2.0 * math.pi * self.times * now.fraction)
        return replace(scene, objects=(replace(first, opening=opening), *others))


MOTIONS = {"orbit": Orbiting, "light": Lighting, "scroll": Scrolling, "opening": Opening}
"""Motions by their names on the command line, where their fields are parameters."""


# --- rotations, shifts ---------------------------------------------------------------------------

_Point = tuple[float, float, float]


def _rotate_y(vector: Sequence[float], degrees: float) -> _Point:
    """A vector rotated about the y axis, from +z towards +x for positive angles."""
    x, y, z = (float(value) for value in rotated("y", degrees)[:3, :3] @ [*vector])
    return x, y, z


def _rotate_around(position: Sequence[float], target: _Point, degrees: float) -> _Point:
    away = _rotate_y([a - b for a, b in zip(position, target, strict=True)], degrees)
    return away[0] + target[0], away[1] + target[1], away[2] + target[2]


def _rotated_camera(camera: LookAt, degrees: float) -> LookAt:
    """The camera rotated about the vertical axis through its target, with its up direction."""
    return replace(
        camera,
        position=_rotate_around(camera.position, camera.target, degrees),
        up=_rotate_y(camera.up_direction, degrees),
    )


def _rotated_light(light: Light, camera: Orbit | LookAt, degrees: float) -> Light:
    direction = Vec3(*_rotate_y([*light.direction], degrees))
    if "position" not in light_parameters(light):
        return replace(light, direction=direction)
    position = Vec3(*_rotate_around([*light.position], camera.target, degrees))
    return replace(light, position=position, direction=direction)


def _shifted(obj: Object, offset: tuple[float, float]) -> Object:
    scrolled = obj.scrolled(*offset)
    if obj.edge != "wrap":
        return scrolled
    # whole tiles change nothing, and small numbers keep their precision
    return replace(
        scrolled, shift=(math.fmod(scrolled.shift[0], 1.0), math.fmod(scrolled.shift[1], 1.0))
    )
