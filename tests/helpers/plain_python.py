"""The whole pixel as plain Python, with the values of a program."""

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
from basrelief.shading.shadow_map import ShadowMapView
from basrelief.shading.surfaces.surface import SurfaceMaps


def pixel_in_python(program: Program, values: Mapping[str, Any], x: int, y: int) -> pixels.Pixel:
    """One pixel of a program, stepped through as it stands; something unread for missing maps."""
    nothing = Texture([np.zeros((1, 1, 4), np.uint16)])
    zero = HeightField([np.zeros((1, 1))])
    given = {"field": zero, "baked": nothing, "distances": zero, "views": Buffer((), ShadowMapView)}
    apart = ("maps_", "geometry_")
    given |= {name: value for name, value in values.items() if not name.startswith(apart)}
    geometry = Geometry(values.get("geometry_vertices", Buffer((), Vertex)))
    of_surface = {name: values.get(f"maps_{name}", nothing) for name in members_of(SurfaceMaps)}
    with bound(program.bindings):
        return pixels.pixel(
            IVec2(x, y),
            **given,
            geometry=geometry,
            maps=SurfaceMaps(**of_surface),
            variant=program.variant,
        )
