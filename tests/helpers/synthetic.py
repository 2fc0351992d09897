"""Synthetic materials, and rays and lookups in float64, independent of the shaders."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from basrelief.lang import Vec3
from basrelief.material import Map, Material
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Scene, directional

SIZE = (97, 61)

TRIPOD = (
    directional(10.0, 5.0, (1.0, 0.0, 0.0)),
    directional(70.0, 10.0, (0.0, 1.0, 0.0)),
    directional(-15.0, -40.0, (0.0, 0.0, 1.0)),
)
"""Three lights that together determine a normal, one in each channel of a picture."""


def unit(v) -> np.ndarray:
    v = np.asarray(v, np.float64)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def normal_under_tripod(lit) -> np.ndarray:
    """The unit normal of a white surface, from its colour by Lambert's law under TRIPOD."""
    cosines = np.asarray(lit, np.float64)
    assert cosines.min() > 0.01
    towards = [[-float(c) for c in light.direction] for light in TRIPOD]
    return np.linalg.solve(towards, cosines)


def rays(camera: LookAt, size=SIZE) -> tuple[np.ndarray, np.ndarray]:
    """Origins and unit directions of the rays through all pixel centres, (H, W, 3)."""
    width, height = size
    position = np.asarray(camera.position, np.float64)
    forward = unit(np.asarray(camera.target) - position)
    right = unit(np.cross(forward, camera.up))
    up = np.cross(right, forward)
    x = (np.arange(width) + 0.5 - width / 2) / height
    y = (height / 2 - np.arange(height) - 0.5) / height
    across = right * x[None, :, None] + up * y[:, None, None]
    if camera.orthographic_height is not None:
        origins = position + across * camera.orthographic_height
        return origins, np.broadcast_to(forward, origins.shape)
    height_at_1 = 2 * math.tan(math.radians(camera.field_of_view) / 2)
    directions = unit(forward + across * height_at_1)
    return np.broadcast_to(position, directions.shape), directions


def map_of(values, *, srgb: bool = False) -> Map:
    values = np.asarray(values, np.float32)
    return Map(values if values.ndim == 3 else values[:, :, None], srgb, "made up")


def noise(seed: int, shape=(24, 36), channels: int = 3, low=0.2, high=0.9) -> np.ndarray:
    """Smooth periodic noise: a few waves along each axis."""
    random = np.random.default_rng(seed)
    v, u = np.meshgrid(*[(np.arange(n) + 0.5) / n for n in shape], indexing="ij")
    total = np.zeros((*shape, channels))
    for _ in range(5):
        i, j = random.integers(-2, 3, 2)
        phase = random.random(channels)
        total += np.cos(2 * np.pi * (i * u + j * v)[:, :, None] + 2 * np.pi * phase)
    total = (total - total.min()) / (total.max() - total.min())
    return low + (high - low) * total


def uniform_material(color=0.6, height: float | None = None, **maps) -> Material:
    """A material of one colour, and optionally one height."""
    pixels = np.broadcast_to(np.asarray(color, np.float64), 3).reshape(1, 1, 3)
    if height is not None:
        maps["height"] = map_of(np.full((1, 1), height))
    return Material("made up", **{"base_color": map_of(pixels), **maps})


def bilinear(values, uv, edge: str = "wrap") -> np.ndarray:
    """An array's value between texel centres, (…, channels), for uv of (…, 2)."""
    values = np.asarray(values, np.float64)
    values = values if values.ndim == 3 else values[:, :, None]
    count = np.array(values.shape[1::-1])
    position = np.asarray(uv) * count - 0.5
    first = np.floor(position).astype(int)
    fraction = position - first
    total = 0.0
    for x in (0, 1):
        for y in (0, 1):
            texel = first + np.array([x, y])
            texel = texel % count if edge == "wrap" else np.clip(texel, 0, count - 1)
            weight = np.abs(1 - x - fraction[..., 0]) * np.abs(1 - y - fraction[..., 1])
            total = total + weight[..., None] * values[texel[..., 1], texel[..., 0]]
    return total


def on_plane(camera: LookAt, z: float = 0.0, size=SIZE) -> tuple[np.ndarray, np.ndarray]:
    """Texture coordinates and distances at which rays intersect the unit plane at height z."""
    origins, directions = rays(camera, size)
    distance = (z - origins[..., 2]) / directions[..., 2]
    points = origins + directions * distance[..., None]
    return np.stack([0.5 + points[..., 0], 0.5 - points[..., 1]], -1), distance


def matte(obj: Object) -> Object:
    """The object without Phong's highlight."""
    surface = replace(obj.resolved.surface_parameters, specular=Vec3(0.0))
    return replace(obj, surface_parameters=surface)


def drawn(*objects: Object, camera, size=SIZE, device: str = "cpu", **scene) -> Frame:
    return render(Scene(objects, camera=camera, **scene), size=size, samples=1, device=device)
