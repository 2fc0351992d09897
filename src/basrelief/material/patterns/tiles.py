"""A floor of marble octagons and small dots, with thin grooves that coarse marches miss."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.6, 0.012
ACROSS = 4
GROOVE = 0.020
"""Width of a groove, in widths of an octagon: 3 mm, some three texels of 512."""
DOT = 0.30
"""Distance from the corner of a square to the tip of its dot, in widths of an octagon."""
CREAM, SAGE = (0.83, 0.80, 0.74), (0.52, 0.59, 0.53)
SLATE, BRASS = (0.20, 0.21, 0.24), (0.91, 0.78, 0.47)
GROUT = (0.50, 0.47, 0.43)


def tiles(canvas: Canvas) -> Relief:
    """60 cm of floor; the grooves are 3 mm wide and as deep as the whole relief, 12 mm."""
    floor = _Floor(canvas)
    fine = canvas.noise("fine", 96, octaves=2)
    pillow = smoothstep(0.0, 0.03, floor.inside) ** 0.5
    wear = canvas.noise("wear", 6, octaves=4)
    height = mix(0.10 + 0.03 * fine, 0.88 + floor.lift + 0.006 * wear, pillow)
    height = height - 0.25 * floor.crack

    veins = np.abs(canvas.noise("veins", 5, octaves=6, gain=0.55) + floor.tone)
    clouds = canvas.noise("clouds", 8, octaves=5, gain=0.6)
    marble = shade(floor.color, 1 + 0.035 * clouds)
    marble = mix(marble, marble * 0.62, 0.8 * smoothstep(0.16, 0.0, veins))
    color = mix(marble, floor.color, floor.is_dot)
    color = shade(color, (1 + 0.03 * fine) * (1 - 0.6 * floor.crack))
    grout = shade(mix(GROUT, GROUT, floor.is_dot), 1 + 0.10 * fine + 0.05 * wear)
    glazed = smoothstep(0.0, 0.012, floor.inside)
    color = mix(grout, color, glazed)
    roughness = mix(0.92, 0.20 + 0.03 * wear + 0.04 * floor.is_dot + 0.4 * floor.crack, glazed)
    return Relief(height, color, roughness, DEPTH, TILE, metallic=floor.is_brass * glazed)


class _Floor:
    """For each texel, the distance to the groove in widths of an octagon, and its tile's look.

    An octagon is a square whose corners are cut off by the dots, squares that stand on their tips.
    """

    def __init__(self, canvas: Canvas) -> None:
        self.count = (canvas.rows(ACROSS), ACROSS)
        x = canvas.x * ACROSS
        y = canvas.y * (self.count[0] * canvas.width / canvas.height)
        across, down = x - np.floor(x) - 0.5, y - np.floor(y) - 0.5
        to_side = 0.5 - np.maximum(np.abs(across), np.abs(down))
        to_dot = (1 - DOT - np.abs(across) - np.abs(down)) / np.float32(2**0.5)
        dot = to_dot < 0
        self.inside = np.where(dot, -to_dot, np.minimum(to_side, to_dot)) - GROOVE / 2
        self.is_dot = dot.astype(np.float32)
        octagon = self._numbers(x, y)
        corner = self._numbers(x + 0.5, y + 0.5)
        self._draw(canvas, octagon, corner, across, down)
        self._crack(canvas, octagon, across, down)

    def _numbers(self, x: Plane, y: Plane) -> tuple[np.ndarray, np.ndarray]:
        rows, columns = self.count
        return np.floor(y).astype(np.int32) % rows, np.floor(x).astype(np.int32) % columns

    def _draw(
        self,
        canvas: Canvas,
        octagon: tuple[np.ndarray, np.ndarray],
        corner: tuple[np.ndarray, np.ndarray],
        across: Plane,
        down: Plane,
    ) -> None:
        random = canvas.random("octagons")

        def per_octagon(low: float, high: float) -> Plane:
            drawn: Plane = random.uniform(low, high, self.count).astype(np.float32)[octagon]
            return drawn

        tilt = per_octagon(-0.05, 0.05) * across + per_octagon(-0.05, 0.05) * down
        self.lift = np.where(self.is_dot > 0, 0.05, per_octagon(-0.05, 0.05) + tilt).astype(
            np.float32
        )
        self.tone = per_octagon(-0.5, 0.5)
        sage = np.zeros(self.count, bool)
        sage[0, 1] = sage[self.count[0] // 2, 3] = sage[self.count[0] // 2, 0] = True
        light = random.uniform(0.94, 1.05, self.count)[:, :, None]
        colors = np.where(sage[:, :, None], SAGE, CREAM) * light
        brass = random.permutation(sage.size).reshape(self.count) < max(1, sage.size // 5)
        dots = np.where(brass[:, :, None], BRASS, SLATE)
        picked = np.where(self.is_dot[:, :, None] > 0, dots[corner], colors[octagon])
        self.color = picked.astype(np.float32)
        self.is_brass = self.is_dot * brass[corner]

    def _crack(
        self, canvas: Canvas, octagon: tuple[np.ndarray, np.ndarray], across: Plane, down: Plane
    ) -> None:
        """Crack one octagon from side to side."""
        cracked = (octagon[0] == self.count[0] - 1) & (octagon[1] == 1) & (self.is_dot == 0)
        line = across * 0.8 - down * 0.55 + 0.05 + 0.02 * canvas.noise("crack", 12, octaves=4)
        self.crack = smoothstep(0.012, 0.004, np.abs(line)) * cracked
