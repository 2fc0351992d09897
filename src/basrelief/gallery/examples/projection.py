"""Three projections of the view ray, for an offset and for a march."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=20.0, distance=0.85, field_of_view=36.0)


PROJECTIONS: dict[str, dict[str, Any]] = {
    "limited": {"projection": "limited"},
    "bias 0: the true projection": {"projection": "biased", "bias": 0.0},
    "bias 0.42": {"projection": "biased", "bias": 0.42},
}


def panels(texels: int) -> Iterator[Panel]:
    """Limited, true (bias 0) and biased by 0.42: first the offset, then the march."""
    bricks = sample("bricks", texels)
    for technique, settings in (("offset", {}), ("parallax_occlusion", {"max_steps": 64})):
        for caption, options in PROJECTIONS.items():
            obj = Object(bricks, technique=technique, settings=settings, scale=0.06, **options)
            yield Panel(f"{technique}, {caption}", Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="projection",
    title="Limited, true and biased projection",
    source="catlike",
    rows={
        "C8": "xy ÷ (z + bias) with a bias of 0 and 0.42",
        "C9": "the same three for the offset and the march",
        "C6": "limited: the offset is never longer than the height",
    },
    look="The true projection tears the offset towards the far edge and deepens the march; the "
    "bias reduces both.",
    article="Limiting is no true perspective; dividing by z is, but increases the artefacts at "
    "shallow angles; a bias of 0.42 distorts the perspective and keeps them acceptable.",
    ours="The same for the offset. For the march the true projection has no artefacts; the other "
    "two make the relief shallower, and it slides as the camera moves.",
    panels=panels,
)
