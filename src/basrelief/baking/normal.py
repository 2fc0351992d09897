"""Heights → normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.texels import Heights, checked, checked_scale, run
from basrelief.engine import Engine, engine_of
from basrelief.lang.resources import Edge
from basrelief.techniques.normal_bake import HeightRange, normals

Normals = NDArray[np.float32]
"""(h, w, 3): unit vectors, x right, y up in the picture, z out of it."""


def normal_map(heights: Heights, edge: Edge, scale: float, device: str | Engine = "cpu") -> Normals:
    """The unit normals (h, w, 3) of heights (h, w), 0 to 1: x right, y up, z out of the picture.

    `scale` is the whole height range as a fraction of the map's width, `edge` ("wrap" or "clamp")
    what lies beyond it. Central differences, of square texels. `device` is as in `render`.
    Raises InputError for other heights, edges and scales.
    """
    heights = checked(heights, edge)
    relief = HeightRange(checked_scale(scale) * heights.shape[1])
    planes = run(normals, heights, edge, engine_of(device), relief=relief)
    return np.stack([planes[f"normal.{axis}"] for axis in "xyz"], -1)
