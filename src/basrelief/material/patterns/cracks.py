"""Plaster with deep branching cracks from its middle that thin out towards the border."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, mix, shade, smoothstep
from basrelief.material.patterns.cells import cells

TILE, DEPTH = 1.2, 0.06
RAYS = 8
STEP = 0.022
"""Length of a straight segment of a crack, in lengths of the shorter side."""
REACH = 0.44
"""Distance from the middle at which the longest crack ends; the border stays intact."""
WIDTH = 0.016
"""Half the width of a crack at the middle."""
SHARDS = 15
PLASTER, WARM = (0.72, 0.69, 0.63), (0.66, 0.59, 0.50)
INSIDE = (0.22, 0.18, 0.15)


def cracks(canvas: Canvas) -> Relief:
    """1.2 m of plastered ground, 6 cm from the bottom of the deepest crack to the surface."""
    crack = _Cracks(canvas)
    crack.grow()
    x, y = canvas.x - np.float32(0.5), canvas.y - np.float32(canvas.aspect / 2)
    distance = np.hypot(x, y) / np.float32(crack.side)
    near = smoothstep(0.34, 0.05, distance)
    shard = cells(canvas, "shards", SHARDS, jitter=0.45, roundness=0.01)
    broken = smoothstep(0.30, 0.06, distance) * smoothstep(-0.7, 0.5, canvas.noise("broken", 9))
    seam = 0.75 * broken * smoothstep(0.10, 0.0, shard.border)
    fine = canvas.noise("fine", 96, octaves=2, gain=0.7)
    trowel = canvas.noise("trowel", 7, octaves=5, gain=0.5)

    sunk = np.maximum(crack.depth, seam)
    settled = near * (0.10 + shard.draw(0, 0.16) + shard.draw(-0.1, 0.1) * shard.x)
    height = 1 - sunk - settled * (1 - sunk) + 0.012 * trowel + 0.008 * fine

    color = mix(PLASTER, WARM, smoothstep(-0.4, 1.8, canvas.noise("stains", 4, octaves=5)))
    color = shade(color, 1 + 0.035 * trowel + 0.030 * fine)
    color = shade(color, 1 + near * shard.draw(-0.06, 0.04))
    grime = smoothstep(0.25, 0.80, sunk)
    color = mix(color, INSIDE, 0.75 * grime)
    roughness = 0.90 + 0.04 * fine * (1 - grime) - 0.03 * trowel
    return Relief(height, color, np.clip(roughness, 0.5, 1), DEPTH, TILE)


class _Cracks:
    """Depth of the cracks at each texel, 0 to 1: V-shaped, deepest on their centre lines."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        self.side = min(1.0, canvas.aspect)
        self.random = canvas.random("cracks")
        self.depth = np.zeros((canvas.height, canvas.width), np.float32)

    def grow(self) -> None:
        """Grow cracks from the middle in all directions, with their branches."""
        start = self.random.uniform(0, 2 * np.pi)
        for ray in range(RAYS):
            angle = start + (ray + self.random.uniform(-0.3, 0.3)) * 2 * np.pi / RAYS
            self._grow_crack((0.0, 0.0), angle, self.random.uniform(0.75, 1.0), 2)

    def _grow_crack(
        self, position: tuple[float, float], angle: float, life: float, branches: int
    ) -> None:
        """Grow one crack, segment by segment; `life` is its remaining strength."""
        heading = angle
        while life > 0.02 and np.hypot(*position) < REACH:
            heading += self.random.normal(0, 0.42)
            heading += 0.35 * (angle - heading)  # wander about a mean direction
            end = (position[0] + STEP * np.cos(heading), position[1] + STEP * np.sin(heading))
            self._segment(position, end, life * min(1.0, 4 * (1 - np.hypot(*position) / REACH)))
            if branches and self.random.random() < 0.16:
                side = self.random.choice([-1, 1]) * self.random.uniform(0.45, 0.95)
                self._grow_crack(
                    end, heading + side, life * self.random.uniform(0.4, 0.75), branches - 1
                )
            position = end
            life -= STEP * self.random.uniform(1.2, 2.4)

    def _segment(
        self, start_point: tuple[float, float], end: tuple[float, float], strength: float
    ) -> None:
        x = 0.5 + start_point[0] * self.side
        y = self.canvas.aspect / 2 + start_point[1] * self.side
        width = self.canvas.softness(WIDTH * self.side * (0.25 + 0.75 * max(strength, 0)))
        window = self.canvas.around(x, y, width + STEP * self.side)
        distance = window.to_segment(
            (end[0] - start_point[0]) * self.side, (end[1] - start_point[1]) * self.side
        )
        profile = np.clip(1 - distance / np.float32(width), 0, 1)
        depth = np.float32(0.15 + 0.85 * max(strength, 0)) * profile
        self.depth[window.texels] = np.maximum(self.depth[window.texels], depth)
