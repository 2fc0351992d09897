"""Bricks with and without parallax mapping."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, Object, Scene, directional
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import placed

CAMERA = LookAt(position=(0.85, 0.1, 0.75), target=(0.0, 0.0, 0.0), field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """A wall at a grazing angle, with and without parallax mapping."""
    for caption, technique in (("with parallax", "parallax_occlusion"), ("without", "flat")):
        wall = Object(
            sample("bricks", texels),
            technique=technique,
            scale=0.06,
            tiling=(6.0, 6.0),
            transform=placed(scale=6.0),
        )
        lights = (directional(60.0, 50.0, intensity=2.4),)
        yield Panel(caption, Scene((wall,), camera=CAMERA, lights=lights))


PAGE = Page(
    name="bricks",
    title="Bricks with and without parallax",
    source="habrador",
    rows={"L8": "the same wall twice, side by side"},
    look="With parallax the bricks stand out from the mortar and cover it on their far side.",
    article="With a normal map alone bricks look flat; parallax mapping makes them look real.",
    ours="The same.",
    panels=panels,
)
