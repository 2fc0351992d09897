"""basrelief: parallax mapping, every technique from one texture read up, written once in Python.

    import basrelief
    basrelief.render("materials/rock", technique="relief").save("rock.png")

Names are imported when first used, so that `import basrelief` costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from basrelief._version import __version__
from basrelief.errors import BasreliefError, EngineError, InputError

if TYPE_CHECKING:
    from basrelief.engine import choose_engine
    from basrelief.film import frames, write_film
    from basrelief.lang import setting, shader, struct
    from basrelief.material import Map, Material, load, sample
    from basrelief.measure.compare import Comparison, compare
    from basrelief.measure.debug import debug_picture
    from basrelief.measure.errors import Errors
    from basrelief.measure.explain import Explanation, explain
    from basrelief.measure.truth import Truth, truth
    from basrelief.measure.tune import Tuned, tune
    from basrelief.motion import Lighting, Opening, Orbiting, Scrolling
    from basrelief.presets import PRESETS, Preset, preset
    from basrelief.rendering import Frame, Image, render
    from basrelief.scene import (
        Layer,
        LookAt,
        Object,
        Orbit,
        Scene,
        Tiling,
        directional,
        placed,
        point,
        spot,
    )
    from basrelief.scene import turned as turned
    from basrelief.shaders.lighting import Light, Shading
    from basrelief.shaders.surfaces.standard import Finish
    from basrelief.shaders.techniques import TECHNIQUES, Hit, Ray, technique

_HOMES = {
    "basrelief.engine": ("choose_engine",),
    "basrelief.film": ("frames", "write_film"),
    "basrelief.lang": ("setting", "shader", "struct"),
    "basrelief.material": ("Map", "Material", "load", "sample"),
    "basrelief.measure.compare": ("Comparison", "compare"),
    "basrelief.measure.debug": ("debug_picture",),
    "basrelief.measure.errors": ("Errors",),
    "basrelief.measure.truth": ("Truth", "truth"),
    "basrelief.measure.tune": ("Tuned", "tune"),
    "basrelief.measure.explain": ("Explanation", "explain"),
    "basrelief.motion": ("Lighting", "Opening", "Orbiting", "Scrolling"),
    "basrelief.presets": ("PRESETS", "Preset", "preset"),
    "basrelief.rendering": ("Frame", "Image", "render"),
    "basrelief.scene": (
        "Layer", "LookAt", "Object", "Orbit", "Scene", "Tiling", "directional", "placed", "point",
        "spot", "turned",
    ),
    "basrelief.shaders.lighting": ("Light", "Shading"),
    "basrelief.shaders.surfaces.standard": ("Finish",),
    "basrelief.shaders.techniques": ("TECHNIQUES", "Hit", "Ray", "technique"),
}  # fmt: skip
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "PRESETS", "TECHNIQUES", "BasreliefError", "Comparison", "EngineError", "Errors", "Explanation",
    "Finish", "Frame", "Hit", "Image", "InputError", "Layer", "Light", "Lighting", "LookAt", "Map",
    "Material", "Object", "Opening", "Orbit", "Orbiting", "Preset", "Ray", "Scene", "Scrolling",
    "Shading", "Tiling", "Truth", "Tuned", "__version__", "choose_engine", "compare",
    "debug_picture", "directional", "explain", "frames", "load", "placed", "point", "preset",
    "render", "sample", "setting", "shader", "spot", "struct", "technique", "truth", "tune",
    "turned", "write_film",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'basrelief' has no attribute {name!r}")
    # the function `render` stands for itself, not for the module of that name
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
