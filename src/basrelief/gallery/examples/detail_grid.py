"""Detail maps: unless the offset is scaled by their tiling, they float above the surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from basrelief import Map, Material, Object, Orbit, Scene
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Layer, Tiling, placed

CAMERA = Orbit(azimuth=22.0, elevation=34.0, distance=0.8, field_of_view=38.0)
TEN = (10.0, 10.0)


def glass(grid: Material) -> Material:
    """The grid's dark lines on transparent glass."""
    assert grid.base_color is not None
    light = grid.base_color.pixels.mean(axis=2, keepdims=True)
    lines = np.where(light < 0.6 * light.max(), 255, 0).astype(np.uint8)
    return replace(grid, normal=None, opacity=Map(lines, False, "lines of the grid"))


def panels(texels: int) -> Iterator[Panel]:
    """The grid on the undisplaced surface, then as a layer, with an offset and with a march."""
    cobbles, grid = sample("cobbles", texels), sample("grid", texels // 2)
    for technique in ("offset", "relief"):
        stones = Object(
            cobbles, technique=technique, scale=0.1, projection="biased", reference_height=1.0
        )
        glass_grid = Object(glass(grid), tiling=TEN, alpha="blend")
        above = replace(
            glass_grid, transform=placed((0.0, 1e-3, 0.0)) @ glass_grid.resolved.transform
        )
        yield Panel(
            f"{technique}, details not displaced",
            Scene((stones, above), camera=CAMERA),
            "the grid on a transparent plane above the polygon",
        )
        layered = replace(stones, layer=Layer(grid, Tiling(TEN)))
        yield Panel(
            f"{technique}, details displaced by the offset × 10",
            Scene((layered,), camera=CAMERA),
            "layer: grid, 10 × 10 tiles",
        )


PAGE = Page(
    name="detail-grid",
    title="Detail maps",
    source="catlike",
    rows={"C10": "a grid of 10 × 10 tiles over stones of 1 × 1, with and without displacement"},
    look="Without displacement the lines are straight; with it they follow the stones.",
    article="Without the offset details stay flat; with the offset itself they move too little; "
    "scaled by detail tiling ÷ main tiling they lie on the surface.",
    ours="The same. The library has no option for the error, so the first picture imitates it: "
    "the grid is on a transparent plane above the polygon.",
    panels=panels,
)
