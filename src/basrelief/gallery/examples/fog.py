"""Fog over cobbles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import LookAt, Object, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING, placed

CAMERA = LookAt(position=(0.0, 0.55, 4.0), target=(0.0, -0.1, 0.0), field_of_view=36.0)
FOG_COLOR = (0.5, 0.55, 0.6)


def panels(texels: int) -> Iterator[Panel]:
    """The same plane in clear air and in three kinds of fog."""
    plane = Object(
        sample("cobbles", texels),
        scale=0.08,
        tiling=(9.0, 9.0),
        transform=LYING @ placed(scale=9.0),
    )
    for fog_mode, fog in (
        ("none", {}),
        ("linear", {"fog_start": 1.5, "fog_end": 8.0}),
        ("exponential", {"fog_density": 0.3}),
        ("exponential_squared", {"fog_density": 0.2}),
    ):
        options: dict[str, Any] = {"fog_mode": fog_mode, "fog": fog, "background": FOG_COLOR}
        numbers = ", ".join(f"{name.replace('_', ' ')} {value:g}" for name, value in fog.items())
        yield Panel(
            f"{fog_mode.replace('_', ' ')} fog" if fog else "clear air",
            Scene((plane,), camera=CAMERA, **options),
            numbers,
        )


PAGE = Page(
    name="fog",
    title="Fog",
    source="catlike",
    rows={"C21": "linear, exponential and squared exponential fog by the distance of the hit"},
    look="The plane fades into the fog; near the camera squared fog is the clearest.",
    article="The shader's fog depends on distance and is applied after the parallax.",
    ours="The same; the distance is that of the displaced point.",
    panels=panels,
)
