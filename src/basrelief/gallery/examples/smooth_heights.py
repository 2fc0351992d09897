"""Heights from coarser mip levels: fewer missed hits, softer edges."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Orbit, directional, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=28.0, distance=0.6, field_of_view=22.0)
LIGHTS = (directional(-60.0, 35.0, intensity=2.8),)


def panels(texels: int) -> Iterator[Panel]:
    """Sharp heights, a coarser level, and fades to a still coarser one."""
    choices: tuple[tuple[str, dict[str, Any]], ...] = (
        ("sharp", {"heights": "sharp"}),
        ("one level coarser", {"smoothing": {"mip_bias": 1.0, "mip_fade": 0.0}}),
        ("one level coarser, faded", {"smoothing": {"mip_bias": 1.0, "mip_fade": 4.0}}),
        ("two levels coarser, faded", {"smoothing": {"mip_bias": 2.0, "mip_fade": 4.0}}),
    )
    for caption, options in choices:
        scene = preset("halliwell").scene(
            sample("grass", texels),
            settings={"min_steps": 8, "max_steps": 16},
            shadows="none",
            occlusion_kind="ambient",
            camera=CAMERA,
            lights=LIGHTS,
            **options,
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="smooth-heights",
    title="Smooth heights",
    source="halliwell",
    rows={
        "H4": "heights from a coarser level by explicit gradients, faded to a still coarser one",
        "G5": "the level comes from the undisplaced coordinates, outside the loop",
    },
    look="With sharp heights the blades are cut into slices, as most steps miss them; the coarser "
    "the level, the fewer slices and the rounder the blades.",
    article="Coarser mip levels remove missed hits and sparkling; a comparison with a still "
    "coarser one, and a fade by the difference, make sharp edges less regular.",
    ours="The same, with the preset `halliwell`, fewer steps and without its shadows: 8 to 16 "
    "steps miss many thin blades. A still picture shows that the slices vanish, a film that the "
    "sparkling does.",
    panels=panels,
)
