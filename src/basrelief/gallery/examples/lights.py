"""Several lights on a displaced surface, which add up."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Light, Object, Orbit, Scene, directional, point
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)
SUN = directional(-60.0, 30.0, color=(1.0, 0.9, 0.75), intensity=1.2)
LINEAR_LAMP = point((0.25, 0.12, 0.15), color=(0.3, 0.6, 1.0), intensity=0.22, falloff=1.0)
SQUARE_LAMP = point((0.25, 0.12, 0.15), color=(0.3, 0.6, 1.0), intensity=0.06, falloff=2.0)
RED_LAMP = point((-0.25, 0.12, -0.2), color=(1.0, 0.25, 0.1), intensity=0.2, falloff=1.0)


def panels(texels: int) -> Iterator[Panel]:
    """The sun, a lamp with each falloff, a light from behind, and sums of lights."""
    obj = Object(
        sample("cobbles", texels),
        technique="relief",
        scale=0.08,
        surface_parameters={"specular": 0.2, "shininess": 10.0},
    )

    def lit(*lights: Light) -> Scene:
        return Scene(
            (obj,),
            camera=CAMERA,
            lights=lights,
            shading_model="phong",
            shading={"ambient": 0.03},
        )

    yield Panel("a directional light", lit(SUN))
    yield Panel("a point light, 1 ÷ distance", lit(LINEAR_LAMP))
    yield Panel("a point light, 1 ÷ distance²", lit(SQUARE_LAMP))
    yield Panel("a light from behind", lit(directional(-60.0, -75.0)))
    yield Panel("two lights", lit(SUN, LINEAR_LAMP))
    yield Panel("three lights", lit(SUN, LINEAR_LAMP, RED_LAMP))


PAGE = Page(
    name="lights",
    title="Several lights",
    source="wikibooks",
    rows={
        "W8": "ambient, diffuse and specular, with shininess 10",
        "W9": "a directional light, a lamp with 1 ÷ distance, one with its square",
        "W10": "one, two and three lights, added",
        "C17": "the relief is the same in every light",
    },
    look="The stones are at the same place in every light; with a light from behind only ambient "
    "light remains, without highlights.",
    article="One pass for the first light and the ambient light, one for each further light, "
    "added; no highlight from a light behind the surface; a lamp falls off with 1 ÷ distance.",
    ours="The same in one pass. The inverse square is another option.",
    panels=panels,
)
