"""Bakes: maps that are computed once from the maps of a material, before drawing.

Names are imported on first use: the command line lists the bakes without loading an engine.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from basrelief.baking.cone import cone_map, relaxed_cone_map
    from basrelief.baking.exact import bounds
    from basrelief.baking.height import Integrated, height_map
    from basrelief.baking.horizon import ambient_occlusion, horizon_map
    from basrelief.baking.normal import normal_map

_HOMES = {
    "ambient_occlusion": "horizon",
    "bounds": "exact",
    "cone_map": "cone",
    "height_map": "height",
    "horizon_map": "horizon",
    "Integrated": "height",
    "normal_map": "normal",
    "relaxed_cone_map": "cone",
}

__all__ = [
    "Integrated", "ambient_occlusion", "bounds", "cone_map", "height_map", "horizon_map",
    "normal_map", "relaxed_cone_map",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'basrelief.baking' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"basrelief.baking.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
