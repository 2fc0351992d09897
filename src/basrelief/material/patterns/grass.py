"""A meadow from above: blades of grass in tufts, lying over each other, a few of them dry."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.3, 0.02
TUFTS = 14
"""Tufts across; each has BLADES blades."""
BLADES = 10
WIND = (0.35, -0.2)
"""What bends all blades one way, against a blade's own direction of length 1."""
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
    """The uppermost blade at each texel: its height, its colour, and whether there is one."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        self.random = canvas.random("blades")
        shape = (canvas.height, canvas.width)
        self.height = np.zeros(shape, np.float32)
        self.covered = np.zeros(shape, np.float32)
        self.color = np.zeros((*shape, 3), np.float32)

    def grow(self) -> None:
        """A tuft somewhere in each square of a grid, its blades around it and with the wind."""
        down = self.canvas.rows(TUFTS)
        random = self.random
        finest = 0.7 / self.canvas.width  # a thinner blade would fall between the texels
        for row in range(down):
            for column in range(TUFTS):
                at = (np.array([column, row]) + random.uniform(0, 1, 2)) / (TUFTS, down)
                around = random.uniform(0, 2 * np.pi)
                for blade in range(BLADES):
                    angle = around + (blade + random.uniform(-0.4, 0.4)) * 2 * np.pi / BLADES
                    self._lay(_Blade(random, at * (1, self.canvas.aspect), angle, finest))

    def _lay(self, blade: _Blade) -> None:
        middle, (reach_x, reach_y) = blade.middle, blade.reach
        window = self.canvas.around(middle[0], middle[1], reach_x, reach_y)
        along, across = blade.seen_from_its_root(window.x, window.y)
        inside = np.nonzero((along > 0) & (np.abs(across) < blade.taper(along)))
        # few texels of the window are the blade's: from here on these alone
        rows, columns = window.there[0][inside[0], 0], window.there[1][0, inside[1]]
        along, across = along[inside], across[inside]
        fold = np.abs(across) / blade.taper(along)
        height = np.float32(blade.top) * along * (2 - along) - np.float32(0.06) * fold
        over = height > self.height[rows, columns]
        rows, columns = rows[over], columns[over]
        shine = (0.75 + 0.35 * along) * np.where(across > 0, 1, 0.86)
        self.height[rows, columns] = height[over]
        self.covered[rows, columns] = 1
        self.color[rows, columns] = shine[over, None] * blade.color


class _Blade:
    """A blade that rises from its root and arches over, folded along its middle."""

    def __init__(
        self, random: np.random.Generator, root: np.ndarray, angle: float, finest: float
    ) -> None:
        way = np.array([np.cos(angle) + WIND[0], np.sin(angle) + WIND[1]])
        self.length = random.uniform(0.055, 0.135) * float(np.hypot(*way))
        self.way = (way / np.hypot(*way)).astype(np.float32)
        self.half = max(random.uniform(0.0042, 0.0078), finest)
        self.bend = random.uniform(-0.35, 0.35)
        self.top = random.uniform(0.45, 1.0)
        self.middle = root + self.way * (self.length / 2)
        self.reach = np.abs(self.way) * (self.length / 2) + self.half
        self.reach += np.abs(self.way[::-1]) * abs(self.bend) * self.length
        color = GREENS[random.integers(0, len(GREENS))] * random.uniform(0.75, 1.2)
        dry = random.random() < 0.07
        self.color = (np.multiply(DRY, 0.95) if dry else color).astype(np.float32)

    def seen_from_its_root(self, x: Plane, y: Plane) -> tuple[Plane, Plane]:
        """From (x, y) counted from its middle: the share of its length, and how far beside it."""
        right, down = self.way
        x, y = x + right * np.float32(self.length / 2), y + down * np.float32(self.length / 2)
        along = (right * x + down * y) / np.float32(self.length)
        across = right * y - down * x - np.float32(self.bend * self.length) * along * along
        return along, across

    def taper(self, along: Plane) -> Plane:
        """Half its width, which goes to 0 at the tip."""
        taper: Plane = np.float32(self.half) * np.sqrt(np.maximum(1 - along, 0))
        return taper
