"""The other maps of a material, added one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from basrelief import LookAt, Map, Material, directional, preset
from basrelief.gallery.page import Page, Panel, sample

CAMERA = LookAt(position=(-0.2, 0.33, 0.36), target=(-0.06, 0.0, -0.04), field_of_view=36.0)
LOW_SUN = (directional(100.0, 16.0, intensity=2.4),)


def glowing(material: Material) -> Material:
    """The material with an emission map: tracks of copper glow, other metal does not."""
    assert material.base_color is not None
    red, _, blue = np.moveaxis(material.base_color.pixels[:, :, :3].astype(np.int16), 2, 0)
    copper = red > blue + 60
    glow = np.where(copper[:, :, None], [255, 90, 10], 0).astype(np.uint8)
    return replace(material, emission=Map(glow, True, "copper, glowing"))


def panels(texels: int) -> Iterator[Panel]:
    """Colour and heights; then normals; occlusion; roughness and metal; emission."""
    circuit = sample("circuit", texels)
    plain = replace(circuit, occlusion=None, roughness=None, metallic=None)
    for caption, material, strength in (
        ("colour", plain, 0.0),
        ("and normals, twice as strong", plain, 2.0),
        ("and occlusion", replace(plain, occlusion=circuit.occlusion), 2.0),
        ("and roughness and metal", circuit, 2.0),
        ("and emission", glowing(circuit), 2.0),
    ):
        scene = preset("catlike-march").scene(
            material,
            scale=0.06,
            surface_parameters={"normal_strength": strength},
            camera=CAMERA,
            lights=LOW_SUN,
            shading={"ambient": 0.6},
        )
        yield Panel(caption, scene)


PAGE = Page(
    name="lighting-around",
    title="Parallax in a complete shader",
    source="catlike",
    rows={
        "C21": "colour, normals with a strength, occlusion, roughness, metal, emission",
        "C5": "every map is read at the displaced coordinates",
    },
    look="Normals give the parts edges, occlusion darkens their feet, the box and the pads turn to "
    "metal, and the copper glows, all exactly where the displaced colours are.",
    article="Parallax completes a shader that already has albedo, metallic, smoothness, normals, "
    "occlusion, emission and detail maps.",
    ours="The same, with the article's final march at twice its strength; smoothness is 1 − "
    "roughness. Occlusion darkens the ambient light alone, so that is strong here.",
    panels=panels,
)
