"""Planar and tri-planar mapping of the colour."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import Orbit, directional, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Tiling

CAMERA = Orbit(azimuth=32.0, elevation=30.0, distance=0.8, field_of_view=38.0)
SUN = (directional(-30.0, 48.0, intensity=2.4),)


def panels(texels: int) -> Iterator[Panel]:
    """Bricks on steep hills, planar and tri-planar."""
    hills = replace(
        sample("noise", texels),
        name="noise with bricks",
        base_color=sample("bricks", texels).base_color,
        roughness=None,
    )
    mappings: tuple[Literal["planar", "triplanar"], ...] = ("planar", "triplanar")
    for mapping in mappings:
        scene = preset("halliwell").scene(
            hills,
            scale=0.9,
            settings={"max_steps": 128},
            mapping=mapping,
            tilings={"base_color": Tiling((2.0, 2.0))},
            camera=CAMERA,
            lights=SUN,
        )
        yield Panel(f"{mapping} colour", scene)


PAGE = Page(
    name="steep-slopes",
    title="Stretched texels on steep slopes",
    source="halliwell",
    rows={"H7": "tri-planar colour in tangent space"},
    look="On steep sides planar bricks are stretched into tall streaks; tri-planar ones lie in "
    "level rows and keep their size.",
    article="At large heights texels on slopes are stretched; tri-planar mapping in tangent space "
    "might fix it.",
    ours="It does, for the colour. The article suggests it without a picture; here its march has "
    "steps for hills almost as high as the tile is wide.",
    panels=panels,
)
