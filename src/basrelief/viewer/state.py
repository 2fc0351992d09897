"""What a page starts with: the scene's numbers, every technique's settings, shapes, presets."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from basrelief._version import __version__
from basrelief.errors import BasreliefError, InputError
from basrelief.material import Material
from basrelief.measure.colors import COUNT, PASSED, SHORT, heat
from basrelief.rendering import textures
from basrelief.rendering.render import sample_positions
from basrelief.scene import SHAPES, SURFACES, LookAt, Object, Orbit, Scene, Tiling, spot
from basrelief.scene.checks import FAR, NEAR
from basrelief.scene.lights import LIGHTS, light_kind, light_parameters
from basrelief.scene.objects import OWN_TILINGS
from basrelief.scene.presets import PRESETS, preset
from basrelief.scene.scene import BACKGROUND
from basrelief.scene.views import FRAME_FILL
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog
from basrelief.shading.kinds import ShapeKind
from basrelief.shading.lights import Light
from basrelief.shading.self_shadow import Shadowing
from basrelief.techniques import TECHNIQUES, Technique
from basrelief.techniques.height import Smoothing
from basrelief.viewer.bakes import bake_numbers
from basrelief.viewer.layouts import plain, settings_of
from basrelief.viewer.names import names
from basrelief.viewer.printed import MENUS

SAMPLES = 16
"""Places in a pixel that a picture at rest is averaged over."""
SHOWS = ("color", "reads", "missed", "depth")
"""What a page can draw."""
LIMITS: dict[str, Any] = {
    "numbers": {
        "scale": (0.0, 10.0),
        "reference_height": (0.0, 1.0),
        "bias": (0.0, 100.0),
        "divider": (0.0, 1.0),
        "shift": (-FAR, FAR),
        "fade": (0.0, FAR / 2.0),
        "background": (0.0, FAR),
    },
    "lights": {
        "position": (-FAR, FAR),
        "color": (0.0, FAR),
        "intensity": (0.0, FAR),
        "falloff": (0.0, 8.0),
        "angle": (0.01, 179.99),
        "softness": (0.0, 1.0),
    },
    "camera": {
        "azimuth": (-FAR, FAR),
        "distance": (1e-3, 1e3),
        "target": (-FAR, FAR),
        "field_of_view": (0.1, 170.0),
        "orthographic_height": (1e-3, 1e3),
    },
    "least": NEAR,
    "most": FAR,
}
"""Where the numbers end that are no settings of a record, as `Object` and `Scene` check them."""


@dataclass(frozen=True)
class Sources:
    """What lines of Python and commands call the material and its layer, and how it is read.

    What is not said is the name of a sample, or else a word to be replaced.
    """

    material: str | None = None
    reading: Mapping[str, Any] = field(default_factory=dict)
    layer: str | None = None


def _named(material: Material | None, otherwise: str) -> str:
    """What a command line would call a material: a sample by its name."""
    if material is None:
        return otherwise
    sources = [one.source for _, one in material.maps()]
    whole = all(each.startswith(f"sample {material.name},") for each in sources)
    return f"sample:{material.name}" if whole and sources else otherwise


def manifest(scene: Scene, sources: Sources, scaled: tuple[int, int] | None) -> dict[str, Any]:
    """What the page knows beside programs and maps."""
    obj = scene.objects[0]
    material = obj.material
    over = None if obj.layer is None else obj.layer.material
    techniques = techniques_of(obj)
    return {
        "name": material.name,
        "version": __version__,
        "source": sources.material or _named(material, "FOLDER"),
        "reading": dict(sources.reading),
        "layerSource": sources.layer or _named(over, "LAYER"),
        "scaledTo": scaled,
        "hasHeights": material.height is not None,
        "mapSources": {kind: one.source for kind, one in material.maps()},
        "bakes": bake_numbers(),
        "menus": {"technique": tuple(techniques), **MENUS},
        "techniques": {name: _technique(made) for name, made in techniques.items()},
        "shapes": {shape: _shape(obj, shape) for shape in SHAPES},
        "settings": {
            "surface_parameters": {name: settings_of(record) for name, record in SURFACES.items()},
            "shading": settings_of(Shading),
            "shadowing": settings_of(Shadowing),
            "smoothing": settings_of(Smoothing),
            "fog": settings_of(Fog),
        },
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
        "lightKinds": {kind: light_parameters(kind) for kind in LIGHTS},
        "limits": LIMITS,
        "names": names(),
        "slots": _slots(),
    }


def _slots() -> dict[str, Any]:
    """What a picture can be used as: which texture holds it, in which channels, and whether as
    light."""
    found: dict[str, Any] = {}
    for name, source in textures.MATERIAL_TEXTURES.items():
        for slot, channels in source.channels.items():
            light = source.light and len(channels) == 3
            found[slot] = {"held": name, "channels": channels, "light": light}
        found["height"] = {"held": "field", "channels": (0,), "light": False}
    del found["layer_mask"]  # a page's layer is that of its scene
    return found


def techniques_of(obj: Object) -> dict[str, Technique[..., Any]]:
    """The library's techniques by name, and the one that an object brings of its own."""
    own = obj.selected_technique
    if own in TECHNIQUES.values():
        return dict(TECHNIQUES)
    name = own.name
    while name in TECHNIQUES:
        name += "_"
    return {**TECHNIQUES, name: own}


