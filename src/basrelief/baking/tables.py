"""Tables that techniques declare, with the functions that bake them.

A declaration (`basrelief.techniques.bake`) that is not listed here cannot be baked. The list loads
no shaders, because the command line uses it for its help.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from basrelief.errors import InputError
from basrelief.timings import step

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basrelief.engine import Engine
    from basrelief.lang.resources import Edge
    from basrelief.techniques import Bake

TABLES: dict[str, tuple[str, str]] = {
    "cone_map": ("cone", "Cone map: cones above the surface that are free of it."),
    "relaxed_cone_map": ("cone", "Relaxed cone map: wider cones, for a search within each step."),
    "bounds": ("exact", "Bounds of the heights, for the technique exact."),
}
"""Module of this package and description, by the name of the declaration. The module's function of
that name bakes heights (h, w) float32, with an edge and an engine, to (rows, columns, 4) uint16."""


def bake_function(bake: Bake) -> Callable[..., NDArray[np.uint16]]:
    """Function that runs the passes of a declared bake."""
    function: Callable[..., Any] = getattr(
        import_module(f"basrelief.baking.{TABLES[bake.name][0]}"), bake.name
    )
    return function


def check_bake(bake: Bake | None, technique: str) -> None:
    """Raise InputError if no function runs the bake that a technique declares."""
    from basrelief.techniques import BAKES

    if bake is not None and not (bake.name in TABLES and BAKES.get(bake.name) is bake):
        known = ", ".join(sorted(name.upper() for name in TABLES))
        raise InputError(
            f"{technique}: no function runs the bake {bake.name} that it declares; "
            f"import {known} from basrelief.techniques"
        )


@step("bake")
def table(
    bake: Bake,
    heights: NDArray[np.float32],
    edge: Edge,
    engine: Engine,
    *,
    all_levels: bool = False,
) -> NDArray[np.uint16]:
    """Table of a declared bake for heights (h, w), 0 to 1, from the cache if it is there.

    `all_levels` also bakes the lower mip levels, for bakes that cover them.
    """
    from basrelief.baking.cache import cached

    parameters: dict[str, Any] = {"all_levels": True} if all_levels else {}
    return cached(bake_function(bake), heights, edge, engine, **parameters)
