"""Offsets clamped to a maximum."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=20.0, distance=0.85, field_of_view=36.0)


def panels(texels: int) -> Iterator[Panel]:
    """From an unlimited offset to one of at most a hundredth of a tile."""
    for caption, max_offset in (
        ("not clamped", 1.0),
        ("clamped to 0.05", 0.05),
        ("clamped to 0.01", 0.01),
    ):
        obj = Object(
            sample("bricks", texels),
            technique="offset",
            settings={"max_offset": max_offset},
            scale=0.08,
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="clamped",
    title="Clamped offsets",
    source="wikibooks",
    rows={"W3": "the offset along u and along v is at most a maximum"},
    look="Unclamped, the far rows tear; clamped, they stay whole but look almost flat.",
    article="The clamp limits offsets; between plateaus with smooth transitions it should be "
    "smaller than the transitions.",
    ours="The same: the joints of the bricks are about 0.02 of a tile wide, so 0.01 keeps the "
    "bricks whole and 0.05 does not.",
    panels=panels,
)
