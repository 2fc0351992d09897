"""Normal mapping against a single step of parallax mapping."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene, point
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Heights of ± half the most, clamped to what the article allows."""
    for caption, technique, scale, most in (
        ("normal mapping alone", "flat", 0.01, 0.0),
        ("a single step, height 0.01", "offset", 0.01, 0.01),
        ("a single step, height 0.04", "offset", 0.04, 0.04),
    ):
        obj = Object(
            sample("cobbles", texels),
            technique=technique,
            scale=scale,
            settings={} if technique == "flat" else {"max_offset": most},
        )
        yield Panel(
            caption,
            Scene(
                (obj,),
                camera=CAMERA,
                lights=(point((-0.5, 0.6, 0.3), intensity=1.5, falloff=1.0),),
                shading_model="phong",
                shading={"specular": 0.15},
            ),
        )


PAGE = Page(
    name="single-step",
    title="Normal mapping against a single step",
    source="wikibooks",
    rows={
        "W1": "offset = height · V.xy ÷ V.z, from one read",
        "W2": "height = most · (h − ½), with 0.01 and 0.04 for the most",
        "W6": "heights may lie in A or in R; once loaded there is no difference",
        "W7": "nor is there once z is rebuilt from normals in A and G",
    },
    look="With height the near sides of the stones draw together and the far sides open.",
    article="Seen from an angle, bumps ought to stick out and dents to recede; a single read moves "
    "them by several pixels, within small heights.",
    ours="The same. At 0.01 the stones move by two or three pixels, which shows when one picture "
    "is laid over the other; 0.04 shows it side by side.",
    panels=panels,
)
