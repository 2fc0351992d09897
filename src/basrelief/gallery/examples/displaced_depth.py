"""Displaced depth: what stands in the relief meets it where it is seen, and so does its shadow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from basrelief import Object, Orbit, Scene, directional, placed
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(
    azimuth=15.0, elevation=32.0, distance=1.05, target=(0.0, 0.0, 0.05), field_of_view=36.0
)
LIGHT = directional(80.0, 40.0, intensity=2.6)


def panels(texels: int) -> Iterator[Panel]:
    """A ball and a pole on stones: flat, with relief, and with shadows of three kinds."""
    stones = Object(sample("cobbles", texels), technique="relief", scale=0.15)
    tiles = replace(sample("tiles", texels // 2), height=None)
    ball = Object(
        tiles, shape="sphere", transform=placed((0.2, -0.03, 0.08), 0.3), tiling=(6.0, 3.0)
    )
    pole = Object(
        tiles,
        shape="cylinder",
        transform=placed((0.0, 0.05, -0.12), (0.07, 0.34, 0.07)),
        tiling=(2.0, 4.0),
    )

    def scene(ground: Object, **options: Any) -> Scene:
        return Scene((ground, ball, pole), camera=CAMERA, lights=(LIGHT,), **options)

    flat = replace(stones, technique="flat", settings={})
    yield Panel("flat: they cut the polygon", scene(flat))
    yield Panel("displaced depth: they cut the stones", scene(stones))
    yield Panel(
        "shadows that ignore the relief", scene(stones, shadows="hard", shadows_on="polygon")
    )
    yield Panel("shadows that fall on the stones", scene(stones, shadows="hard"))
    yield Panel("the same, soft within the relief", scene(stones, shadows="soft"))


PAGE = Page(
    name="displaced-depth",
    title="Displaced depth and the shadows of others",
    source="catlike",
    rows={
        "C18": "ball and pole are cut by the stones, and cast their shadows into the joints",
    },
    look="Where ball and pole meet the ground; then the pole's shadow, a straight bar that floats "
    "over the stones in one picture and bends over them in the next.",
    article="Shadows and intersections of other objects ignore the relief; writing the depth of "
    "each fragment would mend both, at a price.",
    ours="Both are here. Our shadows are read from distances that each light sees, drawn anew for "
    "every picture, which is most of the time that these pictures take.",
    panels=panels,
)
