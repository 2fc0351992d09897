"""The values of each option of a scene that is an enumeration.

Each is a `Literal`, so that a type checker reports code that forgets a value. Records use them as
field types, and `menus_of` lists them: objects and scenes refuse any other value, and programs and
pages offer the same choices. The command line's help imports this module, so it imports little.
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
    """The values as an English list: a, b or c."""
    *others, last = values
    return f"{', '.join(others)} or {last}"


@functools.cache
def menus_of(record: type) -> dict[str, tuple[Any, ...]]:
    """The enumerated fields of a record and their values, with None where a field may be None."""
    return {
        name: (*get_args(kind), None) if kind is not hint else get_args(kind)
        for name, hint in get_type_hints(record).items()
        for kind in (hint, *get_args(hint))
        if get_origin(kind) is Literal
    }
