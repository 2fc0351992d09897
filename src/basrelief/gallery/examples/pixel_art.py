"""Pixel art: each texel of the height map a box of its own, drawn from a picture of letters."""

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
"""Eighths of the whole height; a dot is the ground."""
COLORS = {
    0: (0.35, 0.5, 0.2), 1: (0.7, 0.55, 0.35), 2: (0.5, 0.25, 0.15), 3: (0.3, 0.3, 0.35),
    4: (0.85, 0.75, 0.3), 5: (0.2, 0.45, 0.7), 6: (0.9, 0.9, 0.9), 7: (0.6, 0.2, 0.4),
}  # fmt: skip


def art() -> Material:
    """Sixteen texels by sixteen, a colour for each height."""
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
    """Boxes, boxes with shadows, and the surface that all other techniques draw."""
    choices: tuple[tuple[str, str, Any], ...] = (
        ("texel: a box for each texel", "texel", "none"),
        ("its shadows, which are those of boxes", "texel", "hard"),
        ("relief: the bilinear surface through the same heights", "relief", "none"),
    )
    for caption, technique, shadows in choices:
        obj = Object(art(), technique=technique, scale=0.25, edge="clamp")
        yield Panel(caption, Scene((obj,), camera=CAMERA, shadows=shadows))


PAGE = Page(
    name="pixel-art",
    title="Each texel a box",
    source="beyond",
    rows={"B3": "a walk from box to box, exact; the side of a box is lit as a wall"},
    look="Steps stay steps, and each wall has one shade by where it faces.",
    article="J. Amanatides and A. Woo, 1987, walk a grid cell by cell and miss none; a height map "
    "of pixels is such a grid, of columns.",
    ours="Sixteen texels a side. No pixel mixes two texels' colours, and shadows are found by the "
    "same walk.",
    panels=panels,
)
