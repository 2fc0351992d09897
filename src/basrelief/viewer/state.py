"""Initial data of a page: the scene's state, settings of techniques, shapes, presets."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from basrelief._version import __version__
from basrelief.errors import BasreliefError, InputError
from basrelief.material import Material
from basrelief.measure.colors import COUNT, PASSED, SHORT, heat
from basrelief.rendering import textures
from basrelief.rendering.render import sample_positions
from basrelief.scene import SHAPES, SURFACES, LookAt, Object, Orbit, Scene, Tiling
from basrelief.scene.lights import LIGHTS, light_kind, light_parameters
from basrelief.scene.presets import PRESETS, preset
from basrelief.scene.records import SCENE_RECORDS
from basrelief.scene.resolve import default_scale, default_tiles, default_transform
from basrelief.scene.scene import default_lights
from basrelief.scene.tilings import OWN_TILINGS
from basrelief.scene.views import FRAME_FILL
from basrelief.settings import settings_of
from basrelief.settings.kinds import ShapeKind
from basrelief.shading.lights import Light
from basrelief.techniques import TECHNIQUES, Technique
from basrelief.techniques.height import Smoothing
from basrelief.viewer.bakes import bake_numbers
from basrelief.viewer.controls import controls, light_settings, limits, numbers_of
from basrelief.viewer.layouts import json_value
from basrelief.viewer.names import names
from basrelief.viewer.printed import MENUS

SAMPLES = 16
"""Samples per pixel of a picture at rest."""
SHOWS = ("color", "reads", "missed", "depth")
"""Pictures that a page can show."""


@dataclass(frozen=True)
class Sources:
    """Names of the material and its layer in the Python and the commands that a page copies.

    Attributes
    ----------
    material : str or None
        The material as `basrelief.load` takes it; None for the name of a procedural sample, or
        else a placeholder.
    reading : mapping
        Options of `basrelief.load`.
    layer : str or None
        The layer's material, as above.
    """

    material: str | None = None
    reading: Mapping[str, Any] = field(default_factory=dict)
    layer: str | None = None


def _source_name(material: Material | None, otherwise: str) -> str:
    """A material's name on a command line: sample:NAME of a procedural sample, else `otherwise`."""
    if material is None:
        return otherwise
    sources = [map.source for _, map in material.maps()]
    is_sample = all(source.startswith(f"sample {material.name},") for source in sources)
    return f"sample:{material.name}" if is_sample and sources else otherwise


def manifest(scene: Scene, sources: Sources, scaled: tuple[int, int] | None) -> dict[str, Any]:
    """The data of a page, except its programs and maps."""
    obj = scene.objects[0]
    material = obj.material
    layer = None if obj.layer is None else obj.layer.material
    techniques = techniques_of(obj)
    return {
        "name": material.name,
        "version": __version__,
        "source": sources.material or _source_name(material, "FOLDER"),
        "reading": dict(sources.reading),
        "layerSource": sources.layer or _source_name(layer, "LAYER"),
        "scaledTo": scaled,
        "hasHeights": material.height is not None,
        "mapSources": {kind: map.source for kind, map in material.maps()},
        "bakes": bake_numbers(),
        "menus": {"technique": tuple(techniques), **MENUS},
        "techniques": {name: _technique(technique) for name, technique in techniques.items()},
        "shapes": {shape: _shape(obj, shape) for shape in SHAPES},
        "settings": {
            "surface_parameters": {name: numbers_of(record) for name, record in SURFACES.items()},
            "smoothing": numbers_of(Smoothing),
            **{name: numbers_of(record) for name, (record, _) in SCENE_RECORDS.items()},
        },
        "controls": controls(),
        "constants": _constants(obj),
        "filled": FRAME_FILL,
        "samples": sample_positions(SAMPLES),
        "state": state_of(scene, obj, techniques),
        "defaults": _defaults_of(material),
        "colors": {
            "heat": [[round(float(x), 5) for x in c] for c in heat(np.linspace(0.0, 1.0, COUNT))],
            "short": [float(x) for x in SHORT],
            "passed": [float(x) for x in PASSED],
        },
        "presets": _presets(material, obj, techniques),
        "shows": SHOWS,
        "lightKinds": {kind: [*light_parameters(kind)] for kind in LIGHTS},
        "limits": limits(),
        "names": names(),
        "slots": _slots(),
    }


