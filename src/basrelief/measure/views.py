"""Views of a material at an angle, so that the relief fills the picture at each of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.scene import LYING, Orbit, Scene, placed
from basrelief.scene.presets import scene_of

ANGLES = (0.0, 45.0, 60.0, 75.0, 85.0)
"""Degrees from the normal that a comparison looks from: head-on to grazing."""
STEEPEST = 89.0
SEEN = 0.5
"""How many tiles are as high as the picture."""
AZIMUTH = 30.0
"""From where the camera looks: along neither axis of the map."""


def at_angle(
    material: Material, angle: float, size: tuple[int, int], options: Mapping[str, Any]
) -> Scene:
    """A scene of one lying plane seen from an angle to its normal, in degrees, by an orthographic
    camera, so that the angle is that of every pixel.

    A tile is 1 world unit wide and repeats beyond the picture's edges. Wherever its `level` puts
    the relief, it fills the same space, from the ground down: pictures of several techniques show
    the same. `options` are those of `Object` and `Scene`. Raises InputError for an angle outside 0
    to 89.
    """
    if not 0.0 <= angle <= STEEPEST:
        raise InputError(f"an angle of {angle:g} degrees: give 0 (head-on) to {STEEPEST:g}")
    across, along = SEEN * size[0] / size[1], SEEN / math.cos(math.radians(angle))
    # whole tiles, and a power of two, which 32 bits divide by exactly
    reach = (math.hypot(across, along) + 1.0) * max(1.0, material.proportion)
    tiles = 2.0 ** math.ceil(math.log2(reach))
    camera = Orbit(
        azimuth=AZIMUTH,
        elevation=90.0 - angle,
        distance=SEEN * math.tan(math.radians(angle)) + 1.0,
        orthographic_height=SEEN,
    )
    lying = LYING @ placed(scale=(tiles, tiles / material.proportion, tiles))
    fixed = {"shape": "plane", "tiling": (tiles, tiles), "alpha": "opaque", "camera": camera}
    scene = scene_of(material, {**options, **fixed, "transform": lying})
    obj = scene.objects[0]
    sunk = placed((0.0, (obj.relief_reference_height - 1.0) * obj.relief_scale, 0.0))
    return replace(scene, objects=(replace(obj, transform=sunk @ lying),))
