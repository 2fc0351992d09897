"""One step for each texel along the ray."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=22.0, distance=0.75, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Steps by angle, one for every second texel, and one for every texel."""
    for caption, settings in (
        ("by angle, 4 to 20", {"min_steps": 4, "max_steps": 20}),
        ("one for every second texel", {"steps_per_texel": 0.5}),
        ("one for every texel", {"steps_per_texel": 1.0}),
    ):
        obj = Object(
            sample("grass", min(texels, 256)),
            technique="parallax_occlusion",
            settings=settings,
            scale=0.15,
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA), "256 texels a side at most")


PAGE = Page(
    name="steps-by-texels",
    title="Steps by texels",
    source="gamedev",
    rows={"G8": "a travel of 0.5 over 256 texels takes at most 128 reads"},
    look="Thin blades are whole only where no texel is skipped; that costs reads.",
    article="Reading every texel along the ray gives the best quality and is the slowest: a "
    "parallax limit of 0.5 on a map of 256 texels is at most 128 samples.",
    ours="The same. Reads are means: most rays end long before their limit.",
    panels=panels,
)
