"""Parallax on curved surfaces, which the tangent plane approximates."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.settings.kinds import ShapeKind

CAMERA = Orbit(azimuth=30.0, elevation=15.0, field_of_view=30.0)


def panels(texels: int) -> Iterator[Panel]:
    """Increasing strength on a sphere and a cylinder, and a march."""
    choices: tuple[tuple[ShapeKind, str, float], ...] = (
        ("sphere", "offset", 0.03),
        ("sphere", "offset", 0.15),
        ("sphere", "relief", 0.15),
        ("cylinder", "offset", 0.03),
        ("cylinder", "offset", 0.15),
        ("cylinder", "relief", 0.15),
    )
    for shape, technique, strength in choices:
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
        "C4": "tangent frames that vary from pixel to pixel",
    },
    look="Small strengths look right; with larger ones the map slides and folds near the outline.",
    article="Curved surfaces have curved tangent spaces, so the result is physically wrong, which "
    "is not visible while strength and curvature are small.",
    ours="The same, also for the march: its ray uses the tangent plane of the point on the "
    "polygon, so the stones are stretched near the outline, which stays round.",
    panels=panels,
)
