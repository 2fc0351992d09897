"""Offsets held to a maximum."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=20.0, elevation=20.0, distance=0.85, field_of_view=36.0)


def panels(texels: int) -> Iterator[Panel]:
    """From an offset of any length to one of a hundredth of a tile."""
    for caption, most in (
        ("not clamped", 1.0),
        ("clamped to 0.05", 0.05),
        ("clamped to 0.01", 0.01),
    ):
        obj = Object(
            sample("bricks", texels),
            technique="offset",
            settings={"max_offset": most},
            scale=0.08,
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="clamped",
    title="Clamped offsets",
    source="wikibooks",
    rows={"W3": "u and v each move by no more than a maximum"},
    look="Unclamped, the far rows are torn; clamped, they hold, and are as good as flat.",
    article="The clamp keeps offsets within bounds; where plateaus meet in smooth transitions it "
    "is to be smaller than these.",
    ours="The same: the joints of the bricks are about 0.02 of a tile wide, so 0.01 keeps bricks "
    "whole and 0.05 does not.",
    panels=panels,
)
