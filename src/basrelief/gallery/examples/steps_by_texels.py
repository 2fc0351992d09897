"""As many samples as texels lie under the ray."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=22.0, distance=0.75, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Samples by the angle; by texels, one for each; by texels, one for every other."""
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
    title="Samples by texels",
    source="gamedev",
    rows={"G8": "a way of 0.5 over 256 texels is never read more than 128 times"},
    look="Thin blades are whole only where no texel is passed over; the price is in the reads.",
    article="Reading every texel on the way gives the best quality and takes the longest: a "
    "parallax limit of 0.5 on a map of 256 is at most 128 samples.",
    ours="The same. The reads given are the mean: most rays end long before their limit.",
    panels=panels,
)
