"""Motions: how a scene changes through a film. Pure functions of the scene and the moment.

    Orbiting()(scene, Moment(share=0.25, seconds=1.0, size=(640, 360)))

A motion changes one thing and leaves all else as it is, so that several go together. It always
starts from the scene as it was given, never from the moment before: any frame can be drawn alone.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from basrelief.errors import InputError
from basrelief.lang import Vec3
from basrelief.material import Material, hole, sample
from basrelief.scene import LookAt, Object, Orbit, Scene, rotated
from basrelief.scene.checks import check_range
from basrelief.scene.lights import light_parameters
from basrelief.shading.lights import Light

__all__ = [
    "MOTIONS", "Lighting", "Moment", "Motion", "Opening", "Orbiting", "Scrolling",
    "apply_motions",
]  # fmt: skip

_MOST = 1e3
"""Turns of a film, and tiles a second: far beyond what an eye can follow."""


@dataclass(frozen=True)
class Moment:
    """A moment of a film.

    `share` is how much of it has gone, from 0; 1 is the first frame again and is not drawn, so
    that a film can run in a loop. `seconds` since its beginning; `size` the picture's (width,
    height) in pixels.
    """

    share: float
    seconds: float
    size: tuple[int, int]


class Motion(Protocol):
    """What turns the scene at the beginning of a film into that of another moment."""

    def __call__(self, scene: Scene, now: Moment) -> Scene: ...


def apply_motions(scene: Scene, motions: Sequence[Motion], now: Moment) -> Scene:
    """The scene at a moment, after all motions, one after the other."""
    for motion in motions:
        scene = motion(scene, now)
    return scene


# --- the motions ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Orbiting:
    """The camera goes round the vertical axis through its target; azimuths grow.

    `turns` in the whole film, negative the other way round; a whole number makes a loop. An orbit
    without a distance of its own keeps the one that shows the first object whole all the way.
    """

    turns: float = 1.0

    def __post_init__(self) -> None:
        check_range("turns", self.turns, -_MOST, _MOST)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene from where the camera is at that moment."""
        camera, degrees = scene.camera, 360.0 * self.turns * now.share
        if isinstance(camera, LookAt):
            return scene.with_camera(_turned_round(camera, degrees))
        if camera.distance is None and scene.objects:
            # framed anew for each frame, it would go to and fro
            camera = camera.framing_all_azimuths(scene.objects[0].bounding_points(), now.size)
        return scene.with_camera(replace(camera, azimuth=camera.azimuth + degrees))


@dataclass(frozen=True)
class Lighting:
    """The first light goes round; azimuths grow.

    `turns` as in `Orbiting`. A directional light keeps its elevation; a lamp, with its cone, goes
    round the vertical axis through the camera's target.
    """

    turns: float = 1.0

    def __post_init__(self) -> None:
        check_range("turns", self.turns, -_MOST, _MOST)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene in the light of that moment."""
        if not scene.lights:
            raise InputError("a light that moves: the scene has none; give it one")
        first = _light_round(scene.lights[0], scene.camera, 360.0 * self.turns * now.share)
        return replace(scene, lights=(first, *scene.lights[1:]))


@dataclass(frozen=True)
class Scrolling:
    """All maps of all objects move over their shapes.

    `u` and `v` are how far the texture coordinates go in a second, in those of the shape itself:
    1 is once round a sphere, or across a plane, whatever the tiling. The speed by default is that
    of Habrador, Advanced shaders in Unity: Parallax mapping, `_Time[0] * 5`. It makes a loop where
    as many tiles pass in the film as are whole.
    """

    u: float = 0.25
    v: float = 0.0

    def __post_init__(self) -> None:
        check_range("u", self.u, -_MOST, _MOST)
        check_range("v", self.v, -_MOST, _MOST)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with its maps where they are at that moment."""
        along = (self.u * now.seconds, self.v * now.seconds)
        return replace(scene, objects=tuple(_shifted(obj, along) for obj in scene.objects))


@dataclass(frozen=True)
class Opening:
    """A hole opens in the first object, and closes again; its material is the cracked ground.

    `times` in the whole film; a whole number makes a loop. The dust is the sample of that name.
    After Habrador, Advanced shaders in Unity: Parallax mapping; see `basrelief.material.hole`.
    """

    times: float = 1.0

    def __post_init__(self) -> None:
        check_range("times", self.times, 0.0, _MOST)

    def __call__(self, scene: Scene, now: Moment) -> Scene:
        """The scene with its hole as wide as it is at that moment."""
        if not scene.objects or scene.objects[0].material.height is None:
            raise InputError("a hole that opens: the first object needs a height map")
        first, *others = scene.objects
        opening = 0.5 - 0.5 * math.cos(2.0 * math.pi * self.times * now.share)
        opened = hole(first.material, _dust_for(first.material), opening)
        return replace(scene, objects=(replace(first, material=opened), *others))


MOTIONS = {"orbit": Orbiting, "light": Lighting, "scroll": Scrolling, "opening": Opening}
"""The motions by the names that they have on the command line; their fields are numbers there."""


# --- how they do it ------------------------------------------------------------------------------

_Place = tuple[float, float, float]


def _round_y(vector: Sequence[float], degrees: float) -> _Place:
    """A vector turned about the vertical, from +z towards +x as azimuths grow."""
    x, y, z = (float(each) for each in rotated("y", degrees)[:3, :3] @ [*vector])
    return x, y, z


def _round_target(position: Sequence[float], target: _Place, degrees: float) -> _Place:
    away = _round_y([a - b for a, b in zip(position, target, strict=True)], degrees)
    return away[0] + target[0], away[1] + target[1], away[2] + target[2]


def _turned_round(camera: LookAt, degrees: float) -> LookAt:
    """The camera at another place of its circle, the picture's upright turned with it."""
    return replace(
        camera,
        position=_round_target(camera.position, camera.target, degrees),
        up=_round_y(camera.up_direction, degrees),
    )


def _light_round(light: Light, camera: Orbit | LookAt, degrees: float) -> Light:
    direction = Vec3(*_round_y([*light.direction], degrees))
    if "position" not in light_parameters(light):
        return replace(light, direction=direction)
    position = Vec3(*_round_target([*light.position], camera.target, degrees))
    return replace(light, position=position, direction=direction)


def _dust_for(cracks: Material) -> Material:
    """The dust, as large as the heights of the cracks."""
    assert cracks.height is not None
    return _dust(cracks.height.height, cracks.height.width)


@functools.lru_cache(maxsize=2)
def _dust(height: int, width: int) -> Material:
    return sample("dust", (height, width))


def _shifted(obj: Object, along: tuple[float, float]) -> Object:
    scrolled = obj.scrolled(*along)
    if obj.edge != "wrap":
        return scrolled
    # a whole tile further is the same picture, and small numbers keep their digits
    return replace(
        scrolled, shift=(math.fmod(scrolled.shift[0], 1.0), math.fmod(scrolled.shift[1], 1.0))
    )
