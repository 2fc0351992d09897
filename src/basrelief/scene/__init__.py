"""Scenes: objects, cameras and lights as frozen records. Nothing here draws.

    Scene(objects=(Object(material, shape="sphere", technique="relief"),), camera=Orbit(azimuth=30))

Angles are in degrees, colours linear Rec. 709, the world is right-handed with y up.
"""

from basrelief.scene.checks import checked_record
from basrelief.scene.lights import directional, point, spot
from basrelief.scene.objects import (
    OWN_TILINGS,
    SURFACES,
    Layer,
    Object,
    Tiling,
    technique_named,
)
from basrelief.scene.scene import BACKGROUND, Scene
from basrelief.scene.shapes import SHAPES
from basrelief.scene.transforms import LYING, placed, rotated
from basrelief.scene.views import LookAt, Orbit

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
