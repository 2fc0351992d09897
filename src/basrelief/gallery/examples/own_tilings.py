"""Separate tilings of colour, normals and heights."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Tiling

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Maps with one tiling, with separate ones, and with tiles that are not square."""
    thrice, shifted = Tiling((3.0, 3.0)), Tiling((1.0, 1.0), shift=(0.25, 0.125))
    choices: tuple[tuple[str, Mapping[str, Tiling], tuple[float, float] | None], ...] = (
        ("all maps together", {}, None),
        ("colour 3 × 3", {"base_color": thrice}, None),
        ("normals 3 × 3", {"normal": thrice}, None),
        ("colour shifted by ¼, ⅛", {"base_color": shifted}, None),
        ("all maps 4 × 2", {}, (4.0, 2.0)),
        ("heights 4 × 2, colour 1 × 1", {"base_color": Tiling()}, (4.0, 2.0)),
    )
    for caption, tilings, tiling in choices:
        obj = Object(
            sample("bricks", texels),
            technique="relief",
            scale=0.06,
            tilings=tilings,
            tiling=tiling,
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="own-tilings",
    title="A tiling for each map",
    source="wikibooks",
    rows={
        "W5": "colour, normals and heights each have tiles and a shift",
        "W4": "tiles half as wide as high: the offset is right along both u and v",
    },
    look="The relief stays while colour or normals have another tiling.",
    article="Each map has its own scale and offset, which apply after the parallax offset; tangent "
    "and binormal carry the scale of each axis.",
    ours="The same, with a march instead of the single step, which shows the place of each map.",
    panels=panels,
)
