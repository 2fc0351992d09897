"""A landscape inside a quad, flown over."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import LookAt, Material, Object, Scene, directional
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING, Layer, Tiling

UNITS = 5.0
"""The article's texture coordinates over the quad: heights are read at a fifth of them, colours at
two fifths, and a step is a hundredth."""
SPEED = 0.25
"""Units a second."""
WINDOW = LookAt(position=(0.1, 0.52, 0.62), target=(0.0, -0.05, -0.1), field_of_view=52.0)
LOW = LookAt(position=(0.1, 0.16, 0.6), target=(0.0, -0.03, 0.0), field_of_view=44.0)


def land(texels: int, height: float = 1.0, **options: Any) -> Object:
    """The quad: height 1 is a unit deep."""
    heights, colors = Tiling((0.2 * UNITS,) * 2), Tiling((0.4 * UNITS,) * 2)
    ground = Material(
        "noise and grass",
        height=sample("noise", texels).height,
        base_color=sample("grass", texels).base_color,
    )
    return Object(
        ground,
        technique="fixed_length",
        settings={"steps": 300, "step_length": 0.2 * 0.01},
        scale=0.2 * height,
        tiling=heights.tiles,
        tilings={"base_color": colors},
        surface="landscape",
        layer=Layer(sample("stone", texels), colors),
        transform=LYING,
        **options,
    )


def panels(texels: int) -> Iterator[Panel]:
    """The same window at two times, twice the height, and rays that meet nothing."""

    def seen(obj: Object, camera: LookAt = WINDOW) -> Scene:
        sun = (directional(-55.0, 32.0, intensity=1.7),)
        lambert = {"ambient": 0.2, "specular": 0.0}
        return Scene((obj,), camera=camera, lights=sun, shading_model="phong", shading=lambert)

    for seconds in (0, 4):
        moved = land(texels).scrolled(SPEED * seconds / UNITS)
        yield Panel(f"after {seconds} seconds", seen(moved), "u scrolls ¼ unit a second")
    yield Panel("five times the height", seen(land(texels, 5.0)))
    yield Panel("rays that meet nothing are white", seen(land(texels, 2.0), LOW))


PAGE = Page(
    name="landscape",
    title="A landscape inside a quad",
    source="habrador",
    rows={
        "L1": "300 steps of a hundredth of a unit; height 1, then 5; Lambert's light",
        "L2": "the hit is a weighted average of the last two places",
        "L3": "grass below, stone above, blended by height; noise at 0.2, colours at 0.4",
        "L4": "water below the grey 0.4",
        "L5": "the land moves a quarter of a unit a second",
        "L6": "white where a ray has spent its steps",
    },
    look="Mountains of stone rise behind grass and water, and move from picture to picture.",
    article="A quad shows a landscape below it: grass, stone on the mountains, water in the "
    "valleys, moving along; a plain colour where no step meets the ground.",
    ours="The same. The noise is ours, so the mountains are others; at five times the height the "
    "steps reach only three fifths of the way down, and what lies deeper is white.",
    panels=panels,
)
