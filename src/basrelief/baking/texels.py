"""Running the shaders of `techniques`: one pixel for each texel of a height map."""

from __future__ import annotations

import math
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.passes import run_pass
from basrelief.engine import Engine
from basrelief.engine.engine import Planes
from basrelief.errors import InputError
from basrelief.lang import HeightField
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge

Heights = NDArray[np.float32]
"""(h, w), 0 to 1."""


def checked(heights: Heights, edge: Edge) -> Heights:
    """The heights as bakes take them; raises InputError for other arrays and edges."""
    heights = np.ascontiguousarray(heights, np.float32)
    if heights.ndim != 2 or heights.size == 0:
        raise InputError(f"heights are an array of (rows, columns), not of shape {heights.shape}")
    if not (heights.min() >= 0.0 and heights.max() <= 1.0):
        raise InputError("heights lie within 0 to 1; stretch them, and mend what is not finite")
    checked_edge(edge)
    return heights


def checked_edge(edge: Edge) -> Edge:
    """The edge; raises InputError for another than "wrap" and "clamp"."""
    if edge not in get_args(Edge):
        raise InputError(f"what lies beyond baked heights is wrap or clamp, not {edge}")
    return edge


def checked_scale(scale: float) -> float:
    """The scale; raises InputError where it is below 0 or not finite."""
    if not (math.isfinite(scale) and scale >= 0.0):
        raise InputError(f"scale is a fraction of the tile's width from 0 up, not {scale}")
    return float(scale)


def run(
    entry: Any,
    heights: Heights,
    edge: Edge,
    engine: Engine,
    *,
    effort: int = 1,
    **values: Any,
) -> Planes:
    """An entry's planes, for every texel."""
    rows, columns = heights.shape
    values = {"field": HeightField([heights], edge), **values}
    program = Program(entry, edge=edge)
    size = (columns, rows)
    return run_pass(engine, program, values, size, effort=effort)
