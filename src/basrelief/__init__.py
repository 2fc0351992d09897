"""basrelief: parallax mapping with every technique, from one texture read to exact hits.

    import basrelief
    basrelief.render("materials/rock", technique="relief").save("rock.png")

Names are imported on first use, so that `import basrelief` is fast.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from basrelief._version import __version__
from basrelief.errors import BasreliefError, DeviceError, InputError

if TYPE_CHECKING:
    from basrelief.engine import choose_device
    from basrelief.material import Map, Material, load, sample
    from basrelief.measure.compare import Comparison, compare
    from basrelief.measure.debug import debug_picture
    from basrelief.measure.errors import Errors
    from basrelief.measure.explain import Explanation, explain
    from basrelief.measure.truth import Truth, truth
    from basrelief.measure.tune import TuneResult, tune
    from basrelief.rendering.film import frames, write_film
    from basrelief.rendering.frame import Frame, Image
    from basrelief.rendering.render import render
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
    from basrelief.scene import rotated as rotated
    from basrelief.scene.motion import Lighting, Opening, Orbiting, Scrolling
    from basrelief.scene.presets import PRESETS, Preset, preset
    from basrelief.shading.brdf import Shading
    from basrelief.shading.lights import Light
    from basrelief.shading.surfaces.standard import SurfaceParameters
    from basrelief.techniques import TECHNIQUES

_HOMES = {
    "basrelief.engine": ("choose_device",),
    "basrelief.material": ("Map", "Material", "load", "sample"),
    "basrelief.measure.compare": ("Comparison", "compare"),
    "basrelief.measure.debug": ("debug_picture",),
    "basrelief.measure.errors": ("Errors",),
    "basrelief.measure.truth": ("Truth", "truth"),
    "basrelief.measure.tune": ("TuneResult", "tune"),
    "basrelief.measure.explain": ("Explanation", "explain"),
    "basrelief.rendering.film": ("frames", "write_film"),
    "basrelief.rendering.frame": ("Frame", "Image"),
    "basrelief.rendering.render": ("render",),
    "basrelief.scene": (
        "Layer", "LookAt", "Object", "Orbit", "Scene", "Tiling", "directional", "placed", "point",
        "spot", "rotated",
    ),
    "basrelief.scene.motion": ("Lighting", "Opening", "Orbiting", "Scrolling"),
    "basrelief.scene.presets": ("PRESETS", "Preset", "preset"),
    "basrelief.shading.brdf": ("Shading",),
    "basrelief.shading.lights": ("Light",),
    "basrelief.shading.surfaces.standard": ("SurfaceParameters",),
    "basrelief.techniques": ("TECHNIQUES",),
}  # fmt: skip
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "PRESETS",
    "TECHNIQUES",
    "BasreliefError",
    "Comparison",
    "DeviceError",
    "Errors",
    "Explanation",
    "Frame",
    "Image",
    "InputError",
    "Layer",
    "Light",
    "Lighting",
    "LookAt",
    "Map",
    "Material",
    "Object",
    "Opening",
    "Orbit",
    "Orbiting",
    "Preset",
    "Scene",
    "Scrolling",
    "Shading",
    "SurfaceParameters",
    "Tiling",
    "Truth",
    "TuneResult",
    "__version__",
    "choose_device",
    "compare",
    "debug_picture",
    "directional",
    "explain",
    "frames",
    "load",
    "placed",
    "point",
    "preset",
    "render",
    "rotated",
    "sample",
    "spot",
    "truth",
    "tune",
    "write_film",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        from basrelief.errors import new_name

        hint = new_name(name, __all__)
        raise AttributeError(hint or f"module 'basrelief' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
