"""Bare rock of a mountainside: broken into blocks and ledges, weathered, with lichen on it."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, mix, shade, smoothstep
from basrelief.material.patterns.cells import cells

TILE, DEPTH = 2.0, 0.16
BLOCKS, CHIPS = 5, 17
GREY, WARM, DARK = (0.57, 0.56, 0.55), (0.60, 0.56, 0.51), (0.30, 0.28, 0.28)
LICHEN, PALE = (0.57, 0.56, 0.43), (0.70, 0.69, 0.65)


def stone(canvas: Canvas) -> Relief:
    """2 m of rock, 16 cm from the deepest cleft to the highest ledge."""
    block = cells(canvas, "blocks", BLOCKS, jitter=0.48, roundness=0.02)
    chip = cells(canvas, "chips", CHIPS, jitter=0.48, roundness=0.02)
    rough = canvas.noise("rough", 8, octaves=7, gain=0.55)
    grain = canvas.noise("grain", 96, octaves=3, gain=0.8)
    swell = canvas.noise("swell", 3, octaves=2)

    facets = block.draw(-0.20, 0.20) + block.draw(-0.45, 0.45) * block.x
    facets += block.draw(-0.45, 0.45) * block.y
    flakes = chip.draw(-0.05, 0.05) + chip.draw(-0.14, 0.14) * chip.x
    flakes += chip.draw(-0.14, 0.14) * chip.y
    worn = smoothstep(-0.8, 0.8, canvas.noise("worn", 6, octaves=3))
    # blocks slope towards their clefts; the strength of the clefts varies
    cleft = smoothstep(0.11, 0.0, block.border + 0.02 * rough) * (0.25 + 0.75 * worn)
    height = 0.10 * swell + facets + flakes * (1 - 0.4 * worn) + 0.05 * rough + 0.010 * grain
    height -= 0.30 * cleft + 0.06 * smoothstep(0.12, 0.0, chip.border) * worn

    layers = canvas.noise("layers", 8, octaves=5, gain=0.65)
    color = mix(GREY, WARM, smoothstep(-0.2, 1.2, layers + block.draw(-0.9, 0.9)))
    color = shade(color, 1 + 0.06 * rough + 0.08 * grain + chip.draw(-0.10, 0.10))
    seam = smoothstep(0.045, 0.0, block.border) * (0.25 + 0.75 * worn)
    hollow = smoothstep(0.3, 1.8, -rough) + 0.6 * smoothstep(0.05, 0.0, chip.border) * worn
    color = mix(color, DARK, np.clip(0.75 * seam + 0.35 * hollow, 0, 0.85))
    spots = canvas.noise("spots", 28, octaves=4, gain=0.75)
    grown = smoothstep(1.0, 1.35, spots + 0.6 * canvas.noise("grown", 3, octaves=2)) * (1 - seam)
    color = mix(color, mix(LICHEN, PALE, smoothstep(-0.2, 0.6, layers)), 0.55 * grown)
    roughness = 0.86 + 0.04 * grain + 0.05 * grown
    return Relief(height, color, np.clip(roughness, 0.3, 1), DEPTH, TILE)
