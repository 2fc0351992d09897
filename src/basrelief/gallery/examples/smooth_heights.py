"""Heights from coarser mip levels: fewer missed hits, softer edges."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=20.0, distance=1.0, field_of_view=30.0)


def panels(texels: int) -> Iterator[Panel]:
    """Sharp heights, a coarser level, and fades to a still coarser one."""
    choices: tuple[tuple[str, Any, dict[str, float]], ...] = (
        ("sharp", "sharp", {}),
        ("one level coarser", "smooth", {"mip_bias": 1.0, "mip_fade": 0.0}),
        ("one level coarser, faded", "smooth", {"mip_bias": 1.0, "mip_fade": 4.0}),
        ("two levels coarser, faded", "smooth", {"mip_bias": 2.0, "mip_fade": 4.0}),
    )
    for caption, heights, smoothing in choices:
        obj = Object(
            sample("gravel", texels),
            technique="parallax_occlusion",
            settings={"min_steps": 6, "max_steps": 16},
            scale=0.15,
            tiling=(2.0, 2.0),
            heights=heights,
            smoothing=smoothing,
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="smooth-heights",
    title="Smooth heights",
    source="halliwell",
    rows={
        "H4": "heights from a coarser level by explicit gradients, faded to a still coarser one",
        "G5": "the level comes from the undisplaced coordinates, outside the loop",
    },
    look="Slices and sparkling grains on the far stones vanish, with some of their sharpness.",
    article="Coarser mip levels remove missed hits and sparkling; a comparison with a still "
    "coarser one, and a fade by the difference, make sharp edges less regular.",
    ours="The same. A still picture shows that the slices vanish, a film that the sparkling does.",
    panels=panels,
)
