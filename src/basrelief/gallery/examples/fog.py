"""Fog over a plain of stones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import LookAt, Object, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING, placed

CAMERA = LookAt(position=(0.0, 0.55, 4.0), target=(0.0, -0.1, 0.0), field_of_view=36.0)
AIR = (0.5, 0.55, 0.6)


def panels(texels: int) -> Iterator[Panel]:
    """The same plain through clear air and through three kinds of fog."""
    plain = Object(
        sample("cobbles", texels),
        scale=0.08,
        tiling=(9.0, 9.0),
        transform=LYING @ placed(scale=9.0),
    )
    for kind, air in (
        ("none", {}),
        ("linear", {"fog_start": 1.5, "fog_end": 8.0}),
        ("exponential", {"fog_density": 0.3}),
        ("exponential_squared", {"fog_density": 0.2}),
    ):
        options: dict[str, Any] = {"fog_mode": kind, "fog": air, "background": AIR}
        numbers = ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in air.items())
        yield Panel(
            f"{kind.replace('_', ' ')} fog" if air else "clear air",
            Scene((plain,), camera=CAMERA, **options),
            numbers,
        )


PAGE = Page(
    name="fog",
    title="Fog",
    source="catlike",
    rows={"C21": "linear, exponential and squared fog by the distance of what is met"},
    look="The plain goes over into the air; near the camera squared fog is the clearest.",
    article="The shader's fog goes by distance, around the parallax.",
    ours="The same; the distance is that of the displaced point.",
    panels=panels,
)
