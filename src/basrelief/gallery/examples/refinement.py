"""What is done within the last step of a march: nothing, a chord, cuts, halvings, finer layers."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=26.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Eight layers each, then as each technique goes on."""
    eight: dict[str, float] = {"min_steps": 8, "max_steps": 8}
    choices: tuple[tuple[str, str, dict[str, float]], ...] = (
        ("steep: stays on its layer", "steep", {"steps": 8}),
        ("parallax_occlusion: one chord", "parallax_occlusion", eight),
        ("secant: three cuts", "secant", {**eight, "search_steps": 3}),
        ("relief: three halvings", "relief", {**eight, "search_steps": 3}),
        ("contact: up to seven finer layers", "contact", eight),
    )
    for caption, technique, settings in choices:
        obj = Object(sample("bricks", texels), technique=technique, settings=settings, scale=0.12)
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="refinement",
    title="Within the last step",
    source="beyond",
    rows={"B3": "secant and contact refinement, beside what the articles do in the last step"},
    look="The layers of steep go, first from slopes and then from the sides of the bricks.",
    article="A. Riccardi, 2019: march again within the last step, and 2 N reads find what N² "
    "layers would. E. Risser, M. Shah and S. Pattanaik, 2007: cut the last step by its chord, and "
    "again.",
    ours="The same eight layers for all. What lies between two of them and above neither is missed "
    "by every one of these; only the place of what is found becomes better.",
    panels=panels,
)
