"""Twenty samples against six."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=25.0, elevation=24.0, distance=0.95, field_of_view=38.0)


def panels(texels: int) -> Iterator[Panel]:
    """4 to 20 samples by angle, and 4 to 6."""
    for max_steps in (20, 6):
        obj = Object(
            sample("cobbles", texels),
            technique="parallax_occlusion",
            settings={"min_steps": 4, "max_steps": max_steps},
            scale=0.1,
        )
        yield Panel(f"at most {max_steps} samples", Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="sample-count",
    title="Twenty samples against six",
    source="gamedev",
    rows={
        "G4": "4 samples looking straight down, 20 or 6 along the surface",
        "G3": "the travel is length(V.xy) ÷ V.z × height scale",
        "G6": "the hit is on the chord between the last two samples",
        "G7": "the article's first comparison",
    },
    look="With six samples distant stones break into slices; with twenty they are whole.",
    article="The number of samples sets cost and quality: twenty look right, six show steps.",
    ours="The same. Interpolation hides steps on gentle slopes; look at the far sides of stones.",
    panels=panels,
)
