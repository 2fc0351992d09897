"""Scenes: objects, cameras and lights as frozen records. Nothing here draws.

    Scene(objects=(Object(material, shape="sphere", technique="relief"),), camera=Orbit(azimuth=30))

Angles are in degrees, colours linear Rec. 709, the world is right-handed with y up. Names are
imported on first use, since the command line's help reads the records of this package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basrelief.lazy import lazy_names

if TYPE_CHECKING:
    from basrelief.scene.lights import directional, point, spot
    from basrelief.scene.objects import Object
    from basrelief.scene.records import checked_record
    from basrelief.scene.resolve import SURFACES, ResolvedObject, technique_named
    from basrelief.scene.scene import BACKGROUND, Scene
    from basrelief.scene.shapes import SHAPES
    from basrelief.scene.tilings import OWN_TILINGS, Layer, Tiling
    from basrelief.scene.transforms import LYING, placed, rotated
    from basrelief.scene.views import LookAt, Orbit

__getattr__ = lazy_names(
    __name__,
    {
        "lights": ("directional", "point", "spot"),
        "objects": ("Object",),
        "records": ("checked_record",),
        "resolve": ("SURFACES", "ResolvedObject", "technique_named"),
        "scene": ("BACKGROUND", "Scene"),
        "shapes": ("SHAPES",),
        "tilings": ("OWN_TILINGS", "Layer", "Tiling"),
        "transforms": ("LYING", "placed", "rotated"),
        "views": ("LookAt", "Orbit"),
    },
)

__all__ = [
    "BACKGROUND",
    "LYING",
    "OWN_TILINGS",
    "SHAPES",
    "SURFACES",
    "Layer",
    "LookAt",
    "Object",
    "Orbit",
    "ResolvedObject",
    "Scene",
    "Tiling",
    "checked_record",
    "directional",
    "placed",
    "point",
    "rotated",
    "spot",
    "technique_named",
]  # fmt: skip
