"""Initial data of a page: the scene's state, settings of techniques, shapes, presets."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from basrelief._version import __version__
from basrelief.errors import BasreliefError, InputError
from basrelief.material import MAPS, Material
from basrelief.material.opening import DEPTH, SOFTNESS, STRENGTH
from basrelief.material.options import is_path
from basrelief.measure.colors import COUNT, PASSED, SHORT, heat
from basrelief.rendering import textures
from basrelief.rendering.render import sample_positions
from basrelief.scene import SHAPES, SURFACES, LookAt, Object, Orbit, Scene, Tiling
from basrelief.scene.lights import LIGHTS, light_numbers, light_parameters
from basrelief.scene.presets import PRESETS, Preset, preset
from basrelief.scene.recipe import (
    LENGTHS,
    SAMPLE_OPTIONS,
    omitted_of_sources,
    placement_options,
    portable_path,
    portable_source,
    technique_text,
)
from basrelief.scene.records import SCENE_RECORDS
from basrelief.scene.resolve import default_scale, default_tiles, default_transform
from basrelief.scene.scene import default_lights
from basrelief.scene.tilings import OWN_TILINGS
from basrelief.scene.views import FRAME_FILL
from basrelief.settings import settings_of
from basrelief.settings.kinds import ShapeKind
from basrelief.techniques import TECHNIQUES, Technique
from basrelief.techniques.height import Smoothing
from basrelief.viewer.bakes import bake_numbers
from basrelief.viewer.controls import controls, limits, numbers_of
from basrelief.viewer.layouts import json_value
from basrelief.viewer.names import names
from basrelief.viewer.printed import MENUS

SAMPLES = 16
"""Samples per pixel of a picture at rest."""
SHOWS = ("color", "reads", "missed", "depth")
"""Pictures that a page can show."""


def sources_of(scene: Scene) -> dict[str, Any]:
    """Names of the material and its layer in the Python and the commands that a page copies.

    `omitted` is what these do not say about them, `relative` the paths that are relative.
    """
    obj = scene.objects[0]
    layer = None if obj.layer is None else obj.layer.material
    source, layer_source = portable_source(obj.material, "FOLDER"), portable_source(layer, "LAYER")
    options = {} if obj.material.origin is None else obj.material.origin.options
    reading = {
        name: portable_path(value) if is_path(value) and name in MAPS else value
        for name, value in options.items()
        if name not in SAMPLE_OPTIONS
    }
    named = [source, *(reading[name] for name in MAPS if name in reading)]
    named += [layer_source] if layer is not None else []
    return {
        "source": source,
        "reading": reading,
        "lengths": LENGTHS,
        "layerSource": layer_source,
        "relative": [*filter(is_path, named)],
        "omitted": [*omitted_of_sources(obj)],
    }


def manifest(
    scene: Scene, sources: Mapping[str, Any], scaled: tuple[int, int] | None
) -> dict[str, Any]:
    """The data of a page, except its programs and maps; `sources` are those of `sources_of`."""
    obj = scene.objects[0]
    material = obj.material
    techniques = techniques_of(obj)
    return {
        "name": material.name,
        "version": __version__,
        **sources,
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
    slots["dust"] = {"texture": "dust", "channels": (0,), "light": False}
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
        "commandName": portable_path(technique_text(technique)),
        "reference_height": technique.reference_height,
        "projection": technique.projection,
        "mostReads": technique.most_reads,
        "bake": technique.bake and technique.bake.name,
        "columns": technique.columns,
        "exact": technique.exact,
        "heights": technique.takes_heights,
        "settings": numbers_of(technique.settings),
    }


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
        "lying": geometry.flat and transform is None,
        "radius": round(float(np.linalg.norm(geometry.bounding_points, axis=1).max()), 2),
        "outline": [
            [round(float(x), 9) for x in point] for point in placed_object.bounding_points()
        ],
        "world": None if transform is None else np.asarray(transform, np.float64).tolist(),
        "placement": None if transform is None else placement_options(obj),
    }


def _constants(obj: Object) -> dict[str, Any]:
    """Numbers that no control of the page changes."""
    layer = obj.layer and obj.layer.material
    return {
        "proportion": obj.material.proportion,
        "layer": layer is not None,
        "layerProportion": layer.proportion if layer else 1.0,
        "glow": textures.emission_scale(obj.material),
        "dust_strength": STRENGTH,
        "hole_softness": SOFTNESS,
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
        "opening": None if shown.opening is None else float(shown.opening),
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
        "lights": [light_numbers(light) for light in scene.lights],
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
        "hole_scale": DEPTH,
        "background": [*declared["background"].default],
        "lights": [light_numbers(light) for light in default_lights()],
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
        state = state_of(scene, obj, techniques)
        presets[name] = {
            "about": about, "state": state, "shapes": _on_shapes(chosen, material, state)
        }  # fmt: skip
    return presets


def _on_shapes(chosen: Preset, material: Material, state: Mapping[str, Any]) -> dict[str, Any]:
    """Changes of the state on each shape: the lengths of a preset in widths of the shape."""
    if chosen.lengths == "tile":
        return {}
    name = state["technique"]
    changes: dict[str, Any] = {}
    for shape in SHAPES:
        obj = chosen.scene(material, shape=shape).resolved[0]
        changes[shape] = {"scale": obj.scale, "settings": {name: json_value(obj.settings)}}
    return changes


def _layer_name(obj: Object) -> str | None:
    return None if obj.layer is None else obj.layer.material.name


def check_drawable(scene: Scene) -> None:
    """Raise InputError for a scene that a page's programs cannot draw."""
    if not scene.objects:
        raise InputError("the scene has no object to show")
    if len(scene.objects) > 1:
        raise InputError("the scene has further objects, which the page does not draw; remove them")
    if scene.objects[0].filter == "hardware":
        raise InputError(
            "a page reads heights as texels, to draw the same in every browser; use --filter texel"
        )
