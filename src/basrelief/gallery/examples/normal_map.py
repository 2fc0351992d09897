"""A normal map on a quad, and its limits."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene, SurfaceParameters
from basrelief.gallery.page import Page, Panel, sample

FROM_ABOVE = Orbit(azimuth=20.0, elevation=52.0, distance=1.0, field_of_view=40.0)
SHALLOW = Orbit(azimuth=20.0, elevation=13.0, distance=0.85, field_of_view=36.0)


def quad(texels: int, strength: float, camera: Orbit) -> Scene:
    """A flat quad with the slopes of its normal map multiplied by `strength`."""
    surface_parameters = SurfaceParameters(normal_strength=strength)
    obj = Object(sample("bricks", texels), technique="flat", surface_parameters=surface_parameters)
    return Scene((obj,), camera=camera)


def panels(texels: int) -> Iterator[Panel]:
    """From above and at a shallow angle, with weaker and stronger normals."""
    yield Panel("without the normal map", quad(texels, 0.0, FROM_ABOVE))
    yield Panel("with the normal map", quad(texels, 1.0, FROM_ABOVE))
    yield Panel("with the normal map, at a shallow angle", quad(texels, 1.0, SHALLOW))
    yield Panel("strong normals at a shallow angle", quad(texels, 4.0, SHALLOW))


PAGE = Page(
    name="normal-map",
    title="Limits of a normal map",
    source="catlike",
    rows={
        "C3": "nothing is displaced, so the programs have no parallax code: 0 reads",
        "C4": "one tangent frame takes normals to world space and the view ray to tangent space",
    },
    look="The bricks are shaded, but none hides the joint behind it.",
    article="A normal map makes the quad look uneven, but at a shallow angle it has the parallax "
    "of a flat surface. Stronger normals look weird, and as flat.",
    ours="The same. Our normals fit the heights, which are shallow; four times as strong, the "
    "sides of the bricks turn dark and the surface looks embossed, not deep.",
    panels=panels,
)
