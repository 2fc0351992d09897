"""Pixel art: each texel of the height map is a column; the map is made from text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from basrelief import Map, Material, Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel

CAMERA = Orbit(azimuth=35.0, elevation=38.0, distance=1.3)
HEIGHTS = """
................
.22222222.......
.2111112...33...
.2111112..3443..
.2113112..3443..
.2111112...33...
.22222222.......
................
....5...........
...555......1111
..55655.....1..1
...555......1.21
....5.......1111
................
..7.7.7.........
................
"""
"""Heights in eighths; a dot is the ground."""
COLORS = {
    0: (0.35, 0.5, 0.2), 1: (0.7, 0.55, 0.35), 2: (0.5, 0.25, 0.15), 3: (0.3, 0.3, 0.35),
    4: (0.85, 0.75, 0.3), 5: (0.2, 0.45, 0.7), 6: (0.9, 0.9, 0.9), 7: (0.6, 0.2, 0.4),
}  # fmt: skip


def art() -> Material:
    """A material of sixteen by sixteen texels, with a colour for each height."""
    rows = HEIGHTS.split()
    steps = [[0 if letter == "." else int(letter) for letter in row] for row in rows]
    colors = np.array([[COLORS[step] for step in row] for row in steps], np.float32)
    heights = np.array(steps, np.float32)[:, :, None] / 8.0
    return Material(
        "pixel art",
        base_color=Map(colors, True, "written down"),
        height=Map(heights, False, "written down"),
    )


def panels(texels: int) -> Iterator[Panel]:
    """Columns, columns with shadows, and the surface that all other techniques draw."""
    choices: tuple[tuple[str, str, Any], ...] = (
        ("texel: a column for each texel", "texel", "none"),
        ("with shadows of the columns", "texel", "hard"),
        ("relief: the bilinear surface through the same heights", "relief", "none"),
    )
    for caption, technique, shadows in choices:
        obj = Object(art(), technique=technique, scale=0.25, edge="clamp")
        yield Panel(caption, Scene((obj,), camera=CAMERA, shadows=shadows))


PAGE = Page(
    name="pixel-art",
    title="Texels as columns",
    source="beyond",
    rows={"B3": "exact traversal of columns; their sides are lit as walls"},
    look="Steps stay steps, and each wall has one shade, by its direction.",
    article="J. Amanatides and A. Woo, 1987, traverse a grid cell by cell and miss none; a height "
    "map is such a grid of columns.",
    ours="Sixteen by sixteen texels. No pixel blends the colours of two texels, and shadows use "
    "the same traversal.",
    panels=panels,
)
