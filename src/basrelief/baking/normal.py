"""Bake: heights → normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.texels import Heights, checked_heights, checked_scale, run
from basrelief.engine import Engine, engine_of
from basrelief.lang.resources import Edge
from basrelief.techniques.normal_bake import HeightRange, normals

Normals = NDArray[np.float32]
"""(h, w, 3) unit vectors: x right, y up in the picture, z out of it."""


def normal_map(heights: Heights, edge: Edge, scale: float, device: str | Engine = "cpu") -> Normals:
    """Bake the normals of a height map, by central differences, for square texels.

    Parameters
    ----------
    heights
        (h, w), 0 to 1.
    edge
        "wrap" or "clamp".
    scale
        The whole height range as a fraction of the map's width, at least 0.
    device
        As in `render`.

    Returns
    -------
    array
        (h, w, 3) float32 unit vectors: x right, y up in the picture, z out of it.

    Raises
    ------
    InputError
        For other heights, edges and scales.
    """
    heights = checked_heights(heights, edge)
    relief = HeightRange(checked_scale(scale) * heights.shape[1])
    planes = run(normals, heights, edge, engine_of(device), relief=relief)
    return np.stack([planes[f"normal.{axis}"] for axis in "xyz"], -1)
