"""Allowed values of the options of objects and scenes that are enumerations.

Each enumeration is a `Literal`, so that a type checker reports code that forgets a value. Records
use them as field types, and refuse any other value; the command line and pages offer the same
choices. The command line's help imports this module, so it imports little.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

# --- of an object
ShapeKind = Literal["plane", "box", "sphere", "cylinder"]
HeightsKind = Literal["sharp", "smooth", "mip"]
FilterKind = Literal["texel", "hardware"]
EdgeKind = Literal["wrap", "clamp", "clip"]
MappingKind = Literal["planar", "noise", "triplanar"]
LayerOffsetKind = Literal["scaled", "unscaled", "none"]
AlphaKind = Literal["blend", "mask", "opaque"]
CastsKind = Literal["shape", "polygon", "opaque", "none"]
SurfaceKind = Literal["standard", "landscape"]
Projection = Literal["full", "biased", "limited"]

# --- of a scene
ShadingModel = Literal["ggx", "phong"]
ShadowsKind = Literal["none", "hard", "soft"]
ShadowsOnKind = Literal["relief", "polygon"]
OcclusionKind = Literal["ambient", "directional"]
FogKind = Literal["none", "linear", "exponential", "exponential_squared"]


SYNONYMS = {
    "cube": "box", "ball": "sphere", "globe": "sphere", "tube": "cylinder", "quad": "plane",
    "linear_mip": "mip", "mipmap": "mip", "mipmaps": "mip", "trilinear": "smooth",
    "repeat": "wrap", "tile": "wrap", "border": "clamp", "discard": "clip", "cut": "clip",
    "uv": "planar", "tri_planar": "triplanar",
    "transparent": "blend", "cutout": "mask", "cut_out": "mask", "clip_alpha": "mask",
    "terrain": "landscape", "pbr": "ggx", "metallic_roughness": "ggx", "blinn_phong": "phong",
    "off": "none", "no": "none", "on": "hard", "pcss": "soft", "ao": "ambient",
    "exp": "exponential", "exp2": "exponential_squared", "exponential2": "exponential_squared",
    "opengl": "gl", "directx": "dx", "up": "gl", "down": "dx",
    "red": "r", "green": "g", "blue": "b", "alpha": "a", "luma": "luminance", "grey": "luminance",
    "inverted": "depth", "displacement": "height", "bump": "height",
    "offset_limiting": "limited", "true": "full", "yes": "hard", "pcf": "soft",
}  # fmt: skip
"""Values by the words that other programs have for them."""


def either(values: Iterable[str]) -> str:
    """The values as an English list: a, b or c."""
    *others, last = values
    return f"{', '.join(others)} or {last}"
