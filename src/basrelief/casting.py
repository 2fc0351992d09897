"""The depth maps that cast shadows: from where each light sees the objects of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from basrelief.cameras import look
from basrelief.scene import Scene
from basrelief.shaders.camera import Camera
from basrelief.shaders.lighting import DIRECTIONAL, SPOT, Light

_WIDEST = 100.0
"""The widest angle, in degrees, of one depth map; a lamp that needs more has six, all around."""
_NARROWEST = 0.1
"""The narrowest, which 32 bits still tell apart: of a lamp that is very far away."""
_AXES = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)


@dataclass(frozen=True)
class LightView:
    """A light, by its place in the scene's list, and a camera that sees as it does."""

    light: int
    camera: Camera


def light_views(scene: Scene) -> list[LightView]:
    """The views from all lights of a scene that between them see all of its objects."""
    center, radius = _ball_around(scene)
    # seen from the middles of the outer texels, which are the last that are compared
    radius *= scene.shadow_map / (scene.shadow_map - 2.0)
    side = (scene.shadow_map, scene.shadow_map)
    return [
        LightView(index, camera)
        for index, light in enumerate(scene.lights)
        for camera in _cameras(light, center, radius, side)
    ]


def _ball_around(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """Middle and radius of a ball that holds all objects, their raised reliefs included."""
    points = np.concatenate([thing.outline() for thing in scene.objects])
    center = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = float(np.linalg.norm(points - center, axis=1).max())
    raised = max(
        (1.0 - thing.relief_level) * thing.relief_scale * float(np.linalg.norm(thing.to_world, 2))
        if thing.has_relief
        else 0.0
        for thing in scene.objects
    )
    return center, (radius + raised) * 1.02


def _cameras(
    light: Light, center: NDArray[np.float64], radius: float, side: tuple[int, int]
) -> Iterator[Camera]:
    position = np.array([*light.position], np.float64)
    way = np.array([*light.direction], np.float64)
    if light.kind == DIRECTIONAL:
        yield _looking(center - way * 2.0 * radius, way, side, orthographic_height=2.0 * radius)
        return
    if light.kind == SPOT:
        half = math.degrees(math.acos(max(-1.0, min(1.0, float(light.cos_outer)))))
        if 2.0 * half <= _WIDEST:
            yield _looking(position, way, side, field_of_view=max(2.0 * half, _NARROWEST))
            return
    away = float(np.linalg.norm(center - position))
    half = math.degrees(math.asin(min(1.0, radius / max(away, 1e-9))))
    if 2.0 * half <= _WIDEST and away > radius:
        wide = max(2.0 * half, _NARROWEST)
        yield _looking(position, (center - position) / away, side, field_of_view=wide)
        return
    # the middles of the outer texels reach beyond a right angle, so that neighbours overlap
    around = 2.0 * math.degrees(math.atan(side[0] / (side[0] - 2.0)))
    for axis in _AXES:
        yield _looking(position, axis, side, field_of_view=around)


def _looking(
    position: NDArray[np.float64],
    way: NDArray[np.float64],
    side: tuple[int, int],
    *,
    field_of_view: float | None = None,
    orthographic_height: float | None = None,
) -> Camera:
    up = (0.0, 0.0, 1.0) if abs(way[1]) > 0.9 else (0.0, 1.0, 0.0)
    return look(
        list(position),
        list(position + way),
        up,
        size=side,
        field_of_view=field_of_view,
        orthographic_height=orthographic_height,
    )
