"""Scaled and stretched objects, whose relief is scaled with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Orbit, Scene, placed, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.lang import Vec2
from basrelief.scene import LYING
from basrelief.techniques import HeightField, Hit, Ray, relief, technique
from basrelief.techniques.march import Relief

MARCH = preset("catlike-march")


@technique(most_reads=37)
def not_normalised(field: HeightField, ray: Ray, settings: Relief) -> Hit:
    """The article's error: a normal and tangent of length 10, and so a bitangent of length 100."""
    travel = Vec2(ray.travel.x, 10.0 * ray.travel.y)
    warped = Ray(uv=ray.uv, travel=travel, height=ray.height, drop=ray.drop, cosine=ray.cosine)
    return relief(field, warped, settings)


def quad(texels: int, *size: float, distance: float = 1.0, **options: Any) -> Scene:
    """A quad, `size` times as wide, high (the relief) and deep."""
    return MARCH.scene(
        sample("circuit", texels),
        scale=0.07,
        transform=placed(scale=size) @ LYING,
        camera=Orbit(azimuth=35.0, elevation=36.0, distance=distance, field_of_view=36.0),
        **options,
    )


def panels(texels: int) -> Iterator[Panel]:
    """A quad, ten times as large at ten times the distance, and stretched along one axis."""
    error = {"technique": not_normalised, "settings": MARCH.values["object"]["settings"]}
    yield Panel("size 1", quad(texels, 1.0, 1.0, 1.0))
    yield Panel("size 10, at ten times the distance", quad(texels, 10.0, 10.0, 10.0, distance=10.0))
    yield Panel("not normalised", quad(texels, 10.0, 10.0, 10.0, distance=10.0, **error))
    yield Panel("twice as wide", quad(texels, 2.0, 1.0, 1.0, distance=1.3), "× 2, 1, 1")
    yield Panel("twice as high", quad(texels, 1.0, 2.0, 1.0), "× 1, 2, 1")


PAGE = Page(
    name="scaled",
    title="Scaled and stretched objects",
    source="catlike",
    rows={
        "C15": "uniform and non-uniform scale, with the relief in object space",
        "C4": "tangents and normals are normalised before the view is transformed",
    },
    look="The first two pictures are equal, and the third is torn; in the others the parts are "
    "twice as wide, or stand twice as high.",
    article="Batched objects of scale 10 have tangents and normals of that length, which warps the "
    "relief unless they are normalised: a weird picture, then a correct one.",
    ours="The same quad. The library is always right; the error is a technique in this file, whose "
    "ray runs ten times as far along v, as the article's does. The article scales uniformly only.",
    panels=panels,
)
