"""A march along the ray: few steps, many steps, interpolation, and a search."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=24.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """The offset, then four marches of the same relief."""
    ten: dict[str, Any] = {"min_steps": 10, "max_steps": 10}
    for caption, technique, settings in (
        ("one read, for comparison", "offset", {}),
        ("10 steps", "steep", {"steps": 10}),
        ("100 steps", "steep", {"steps": 100}),
        ("10 steps and interpolation", "parallax_occlusion", ten),
        ("10 steps and a search of 3", "relief", {**ten, "search_steps": 3}),
    ):
        obj = Object(sample("cobbles", texels), technique=technique, settings=settings, scale=0.15)
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="march",
    title="Marching through the height field",
    source="catlike",
    rows={
        "C11": "10 steps and 100; at most so many reads",
        "C12": "the last step is intersected with the chord between its two reads",
        "C13": "the last step is halved 3 times, without interpolation",
    },
    look="Ten steps show ten layers; a hundred hide them, as do interpolation and search with a "
    "tenth of the reads.",
    article="Ten steps give a strong effect, true occlusion and obvious layers; a hundred are "
    "smooth but too expensive; interpolation looks much better; three halvings look good but "
    "leave some layers.",
    ours="The same. Interpolation leaves wavy edges where the surface between two reads is not "
    "straight; three halvings leave layers an eighth as thick.",
    panels=panels,
)
