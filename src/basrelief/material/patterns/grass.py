"""A meadow from above: overlapping blades of grass in tufts, a few of them dry."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.3, 0.02
TUFTS = 14
"""Tufts across; each has BLADES blades."""
BLADES = 10
WIND = (0.35, -0.2)
"""Common bend of all blades, relative to a blade's own direction of length 1."""
GREENS = np.array(
    [[0.37, 0.50, 0.18], [0.44, 0.56, 0.22], [0.31, 0.43, 0.16], [0.51, 0.59, 0.27]], np.float32
)
DRY, SOIL = (0.68, 0.61, 0.37), (0.25, 0.27, 0.14)


def grass(canvas: Canvas) -> Relief:
    """30 cm of turf, 2 cm from the soil to the tips of the blades."""
    meadow = _Meadow(canvas)
    meadow.grow()
    patches = canvas.noise("patches", 3, octaves=4)
    grain = canvas.noise("grain", 128, octaves=2)
    soil = shade(mix(SOIL, SOIL, meadow.covered), 1 + 0.15 * grain)
    color = mix(soil, meadow.color, meadow.covered)
    color = shade(color, 0.55 + 0.45 * smoothstep(0.05, 0.75, meadow.height))
    color = shade(color, 1 + 0.06 * patches)
    yellow = smoothstep(0.2, 1.8, canvas.noise("yellow", 4, octaves=3))
    color = mix(color, color * np.array([1.22, 1.08, 0.85], np.float32), 0.6 * yellow)
    height = meadow.height + 0.02 * grain * (1 - meadow.covered) + 0.04 * patches
    roughness = mix(0.95, 0.62 + 0.06 * grain, meadow.covered)
    return Relief(height, color, roughness, DEPTH, TILE)


class _Meadow:
    """The topmost blade at each texel: height, colour, and coverage."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        self.random = canvas.random("blades")
        shape = (canvas.height, canvas.width)
        self.height = np.zeros(shape, np.float32)
        self.covered = np.zeros(shape, np.float32)
        self.color = np.zeros((*shape, 3), np.float32)

    def grow(self) -> None:
        """Grow a tuft in each square of a grid, with blades all around it, bent by the wind."""
        down = self.canvas.rows(TUFTS)
        random = self.random
        finest = 0.7 / self.canvas.width  # a thinner blade would miss the texel centres
        for row in range(down):
            for column in range(TUFTS):
                at = (np.array([column, row]) + random.uniform(0, 1, 2)) / (TUFTS, down)
                around = random.uniform(0, 2 * np.pi)
                for blade in range(BLADES):
                    angle = around + (blade + random.uniform(-0.4, 0.4)) * 2 * np.pi / BLADES
                    self._draw_blade(_Blade(random, at * (1, self.canvas.aspect), angle, finest))

    def _draw_blade(self, blade: _Blade) -> None:
        middle, (reach_x, reach_y) = blade.middle, blade.reach
        window = self.canvas.around(middle[0], middle[1], reach_x, reach_y)
        along, across = blade.to_blade_coordinates(window.x, window.y)
        inside = np.nonzero((along > 0) & (np.abs(across) < blade.taper(along)))
        # the blade covers few texels of its window: continue with these alone
        rows, columns = window.texels[0][inside[0], 0], window.texels[1][0, inside[1]]
        along, across = along[inside], across[inside]
        fold = np.abs(across) / blade.taper(along)
        height = np.float32(blade.top) * along * (2 - along) - np.float32(0.06) * fold
        on_top = height > self.height[rows, columns]
        rows, columns = rows[on_top], columns[on_top]
        shine = (0.75 + 0.35 * along) * np.where(across > 0, 1, 0.86)
        self.height[rows, columns] = height[on_top]
        self.covered[rows, columns] = 1
        self.color[rows, columns] = shine[on_top, None] * blade.color


class _Blade:
    """A blade that rises from its root and arches over, folded along its middle."""

    def __init__(
        self, random: np.random.Generator, root: np.ndarray, angle: float, finest: float
    ) -> None:
        direction = np.array([np.cos(angle) + WIND[0], np.sin(angle) + WIND[1]])
        self.length = random.uniform(0.055, 0.135) * float(np.hypot(*direction))
        self.direction = (direction / np.hypot(*direction)).astype(np.float32)
        self.half = max(random.uniform(0.0042, 0.0078), finest)
        self.bend = random.uniform(-0.35, 0.35)
        self.top = random.uniform(0.45, 1.0)
        self.middle = root + self.direction * (self.length / 2)
        self.reach = np.abs(self.direction) * (self.length / 2) + self.half
        self.reach += np.abs(self.direction[::-1]) * abs(self.bend) * self.length
        color = GREENS[random.integers(0, len(GREENS))] * random.uniform(0.75, 1.2)
        dry = random.random() < 0.07
        self.color = (np.multiply(DRY, 0.95) if dry else color).astype(np.float32)

    def to_blade_coordinates(self, x: Plane, y: Plane) -> tuple[Plane, Plane]:
        """Fraction along the blade and offset across it, of (x, y) relative to its middle."""
        right, down = self.direction
        x, y = x + right * np.float32(self.length / 2), y + down * np.float32(self.length / 2)
        along = (right * x + down * y) / np.float32(self.length)
        across = right * y - down * x - np.float32(self.bend * self.length) * along * along
        return along, across

    def taper(self, along: Plane) -> Plane:
        """Half the width, which falls to 0 at the tip."""
        taper: Plane = np.float32(self.half) * np.sqrt(np.maximum(1 - along, 0))
        return taper
