"""Views of a material at an angle, in which its relief fills the picture."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.scene import LYING, Orbit, Scene, Tiling, placed
from basrelief.scene.presets import scene_of

ANGLES = (0.0, 45.0, 60.0, 75.0, 85.0)
"""Default angles between view and normal, in degrees: head-on to grazing."""
MAX_ANGLE = 89.0
SET_BY_MEASURE = (
    "shape", "tiling", "transform", "camera", "technique", "alpha", "edge", "fade", "heights",
)  # fmt: skip
"""Options of `Object` and `Scene` that a measurement decides itself."""
VIEW_HEIGHT = 0.5
"""Height of the view, in tiles."""
AZIMUTH = 30.0
"""Azimuth of the camera in degrees: along neither axis of the map."""


def at_angle(
    material: Material, angle: float, size: tuple[int, int], options: Mapping[str, Any]
) -> Scene:
    """A scene of one horizontal plane, seen at an angle to its normal in degrees.

    The camera is orthographic, so all pixels have the same angle. A tile is 1 world unit wide and
    repeats beyond the picture's edges. The relief lies between the ground and one height range
    below it whatever its reference height, so that pictures of several techniques show the same.
    `options` are fields of `Object` and `Scene`; tilings of single maps and of the layer are those
    of one tile of the heights. Raises InputError for an angle outside 0 to 89.
    """
    if not 0.0 <= angle <= MAX_ANGLE:
        raise InputError(f"an angle of {angle:g} degrees: give 0 (head-on) to {MAX_ANGLE:g}")
    across, along = VIEW_HEIGHT * size[0] / size[1], VIEW_HEIGHT / math.cos(math.radians(angle))
    # a power of two, by which 32-bit numbers are divided exactly
    reach = (math.hypot(across, along) + 1.0) * max(1.0, material.proportion)
    tiles = 2.0 ** math.ceil(math.log2(reach))
    camera = Orbit(
        azimuth=AZIMUTH,
        elevation=90.0 - angle,
        distance=VIEW_HEIGHT * math.tan(math.radians(angle)) + 1.0,
        orthographic_height=VIEW_HEIGHT,
    )
    lying = LYING @ placed(scale=(tiles, tiles / material.proportion, tiles))
    options = in_proportion(options, tiles, tiles)
    fixed = {"shape": "plane", "tiling": (tiles, tiles), "alpha": "opaque", "camera": camera}
    scene = scene_of(material, {**options, **fixed, "transform": lying})
    (obj,) = scene.objects
    height = (obj.resolved.reference_height - 1.0) * obj.resolved.scale
    lowered = placed((0.0, height, 0.0)) @ lying
    return replace(scene, objects=(replace(obj, transform=lowered),))


def in_proportion(options: Mapping[str, Any], u: float, v: float) -> dict[str, Any]:
    """Options with the tilings of single maps and of the layer times u and v."""

    def scaled(tiling: Tiling) -> Tiling:
        return replace(tiling, tiles=(tiling.tiles[0] * u, tiling.tiles[1] * v))

    changed = dict(options)
    if options.get("tilings"):
        changed["tilings"] = {name: scaled(own) for name, own in options["tilings"].items()}
    if options.get("layer") is not None:
        changed["layer"] = replace(options["layer"], tiling=scaled(options["layer"].tiling))
    return changed
