"""Shadow maps: depth maps of a scene's objects as seen from each light."""

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
from basrelief.rendering.programs import depth_program_of, map_edge, object_values
from basrelief.scene import ResolvedObject, Scene
from basrelief.scene.cameras import look_at
from basrelief.scene.lights import light_parameters
from basrelief.scene.resolve import undisplaced
from basrelief.shading.camera import Camera
from basrelief.shading.intersection import CameraSample
from basrelief.shading.lights import FAR_AWAY, Light
from basrelief.shading.shadow_map import ShadowMapView

_WIDEST = 100.0
"""Widest angle in degrees of one shadow map; a light that needs more gets a cube of six."""
_NARROWEST = 0.1
"""Narrowest angle in degrees that 32 bits resolve, for a very distant light."""
_AXES = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)


@dataclass(frozen=True)
class LightView:
    """A light, by its index in the scene's list, and a camera of its shadow map."""

    light: int
    camera: Camera


def light_views(scene: Scene) -> list[LightView]:
    """Views from all lights of a scene, which together cover all of its objects."""
    center, radius = _bounding_sphere(scene)
    # widened to the centres of the outer texels, the last that are compared
    radius *= scene.shadow_map_size / (scene.shadow_map_size - 2.0)
    side = (scene.shadow_map_size, scene.shadow_map_size)
    return [
        LightView(index, camera)
        for index, light in enumerate(scene.lights)
        for camera in _cameras(light, center, radius, side)
    ]


def _bounding_sphere(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """Centre and radius of a sphere around all objects, raised reliefs included."""
    points = np.concatenate([obj.bounding_points() for obj in scene.resolved])
    center = (points.min(axis=0) + points.max(axis=0)) / 2.0
    radius = float(np.linalg.norm(points - center, axis=1).max())
    raised = max(
        obj.raised * float(np.linalg.norm(obj.transform[:3, :3], 2)) for obj in scene.resolved
    )
    return center, (radius + raised) * 1.02


def _cameras(
    light: Light, center: NDArray[np.float64], radius: float, side: tuple[int, int]
) -> Iterator[Camera]:
    position = np.array([*light.position], np.float64)
    direction = np.array([*light.direction], np.float64)
    numbers = light_parameters(light)
    if "position" not in numbers:
        yield _camera_towards(
            center - direction * 2.0 * radius, direction, side, orthographic_height=2.0 * radius
        )
        return
    if "angle" in numbers:
        half = math.degrees(math.acos(max(-1.0, min(1.0, float(light.cos_outer)))))
        if 2.0 * half <= _WIDEST:
            wide = math.tan(math.radians(half)) * side[0] / (side[0] - 2.0)
            degrees = max(2.0 * math.degrees(math.atan(wide)), _NARROWEST)
            yield _camera_towards(position, direction, side, field_of_view=degrees)
            return
    # a point light, or a cone too wide for one shadow map
    distance = float(np.linalg.norm(center - position))
    half = math.degrees(math.asin(min(1.0, radius / max(distance, 1e-9))))
    # inside the sphere the half angle is a right angle
    if 2.0 * half <= _WIDEST:
        wide = max(2.0 * half, _NARROWEST)
        yield _camera_towards(position, (center - position) / distance, side, field_of_view=wide)
        return
    # the centres of the outer texels lie at 45°, so that neighbouring faces overlap
    field_of_view = 2.0 * math.degrees(math.atan(side[0] / (side[0] - 2.0)))
    for axis in _AXES:
        yield _camera_towards(position, axis, side, field_of_view=field_of_view)


def _camera_towards(
    position: NDArray[np.float64],
    direction: NDArray[np.float64],
    side: tuple[int, int],
    *,
    field_of_view: float | None = None,
    orthographic_height: float | None = None,
) -> Camera:
    up = (0.0, 0.0, 1.0) if abs(direction[1]) > 0.9 else (0.0, 1.0, 0.0)
    return look_at(
        list(position),
        list(position + direction),
        up,
        size=side,
        field_of_view=field_of_view,
        orthographic_height=orthographic_height,
    )


# --- contents -------------------------------------------------------------------------------------


def shadow_map_values(scene: Scene, engine: Engine) -> list[dict[str, Any]]:
    """For each object of a scene, the shadow maps of the other objects, as program values."""
    views, side = light_views(scene), scene.shadow_map_size
    distances_of = [_distances(obj, views, side, engine) for obj in scene.resolved]
    # side by side in an atlas about as wide as it is high, within any GPU's limits
    columns = max(math.isqrt(max(len(views) - 1, 0)) + 1, 1)
    rows = -(-len(views) // columns) or 1
    corners = [(k % columns * side, k // columns * side) for k in range(len(views))]
    records = [
        ShadowMapView(view.light, view.camera, side, IVec2(*corner))
        for view, corner in zip(views, corners, strict=True)
    ]
    values_of_objects = []
    for own_index in range(len(distances_of)):
        others = [
            object_distances
            for index, object_distances in enumerate(distances_of)
            if index != own_index and object_distances is not None
        ]
        atlas = np.full((rows * side, columns * side), FAR_AWAY, np.float32)
        for object_distances in others:
            for (x, y), light_view in zip(corners, object_distances, strict=True):
                part = atlas[y : y + side, x : x + side]
                np.minimum(part, light_view, out=part)
        # a program has one edge policy for all maps; shadow maps are read only inside theirs
        distances = HeightField([atlas], map_edge(scene.resolved[own_index]))
        values_of_objects.append({"distances": distances, "views": Buffer(records, ShadowMapView)})
    return values_of_objects


def _distances(
    obj: ResolvedObject, views: list[LightView], side: int, engine: Engine
) -> list[NDArray[np.float32]] | None:
    """Distances from each light's views to an object; None if it casts no shadow."""
    if obj.casts == "none" or not views:
        return None
    caster = undisplaced(obj) if obj.casts == "polygon" else obj
    program, values = depth_program_of(caster), object_values(caster, engine)
    maps = []
    for view in views:
        light_view = CameraSample(view.camera, Vec2(0.5, 0.5))
        planes = engine.run(program, {**values, "sample": light_view}, (side, side))
        hit = planes["hit"] != 0
        maps.append(np.where(hit, planes["distance"], np.float32(FAR_AWAY)).astype(np.float32))
    return maps
