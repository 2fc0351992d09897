"""The depth maps that cast shadows: from where each light sees the objects of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine
from basrelief.lang import Buffer, IVec2, Vec2
from basrelief.lang.resources import HeightField
from basrelief.rendering.programs import depth_program_of, map_edge, own_values
from basrelief.scene import Object, Scene
from basrelief.scene.cameras import look
from basrelief.scene.lights import numbers_of
from basrelief.shading.camera import Camera
from basrelief.shading.intersection import CameraSample
from basrelief.shading.lights import FAR_AWAY, Light
from basrelief.shading.shadow_map import ShadowMapView

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
    radius *= scene.shadow_map_size / (scene.shadow_map_size - 2.0)
    side = (scene.shadow_map_size, scene.shadow_map_size)
    return [
        LightView(index, camera)
        for index, light in enumerate(scene.lights)
        for camera in _cameras(light, center, radius, side)
    ]


def _ball_around(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """Middle and radius of a ball that holds all objects, their raised reliefs included."""
    points = np.concatenate([obj.outline() for obj in scene.objects])
    center = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = float(np.linalg.norm(points - center, axis=1).max())
    raised = max(
        obj.raised * float(np.linalg.norm(obj.to_world[:3, :3], 2)) for obj in scene.objects
    )
    return center, (radius + raised) * 1.02


def _cameras(
    light: Light, center: NDArray[np.float64], radius: float, side: tuple[int, int]
) -> Iterator[Camera]:
    position = np.array([*light.position], np.float64)
    way = np.array([*light.direction], np.float64)
    numbers = numbers_of(light)
    if "position" not in numbers:
        yield _looking(center - way * 2.0 * radius, way, side, orthographic_height=2.0 * radius)
        return
    if "angle" in numbers:
        half = math.degrees(math.acos(max(-1.0, min(1.0, float(light.cos_outer)))))
        if 2.0 * half <= _WIDEST:
            wide = math.tan(math.radians(half)) * side[0] / (side[0] - 2.0)
            degrees = max(2.0 * math.degrees(math.atan(wide)), _NARROWEST)
            yield _looking(position, way, side, field_of_view=degrees)
            return
    # all that a lamp lights, or a cone too wide for one depth map
    away = float(np.linalg.norm(center - position))
    half = math.degrees(math.asin(min(1.0, radius / max(away, 1e-9))))
    # within the ball it is a right angle
    if 2.0 * half <= _WIDEST:
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


# --- what they show -------------------------------------------------------------------------------


def shadow_map_values(scene: Scene, engine: Engine) -> list[dict[str, Any]]:
    """For each object of a scene, what the others' shadows on it are read from."""
    views, side = light_views(scene), scene.shadow_map_size
    whose = [_distances(obj, views, side, engine) for obj in scene.objects]
    # side by side in a sheet about as wide as it is high, which any GPU takes
    columns = max(math.isqrt(max(len(views) - 1, 0)) + 1, 1)
    rows = -(-len(views) // columns) or 1
    corners = [(k % columns * side, k // columns * side) for k in range(len(views))]
    listed = [
        ShadowMapView(view.light, view.camera, side, IVec2(*corner))
        for view, corner in zip(views, corners, strict=True)
    ]
    found = []
    for own in range(len(whose)):
        others = [each for index, each in enumerate(whose) if index != own and each is not None]
        sheet = np.full((rows * side, columns * side), FAR_AWAY, np.float32)
        for each in others:
            for (x, y), seen in zip(corners, each, strict=True):
                part = sheet[y : y + side, x : x + side]
                np.minimum(part, seen, out=part)
        # a program has one edge for all its maps; depth maps are read within theirs alone
        distances = HeightField([sheet], map_edge(scene.objects[own]))
        found.append({"distances": distances, "views": Buffer(listed, ShadowMapView)})
    return found


def _distances(
    obj: Object, views: list[LightView], side: int, engine: Engine
) -> list[NDArray[np.float32]] | None:
    """How far each view of each light reaches until it meets an object."""
    if obj.casts == "none" or not views:
        return None
    program, values = depth_program_of(obj), own_values(obj, engine)
    made = []
    for view in views:
        seen = CameraSample(view.camera, Vec2(0.5, 0.5))
        planes = engine.run(program, {**values, "sample": seen}, (side, side))
        met = planes["hit"] != 0
        made.append(np.where(met, planes["distance"], np.float32(FAR_AWAY)).astype(np.float32))
    return made