def _slots() -> dict[str, Any]:
    """Slots for dropped pictures: the texture, its channels, and whether it is decoded to light."""
    slots: dict[str, Any] = {}
    for name, source in textures.MATERIAL_TEXTURES.items():
        for slot, channels in source.channels.items():
            light = source.light and len(channels) == 3
            slots[slot] = {"texture": name, "channels": channels, "light": light}
        slots["height"] = {"texture": "field", "channels": (0,), "light": False}
    del slots["layer_mask"]  # pages have no slots for layers
    return slots


def techniques_of(obj: Object) -> dict[str, Technique[..., Any]]:
    """The library's techniques by name, and the object's own technique, if a user wrote it."""
    own = obj.resolved.technique
    if own in TECHNIQUES.values():
        return dict(TECHNIQUES)
    name = own.name
    while name in TECHNIQUES:
        name += "_"
    return {**TECHNIQUES, name: own}


def _technique(technique: Technique[..., Any]) -> dict[str, Any]:
    doc = inspect.cleandoc(technique.__doc__ or "").split("\n\n")
    return {
        "doc": " ".join(doc[0].split()),
        "commandName": _command_name(technique),
        "reference_height": technique.reference_height,
        "projection": technique.projection,
        "mostReads": technique.most_reads,
        "bake": technique.bake and technique.bake.name,
        "columns": technique.columns,
        "heights": technique.takes_heights,
        "settings": numbers_of(technique.settings),
    }


def _command_name(technique: Technique[..., Any]) -> str:
    """A technique as a command line names it: NAME, or FILE.py:NAME for a user's."""
    if technique in TECHNIQUES.values():
        return technique.name
    file = Path(technique.function.__code__.co_filename)
    folder = Path.cwd()
    shown = file.relative_to(folder) if file.is_relative_to(folder) else file.name
    return f"{shown}:{technique.name}"


def _shape(obj: Object, shape: ShapeKind) -> dict[str, Any]:
    """Placement, tiling and extent of a shape."""
    # a transform was chosen for the object's own shape; other shapes keep their default
    transform = obj.transform if shape == obj.shape else None
    placed_object = replace(
        obj.resolved,
        shape=shape,
        tiling=Tiling(default_tiles(shape, obj.material)),
        transform=default_transform(shape, obj.material) if transform is None else transform,
    )
    placement = json_value(placed_object.placement())
    geometry = SHAPES[shape]
    return {
        "origin": placement["origin"],
        "to_object": placement["to_object"],
        "tiling": list(map(float, placed_object.tiling.tiles)),
        "flat": geometry.flat,
        "radius": round(float(np.linalg.norm(geometry.bounding_points, axis=1).max()), 2),
        "outline": [
            [round(float(x), 9) for x in point] for point in placed_object.bounding_points()
        ],
        "world": None if transform is None else np.asarray(transform, np.float64).tolist(),
    }


def _constants(obj: Object) -> dict[str, Any]:
    """Numbers that no control of the page changes."""
    layer = obj.layer and obj.layer.material
    return {
        "proportion": obj.material.proportion,
        "layer": layer is not None,
        "layerProportion": layer.proportion if layer else 1.0,
        "glow": textures.emission_scale(obj.material),
    }


def state_of(
    scene: Scene, shown: Object, techniques: Mapping[str, Technique[..., Any]] | None = None
) -> dict[str, Any]:
    """The state of a page that shows a scene: all that its controls can change."""
    techniques, obj = techniques or techniques_of(shown), shown.resolved
    name = next(key for key, technique in techniques.items() if technique is obj.technique)
    main = obj.tiling
    state = {
        "technique": name,
        **{menu: getattr(obj if hasattr(obj, menu) else scene, menu) for menu in MENUS},
        "projection": obj.projection,
        "scale": obj.scale,
        "reference_height": obj.reference_height,
        "bias": float(obj.bias),
        "fades": obj.fade is not None,
        "fade": list(map(float, obj.fade or (2.0, 4.0))),
        "tiling": list(map(float, main.tiles)),
        "shift": list(map(float, main.shift)),
        "apart": bool(obj.tilings),
        "tilings": {map: tiling_to_dict(obj.tilings.get(map, main)) for map in OWN_TILINGS},
        "layer": obj.layer is not None,
        "layer_tiling": tiling_to_dict(obj.layer.tiling if obj.layer else Tiling((10.0, 10.0))),
        "settings": {key: _defaults(technique) for key, technique in techniques.items()},
        "surface_parameters": {name: json_value(record()) for name, record in SURFACES.items()},
        "smoothing": json_value(obj.smoothing),
        "shading": json_value(scene.shading),
        "shadowing": json_value(scene.shadowing),
        "fog": json_value(scene.fog),
        "background": list(map(float, scene.background or (0.0, 0.0, 0.0))),
        "lights": [light_to_dict(light) for light in scene.lights],
        "camera": camera_to_dict(scene.camera),
    }
    state["settings"][name] = json_value(obj.settings)
    state["surface_parameters"][obj.surface] = json_value(obj.surface_parameters)
    return state


