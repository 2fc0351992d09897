"""A soft, uneven blob of dust in the middle, where a hole opens."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, smoothstep, to_unit

TILE, DEPTH = 1.2, 0.06
REACH, VARIATION = 0.40, 0.2
"""Radius of the blob in lengths of the shorter side, and its relative variation."""


def dust(canvas: Canvas) -> Relief:
    """A heap 1.2 m wide and 6 cm high with a frayed edge; the grey of the colour is the height."""
    side = min(1.0, canvas.aspect)
    x, y = canvas.x - np.float32(0.5), canvas.y - np.float32(canvas.aspect / 2)
    distance = np.hypot(x, y) / np.float32(side)
    lobes = canvas.noise("lobes", 5, octaves=3, gain=0.5)
    specks = canvas.noise("specks", 48, octaves=2, gain=0.7)
    # the noise frays the slope and fades out before the reach, so that the border stays 0
    reach = REACH * (1 + VARIATION * np.tanh(canvas.noise("reach", 4)))
    rise = np.clip(1 - distance / reach, 0, 1)
    frayed = rise + rise * (1 - rise) * np.tanh(0.5 * lobes + 0.12 * specks)
    height = to_unit(frayed * smoothstep(-0.2, 0.3, rise))
    grey = np.repeat(height[:, :, None], 3, axis=2).astype(np.float32)
    roughness = (0.98 - 0.06 * height).astype(np.float32)
    return Relief(height.astype(np.float32), grey, roughness, DEPTH, TILE)
