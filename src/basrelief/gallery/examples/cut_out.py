"""A cut-out: holes move with the relief and show objects behind it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

from basrelief import LookAt, Material, Object, Scene, directional, placed, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING

CLOSE = LookAt(position=(-0.55, 0.75, 0.95), target=(-0.03, -0.12, 0.0), field_of_view=40.0)
WIDE = LookAt(position=(0.3, 1.15, 1.35), target=(0.39, -0.25, 0.02), field_of_view=40.0)
SUN = (directional(-80.0, 37.0, intensity=2.6),)


def panels(texels: int) -> Iterator[Panel]:
    """A grating above sand: opaque, cut out, and with its shadow beside it."""
    below = placed((0.0, -0.6, 0.0)) @ LYING @ placed(scale=6.0)
    sand = Object(
        Material("sand", base_color=sample("cracks", texels).base_color),
        tiling=(2.0, 2.0),
        transform=below,
        casts="none",
    )
    # the article's steps for its best quality: with ten, thin walls are torn
    march = preset("catlike-march").scene(
        sample("grating", texels),
        scale=0.12,
        settings={"min_steps": 100, "max_steps": 100},
        alpha="mask",
        lights=SUN,
        shadow_map_size=2048,
    )
    (cut,) = march.objects

    def scene(
        obj: Object, camera: LookAt = CLOSE, shadows: Literal["none", "hard"] = "none"
    ) -> Scene:
        return replace(march, objects=(obj, sand), camera=camera, shadows=shadows)

    yield Panel("opaque", scene(replace(cut, alpha="opaque")))
    flat = replace(cut, technique="flat", settings={})
    yield Panel("cut out without relief", scene(flat))
    yield Panel("cut out after the parallax", scene(cut))
    yield Panel("shadow of displaced holes", scene(cut, WIDE, "hard"), "casts shape")
    polygon, opaque = replace(cut, casts="polygon"), replace(cut, casts="opaque")
    yield Panel("shadow of undisplaced holes", scene(polygon, WIDE, "hard"), "casts polygon")
    yield Panel("shadow without holes", scene(opaque, WIDE, "hard"), "casts opaque")


PAGE = Page(
    name="cut-out",
    title="Cut-outs",
    source="catlike",
    rows={
        "C16": "opacity is read at displaced coordinates; the shadow is with displaced, "
        "undisplaced or no holes"
    },
    look="Sand shows through holes whose walls have depth, and the shadow is that of deep bars, of "
    "thin ones where its holes are not displaced, or of a plate where it has none.",
    article="The cut-out is tested after the parallax; the shadow caster may do the same, but that "
    "is rarely worth its cost.",
    ours="The same, with all three kinds of shadow. The article has no picture of it. Here the "
    "grating is so deep, and the sun so low, that the kinds differ.",
    panels=panels,
)
