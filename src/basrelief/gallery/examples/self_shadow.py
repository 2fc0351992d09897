"""Self-shadows of a relief: none, hard and soft."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from basrelief import Object, Orbit, Scene, directional
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=40.0, distance=0.85, field_of_view=38.0)
LIGHTS = (directional(-70.0, 22.0, intensity=2.6),)


def panels(texels: int) -> Iterator[Panel]:
    """The same stones in a low light, with three kinds of self-shadow."""
    kinds: tuple[Literal["none", "hard", "soft"], ...] = ("none", "hard", "soft")
    for shadows in kinds:
        obj = Object(sample("cobbles", texels), technique="relief", scale=0.12)
        scene = Scene(
            (obj,),
            camera=CAMERA,
            lights=LIGHTS,
            shadows=shadows,
            shadowing={"max_shadow_steps": 24},
        )
        yield Panel("no shadow" if shadows == "none" else f"{shadows} shadow", scene)


PAGE = Page(
    name="self-shadow",
    title="Hard and soft self-shadows",
    source="halliwell",
    rows={
        "H3": "a march from the hit to the light: hard or soft occlusion",
    },
    look="Long shadows fall on the stones; soft ones fade out at their far end.",
    article="A march from the hit towards the light finds whether the light reaches it.",
    ours="The same, and a soft form. Reads include the march to the light.",
    panels=panels,
)
