"""Kinds: the values of each option of a scene that is one of a few.

Each is a `Literal`, so that a type checker sees where code forgets one of its values. `values_of`
lists them. Objects and scenes refuse any other value when they are made.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

from basrelief.errors import InputError
from basrelief.shading.lights import DIRECTIONAL, POINT, SPOT, Light
from basrelief.techniques.technique import Projection

__all__ = [
    "AlphaKind", "CastsKind", "EdgeKind", "FogKind", "HeightsKind", "LightKind", "MappingKind",
    "OcclusionKind", "Projection", "ShadingModel", "ShadowsKind", "ShadowsOnKind", "ShapeKind",
    "SurfaceKind", "light_kind", "values_of",
]  # fmt: skip

# --- of an object
ShapeKind = Literal["plane", "box", "sphere", "cylinder"]
HeightsKind = Literal["sharp", "smooth", "mip"]
EdgeKind = Literal["wrap", "clamp", "clip"]
MappingKind = Literal["planar", "triplanar"]
AlphaKind = Literal["blend", "mask", "opaque"]
CastsKind = Literal["shape", "opaque", "none"]
SurfaceKind = Literal["standard", "landscape"]

# --- of a scene
LightKind = Literal["directional", "point", "spot"]
ShadingModel = Literal["ggx", "phong"]
ShadowsKind = Literal["none", "hard", "soft"]
ShadowsOnKind = Literal["relief", "polygon"]
OcclusionKind = Literal["ambient", "directional"]
FogKind = Literal["none", "linear", "exponential", "exponential_squared"]

_OF_LIGHTS: dict[int, LightKind] = {DIRECTIONAL: "directional", POINT: "point", SPOT: "spot"}


def values_of(kind: Any) -> tuple[str, ...]:
    """The values of one of the types above, in order."""
    return get_args(kind)


def light_kind(light: Light) -> LightKind:
    """The kind of a light, by its name; raises InputError for a number that stands for none."""
    found = _OF_LIGHTS.get(int(light.kind))
    if found is None:
        known = ", ".join(f"{number} ({name})" for number, name in _OF_LIGHTS.items())
        raise InputError(f"the kind of a light is one of {known}, not {light.kind}")
    return found
