"""Granite cobbles in sand, with moss in the joints where it stays damp."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, mix, shade, smoothstep
from basrelief.material.patterns.cells import Cells, cells

TILE, DEPTH = 1.0, 0.06
ACROSS = 8
STONES = np.array(
    [[0.50, 0.50, 0.51], [0.58, 0.56, 0.54], [0.42, 0.43, 0.46], [0.60, 0.55, 0.49]],
    np.float32,
)
RED = np.array([0.58, 0.41, 0.36], np.float32)
SAND, MOSS = (0.44, 0.39, 0.32), (0.31, 0.38, 0.17)


def cobbles(canvas: Canvas) -> Relief:
    """A square metre of 12 cm stones, 6 cm from the deepest joint to the highest stone."""
    stone = cells(canvas, "stones", ACROSS, jitter=0.22, roundness=0.05)
    grain = canvas.noise("grain", 128, octaves=2, gain=0.8)
    dents = canvas.noise("dents", 20, octaves=4)
    patches = canvas.noise("patches", 3, octaves=3)
    inside = np.clip((stone.border - 0.035 + 0.012 * dents) / 0.30, 0, 1)
    dome = np.sqrt(1 - (1 - inside) ** 2)
    top = 0.72 + stone.draw(-0.12, 0.12)
    top += stone.draw(-0.18, 0.18) * stone.x + stone.draw(-0.18, 0.18) * stone.y
    damp = smoothstep(0.1, 1.1, patches)
    bed = 0.20 + 0.03 * canvas.noise("sand", 24, octaves=4, gain=0.7) + 0.02 * grain
    moss = damp * smoothstep(0.16, 0.02, inside) * smoothstep(-1.2, 0.6, dents)
    bed = bed + 0.16 * moss * (1 + 0.5 * canvas.noise("cushions", 48, octaves=2))
    carved = (top - 0.1) * dome + 0.022 * dents * dome + 0.006 * grain + 0.1
    height = np.maximum(carved, bed)

    color = shade(_stones(stone), 1 + 0.05 * dents + 0.02 * patches)
    speckle = canvas.noise("speckle", 160, octaves=2, gain=1.0)
    color = mix(color, (0.20, 0.20, 0.21), 0.55 * smoothstep(1.1, 1.9, speckle))
    color = mix(color, (0.86, 0.83, 0.80), 0.40 * smoothstep(1.2, 2.0, -speckle))
    color = mix(color, color * 0.5 + 0.40, 0.25 * smoothstep(0.5, 1.0, inside))
    ground = mix(SAND, MOSS, moss)
    ground = shade(ground, 1 + 0.14 * grain + 0.05 * dents)
    buried = smoothstep(-0.015, 0.02, carved - bed)
    color = mix(ground, color, buried)
    roughness = mix(0.96, 0.62 + 0.06 * dents - 0.14 * inside, buried)
    return Relief(height, color, roughness, DEPTH, TILE)


def _stones(stone: Cells) -> np.ndarray:
    """A colour of its own for each stone; one in twelve is red granite."""
    kind = stone.random.integers(0, len(STONES), stone.count)
    colors = STONES[kind] * stone.random.uniform(0.82, 1.12, stone.count)[:, :, None]
    colors[stone.random.uniform(0, 1, stone.count) < 1 / 12] = RED
    return stone.per_cell(colors)
