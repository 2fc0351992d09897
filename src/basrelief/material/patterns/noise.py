"""Smooth fractal noise: broad mountains and valleys, the heights of a landscape."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Relief, to_unit

TILE, DEPTH = 2000.0, 400.0
"""A ratio of a fifth, as in the landscape of E. Nordeus (habrador, *Parallax mapping*)."""


def noise(canvas: Canvas) -> Relief:
    """2 km of hills, 400 m from the lowest to the highest; the grey of the colour is the height.

    The grey's code value, 0 to 1, is the height, as when a height map is opened as a picture.
    """
    broad = canvas.noise("broad", 4, octaves=2, gain=0.45)
    fine = canvas.noise("fine", 12, octaves=6, gain=0.5)
    # peaks are rougher than valleys, which sediment has smoothed
    height = to_unit(broad + 0.16 * fine * (1 + 0.5 * np.tanh(broad)))
    grey = np.repeat(height[:, :, None], 3, axis=2).astype(np.float32)
    roughness = (0.95 - 0.1 * height).astype(np.float32)
    return Relief(height.astype(np.float32), grey, roughness, DEPTH, TILE)
