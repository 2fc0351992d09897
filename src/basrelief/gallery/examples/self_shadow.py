"""The relief's shadow on itself: none, hard and soft."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from basrelief import Object, Orbit, Scene, directional
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=40.0, distance=0.85, field_of_view=38.0)
LIGHTS = (directional(-70.0, 22.0, intensity=2.6),)


def panels(texels: int) -> Iterator[Panel]:
    """The same stones in a low light."""
    kinds: tuple[Literal["none", "hard", "soft"], ...] = ("none", "hard", "soft")
    for shadows in kinds:
        obj = Object(sample("cobbles", texels), technique="relief", scale=0.12)
        scene = Scene(
            (obj,),
            camera=CAMERA,
            lights=LIGHTS,
            shadows=shadows,
            shadowing={"shadow_steps": 24},
        )
        yield Panel("no shadow" if shadows == "none" else f"{shadows} shadow", scene)


PAGE = Page(
    name="self-shadow",
    title="Hard and soft self-shadows",
    source="halliwell",
    rows={
        "H3": "from the hit on towards the light: anything in the way, or how much",
    },
    look="Long shadows lie across the stones; the soft ones fade out at their far end.",
    article="Marching on from the hit towards the light tells whether the light gets there.",
    ours="The same, and a soft form. The reads count the way to the light too.",
    panels=panels,
)
