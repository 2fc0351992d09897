"""The reference height: a relief pushed in, centred, or raised."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=28.0, distance=1.6, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """The same relief at three reference heights, clipped at the edges of the tile."""
    for caption, reference_height in (("pushed in", 1.0), ("centred", 0.5), ("raised", 0.0)):
        obj = Object(
            sample("cobbles", texels),
            technique="relief",
            scale=0.2,
            reference_height=reference_height,
            edge="clip",
        )
        yield Panel(
            f"{caption}: reference height {reference_height:g}",
            Scene((obj,), camera=CAMERA),
            "edge clip",
        )


PAGE = Page(
    name="reference-level",
    title="Pushed in, centred, raised",
    source="halliwell",
    rows={"H6": "reference heights of 1, ½ and 0"},
    look="Pushed in, the ground recedes from the polygon's near edge; raised, it comes towards the "
    "viewer and is cut off at the polygon's outline.",
    article="The relief is always pushed in, so objects shrink.",
    ours="That is the first picture; the other two avoid it. No ray starts outside the polygon, so "
    "a raised relief ends at the polygon's outline.",
    panels=panels,
)
