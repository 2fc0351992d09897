"""Normal mapping against a single step of parallax mapping."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import Orbit, point, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=32.0, distance=0.3, field_of_view=36.0)


def panels(texels: int) -> Iterator[Panel]:
    """Heights of ± half the maximum, with a clamp at the maximum."""
    choices: tuple[tuple[str, dict[str, Any]], ...] = (
        ("normal mapping alone", {"technique": "flat"}),
        ("a single step, height 0.01", {}),
        ("a single step, height 0.04", {"scale": 0.04, "settings": {"max_offset": 0.04}}),
    )
    for caption, options in choices:
        scene = preset("wikibooks").scene(
            sample("tiles", texels),
            camera=CAMERA,
            lights=(point((-1.0, 0.6, -0.2), intensity=1.0, falloff=1.0),),
            **options,
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="single-step",
    title="Normal mapping against a single step",
    source="wikibooks",
    rows={
        "W1": "offset = height · V.xy ÷ V.z, from one read",
        "W2": "height = maximum · (h − ½), with maxima of 0.01 and 0.04",
        "W6": "heights in A or in R; once loaded they are the same",
        "W7": "normals in A and G; once z is reconstructed they are the same as in RGB",
    },
    look="At 0.01 the brass tile gets sides and stands out of the floor; at 0.04 its edges are "
    "doubled, and marble lies between them.",
    article="At an angle bumps should stick out and dents recede; a single read moves them by "
    "several pixels, for small heights.",
    ours="The same, with the settings of the preset `wikibooks`, so near that the shift is about "
    "five pixels. At 0.04, four times the article's height and clamp, it is wider than the slopes "
    "between the plateaus: the read takes the height of another one, of which the article warns.",
    panels=panels,
)
