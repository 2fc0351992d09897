"""Bricks in running bond with worn edges, sanded mortar and a few distinctive bricks."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.72, 0.03
ACROSS, DOWN = 3, 9  # bricks of 24 × 8 cm with their joints: close to the common 240 × 71 mm
JOINT = 0.011
ROUNDING = 0.006
PALETTE = np.array(
    [
        [0.60, 0.32, 0.25],
        [0.64, 0.38, 0.29],
        [0.53, 0.28, 0.23],
        [0.69, 0.46, 0.35],
        [0.47, 0.26, 0.23],
        [0.62, 0.36, 0.30],
    ],
    np.float32,
)
BURNT, PALE = (0.29, 0.20, 0.20), (0.78, 0.60, 0.45)
MORTAR = (0.70, 0.66, 0.59)


def bricks(canvas: Canvas) -> Relief:
    """A wall 0.72 m wide; joints 11 mm wide, 3 cm from the deepest joint to the highest brick."""
    wall = _Wall(canvas)
    edge = wall.distance_inside
    grain = canvas.noise("grain", 96, octaves=3, gain=0.7)
    dents = canvas.noise("dents", 14, octaves=5, gain=0.6)
    body = smoothstep(0, 1, np.sqrt(np.clip(edge / ROUNDING, 0, 1)))
    face = 0.80 + wall.lift + 0.022 * dents + 0.010 * grain
    pits = smoothstep(1.5, 2.6, canvas.noise("pits", 48, octaves=2)) * body
    joint = 0.26 + 0.035 * canvas.noise("joint", 20, octaves=3) + 0.028 * grain
    height = joint + (np.maximum(face, joint) - joint) * body - 0.10 * pits

    color = shade(wall.color, 1 + 0.05 * dents + 0.045 * grain - 0.30 * pits)
    bloom = smoothstep(0.6, 2.2, canvas.noise("bloom", 5, octaves=4)) * 0.30
    color = mix(color, (0.80, 0.74, 0.68), bloom * smoothstep(-1.0, 1.0, grain))
    worn = smoothstep(0.010, 0.001, edge) * smoothstep(-0.8, 1.6, dents) * 0.35
    color = mix(color, color * 0.6 + 0.32, worn)
    soot = smoothstep(0.2, 2.0, canvas.noise("soot", 4, octaves=3))
    color = shade(color, 1 - 0.22 * soot)
    mortar = np.asarray(MORTAR, np.float32) * (
        1 + 0.07 * grain + 0.06 * canvas.noise("mortar", 9, octaves=3) - 0.12 * soot
    )[:, :, None].astype(np.float32)
    color = mix(mortar, color, smoothstep(-0.0005, 0.0015, edge))
    roughness = mix(0.95, 0.80 + 0.06 * dents - 0.10 * worn + 0.05 * pits, body)
    return Relief(height, color, roughness, DEPTH, TILE)


class _Wall:
    """For each texel, the distance inside its brick in metres, and the brick's lift and colour."""

    def __init__(self, canvas: Canvas) -> None:
        down = max(2, 2 * round((DOWN + 1) * canvas.height / canvas.width / 2))
        rise = TILE * canvas.height / canvas.width / down
        run = TILE / ACROSS
        row = np.minimum((canvas.y * (TILE / rise)).astype(np.int32), down - 1)
        shift = 0.5 * (np.arange(down) % 2) + canvas.random("rows").uniform(-0.05, 0.05, down)
        along = canvas.x * ACROSS + shift[row].astype(np.float32)
        column = np.floor(along).astype(np.int32) % ACROSS
        self.row, self.column = np.broadcast_arrays(row, column)
        self.random = canvas.random("bricks")
        self.count = (down, ACROSS)
        ripple = 0.0011 * canvas.noise("ripple", 24, octaves=3)
        across_offset = (along - np.floor(along) - 0.5) * run + ripple
        down_offset = (
            canvas.y * TILE - (row + 0.5) * rise + 0.0009 * canvas.noise("sway", 24, octaves=3)
        )
        self._place(canvas, across_offset, down_offset, run, rise)
        self._paint(canvas)

    def draw(self, low: float, high: float) -> Plane:
        """A random number per brick, at each texel."""
        return self.per_brick(self.random.uniform(low, high, self.count))

    def per_brick(self, values: np.ndarray) -> Plane:
        """Values by (row, column) of a brick, at each texel."""
        spread: Plane = values.astype(np.float32)[self.row, self.column]
        return spread

    def _place(self, canvas: Canvas, x: Plane, y: Plane, run: float, rise: float) -> None:
        turn = self.draw(-0.012, 0.012)
        x, y = x + self.draw(-0.002, 0.002) + turn * y, y + self.draw(-0.0012, 0.0012) - turn * x
        half_x = run / 2 - JOINT / 2 - self.draw(0, 0.003)
        half_y = rise / 2 - JOINT / 2 - self.draw(0, 0.0015)
        corner = 0.006
        out_x, out_y = np.abs(x) - half_x + corner, np.abs(y) - half_y + corner
        outside = np.hypot(np.maximum(out_x, 0), np.maximum(out_y, 0))
        inside = corner - outside - np.minimum(np.maximum(out_x, out_y), 0)
        chips = smoothstep(0.7, 2.4, canvas.noise("chips", 18, octaves=3, gain=0.6))
        self.distance_inside = (inside - 0.012 * chips * smoothstep(0.02, 0.0, inside)).astype(
            np.float32
        )
        self.lift = self.draw(-0.05, 0.07) + self.draw(-0.5, 0.5) * x + self.draw(-1.2, 1.2) * y

    def _paint(self, canvas: Canvas) -> None:
        kinds = self.random.integers(0, len(PALETTE), self.count)
        blend = self.random.uniform(0, 1, self.count)[:, :, None]
        colors = PALETTE[kinds] * (1 - blend) + PALETTE[np.roll(kinds, 1)] * blend
        colors *= self.random.uniform(0.88, 1.10, self.count)[:, :, None]
        down = self.count[0]
        for row, column, color, lift in (
            (down // 4, 0, BURNT, 0.10),
            (down // 2, 2, BURNT, -0.02),
            (down * 3 // 4, 1, PALE, -0.22),
        ):
            colors[row, column] = color
            special = (self.row == row) & (self.column == column)
            self.lift = self.lift + np.float32(lift) * special
        self.color = colors.astype(np.float32)[self.row, self.column]
