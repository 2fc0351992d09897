"""Checks of the arguments of bakes, and runs of their shaders for each texel."""

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


def checked_heights(heights: Heights, edge: Edge) -> Heights:
    """Heights as a contiguous float32 array. Raises InputError for other arrays and edges."""
    heights = np.ascontiguousarray(heights, np.float32)
    if heights.ndim != 2 or heights.size == 0:
        raise InputError(
            f"heights must be an array of (rows, columns), not of shape {heights.shape}"
        )
    if not (heights.min() >= 0.0 and heights.max() <= 1.0):
        raise InputError("heights must be finite and within 0 to 1; rescale them")
    checked_edge(edge)
    return heights


def checked_edge(edge: Edge) -> Edge:
    """The edge. Raises InputError unless it is "wrap" or "clamp"."""
    if edge not in get_args(Edge):
        raise InputError(f"the edge of a bake must be wrap or clamp, not {edge}")
    return edge


def checked_scale(scale: float) -> float:
    """The scale. Raises InputError if it is negative or not finite."""
    if not (math.isfinite(scale) and scale >= 0.0):
        raise InputError(f"scale must be a fraction of the tile's width, at least 0, not {scale}")
    return float(scale)


def run(
    entry: Any,
    heights: Heights,
    edge: Edge,
    engine: Engine,
    *,
    cost: int = 1,
    **values: Any,
) -> Planes:
    """Planes of a shader, run for every texel of the heights."""
    rows, columns = heights.shape
    values = {"field": HeightField([heights], edge), **values}
    program = Program(entry, edge=edge)
    size = (columns, rows)
    return run_pass(engine, program, values, size, cost=cost)
