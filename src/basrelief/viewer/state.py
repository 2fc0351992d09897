"""What a page starts with: the scene's numbers, every technique's settings, shapes, presets."""

from __future__ import annotations

import inspect
import math
from dataclasses import replace
from typing import Any

import numpy as np

from basrelief._version import __version__
from basrelief.errors import BasreliefError, InputError
from basrelief.material import Material, pyramids
from basrelief.measure.colors import COUNT, PASSED, SHORT, heat
from basrelief.presets import PRESETS, preset
from basrelief.programs import values_of
from basrelief.rendering import sample_places
from basrelief.scene import SHAPES, LookAt, Object, Orbit, Scene
from basrelief.scene.views import FILLED
from basrelief.shaders.height import Smoothing
from basrelief.shaders.lighting import DIRECTIONAL, Light, Shading
from basrelief.shaders.shadow import Shadowing
from basrelief.shaders.surfaces.standard import Finish
from basrelief.shaders.techniques import TECHNIQUES
from basrelief.viewer.bakes import BAKED_NORMALS, bake_numbers
from basrelief.viewer.layouts import plain, settings_of
from basrelief.viewer.printed import CHOICES

SAMPLES = 16
"""Places in a pixel that a picture at rest is averaged over."""
_KINDS = ("directional", "point", "spot")


def manifest(
    scene: Scene, material: Material, source: str, scaled: tuple[int, int] | None
) -> dict[str, Any]:
    """What the page knows beside programs and maps."""
    thing = replace(scene.objects[0], material=material)
    return {
        "name": material.name,
        "version": __version__,
        "source": source,
        "scaledTo": scaled,
        "hasHeights": material.height is not None,
        "choices": CHOICES,
        "bakedNormals": BAKED_NORMALS,
        "bakes": bake_numbers(),
        "techniques": {name: _technique(made) for name, made in TECHNIQUES.items()},
        "shapes": {shape: _shape(material, shape) for shape in SHAPES},
        "settings": {
            "finish": settings_of(Finish),
            "shading": settings_of(Shading),
            "shadowing": settings_of(Shadowing),
            "smoothing": settings_of(Smoothing),
        },
        "constants": _constants(scene, thing),
        "filled": FILLED,
        "samples": sample_places(SAMPLES),
        "state": state_of(scene, thing),
        "defaults": _defaults_of(material),
        "colors": {
            "heat": [[round(float(x), 5) for x in c] for c in heat(np.linspace(0.0, 1.0, COUNT))],
            "short": [float(x) for x in SHORT],
            "passed": [float(x) for x in PASSED],
        },
        "presets": _presets(material),
    }


def _technique(made: Any) -> dict[str, Any]:
    doc = inspect.cleandoc(made.__doc__ or "").split("\n\n")
    return {
        "doc": " ".join(doc[0].split()),
        "level": made.level,
        "projection": made.projection,
        "mostReads": made.most_reads,
        "bake": made.bake,
        "boxes": made.boxes,
        "settings": settings_of(made.settings),
    }


def _shape(material: Material, shape: str) -> dict[str, Any]:
    """Where a shape stands, how many tiles it has, and the points that it lies between."""
    thing = Object(material, shape=shape, technique="flat")
    placement = plain(thing.placement())
    return {
        "origin": placement["origin"],
        "to_object": placement["to_object"],
        "proportion": placement["proportion"],
        "tiling": list(map(float, thing.tiles)),
        "outline": [[round(float(x), 9) for x in point] for point in thing.outline()],
    }


def _constants(scene: Scene, thing: Object) -> dict[str, Any]:
    """What the page's controls leave as it is: records, and an emission map's own brightness."""
    values = values_of(thing, scene, (16, 9))
    background = scene.background or (0.0, 0.0, 0.0)
    glow = pyramids.emission(thing.material, "wrap")
    return {
        "places": plain(values["places"]),
        "fog": plain(values["fog"]),
        "background": list(background),
        "glow": glow[1] if glow else 1.0,
    }


