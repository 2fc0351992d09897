"""The pixel shader run as plain Python with the values of a program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from basrelief.lang import Buffer, HeightField, Texture, bound
from basrelief.lang.program import Program
from basrelief.lang.resources import members_of
from basrelief.lang.values import IVec2
from basrelief.shading import pixel as pixels
from basrelief.shading.geometry import Geometry, Vertex
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.shadow_map import ShadowMapView


def pixel_in_python(program: Program, values: Mapping[str, Any], x: int, y: int) -> pixels.Pixel:
    """One pixel of a program, computed in Python; missing maps get unused placeholders."""
    empty_texture = Texture([np.zeros((1, 1, 4), np.uint16)])
    empty_field = HeightField([np.zeros((1, 1))])
    arguments = {
        "field": empty_field,
        "baked": empty_texture,
        "distances": empty_field,
        "views": Buffer((), ShadowMapView),
    }
    grouped = ("maps_", "geometry_")
    arguments |= {name: value for name, value in values.items() if not name.startswith(grouped)}
    geometry = Geometry(values.get("geometry_vertices", Buffer((), Vertex)))
    surface_textures = {
        name: values.get(f"maps_{name}", empty_texture) for name in members_of(SurfaceMaps)
    }
    with bound(program.bindings):
        return pixels.pixel(
            IVec2(x, y),
            **arguments,
            geometry=geometry,
            maps=SurfaceMaps(**surface_textures),
            variant=program.variant,
        )
