"""Parallax offset at a reasonable strength, and beyond."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """The limited offset, from no strength to far too much."""
    for caption, strength in (
        ("no strength", 0.0),
        ("reasonable", 0.03),
        ("the maximum of the article's slider", 0.1),
        ("far beyond it", 0.3),
    ):
        obj = Object(sample("cobbles", texels), technique="offset_limited", scale=strength)
        yield Panel(caption, Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="strength",
    title="Parallax at a reasonable strength, and beyond",
    source="catlike",
    rows={
        "C7": "heights above one half move towards the viewer, lower ones away",
        "C1": "heights are linear, whatever channel they come from: black is low, white is high",
        "C2": "0, 0.03, 0.1 and 0.3; at 0 no height is read",
        "C5": "colour, normals, occlusion and roughness move together",
        "C6": "the offset is V.xy, not divided by V.z",
    },
    look="At 0.03 the stones gain depth; at 0.1 their edges smear, at 0.3 they tear.",
    article="The effect works at low strength only; larger displacements tear the surface apart.",
    ours="The same. The cobbles are rounder than the article's rock, so they smear before they "
    "tear.",
    panels=panels,
)
