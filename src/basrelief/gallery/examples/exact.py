"""Features that marches miss: posts and a wall, one texel wide, at a grazing angle."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Any

import numpy as np

from basrelief import Map, Material, Object, Orbit, Scene, directional, placed
from basrelief.gallery.page import Page, Panel
from basrelief.scene import LYING

TEXELS = 64
POSTS = 84
CAMERA = Orbit(
    azimuth=24.0, elevation=13.0, distance=0.72, target=(0.0, -0.1, 0.0), field_of_view=34.0
)
GROUND_PLAN: Any = {
    "transform": placed((0.48, 0.0, 0.58)) @ LYING @ placed(scale=(4.0, 4.0, 4.0)),
    "tiling": (4.0, 4.0),
}
"""Four by four tiles of width 1, with one spiral in the middle of the picture."""
LIGHT = directional(-70.0, 38.0, intensity=2.2)
MIDDLE, END = (0.95, 0.42, 0.04), (0.6, 0.03, 0.2)
"""The colours of the posts in the middle of the spiral and at its end."""
GROUND, WALL = (0.02, 0.09, 0.11), (0.25, 0.55, 0.4)


@functools.cache
def posts() -> Material:
    """Posts of one texel along a spiral, and a wall as thin, on uneven ground."""
    rows, columns = np.mgrid[0:TEXELS, 0:TEXELS] / TEXELS * 2.0 * np.pi
    heights = 0.05 + 0.04 * np.sin(columns + 0.7) * np.cos(2.0 * rows)
    colors = np.full((TEXELS, TEXELS, 3), GROUND)
    for share in np.linspace(0.0, 1.0, 4 * TEXELS):
        row, column = int(TEXELS * (0.86 - 0.1 * np.sin(5.0 * share))), int(TEXELS * share)
        heights[row, column % TEXELS] = 0.38
        colors[row, column % TEXELS] = WALL
    for number in range(POSTS):
        share = number / POSTS
        # the golden angle, so that no post hides another
        angle, radius = number * np.pi * (3.0 - np.sqrt(5.0)), 0.36 * np.sqrt(share)
        column = int(TEXELS * (0.52 + radius * np.cos(angle)))
        row = int(TEXELS * (0.42 + radius * np.sin(angle)))
        heights[row, column] = 0.45 + 0.5 * np.cos(2.6 * share) ** 2
        colors[row, column] = np.array(MIDDLE) * (1.0 - share) + np.array(END) * share
    return Material(
        "posts",
        base_color=Map(colors.astype(np.float32), False, "written down"),
        height=Map(heights.astype(np.float32)[:, :, None], False, "written down"),
    )


def panels(texels: int) -> Iterator[Panel]:
    """The same posts by two marches and by `exact`."""
    steps: dict[str, float] = {"min_steps": 32, "max_steps": 32}
    choices: tuple[tuple[str, str, dict[str, float]], ...] = (
        ("parallax_occlusion, 32 steps", "parallax_occlusion", steps),
        ("relief, 32 steps and 5 halvings", "relief", {**steps, "search_steps": 5}),
        ("exact", "exact", {}),
    )
    for caption, technique, settings in choices:
        obj = Object(posts(), technique=technique, settings=settings, scale=0.2, **GROUND_PLAN)
        yield Panel(caption, Scene((obj,), camera=CAMERA, lights=(LIGHT,)), "64 texels a side")


PAGE = Page(
    name="exact",
    title="Features that marches miss",
    source="beyond",
    rows={
        "B1": "the first intersection of a ray with the bilinear surface, however thin the feature",
    },
    look="Marches cut the posts and the wall behind them into floating slices; with exact each is "
    "whole up to its tip.",
    article="F. Policarpo, M. M. Oliveira and J. L. D. Comba, 2005, march in even steps and then "
    "halve the last one: thin features may lie between two steps.",
    ours="A step, one of 32, is a texel and a half near the camera and many texels far away; posts "
    "and wall are one texel wide. So a third of all pixels show the ground behind them, after 29 "
    "reads by parallax_occlusion and 34 by relief. Halving refines hits but finds no missed ones. "
    "exact takes 61 reads, as rays travel far between the posts and it leaves out no cell.",
    panels=panels,
)
