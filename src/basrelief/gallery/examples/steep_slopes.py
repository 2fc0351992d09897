"""Planar colour, with noise, and tri-planar."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from basrelief import Orbit, directional, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Tiling
from basrelief.settings.kinds import MappingKind

CAMERA = Orbit(azimuth=32.0, elevation=30.0, distance=0.8, field_of_view=38.0)
SUN = (directional(-30.0, 48.0, intensity=2.4),)


def panels(texels: int) -> Iterator[Panel]:
    """Bricks on steep hills, planar, with noise, and tri-planar."""
    hills = replace(
        sample("noise", texels),
        name="noise with bricks",
        base_color=sample("bricks", texels).base_color,
        roughness=None,
    )
    captions: dict[MappingKind, str] = {
        "planar": "planar colour",
        "noise": "planar colour with noise",
        "triplanar": "tri-planar colour",
    }
    for mapping, caption in captions.items():
        scene = preset("halliwell").scene(
            hills,
            scale=0.9,
            settings={"max_steps": 128},
            mapping=mapping,
            tilings={"base_color": Tiling((2.0, 2.0))},
            camera=CAMERA,
            lights=SUN,
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="steep-slopes",
    title="Stretched texels on steep slopes",
    source="halliwell",
    rows={"H7": "noise over the stretched texels; tri-planar colour in tangent space"},
    look="On steep sides planar bricks are stretched into tall streaks; noise covers them with "
    "grain; tri-planar bricks lie in level rows and keep their size.",
    article="At large heights texels on slopes are stretched; tri-planar mapping in tangent space "
    "might fix it, or noise hide it.",
    ours="Tri-planar mapping does, for the colour. The article suggests it without a picture; here "
    "its march has steps for hills almost as high as the tile is wide.",
    panels=panels,
)
