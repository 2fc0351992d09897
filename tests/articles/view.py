"""A camera over a lying quad in float64: what a rasterizer hands to the fragment shader.

The quad is the unit square in object space, x along u, y against v and z up; the world has x to the
right, y up, and the picture's top towards −z. Texture coordinates run from the top left corner.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from articles.maps import Floats


@dataclass(frozen=True)
class Eye:
    """A perspective camera: positions in the world, and the vertical angle in degrees."""

    position: tuple[float, float, float]
    target: tuple[float, float, float]
    angle: float


@dataclass(frozen=True)
class Fragments:
    """The n pixels that show the quad.

    `shown` says which they are, (rows, columns). `uv` are coordinates on the quad, (n, 2), and
    `gradients` their change per pixel to the right and down, (2, n, 2). `to_eye` goes from the
    point to the camera in object space, (n, 3), whose axes are the tangent space's. `position` and
    `camera` are in the world; `depth` is the length of object space's z there.
    """

    shown: NDArray[np.bool_]
    uv: Floats
    gradients: Floats
    to_eye: Floats
    position: Floats
    camera: Floats
    depth: float

    @property
    def view(self) -> Floats:
        """Unit vectors to the camera in the world, (n, 3)."""
        return unit(self.camera - self.position)

    def raised(self, height: Floats) -> Floats:
        """The points of the view rays at n heights above the quad in object space, (n, 3)."""
        away = self.camera - self.position
        return self.position + away * (height * self.depth / away[:, 1])[:, None]


@dataclass(frozen=True)
class Pixels:
    """The results of a fragment shader for n pixels: the displaced coordinates of the maps,
    (n, 2), linear colours, (n, 3), and the hit's height over the quad in object space, (n,).

    `margin`, (n,), is by how much the closest comparison on the way was decided; infinite where
    there is none.
    """

    uv: Floats
    colors: Floats
    height: Floats
    margin: Floats


def fragments(eye: Eye, size: tuple[int, int], proportion: float) -> Fragments:
    """The fragments of a quad of `proportion` = width ÷ height, its longer side of length 1."""
    columns, rows = size
    camera = np.array(eye.position)
    forward = unit(np.array(eye.target) - camera)
    right = unit(np.cross(forward, [0.0, 1.0, 0.0]))
    down = np.cross(forward, right)
    half = np.tan(np.radians(eye.angle) / 2.0)
    extent = np.array([min(proportion, 1.0), min(1.0 / proportion, 1.0)])

    def position_of(x: Floats, y: Floats) -> Floats:
        across, along = (2 * x - columns) / rows * half, (2 * y - rows) / rows * half
        direction = forward + across[..., None] * right + along[..., None] * down
        return camera - direction * (camera[1] / direction[..., 1])[..., None]

    def uv_of(x: Floats, y: Floats) -> Floats:
        return position_of(x, y)[..., [0, 2]] / extent + 0.5

    y, x = np.mgrid[0:rows, 0:columns] + 0.5
    uv = uv_of(x, y)
    shown = (uv.min(-1) >= 0.0) & (uv.max(-1) <= 1.0)
    step = 1e-3
    gradients = np.stack(
        [
            uv_of(x + step, y) - uv_of(x - step, y),
            uv_of(x, y + step) - uv_of(x, y - step),
        ]
    ) / (2 * step)
    position = position_of(x, y)[shown]
    depth = float(extent[0])
    x_world, y_world, z_world = (camera - position).T
    to_eye = np.stack([x_world / extent[0], -z_world / extent[1], y_world / depth], -1)
    return Fragments(shown, uv[shown], gradients[:, shown], to_eye, position, camera, depth)


def to_uv(offset: Floats) -> Floats:
    """An offset along the quad's x and y in coordinates of the picture, whose v points down."""
    return offset * (1.0, -1.0)


def to_world(normal: Floats) -> Floats:
    """Unit normals of tangent space in the world: the articles' matrix of tangent, bitangent and
    normal, which all have unit length."""
    x, y, z = normal.T
    return unit(np.stack([x, z, -y], -1))


def unit(vector: Floats) -> Floats:
    """Vectors divided by their length."""
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def dot(a: Floats, b: Floats) -> Floats:
    """Products of n pairs of vectors, (n,)."""
    return (a * b).sum(-1)


# --- lights ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Lamp:
    """A light. Without `falloff` it is directional, and `place` its direction from the surface;
    else it is at `place`, and divided by distance to the power of `falloff`."""

    place: tuple[float, float, float]
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    falloff: float | None = None

    def at(self, position: Floats) -> tuple[Floats, Floats]:
        """Unit directions to the light from n points, (n, 3), and its colour there, (n, 3)."""
        color = np.broadcast_to(self.color, position.shape)
        if self.falloff is None:
            return np.broadcast_to(unit(np.array(self.place)), position.shape), color
        offset = np.array(self.place) - position
        distance = np.linalg.norm(offset, axis=-1, keepdims=True)
        return offset / distance, color / distance**self.falloff


def sun(azimuth: float, elevation: float, color: tuple[float, float, float]) -> Lamp:
    """A directional light by angles in degrees: azimuth 0 is +z, 90 is +x."""
    a, e = np.radians([azimuth, elevation])
    place = (np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e))
    return Lamp((float(place[0]), float(place[1]), float(place[2])), color)
