"""E. Nordeus (Habrador), Advanced shaders in Unity, 3: Parallax mapping, in float64.

The shader's names and order are kept. Its y is up, so that positions on the quad are (x, z); here
they are coordinates of the picture, and y stands apart. Colours are filtered to the pixel, where
the article reads the finest level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from articles.maps import Floats, Sampler
from articles.view import Fragments, Lamp, Pixels, dot, to_uv, to_world, unit

STEPS = 300
STEP_DISTANCE = 0.01
NOISE_SIZE = 0.2
TEXTURE_SIZE = 0.4
WATER_LEVEL = 0.4
FLAT_CHORD = 5e-5
"""A ray and a chord that part by less than this over a step meet at a place that the last digits
of the heights move by more than a tenth of the step."""


@dataclass(frozen=True)
class Relief:
    """The height map as getHeight reads it: at `tiling` of the quad's coordinates plus `shift`,
    `depth` high in units of the quad."""

    map: Sampler
    tiling: float
    shift: Floats
    depth: float

    def on_map(self, position: Floats) -> Floats:
        """The coordinates of the map at n positions, (n, 2)."""
        return position * self.tiling + self.shift

    def height(self, position: Floats) -> Floats:
        """getHeight: 0 at the quad, negative below it, (n,)."""
        return (1.0 - self.map.at(self.on_map(position))[:, 0]) * -1.0 * self.depth


@dataclass(frozen=True)
class Hit:
    """The end of n rays: the position on the quad, (n, 2), the ray's y there, whether the terrain
    is hit, and the closest decision."""

    position: Floats
    y: Floats
    found: Floats
    margin: Floats


def march(quad: Fragments, relief: Relief, step_distance: float) -> Hit:
    """The loop of surf with getWeightedTexPos; a ray that hits nothing ends at its last sample."""
    direction = -unit(quad.to_eye)
    across, down = to_uv(direction[:, :2]) * step_distance, direction[:, 2] * step_distance
    position, y = quad.uv, np.zeros(len(direction))
    end, end_y = position, y
    going_on = np.ones(len(y), bool)
    margin = np.full(len(y), np.inf)
    for k in range(STEPS):
        height = relief.height(position)
        hit = going_on & (y < height)
        old, old_y = position - across, y - down
        old_distance = np.abs(relief.height(old) - old_y)
        distance = y - height
        width = old_distance - distance
        weight = np.where(hit, -distance / np.where(hit, width, 1.0), 0.0)
        crossing = old * weight[:, None] + position * (1.0 - weight)[:, None]
        end = np.where(hit[:, None], crossing, np.where(going_on[:, None], position, end))
        end_y = np.where(hit, old_y * weight + y * (1.0 - weight), np.where(going_on, y, end_y))
        flat = np.where(hit & (width < FLAT_CHORD * relief.depth), 0.0, np.inf)
        decided = np.minimum(np.abs(distance) / relief.depth, flat)
        margin = np.where(going_on, np.minimum(margin, decided), margin)
        going_on &= ~hit
        if k < STEPS - 1:
            position, y = position + across, y + down
    return Hit(end, end_y, ~going_on, margin)


def lambert(
    albedo: Floats, normal: Floats, position: Floats, lamps: Sequence[Lamp], ambient: Floats
) -> Floats:
    """The engine's Lambert lighting, (n, 3); `normal` is in the world."""
    total = ambient * albedo
    for lamp in lamps:
        light, color = lamp.at(position)
        total = total + albedo * color * np.maximum(0.0, dot(normal, light))[:, None]
    return total


def landscape(
    quad: Fragments,
    relief: Relief,
    grass: Sampler,
    stone: Sampler,
    lamps: Sequence[Lamp],
    *,
    scrolled: Floats,
    water_color: Floats,
    ambient: Floats,
) -> Pixels:
    """surf. `relief` is scrolled already; `scrolled` is what animateUV adds on the quad."""
    hit = march(quad, relief, STEP_DISTANCE)
    height = relief.height(hit.position)
    grayscale = 1.0 - np.abs(height) / relief.depth
    colors_at = (hit.position + scrolled) * TEXTURE_SIZE
    gradients = quad.gradients * TEXTURE_SIZE
    low, high = grass.grad(colors_at, gradients), stone.grad(colors_at, gradients)
    mixed = low + (high - low) * grayscale[:, None]
    noise = relief.map.at(relief.on_map(hit.position))
    mixed = np.where((grayscale < WATER_LEVEL)[:, None], noise * water_color, mixed)
    final = np.where(hit.found[:, None], mixed, 1.0)
    up = to_world(np.broadcast_to([0.0, 0.0, 1.0], final.shape))
    colors = lambert(final, up, quad.raised(hit.y), lamps, ambient)
    shore = np.where(hit.found, np.abs(grayscale - WATER_LEVEL), np.inf)
    margin = np.minimum(hit.margin, shore)
    return Pixels(relief.on_map(hit.position), colors, hit.y, margin)


def relief_with_normals(
    quad: Fragments,
    relief: Relief,
    step_distance: float,
    color_map: Sampler,
    normal_map: Sampler,
    lamps: Sequence[Lamp],
    *,
    ambient: Floats,
) -> Pixels:
    """Bricks and the hole: the landscape's march over a height map with colours and normals."""
    hit = march(quad, relief, step_distance)
    uv = relief.on_map(hit.position)
    normal = to_world(unit(normal_map.grad(uv, quad.gradients) * 2.0 - 1.0))
    albedo = color_map.grad(uv, quad.gradients)
    colors = lambert(albedo, normal, quad.raised(hit.y), lamps, ambient)
    return Pixels(uv, colors, hit.y, hit.margin)
