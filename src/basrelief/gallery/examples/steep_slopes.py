"""Colour laid on from one side or from three."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Tiling

CAMERA = Orbit(azimuth=32.0, elevation=34.0, distance=1.1, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Stones on steep hills, planar and tri-planar, with many steps so that slopes are smooth."""
    hills = replace(
        sample("noise", texels),
        name="noise with cobbles",
        base_color=sample("cobbles", texels).base_color,
        roughness=None,
    )
    ways: tuple[Literal["planar", "triplanar"], ...] = ("planar", "triplanar")
    for mapping in ways:
        obj = Object(
            hills,
            settings={"max_steps": 64},
            scale=0.9,
            mapping=mapping,
            tilings={"base_color": Tiling((2.0, 2.0))},
        )
        yield Panel(f"{mapping} colour", Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="steep-slopes",
    title="Stretched texels on steep slopes",
    source="halliwell",
    rows={"H7": "tri-planar colour in tangent space"},
    look="On the steep sides planar stones are drawn out into streaks; tri-planar ones keep "
    "their size.",
    article="At great heights texels on slopes are pulled in ways they were never meant to be; "
    "tri-planar mapping in tangent space might mend it.",
    ours="It does, in colour; it is a suggestion of the article's, without a picture there.",
    panels=panels,
)
