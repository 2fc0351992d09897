"""Self-shadows of a relief: none, hard and soft."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Orbit, directional, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(
    azimuth=-10.0,
    elevation=60.0,
    distance=0.4,
    target=(-0.08, 0.0, -0.05),
    field_of_view=30.0,
)
LIGHTS = (directional(70.0, 26.0, intensity=2.6),)


def panels(texels: int) -> Iterator[Panel]:
    """The same stones in a low light, with three kinds of self-shadow."""
    for caption, shadows in (
        ("no shadow", "none"),
        ("hard shadow", "hard"),
        ("soft shadow", "soft"),
    ):
        scene = preset("halliwell").scene(
            sample("cobbles", texels),
            scale=0.12,
            shadows=shadows,
            shadowing={"light_angle": 30.0},
            occlusion_kind="ambient",
            camera=CAMERA,
            lights=LIGHTS,
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="self-shadow",
    title="Hard and soft self-shadows",
    source="halliwell",
    rows={
        "H3": "a march from the hit to the light: hard or soft occlusion",
    },
    look="The pale stone in the middle casts a shadow on the red one: first none, then one with a "
    "sharp edge, then one that fades out.",
    article="A march from the hit towards the light finds whether the light reaches it.",
    ours="The same, with the settings of the preset `halliwell` in a deeper relief and without its "
    "directional occlusion, and a soft form, of a light that spans 30°. Reads include the march "
    "to the light.",
    panels=panels,
)
