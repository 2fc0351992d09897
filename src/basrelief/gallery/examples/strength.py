"""Parallax offset at a reasonable strength, and beyond."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Orbit, directional, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.5, field_of_view=34.0)
LIGHTS = (directional(-120.0, 40.0, intensity=2.6),)


def panels(texels: int) -> Iterator[Panel]:
    """The limited offset, from no strength to far too much."""
    for caption, strength in (
        ("no strength", 0.0),
        ("reasonable", 0.03),
        ("the maximum of the article's slider", 0.1),
        ("far beyond it", 0.3),
    ):
        scene = preset("catlike-limited").scene(
            sample("bricks", texels), scale=strength, camera=CAMERA, lights=LIGHTS
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="strength",
    title="Parallax at a reasonable strength, and beyond",
    source="catlike",
    rows={
        "C7": "heights above one half move towards the viewer, lower ones away",
        "C1": "heights are linear, whatever channel they come from: black is low, white is high",
        "C2": "0, 0.03, 0.1 and 0.3; at 0 no height is read",
        "C5": "colour, normals, occlusion and roughness move together",
        "C6": "the offset is V.xy, not divided by V.z",
    },
    look="At 0.03 the bricks get thick sides; at 0.1 their edges are doubled, at 0.3 they are "
    "torn.",
    article="The effect works at low strength only; larger displacements tear the surface apart.",
    ours="The same, with the settings of the preset `catlike-limited`, on bricks. The light comes "
    "from behind them, so the sides that you see are dark.",
    panels=panels,
)