def tiling_to_dict(tiling: Tiling) -> dict[str, Any]:
    """A tiling as a mapping for a page."""
    return {"tiles": list(map(float, tiling.tiles)), "shift": list(map(float, tiling.shift))}


def _defaults_of(material: Material) -> dict[str, Any]:
    """The library's defaults, which copied Python and commands omit."""
    declared = {**settings_of(Object), **settings_of(Scene)}
    return {
        "options": {
            # the default projection is the technique's
            **{name: declared[name].default for name in (*MENUS, "bias") if name != "projection"},
            "scale": default_scale(material),
        },
        "background": [*declared["background"].default],
        "lights": [light_to_dict(light) for light in default_lights()],
        "camera": camera_to_dict(Orbit()),
    }


def _defaults(technique: Any) -> dict[str, Any]:
    return {setting["name"]: setting["default"] for setting in numbers_of(technique.settings)}


def camera_to_dict(camera: Orbit | LookAt) -> dict[str, Any]:
    """A camera as a mapping of an orbit; a `LookAt` becomes the orbit through its position."""
    if isinstance(camera, LookAt):
        camera.camera((1, 1))  # raises InputError where position and target coincide
        offset = [p - t for p, t in zip(camera.position, camera.target, strict=True)]
        distance = math.hypot(*offset)
        camera = Orbit(
            math.degrees(math.atan2(offset[0], offset[2])),
            math.degrees(math.asin(offset[1] / distance)),
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


def light_to_dict(light: Light) -> dict[str, Any]:
    """A light as a mapping: intensity separate from colour, direction and cone as angles.

    It has the numbers of all kinds, since the page can turn a light into any other. Those that its
    own kind lacks have their defaults.
    """
    record, own = json_value(light), light_parameters(light)
    numbers = {
        name: [*usual.default] if usual.kind == "triple" and usual.default else usual.default
        for name, usual in light_settings().items()
    }
    numbers |= {name: record[name] for name in own if name in record}
    intensity = max(*record["color"], 1e-9)
    x, y, z = (-float(component) for component in light.direction)
    if "angle" in own:
        outer, inner = (math.acos(float(c)) for c in (light.cos_outer, light.cos_inner))
        numbers["angle"] = round(math.degrees(2.0 * outer), 4)
        numbers["softness"] = round(1.0 - inner / outer if outer > 0.0 else 0.0, 4)
    return {
        "kind": light_kind(light),
        **numbers,
        "position": record["position"],
        "azimuth": round(math.degrees(math.atan2(x, z)), 4),
        "elevation": round(math.degrees(math.asin(max(-1.0, min(1.0, y)))), 4),
        "color": [round(component / intensity, 6) for component in record["color"]],
        "intensity": intensity,
    }


def _presets(
    material: Material, shown: Object, techniques: Mapping[str, Technique[..., Any]]
) -> dict[str, Any]:
    """States of the presets, or the reason why a page cannot draw one."""
    presets: dict[str, Any] = {}
    for name in PRESETS:
        chosen = preset(name)
        about = " ".join(chosen.about.split())
        try:
            scene = chosen.scene(material)
        except BasreliefError as error:
            presets[name] = {"about": about, "why": str(error)}
            continue
        obj = scene.objects[0]
        if _layer_name(obj) not in (None, _layer_name(shown)):
            why = f"it has a layer of {_layer_name(obj)}; make a page with --preset {name}"
            presets[name] = {"about": about, "why": why}
            continue
        presets[name] = {"about": about, "state": state_of(scene, obj, techniques)}
    return presets


def _layer_name(obj: Object) -> str | None:
    return None if obj.layer is None else obj.layer.material.name


def check_drawable(scene: Scene) -> None:
    """Raise InputError for a scene that a page's programs cannot draw."""
    if not scene.objects:
        raise InputError("the scene has no object to show")
    if len(scene.objects) > 1:
        raise InputError("the scene has further objects, which the page does not draw; remove them")
