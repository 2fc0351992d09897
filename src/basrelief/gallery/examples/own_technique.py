"""A technique of your own, compared with the library's."""

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

    guesses: int = setting(default=4, doc="number of guesses, one read each", low=1, high=16)


@technique(reference_height=0.5, most_reads=4)
def guess(field: HeightField, ray: Ray, settings: Guessing) -> Hit:
    """Guess the height of the hit from that at the last guess, as a fixed-point iteration."""
    height = height_under(field, ray, t_at(ray, ray.reference_height))
    for _ in range(1, settings.guesses):
        height = 0.5 * (height + height_under(field, ray, t_at(ray, height)))
    return hit_at(ray, t_at(ray, height), True, settings.guesses)


def panels(texels: int) -> Iterator[Panel]:
    """The offset, your own technique, and a march, with the same relief."""
    choices: tuple[tuple[str, Any], ...] = (
        ("the library's offset", "offset"),
        ("your own: four guesses", guess),
        ("the library's relief", "relief"),
    )
    for caption, parallax in choices:
        obj = Object(
            sample("cobbles", texels), technique=parallax, scale=0.08, reference_height=0.5
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="own-technique",
    title="A technique of your own",
    source="catlike",
    rows={"C14": "any function (field, ray, settings) → Hit can replace another"},
    look="Four reads, each from the height of the last, come close to the march on gentle slopes.",
    article="The parallax function can be chosen: an offset or a march, with one signature.",
    ours="A third one is added in ten lines of this file; it runs on the CPU and on the GPU.",
    panels=panels,
)
