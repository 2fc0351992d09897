"""A shallow and a deep relief from the same heights."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=38.0, distance=0.85, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """Height scale 0.1 and 0.4, both with 4 to 20 samples; then 0.4 with more."""
    for scale, max_steps in ((0.1, 20), (0.4, 20), (0.4, 100)):
        obj = Object(
            sample("cobbles", texels),
            technique="parallax_occlusion",
            settings={"min_steps": 4, "max_steps": max_steps},
            scale=scale,
        )
        yield Panel(
            f"height scale {scale:g}, at most {max_steps} samples", Scene((obj,), camera=CAMERA)
        )


PAGE = Page(
    name="height-scale",
    title="Height scale 0.1 against 0.4",
    source="gamedev",
    rows={
        "G7": "the article's second comparison, at the same sampling rates",
        "G3": "four times the scale, four times the travel",
    },
    look="At 0.4 the same twenty samples are too few for the longer travel: the stones are ragged.",
    article="The scale is the depth of the simulated volume relative to its width; 0.1 and 0.4 are "
    "shown with at most twenty samples.",
    ours="The same; the third picture adds 0.4 with a hundred samples.",
    panels=panels,
)
