"""Cone stepping with few steps and many, relaxed cones, and the exact walk."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(
    azimuth=24.0, elevation=21.0, distance=0.72, target=(0.0, -0.06, 0.0), field_of_view=36.0
)


def panels(texels: int) -> Iterator[Panel]:
    """Conservative cones three times, then relaxed ones with a search, then the truth."""
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
    title="Stepping by cones",
    source="beyond",
    rows={
        "B2": "cones that nothing rises into, and relaxed ones with a search",
    },
    look="With five steps rays stop short in the air and smear the stones; with more they reach "
    "them, from the tops down to the feet.",
    article="J. Dummer, 2006: leap to where the ray leaves the cone below it, and never pass "
    "through anything. F. Policarpo and M. M. Oliveira, 2007: wider cones, which a ray may enter, "
    "and then a binary search.",
    ours="The same, and no ray here passes through a stone: what errs is short. After twenty steps "
    "that is one pixel in seven, around the feet of the stones, where cones are narrow; at so "
    "flat an angle fifteen leaps by relaxed cones and six halvings leave a quarter. exact "
    "needs fewer reads than either.",
    panels=panels,
)
