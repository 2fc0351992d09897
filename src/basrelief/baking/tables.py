"""The tables that techniques declare: which function runs the passes of each.

A declaration (`basrelief.techniques.bake`) that is not listed here cannot be baked.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.cache import kept
from basrelief.baking.cone import cone_map, relaxed_cone_map
from basrelief.baking.exact import bounds
from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.lang.resources import Edge
from basrelief.techniques import BOUNDS, CONE_MAP, RELAXED_CONE_MAP, Bake

FUNCTIONS: dict[Bake, Callable[..., NDArray[np.uint16]]] = {
    BOUNDS: bounds,
    CONE_MAP: cone_map,
    RELAXED_CONE_MAP: relaxed_cone_map,
}
"""What bakes each table from heights (h, w) float32, an edge and an engine: (rows, columns, 4)."""


def check_bake(bake: Bake | None, technique: str) -> None:
    """Raise InputError where nothing bakes what a technique declares."""
    if bake is not None and bake not in FUNCTIONS:
        known = ", ".join(each.name.upper() for each in FUNCTIONS)
        raise InputError(
            f"{technique}: no function runs the bake {bake.name} that it declares; "
            f"import {known} from basrelief.techniques"
        )


def table(
    bake: Bake,
    heights: NDArray[np.float32],
    edge: Edge,
    engine: Engine,
    *,
    all_levels: bool = False,
) -> NDArray[np.uint16]:
    """The table that a bake declares, of heights (h, w), 0 to 1; from disk if it was baked before.

    `all_levels` is for bakes that cover the lower levels too.
    """
    parameters: dict[str, Any] = {"all_levels": True} if all_levels else {}
    return kept(FUNCTIONS[bake], heights, edge, engine, **parameters)