def _technique(made: Technique[..., Any]) -> dict[str, Any]:
    doc = inspect.cleandoc(made.__doc__ or "").split("\n\n")
    return {
        "doc": " ".join(doc[0].split()),
        "called": _called(made),
        "reference_height": made.reference_height,
        "projection": made.projection,
        "mostReads": made.most_reads,
        "bake": made.bake and made.bake.name,
        "columns": made.columns,
        "heights": made.takes_heights,
        "settings": settings_of(made.settings),
    }


def _called(made: Technique[..., Any]) -> str:
    """What a command line calls a technique: its name, or its file and name."""
    if made in TECHNIQUES.values():
        return made.name
    file = Path(made.function.__code__.co_filename)
    home = Path.cwd()
    return f"{file.relative_to(home) if file.is_relative_to(home) else file.name}:{made.name}"


def _shape(obj: Object, shape: ShapeKind) -> dict[str, Any]:
    """Where a shape stands, how many tiles it has, and how far it reaches."""
    # a scene's own transform is that of its own shape
    placed = obj.transform if shape == obj.shape else None
    stands = Object(obj.material, shape=shape, technique="flat", transform=placed)
    placement = plain(stands.placement())
    facts = SHAPES[shape]
    return {
        "origin": placement["origin"],
        "to_object": placement["to_object"],
        "tiling": list(map(float, stands.tiles)),
        "flat": facts.flat,
        "radius": round(float(np.linalg.norm(facts.bounding_points, axis=1).max()), 2),
        "outline": [[round(float(x), 9) for x in point] for point in stands.bounding_points()],
        "world": None if placed is None else np.asarray(placed, np.float64).tolist(),
    }


def _constants(obj: Object) -> dict[str, Any]:
    """What the page's controls leave as it is."""
    over = obj.layer and obj.layer.material
    return {
        "proportion": obj.material.proportion,
        "layer": over is not None,
        "layerProportion": over.proportion if over else 1.0,
        "glow": textures.emission_scale(obj.material),
    }


def state_of(
    scene: Scene, obj: Object, techniques: Mapping[str, Technique[..., Any]] | None = None
) -> dict[str, Any]:
    """Everything that a person can change, as it is in a scene."""
    techniques = techniques or techniques_of(obj)
    name = next(name for name, each in techniques.items() if each is obj.selected_technique)
    main = obj.main_tiling
    made = {
        "technique": name,
        **{each: getattr(obj if hasattr(obj, each) else scene, each) for each in MENUS},
        "projection": obj.relief_projection,
        "scale": obj.relief_scale,
        "reference_height": obj.relief_reference_height,
        "bias": float(obj.bias),
        "fades": obj.fade is not None,
        "fade": list(map(float, obj.fade or (2.0, 4.0))),
        "tiling": list(map(float, obj.tiles)),
        "shift": list(map(float, obj.shift)),
        "apart": bool(obj.tilings),
        "tilings": {each: plain_tiling(obj.tilings.get(each, main)) for each in OWN_TILINGS},
        "layer": obj.layer is not None,
        "layer_tiling": plain_tiling(obj.layer.tiling if obj.layer else Tiling((10.0, 10.0))),
        "settings": {name: _defaults(each) for name, each in techniques.items()},
        "surface_parameters": {name: plain(record()) for name, record in SURFACES.items()},
        "smoothing": plain(obj.smoothing),
        "shading": plain(scene.shading),
        "shadowing": plain(scene.shadowing),
        "fog": plain(scene.fog),
        "background": list(map(float, scene.background or (0.0, 0.0, 0.0))),
        "lights": [plain_light(each) for each in scene.lights],
        "camera": plain_camera(scene.camera),
    }
    made["settings"][name] = plain(obj.settings)
    made["surface_parameters"][obj.surface] = plain(obj.surface_parameters)
    return made


