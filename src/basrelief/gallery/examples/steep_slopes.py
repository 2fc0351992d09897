"""Planar and tri-planar mapping of the colour."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Tiling

CAMERA = Orbit(azimuth=32.0, elevation=34.0, distance=1.1, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Stones on steep hills, planar and tri-planar, with many steps for smooth slopes."""
    hills = replace(
        sample("noise", texels),
        name="noise with cobbles",
        base_color=sample("cobbles", texels).base_color,
        roughness=None,
    )
    mappings: tuple[Literal["planar", "triplanar"], ...] = ("planar", "triplanar")
    for mapping in mappings:
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
    look="On steep sides planar stones are stretched into streaks; tri-planar ones keep their "
    "size.",
    article="At large heights texels on slopes are stretched; tri-planar mapping in tangent space "
    "might fix it.",
    ours="It does, for the colour. The article suggests it without a picture.",
    panels=panels,
)
