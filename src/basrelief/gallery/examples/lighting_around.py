"""The other maps of a material, added one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from basrelief import Map, Material, Object, Orbit, Scene, SurfaceParameters, directional
from basrelief.gallery.page import Page, Panel, sample

CAMERA = Orbit(azimuth=-25.0, elevation=34.0, distance=1.0, field_of_view=38.0)
STRONG = SurfaceParameters(normal_strength=2.0)
LIGHTS = (directional(150.0, 35.0, intensity=2.0), directional(-60.0, 40.0, intensity=1.0))


def glowing(material: Material) -> Material:
    """The material with an emission map on its copper."""
    assert material.metallic is not None
    copper = material.metallic.pixels[:, :, 0] > 127
    glow = np.where(copper[:, :, None], [255, 120, 20], 0).astype(np.uint8)
    return replace(material, emission=Map(glow, True, "copper, glowing"))


def panels(texels: int) -> Iterator[Panel]:
    """Colour and heights; then normals, occlusion, roughness and metal; then emission."""
    circuit = sample("circuit", texels)
    basic = replace(circuit, occlusion=None, roughness=None, metallic=None)
    flat_lit = SurfaceParameters(normal_strength=0.0)
    steps = (
        ("colour, displaced", basic, flat_lit),
        ("with normals", basic, SurfaceParameters()),
        ("with strong normals and occlusion", replace(basic, occlusion=circuit.occlusion), STRONG),
        ("with roughness and metal", circuit, SurfaceParameters()),
        ("with emission", glowing(circuit), SurfaceParameters()),
    )
    for caption, material, surface_parameters in steps:
        obj = Object(material, surface_parameters=surface_parameters)
        yield Panel(caption, Scene((obj,), camera=CAMERA, lights=LIGHTS))


PAGE = Page(
    name="lighting-around",
    title="Parallax in a complete shader",
    source="catlike",
    rows={
        "C21": "colour, normals with a strength, occlusion, roughness, metal, emission",
        "C5": "every map is read at the displaced coordinates",
    },
    look="Each map adds its effect, and all of them are aligned.",
    article="Parallax completes a shader that already has albedo, metallic, smoothness, normals, "
    "occlusion, emission and detail maps.",
    ours="The same; smoothness is 1 − roughness.",
    panels=panels,
)