def plain_tiling(tiling: Tiling) -> dict[str, Any]:
    """A tiling as a page has it."""
    return {"tiles": list(map(float, tiling.tiles)), "shift": list(map(float, tiling.shift))}


def _defaults_of(material: Material) -> dict[str, Any]:
    """What the library takes where nothing is said."""
    scene = Scene((Object(material, technique="flat"),), background=BACKGROUND)
    state = state_of(scene, scene.objects[0])
    plainly = (*MENUS, "scale", "bias")
    return {
        "plain": {name: state[name] for name in plainly},
        "background": state["background"],
        "lights": state["lights"],
        "camera": state["camera"],
    }


def _defaults(made: Any) -> dict[str, Any]:
    return {each["name"]: each["default"] for each in settings_of(made.settings)}


def plain_camera(camera: Orbit | LookAt) -> dict[str, Any]:
    """The camera as an orbit; one that stands somewhere is taken for the orbit it lies on."""
    if isinstance(camera, LookAt):
        camera.camera((1, 1))  # one that stands where it looks is told
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


def plain_light(light: Light) -> dict[str, Any]:
    """A light with its strength apart from its colour, its direction and its cone as angles."""
    said = plain(light)
    intensity = max(*said["color"], 1e-9)
    x, y, z = (-float(each) for each in light.direction)
    # a light without a cone has the one that it would get as a spot
    cone = light if "angle" in light_parameters(light) else spot((0.0, 1.0, 0.0))
    outer, inner = (math.acos(float(c)) for c in (cone.cos_outer, cone.cos_inner))
    return {
        "kind": light_kind(light),
        "position": said["position"],
        "azimuth": round(math.degrees(math.atan2(x, z)), 4),
        "elevation": round(math.degrees(math.asin(max(-1.0, min(1.0, y)))), 4),
        "color": [round(each / intensity, 6) for each in said["color"]],
        "intensity": intensity,
        "falloff": said["falloff"],
        "angle": round(math.degrees(2.0 * outer), 4),
        "softness": round(1.0 - inner / outer if outer > 0.0 else 0.0, 4),
    }


def _presets(
    material: Material, shown: Object, techniques: Mapping[str, Technique[..., Any]]
) -> dict[str, Any]:
    """The presets as states; those that a page's programs cannot draw say why not."""
    found: dict[str, Any] = {}
    for name in PRESETS:
        chosen = preset(name)
        about = " ".join(chosen.about.split())
        try:
            scene = chosen.scene(material)
        except BasreliefError as error:
            found[name] = {"about": about, "why": str(error)}
            continue
        obj = scene.objects[0]
        if _layer_of(obj) not in (None, _layer_of(shown)):
            why = f"it lays {_layer_of(obj)} over; make a page with --preset {name}"
            found[name] = {"about": about, "why": why}
            continue
        found[name] = {"about": about, "state": state_of(scene, obj, techniques)}
    return found


def _layer_of(obj: Object) -> str | None:
    return None if obj.layer is None else obj.layer.material.name


def check_shown(scene: Scene) -> None:
    """Raise InputError for a scene that a page's programs cannot draw."""
    if not scene.objects:
        raise InputError("there is nothing in the scene to show")
    if len(scene.objects) > 1:
        raise InputError(
            "the scene has further objects, which the page does not draw; leave them away"
        )
