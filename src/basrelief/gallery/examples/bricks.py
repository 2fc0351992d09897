"""Bricks with and without parallax mapping."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, directional, placed, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = LookAt(position=(0.6, 0.1, 0.45), target=(0.1, 0.0, 0.0), field_of_view=40.0)
LIGHTS = (directional(-50.0, 55.0, intensity=1.5),)


def panels(texels: int) -> Iterator[Panel]:
    """A wall at a grazing angle, without and with parallax mapping."""
    for caption, options in (("without parallax", {"technique": "flat"}), ("with parallax", {})):
        scene = preset("habrador-bricks").scene(
            sample("bricks", texels),
            tiling=(3.0, 3.0),
            transform=placed(scale=3.0),
            camera=CAMERA,
            lights=LIGHTS,
            **options,
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="bricks",
    title="Bricks with and without parallax",
    source="habrador",
    rows={"L8": "the same wall twice, side by side"},
    look="With parallax the bricks stand out of the wall: you see their dark ends, and the joints "
    "behind them are hidden.",
    article="With a normal map alone bricks look flat; parallax mapping makes them look real.",
    ours="The same, with the settings of the preset `habrador-bricks`. The light comes from the "
    "far end of the wall, so the ends of the bricks are in the dark.",
    panels=panels,
)
