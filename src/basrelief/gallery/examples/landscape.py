"""A landscape inside a quad, in motion."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from basrelief import LookAt, Material, Object, Scene, directional
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING, Layer, Tiling

UNITS = 5.0
"""The article's texture units across the quad: a tile of heights is five of them, one of colours
two and a half, and a step a hundredth of one."""
SPEED = 0.25
"""Units per second."""
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
        surface_parameters={"layer_normal": 0.0, "specular": 0.0},
        layer=Layer(sample("stone", texels), colors),
        transform=LYING,
        **options,
    )


def panels(texels: int) -> Iterator[Panel]:
    """The same view at two times, five times the height, and rays without a hit."""

    def scene(obj: Object, camera: LookAt = WINDOW) -> Scene:
        sun = (directional(-55.0, 32.0, intensity=1.7),)
        lambert = {"ambient": 0.2}
        return Scene((obj,), camera=camera, lights=sun, shading_model="phong", shading=lambert)

    for seconds in (0, 4):
        moved = land(texels).scrolled(SPEED * seconds / UNITS)
        yield Panel(f"after {seconds} seconds", scene(moved), "u scrolls ¼ unit per second")
    yield Panel("five times the height", scene(land(texels, 5.0)))
    yield Panel("rays without a hit are white", scene(land(texels, 2.0), LOW))


PAGE = Page(
    name="landscape",
    title="A landscape inside a quad",
    source="habrador",
    rows={
        "L1": "300 steps of a hundredth of a unit; height 1, then 5; Lambert's light",
        "L2": "the hit is a weighted average of the last two points",
        "L3": "grass below, stone above, blended by height; noise at 0.2, colours at 0.4",
        "L4": "water below the grey 0.4",
        "L5": "the land moves a quarter of a unit per second",
        "L6": "white where a ray has used all its steps",
    },
    look="Mountains of stone rise behind grass and water, and move from picture to picture.",
    article="A quad shows a landscape below it in motion: grass, stone on the mountains, water in "
    "the valleys, and a plain colour where no step hits the ground.",
    ours="The same, with other mountains, as the noise is our own. At five times the height the "
    "steps reach only three fifths of the depth; the rest is white.",
    panels=panels,
)
