"""Refinement of the last step of a march: none, a chord, secants, halvings, finer layers."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=26.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Eight layers each, then the refinement of each technique."""
    eight: dict[str, float] = {"min_steps": 8, "max_steps": 8}
    choices: tuple[tuple[str, str, dict[str, float]], ...] = (
        ("steep: none", "steep", {"steps": 8}),
        ("parallax_occlusion: one chord", "parallax_occlusion", eight),
        ("secant: three chords", "secant", {**eight, "search_steps": 3}),
        ("relief: three halvings", "relief", {**eight, "search_steps": 3}),
        ("contact: up to seven finer layers", "contact", eight),
    )
    for caption, technique, settings in choices:
        obj = Object(sample("bricks", texels), technique=technique, settings=settings, scale=0.12)
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="refinement",
    title="Refinement of the last step",
    source="beyond",
    rows={"B3": "secant and contact refinement, next to the refinements of the articles"},
    look="The layers of steep vanish, first on slopes and then on the sides of the bricks.",
    article="A. Riccardi, 2019: march again within the last step, so that 2 N reads find what N² "
    "layers would. E. Risser, M. Shah and S. Pattanaik, 2007: intersect the last step with its "
    "chord, repeatedly.",
    ours="All have the same eight layers. All of them miss features between two layers; refinement "
    "only improves the position of hits.",
    panels=panels,
)
