"""Cone stepping with few and many steps, relaxed cones, and the exact technique."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(
    azimuth=24.0, elevation=21.0, distance=0.72, target=(0.0, -0.06, 0.0), field_of_view=36.0
)


def panels(texels: int) -> Iterator[Panel]:
    """Conservative cones three times, then relaxed cones with a search, then `exact`."""
    choices: tuple[tuple[str, str, dict[str, float]], ...] = (
        ("cone, 5 steps", "cone", {"steps": 5}),
        ("cone, 10 steps", "cone", {"steps": 10}),
        ("cone, 20 steps", "cone", {"steps": 20}),
        ("relaxed_cone, 15 + 6", "relaxed_cone", {"steps": 15, "search_steps": 6}),
        ("exact", "exact", {}),
    )
    for caption, technique, settings in choices:
        obj = Object(
            sample("gravel", min(texels, 256)), technique=technique, settings=settings, scale=0.12
        )
        yield Panel(caption, Scene((obj,), camera=CAMERA), "256 texels a side at most")


PAGE = Page(
    name="cone-stepping",
    title="Cone stepping",
    source="beyond",
    rows={
        "B2": "empty cones, and relaxed cones with a search",
    },
    look="With five steps rays stop short of the surface and smear the stones; with more they "
    "reach it, first at the tops and then at the feet of the stones.",
    article="J. Dummer, 2006: step to the point where the ray leaves the cone below it, and never "
    "pass through a feature. F. Policarpo and M. M. Oliveira, 2007: wider cones, through which a "
    "ray may enter the surface once, then a binary search.",
    ours="The same, and no ray passes through a stone: all errors are short. After twenty steps "
    "one pixel in seven has one, around the feet of the stones, where cones are narrow. At this "
    "grazing angle fifteen steps by relaxed cones and six halvings leave one in four. exact "
    "needs fewer reads than either.",
    panels=panels,
)
