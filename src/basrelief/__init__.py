"""basrelief: parallax mapping with every technique, from one texture read to exact hits.

    import basrelief
    basrelief.render("materials/rock", technique="relief").save("rock.png")

Names are imported on first use, so that `import basrelief` is fast.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basrelief._version import __version__
from basrelief.errors import BasreliefError, DeviceError, InputError
from basrelief.lazy import lazy_names as _lazy_names

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
    "engine": ("choose_device",),
    "material": ("Map", "Material", "load", "sample"),
    "measure.compare": ("Comparison", "compare"),
    "measure.debug": ("debug_picture",),
    "measure.errors": ("Errors",),
    "measure.truth": ("Truth", "truth"),
    "measure.tune": ("TuneResult", "tune"),
    "measure.explain": ("Explanation", "explain"),
    "rendering.film": ("frames", "write_film"),
    "rendering.frame": ("Frame", "Image"),
    "rendering.render": ("render",),
    "scene": (
        "Layer", "LookAt", "Object", "Orbit", "Scene", "Tiling", "directional", "placed", "point",
        "spot", "rotated",
    ),
    "scene.motion": ("Lighting", "Opening", "Orbiting", "Scrolling"),
    "scene.presets": ("PRESETS", "Preset", "preset"),
    "shading.brdf": ("Shading",),
    "shading.lights": ("Light",),
    "shading.surfaces.standard": ("SurfaceParameters",),
    "techniques": ("TECHNIQUES",),
}  # fmt: skip
__getattr__ = _lazy_names(__name__, _HOMES)

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


def __dir__() -> list[str]:
    return sorted(__all__)
