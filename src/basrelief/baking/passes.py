"""Running one pass of a bake on an engine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from basrelief.engine import Engine
from basrelief.engine.engine import Planes
from basrelief.lang.program import Program

AT_ONCE = 1 << 20
"""Texels that a GPU is given at once. Drivers stop what runs for seconds: Windows after two."""


def run_pass(
    engine: Engine,
    program: Program,
    values: Mapping[str, Any],
    size: tuple[int, int],
    *,
    effort: int = 1,
) -> Planes:
    """The planes of a program over a picture of (width, height), by a GPU band by band.

    `effort` is how many times as long as others the program takes for a texel.
    """
    width, height = size
    rows = max(1, AT_ONCE // (effort * width))
    if engine.name != "gpu" or rows >= height:
        return engine.run(program, values, size)
    bands = [
        engine.run(program, values, size, (top, min(top + rows, height)))
        for top in range(0, height, rows)
    ]
    return {name: np.concatenate([band[name] for band in bands]) for name in bands[0]}
