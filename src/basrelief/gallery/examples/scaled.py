"""Scaled and stretched objects, whose relief is scaled with them."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, Object, Scene, placed, rotated
from basrelief.gallery.page import Page, Panel, sample

EYE = (0.8, 0.9, 1.85)


def box(texels: int, scale: tuple[float, float, float], eye: tuple[float, float, float]) -> Scene:
    """A box of bricks, scaled and seen from `eye`."""
    obj = Object(
        sample("bricks", texels),
        shape="box",
        scale=0.08,
        transform=placed(scale=scale) @ rotated("y", 10.0),
    )
    return Scene((obj,), camera=LookAt(position=eye, field_of_view=40.0))


def panels(texels: int) -> Iterator[Panel]:
    """A box of size 1, of size 10 at ten times the distance, and stretched along one axis."""
    far = (10.0 * EYE[0], 10.0 * EYE[1], 10.0 * EYE[2])
    yield Panel("size 1", box(texels, (1.0, 1.0, 1.0), EYE))
    yield Panel("size 10, at ten times the distance", box(texels, (10.0, 10.0, 10.0), far), "× 10")
    yield Panel("twice as wide", box(texels, (2.0, 1.0, 1.0), (1.0, 1.2, 2.5)), "× 2, 1, 1")
    yield Panel("half as high", box(texels, (1.0, 0.5, 1.0), EYE), "× 1, 0.5, 1")


PAGE = Page(
    name="scaled",
    title="Scaled and stretched objects",
    source="catlike",
    rows={
        "C15": "uniform and non-uniform scale, with the relief in object space",
        "C4": "tangents and normals are normalised before the view is transformed",
    },
    look="The first two pictures are equal; in the others the relief is stretched with the box.",
    article="Batched objects of scale 10 have tangents and normals of that length, which distort "
    "the relief unless they are normalised.",
    ours="Always right, as the equal first two pictures show. The library has no option for the "
    "error.",
    panels=panels,
)
