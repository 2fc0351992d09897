"""Parallax on curved surfaces, where the tangent plane is only nearly the surface."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.shading.kinds import ShapeKind

CAMERA = Orbit(azimuth=30.0, elevation=15.0, field_of_view=30.0)


def panels(texels: int) -> Iterator[Panel]:
    """Growing strength on a sphere and on a cylinder; last a march."""
    shown: tuple[tuple[ShapeKind, str, float], ...] = (
        ("sphere", "offset", 0.03),
        ("sphere", "offset", 0.15),
        ("sphere", "relief", 0.15),
        ("cylinder", "offset", 0.03),
        ("cylinder", "offset", 0.15),
        ("cylinder", "relief", 0.15),
    )
    for shape, technique, strength in shown:
        obj = Object(
            sample("tiles" if shape == "cylinder" else "cobbles", texels),
            shape=shape,
            technique=technique,
            scale=strength,
            projection="biased" if technique == "offset" else "full",
        )
        yield Panel(f"{shape}, {technique}, {strength:g}", Scene((obj,), camera=CAMERA))


PAGE = Page(
    name="curved",
    title="Curved surfaces",
    source="catlike",
    rows={
        "C19": "a sphere and a cylinder, weak and strong",
        "C4": "tangent frames that turn from pixel to pixel",
    },
    look="Small strengths hold up; with greater ones the map slides and folds near the outline.",
    article="Curved surfaces have curved tangent spaces, so the result is physically wrong, which "
    "passes unseen while strength and curvature are small.",
    ours="The same, and the march shows it too: its ray falls in the tangent plane of the point "
    "it meets, so near the outline the stones are drawn out, while the outline stays round.",
    panels=panels,
)
