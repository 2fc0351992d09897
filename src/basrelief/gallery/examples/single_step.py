"""Normal mapping against a single step of parallax mapping."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene, point
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Heights of ± half the maximum, with the article's clamp."""
    for caption, technique, scale, max_offset in (
        ("normal mapping alone", "flat", 0.01, 0.0),
        ("a single step, height 0.01", "offset", 0.01, 0.01),
        ("a single step, height 0.04", "offset", 0.04, 0.04),
    ):
        obj = Object(
            sample("cobbles", texels),
            technique=technique,
            scale=scale,
            settings={} if technique == "flat" else {"max_offset": max_offset},
            surface_parameters={"specular": 0.15},
        )
        yield Panel(
            caption,
            Scene(
                (obj,),
                camera=CAMERA,
                lights=(point((-0.5, 0.6, 0.3), intensity=1.5, falloff=1.0),),
                shading_model="phong",
            ),
        )


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
    look="With parallax the near sides of the stones narrow and the far sides widen.",
    article="At an angle bumps should stick out and dents recede; a single read moves them by "
    "several pixels, for small heights.",
    ours="The same. At 0.01 the stones move by two or three pixels, visible when the pictures "
    "alternate; at 0.04 it is visible side by side.",
    panels=panels,
)
