"""A cut-out: holes move with the relief, and what lies behind shows through."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import Object, Orbit, Scene, directional, placed
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING

CAMERA = Orbit(azimuth=28.0, elevation=38.0, distance=1.15, field_of_view=40.0)


def panels(texels: int) -> Iterator[Panel]:
    """A grating over cobbles: closed, cut out, and with shadows."""
    below = placed((0.0, -0.25, 0.0)) @ LYING @ placed(scale=2.0)
    ground = Object(
        sample("cobbles", texels), scale=0.03, tiling=(3.0, 3.0), transform=below, casts="none"
    )
    closed = Object(sample("grating", texels), alpha="opaque")
    cut = replace(closed, alpha="mask")
    lights = (directional(-50.0, 66.0, intensity=2.4),)

    def scene(grating: Object, shadows: Literal["none", "hard"] = "none") -> Scene:
        return Scene((grating, ground), camera=CAMERA, lights=lights, shadows=shadows)

    yield Panel("nothing cut out", scene(closed))
    flat = replace(cut, technique="flat", settings={})
    yield Panel("cut out without any relief", scene(flat))
    yield Panel("cut out after the offset", scene(cut))
    yield Panel("its shadow has holes too", scene(cut, "hard"))
    yield Panel(
        "the shadow of the uncut grating",
        scene(replace(cut, casts="opaque"), "hard"),
        "casts opaque",
    )


PAGE = Page(
    name="cut-out",
    title="Cut-outs",
    source="catlike",
    rows={"C16": "opacity is read at the displaced place; the shadow may have holes or not"},
    look="Through the holes, whose walls have depth, the stones below show, lit in the grating's "
    "own pattern.",
    article="The cut-out is tested after the parallax; the shadow caster may do the same, though "
    "it is rarely worth its time.",
    ours="The same, with both shadows. The article has no picture of it.",
    panels=panels,
)
