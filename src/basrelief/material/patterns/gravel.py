"""River gravel: overlapping smooth pebbles of three sizes."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.4, 0.032
SIZES = ((9, 0.54, 0.30), (16, 0.56, 0.16), (30, 0.60, 0.04))
"""Pebbles across, largest radius in grid squares, and base height, largest pebbles first."""
STONES = np.array(
    [
        [0.55, 0.53, 0.50],
        [0.43, 0.43, 0.44],
        [0.68, 0.63, 0.55],
        [0.52, 0.42, 0.35],
        [0.37, 0.38, 0.40],
        [0.74, 0.71, 0.67],
        [0.60, 0.48, 0.39],
    ],
    np.float32,
)
SAND = (0.33, 0.29, 0.24)


def gravel(canvas: Canvas) -> Relief:
    """40 cm of pebbles from 1 to 5 cm, 3 cm from the sand to the top of the highest."""
    heap = _Heap(canvas)
    for across, radius, base in SIZES:
        heap.scatter(across, radius, base)
    grain = canvas.noise("grain", 128, octaves=2, gain=0.8)
    dents = canvas.noise("dents", 24, octaves=4)
    stone = heap.is_stone
    height = heap.height + 0.006 * dents + 0.003 * grain + 0.012 * (1 - stone) * grain
    color = mix(np.asarray(SAND, np.float32), heap.color, stone)
    vein = smoothstep(0.10, 0.0, np.abs(canvas.noise("veins", 7, octaves=4) + heap.tone))
    color = mix(color, (0.82, 0.80, 0.76), 0.55 * vein * stone)
    color = shade(color, 1 + 0.05 * dents + 0.05 * grain)
    color = shade(color, 0.62 + 0.38 * smoothstep(0.0, 0.35, heap.height))
    roughness = mix(0.95, 0.48 + 0.05 * dents + 0.05 * heap.tone, stone)
    return Relief(height, color, roughness, DEPTH, TILE)


class _Heap:
    """The topmost pebble at each texel so far: height, colour and tone (−1 to 1)."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        shape = (canvas.height, canvas.width)
        self.height = (0.03 * canvas.noise("sand", 12, octaves=4) + 0.05).astype(np.float32)
        self.color = np.zeros((*shape, 3), np.float32)
        self.tone = np.zeros(shape, np.float32)
        self.is_stone = np.zeros(shape, np.float32)

    def scatter(self, across: int, radius: float, base: float) -> None:
        """Draw a pebble in each square of a grid, of random position, shape, angle and tilt."""
        down = self.canvas.rows(across)
        random = self.canvas.random(f"pebbles {across}")
        for row in range(down):
            for column in range(across):
                square = np.array([column + row % 2 / 2, row])
                middle = square + random.uniform(0.2, 0.8, 2)
                self._draw_pebble(_Pebble(random, middle / (across, down), radius / across, base))

    def _draw_pebble(self, pebble: _Pebble) -> None:
        middle_x, middle_y = pebble.middle
        window = self.canvas.around(middle_x, middle_y * self.canvas.aspect, pebble.long)
        texels = window.texels
        top = pebble.top(window.x, window.y)
        on_top = top > self.height[texels]
        self.height[texels] = np.where(on_top, top, self.height[texels])
        self.color[texels] = np.where(on_top[:, :, None], pebble.color, self.color[texels])
        self.tone[texels] = np.where(on_top, np.float32(pebble.tone), self.tone[texels])
        self.is_stone[texels] = np.maximum(self.is_stone[texels], on_top)


class _Pebble:
    """A flattened, tilted dome over an ellipse; lengths in widths of the picture."""

    def __init__(
        self, random: np.random.Generator, middle: np.ndarray, radius: float, base: float
    ) -> None:
        self.middle = middle
        self.long = radius * random.uniform(0.72, 1)
        self.short = self.long * random.uniform(0.58, 0.95)
        self.angle = random.uniform(0, np.pi)
        self.base = base + random.uniform(-0.10, 0.10)
        self.tilt = random.uniform(-0.12, 0.12, 2)
        self.tone = random.uniform(-1, 1)
        color = STONES[random.integers(0, len(STONES))] * random.uniform(0.75, 1.15)
        self.color = color.astype(np.float32)

    def top(self, x: Plane, y: Plane) -> Plane:
        """Height of the upper side at offset (x, y) from the middle; below 0 outside."""
        cos, sin = np.float32(np.cos(self.angle)), np.float32(np.sin(self.angle))
        u = (cos * x + sin * y) / np.float32(self.long)
        v = (cos * y - sin * x) / np.float32(self.short)
        square = u * u + v * v
        dome = np.sqrt(np.maximum(1 - square * (0.6 + 0.4 * square), 0))
        lean = np.float32(self.tilt[0]) * u + np.float32(self.tilt[1]) * v
        inside = np.float32(self.base) + np.float32(6 * self.long) * dome + lean
        return np.where(square < 1, inside, np.float32(-1))
