"""Displaced depth: objects intersect the visible relief, and their shadows fall on it."""

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
    """A ball and a pole on stones: flat, with relief, and with three kinds of shadows."""
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
    yield Panel("flat: the polygon cuts the objects", scene(flat))
    yield Panel("displaced depth: the stones cut the objects", scene(stones))
    yield Panel("shadows on the polygon", scene(stones, shadows="hard", shadows_on="polygon"))
    yield Panel("shadows on the relief", scene(stones, shadows="hard"))
    yield Panel("the same, with soft self-shadows", scene(stones, shadows="soft"))


PAGE = Page(
    name="displaced-depth",
    title="Displaced depth and shadows of other objects",
    source="catlike",
    rows={
        "C18": "the stones cut ball and pole, whose shadows fall into the joints",
    },
    look="Compare where ball and pole meet the ground, and the pole's shadow: straight in one "
    "picture, bent over the stones in the next.",
    article="Shadows and intersections of other objects ignore the relief; writing a depth for "
    "each fragment would fix both, at a cost.",
    ours="Both are fixed. The shadow maps are drawn for every picture, which takes most of its "
    "time.",
    panels=panels,
)
