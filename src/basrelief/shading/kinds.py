"""Kinds: the values of each option of a scene that is one of a few.

Each is a `Literal`, so that a type checker sees where code forgets one of its values. Records have
them as the types of their fields, and `menus_of` lists those: objects and scenes refuse any other
value, and programs and pages have the same choices. Nothing heavy is imported: help lists them too.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any, Literal, get_args, get_origin, get_type_hints

# --- of an object
ShapeKind = Literal["plane", "box", "sphere", "cylinder"]
HeightsKind = Literal["sharp", "smooth", "mip"]
EdgeKind = Literal["wrap", "clamp", "clip"]
MappingKind = Literal["planar", "triplanar"]
AlphaKind = Literal["blend", "mask", "opaque"]
CastsKind = Literal["shape", "opaque", "none"]
SurfaceKind = Literal["standard", "landscape"]

# --- of a scene
ShadingModel = Literal["ggx", "phong"]
ShadowsKind = Literal["none", "hard", "soft"]
ShadowsOnKind = Literal["relief", "polygon"]
OcclusionKind = Literal["ambient", "directional"]
FogKind = Literal["none", "linear", "exponential", "exponential_squared"]


def either(values: Iterable[str]) -> str:
    """Values in a sentence: a, b or c."""
    *others, last = values
    return f"{', '.join(others)} or {last}"


@functools.cache
def menus_of(record: type) -> dict[str, tuple[Any, ...]]:
    """The fields of a record that are one of a few values, with these; None where it may be."""
    return {
        name: (*get_args(kind), None) if kind is not hint else get_args(kind)
        for name, hint in get_type_hints(record).items()
        for kind in (hint, *get_args(hint))
        if get_origin(kind) is Literal
    }
