"""A speckle of dust: a soft, uneven blob in the middle, where a hole is to open."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, smoothstep, to_unit

TILE, DEPTH = 1.2, 0.06
REACH, STRAY = 0.40, 0.2
"""Where the blob ends, in widths of the shorter side, and the share by which that strays: within
the border, which is 0."""


def dust(canvas: Canvas) -> Relief:
    """A heap 1.2 m wide, 6 cm high, frayed at its edge; the grey of the colour is the height."""
    side = min(1.0, canvas.aspect)
    x, y = canvas.x - np.float32(0.5), canvas.y - np.float32(canvas.aspect / 2)
    away = np.hypot(x, y) / np.float32(side)
    lobes = canvas.noise("lobes", 5, octaves=3, gain=0.5)
    specks = canvas.noise("specks", 48, octaves=2, gain=0.7)
    # the noise frays the slope, and dies out before the reach: the border stays 0
    reach = REACH * (1 + STRAY * np.tanh(canvas.noise("reach", 4)))
    rise = np.clip(1 - away / reach, 0, 1)
    frayed = rise + rise * (1 - rise) * np.tanh(0.5 * lobes + 0.12 * specks)
    height = to_unit(frayed * smoothstep(-0.2, 0.3, rise))
    grey = np.repeat(height[:, :, None], 3, axis=2).astype(np.float32)
    roughness = (0.98 - 0.06 * height).astype(np.float32)
    return Relief(height.astype(np.float32), grey, roughness, DEPTH, TILE)