def state_of(scene: Scene, thing: Object) -> dict[str, Any]:
    """Everything that a person can change, as it is in a scene."""
    made = {
        "technique": thing.drawn_with.name,
        "shape": thing.shape,
        "shadows": scene.shadows,
        "projection": thing.relief_projection,
        "shading_model": scene.shading_model,
        "scale": thing.relief_scale,
        "level": thing.relief_level,
        "bias": float(thing.bias),
        "tiling": list(map(float, thing.tiles)),
        "shift": list(map(float, thing.shift)),
        "settings": {name: _defaults(each) for name, each in TECHNIQUES.items()},
        "finish": plain(thing.finish),
        "smoothing": plain(thing.smoothing),
        "shading": plain(scene.shading),
        "shadowing": plain(scene.shadowing),
        "lights": [_light(each) for each in scene.lights],
        "camera": _camera(scene),
    }
    made["settings"][thing.drawn_with.name] = plain(thing.settings)
    return made


def _defaults_of(material: Material) -> dict[str, Any]:
    """What the library takes where nothing is said."""
    thing = Object(material, technique="flat")
    return {
        "scale": thing.relief_scale,
        "bias": float(thing.bias),
        "lights": [_light(each) for each in Scene(()).lights],
    }


def _defaults(made: Any) -> dict[str, Any]:
    return {each["name"]: each["default"] for each in settings_of(made.settings)}


def _camera(scene: Scene) -> dict[str, Any]:
    """The camera as an orbit; one that stands somewhere is taken for the orbit it lies on."""
    camera = scene.camera
    if isinstance(camera, LookAt):
        away = [p - t for p, t in zip(camera.position, camera.target, strict=True)]
        distance = math.hypot(*away)
        camera = Orbit(
            math.degrees(math.atan2(away[0], away[2])),
            math.degrees(math.asin(away[1] / distance)),
            distance,
            camera.target,
            camera.field_of_view,
            camera.orthographic_height,
        )
    return {
        "azimuth": float(camera.azimuth),
        "elevation": float(camera.elevation),
        "distance": None if camera.distance is None else float(camera.distance),
        "target": list(map(float, camera.target)),
        "field_of_view": float(camera.field_of_view),
        "orthographic_height": camera.orthographic_height,
    }


def _light(light: Light) -> dict[str, Any]:
    """A light with its strength apart from its colour, and its direction as angles."""
    said = plain(light)
    intensity = max(*said["color"], 1e-9)
    x, y, z = (-float(each) for each in light.direction)
    return {
        **said,
        "kind": _KINDS[int(light.kind)],
        "color": [round(each / intensity, 6) for each in said["color"]],
        "intensity": intensity,
        "azimuth": round(math.degrees(math.atan2(x, z)), 4),
        "elevation": round(math.degrees(math.asin(max(-1.0, min(1.0, y)))), 4),
        "turned": int(light.kind) == DIRECTIONAL,
    }


def _presets(material: Material) -> dict[str, Any]:
    """The presets as states; those that a page's programs cannot draw say why not."""
    found: dict[str, Any] = {}
    for name in PRESETS:
        chosen = preset(name)
        try:
            scene = chosen.scene(material)
        except BasreliefError as error:
            found[name] = {"about": chosen.about, "why": str(error)}
            continue
        thing = scene.objects[0]
        lost = beyond(scene, thing)
        found[name] = {"about": " ".join(chosen.about.split())}
        if lost:
            found[name]["why"] = lost
        else:
            found[name]["state"] = state_of(scene, thing)
    return found


def check_shown(scene: Scene) -> None:
    """Raise InputError for a scene that a page's programs cannot draw."""
    if not scene.objects:
        raise InputError("there is nothing in the scene to show")
    lost = beyond(scene, scene.objects[0])
    if lost:
        raise InputError(f"the scene {lost}; leave that away")


def beyond(scene: Scene, thing: Object) -> str:
    """What of a scene a page's programs do not have, in words; "" where they have all of it."""
    for lost, what in (
        (thing.surface != "standard", "a landscape"),
        (thing.layer is not None, "a second layer"),
        (thing.heights != "sharp", "smooth heights"),
        (scene.occlusion_kind != "ambient", "occlusion with a direction"),
        (scene.fog != "none", "fog"),
        (bool(thing.tilings), "maps with tilings of their own"),
        (thing.mapping != "planar", "tri-planar colour"),
        (thing.edge != "wrap", "maps that do not repeat"),
        (thing.fade is not None, "a relief that fades"),
        (thing.alpha != "blend", "a cut-out"),
        (thing.transform is not None, "a transform"),
        (len(scene.objects) > 1, "further objects"),
        (TECHNIQUES.get(thing.drawn_with.name) is not thing.drawn_with, "a technique of one's own"),
    ):
        if lost:
            return f"has {what}, which the page does not draw"
    return ""
