"""A hole that opens in a surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from basrelief import Orbit, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=48.0, distance=0.75, field_of_view=40.0)


def panels(texels: int) -> Iterator[Panel]:
    """Cracks and dust combined, the dust stronger in each picture."""
    ground = replace(sample("cracks", texels), dust=sample("dust", texels).height)
    for opening in (0.0, 0.2, 0.5, 1.0):
        scene = preset("habrador-hole").scene(ground, opening=opening, camera=CAMERA)
        yield Panel(f"opened by {opening:g}", scene)


PAGE = Page(
    name="hole-opening",
    title="A hole that opens",
    source="habrador",
    rows={"L7": "a map of cracks combined with one of dust, and a number that opens the hole"},
    look="The cracks open first, then the ground between them, until one hole is left.",
    article="Two textures, of cracks and of a speck of dust, are combined, and a slider sets the "
    "strength of the dust: the hole opens and closes.",
    ours="The same, at four strengths. The article does not say how the two are combined; here the "
    "ground sinks where the dust, times its strength, exceeds the height of the cracks.",
    panels=panels,
)
