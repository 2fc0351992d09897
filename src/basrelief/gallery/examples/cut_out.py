"""A cut-out: holes move with the relief and show objects behind it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import Object, Orbit, Scene, directional, placed
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING

CAMERA = Orbit(azimuth=28.0, elevation=38.0, distance=1.15, field_of_view=40.0)


def panels(texels: int) -> Iterator[Panel]:
    """A grating over cobbles: opaque, cut out, and with shadows."""
    below = placed((0.0, -0.25, 0.0)) @ LYING @ placed(scale=2.0)
    ground = Object(
        sample("cobbles", texels), scale=0.03, tiling=(3.0, 3.0), transform=below, casts="none"
    )
    opaque = Object(sample("grating", texels), alpha="opaque")
    cut = replace(opaque, alpha="mask")
    lights = (directional(-50.0, 66.0, intensity=2.4),)

    def scene(grating: Object, shadows: Literal["none", "hard"] = "none") -> Scene:
        return Scene((grating, ground), camera=CAMERA, lights=lights, shadows=shadows)

    yield Panel("opaque", scene(opaque))
    flat = replace(cut, technique="flat", settings={})
    yield Panel("cut out without relief", scene(flat))
    yield Panel("cut out after the offset", scene(cut))
    yield Panel("shadow with holes", scene(cut, "hard"))
    yield Panel(
        "shadow of the undisplaced holes",
        scene(replace(cut, casts="polygon"), "hard"),
        "casts polygon",
    )
    yield Panel(
        "shadow of the opaque grating",
        scene(replace(cut, casts="opaque"), "hard"),
        "casts opaque",
    )


PAGE = Page(
    name="cut-out",
    title="Cut-outs",
    source="catlike",
    rows={
        "C16": "opacity is read at displaced coordinates; the shadow is with displaced, "
        "undisplaced or no holes"
    },
    look="The stones show through holes whose walls have depth, and the shadow has the pattern of "
    "the grating, with thinner bars where its holes are not displaced.",
    article="The cut-out is tested after the parallax; the shadow caster may do the same, but that "
    "is rarely worth its cost.",
    ours="The same, with all three kinds of shadow. The article has no picture of it.",
    panels=panels,
)
