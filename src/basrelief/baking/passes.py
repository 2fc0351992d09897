"""One pass of a bake, run on an engine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from basrelief.engine import Engine
from basrelief.engine.engine import Planes
from basrelief.lang.program import Program

MAX_TEXELS = 1 << 20
"""Texels of a dispatch on a GPU. Drivers stop programs that run too long, Windows after 2 s."""


def run_pass(
    engine: Engine,
    program: Program,
    values: Mapping[str, Any],
    size: tuple[int, int],
    *,
    cost: int = 1,
) -> Planes:
    """Planes of a program over a picture of (width, height).

    A GPU runs it in bands of rows, of at most `MAX_TEXELS` ÷ `cost` texels each. `cost` is the time
    of the program for a texel, relative to that of most bakes.
    """
    width, height = size
    rows = max(1, MAX_TEXELS // (cost * width))
    if engine.name != "gpu" or rows >= height:
        return engine.run(program, values, size)
    bands = [
        engine.run(program, values, size, (top, min(top + rows, height)))
        for top in range(0, height, rows)
    ]
    return {name: np.concatenate([band[name] for band in bands]) for name in bands[0]}
