"""Scaled and stretched objects: the relief goes with them, unwarped."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, Object, Scene, placed, rotated
from basrelief.gallery.page import Page, Panel, sample

EYE = (0.8, 0.9, 1.85)


def box(texels: int, scale: tuple[float, float, float], eye: tuple[float, float, float]) -> Scene:
    """A box of bricks of some size, seen from some place."""
    obj = Object(
        sample("bricks", texels),
        shape="box",
        scale=0.08,
        transform=placed(scale=scale) @ rotated("y", 10.0),
    )
    return Scene((obj,), camera=LookAt(position=eye, field_of_view=40.0))


def panels(texels: int) -> Iterator[Panel]:
    """A box of size 1, of size 10 from ten times as far, and stretched along one axis each."""
    far = (10.0 * EYE[0], 10.0 * EYE[1], 10.0 * EYE[2])
    yield Panel("size 1", box(texels, (1.0, 1.0, 1.0), EYE))
    yield Panel("size 10, from ten times as far", box(texels, (10.0, 10.0, 10.0), far), "× 10")
    yield Panel("twice as wide", box(texels, (2.0, 1.0, 1.0), (1.0, 1.2, 2.5)), "× 2, 1, 1")
    yield Panel("half as high", box(texels, (1.0, 0.5, 1.0), EYE), "× 1, 0.5, 1")


PAGE = Page(
    name="scaled",
    title="Scaled and stretched objects",
    source="catlike",
    rows={
        "C15": "even and uneven scaling, with the relief set in object space",
        "C4": "tangents and normals are normalised before the view is taken to their frame",
    },
    look="The first two pictures are the same; in the others joints stay as deep as bricks "
    "stretched with their box would have them.",
    article="Batched objects of scale 10 have tangents and normals of that length: the relief is "
    "warped until they are normalised.",
    ours="Always right. There is no switch to get it wrong, so the warped picture is not here; "
    "that the first two are the same is the proof.",
    panels=panels,
)
