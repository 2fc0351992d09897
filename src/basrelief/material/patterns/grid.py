"""A detail grid: thin dark lines on light grey that make a relief easy to read."""

from __future__ import annotations

import numpy as np

from basrelief.images import srgb_decode, srgb_encode
from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.1, 0.0004
ACROSS = 2
HEAVY, LIGHT = 0.020, 0.009
"""Half widths of the lines around and within the tile, in widths of the tile."""
NOTCH = (0.26, 0.10)
"""Sides of the triangle in each cell's corner, along x and y, in widths of the tile."""
INK, PAPER = 0.16, 0.80
MEAN = 0.214041
"""sRGB 0.5 as a linear value: the neutral grey of a detail map."""


def grid(canvas: Canvas) -> Relief:
    """Cells of 5 cm with a filled upper left corner, which reveals mirrored maps.

    A detail map: colour and fine normals only. The colour averages to middle grey, so that a second
    layer keeps the brightness below it.
    """
    ink = np.maximum(_lines(canvas), _notches(canvas))
    grain = canvas.noise("grain", 64, octaves=2)
    color = mix((PAPER,) * 3, (INK,) * 3, ink)
    color = shade(color, 1 + 0.02 * grain * (1 - ink))
    color = srgb_encode(_with_mean(srgb_decode(color))).astype(np.float32)
    height = 0.06 * grain - ink
    return Relief(height, color, np.full_like(ink, 0.7), DEPTH, TILE, detail=True)


def _lines(canvas: Canvas) -> Plane:
    down = canvas.rows(ACROSS)
    soft = canvas.softness(0.006) / 2
    lines = []
    for at, count, length in (
        (canvas.x, ACROSS, 1.0),
        (canvas.y, down, canvas.aspect),
    ):
        place = at / np.float32(length)
        to_edge = np.abs(place - np.round(place)) * np.float32(length)
        cell = place * np.float32(count)
        to_line = np.abs(cell - np.round(cell)) * np.float32(length / count)
        heavy = smoothstep(HEAVY + soft, HEAVY - soft, to_edge)
        light = smoothstep(LIGHT + soft, LIGHT - soft, to_line)
        lines.append(np.maximum(heavy, light))
    return np.maximum(*lines)


def _notches(canvas: Canvas) -> Plane:
    """A triangle in each cell's upper left corner, with a gap to the lines."""
    down = canvas.rows(ACROSS)
    soft = canvas.softness(0.006) / 2
    x = (canvas.x * ACROSS % 1) / ACROSS - np.float32(2.6 * HEAVY)
    y = canvas.y * np.float32(down / canvas.aspect) % 1 * np.float32(canvas.aspect / down)
    y = y - np.float32(2.6 * HEAVY)
    across, down_by = NOTCH
    slope = (1 - x / np.float32(across) - y / np.float32(down_by)) / np.float32(
        np.hypot(1 / across, 1 / down_by)
    )
    inside = np.minimum(np.minimum(x, y), slope)
    return smoothstep(-soft, soft, inside)


def _with_mean(light: np.ndarray) -> np.ndarray:
    """Linear greys scaled to the mean `MEAN`, clamped to 0…1."""
    factor = 1.0
    for _ in range(4):  # clipping lowers the mean, so iterate
        factor *= MEAN / float(np.clip(light * factor, 0, 1).mean())
    return np.clip(light * factor, 0, 1)
