"""A parallax function of one's own, beside those that come with the library."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.techniques import (
    HeightField,
    Hit,
    Ray,
    height_under,
    hit_at,
    setting,
    struct,
    t_at,
    technique,
)

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)


@struct
class Guessing:
    """Settings of `guess`."""

    guesses: int = setting(default=4, doc="how often to read and try again", low=1, high=16)


@technique(reference_height=0.5, most_reads=4)
def guess(field: HeightField, ray: Ray, settings: Guessing) -> Hit:
    """Take the height found here for the height where the ray ends, and look there again."""
    height = height_under(field, ray, t_at(ray, ray.reference_height))
    for _ in range(1, settings.guesses):
        height = 0.5 * (height + height_under(field, ray, t_at(ray, height)))
    return hit_at(ray, t_at(ray, height), True, settings.guesses)


def panels(texels: int) -> Iterator[Panel]:
    """The offset, one's own, and a march, on the same relief at the same level."""
    choices: tuple[tuple[str, Any], ...] = (
        ("the library's offset", "offset"),
        ("one's own: guess, look again, four times", guess),
        ("the library's relief", "relief"),
    )
    for caption, chosen in choices:
        obj = Object(sample("cobbles", texels), technique=chosen, scale=0.08, reference_height=0.5)
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="own-technique",
    title="A technique of one's own",
    source="catlike",
    rows={"C14": "any function (field, ray, settings) → Hit takes the place of another"},
    look="Four reads that correct one another come close to the march where slopes are gentle.",
    article="The parallax function is a choice: the offset is one, the march another, under one "
    "signature.",
    ours="A third is added in a file of its own, in ten lines; it runs on the CPU and on the GPU.",
    panels=panels,
)
