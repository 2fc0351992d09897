"""Detail maps: unless the offset is scaled by their tiling, they float above the surface."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import Orbit, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import Layer, Tiling
from basrelief.settings.kinds import LayerOffsetKind

CAMERA = Orbit(azimuth=22.0, elevation=38.0, distance=0.45, field_of_view=38.0)
CAPTIONS: dict[LayerOffsetKind, str] = {
    "none": "details not displaced",
    "unscaled": "by the same offset",
    "scaled": "by the offset × 10",
}


def panels(texels: int) -> Iterator[Panel]:
    """A grid of 10 × 10 tiles over stones: undisplaced, by the offset as it is, and scaled."""
    grid = Layer(sample("grid", texels // 2), Tiling((10.0, 10.0)))
    for name, technique, scale in (("catlike", "offset", 0.08), ("catlike-march", "march", 0.1)):
        for layer_offset, caption in CAPTIONS.items():
            scene = preset(name).scene(
                sample("cobbles", texels),
                scale=scale,
                layer=grid,
                layer_offset=layer_offset,
                camera=CAMERA,
            )
            yield Panel(
                f"{technique}, {caption}",
                scene,
                f"layer: grid, 10 × 10 tiles, layer offset {layer_offset}",
            )


PAGE = Page(
    name="detail-grid",
    title="Detail maps",
    source="catlike",
    rows={"C10": "a grid of 10 × 10 tiles over stones of 1 × 1, with and without displacement"},
    look="Without displacement the lines are straight, with the offset of the stones nearly so; "
    "only the scaled offset bends them over the stones.",
    article="Without the offset details stay flat; with the offset itself they move too little; "
    "scaled by detail tiling ÷ main tiling they lie on the surface.",
    ours="The same, for a single step and for a march, which is deeper.",
    panels=panels,
)
