"""The bounds that the technique `exact` goes by, rounded to the safe side.

A cell lies between four texel centres. For each block of cells and each of the four quadrants that
a ray can run towards, a record of four 16-bit numbers holds: the room above a plane, at the block's
corner, and the plane's two slopes, nothing in a small window ahead rising above the plane; and the
room above the highest point of a larger window ahead. Room is 1 less a height.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from basrelief.lang.resources import Edge
from basrelief.shaders.techniques.exact import (
    BLOCK,
    HIGHEST,
    LOWEST,
    PLANE,
    STEEPEST,
    WINDOW,
)

_MOST = 65535
_SLACK = 1e-6
"""Heights that float32 may lose on the way."""
_PLACE_SLACK = 0.002
"""Texels by which float32 may misplace a ray, and so what a slope makes of them."""

Heights = NDArray[np.float32]


def bounds(heights: Heights, edge: Edge) -> NDArray[np.uint16]:
    """The records of a height map (h, w), 0 to 1: (4 · ⌈h ÷ 2⌉, ⌈w ÷ 2⌉, 4) uint16.

    The quadrants lie below one another: u and v growing; u shrinking; v shrinking; both.
    """
    count = [-(-side // BLOCK) for side in heights.shape]
    around = _Around(np.asarray(heights, np.float32), edge)
    made = np.empty((4 * count[0], count[1], 4), np.uint16)
    windows = around.highest(WINDOW)
    for quadrant in range(4):
        left, up = quadrant & 1, quadrant >> 1
        part = made[quadrant * count[0] : (quadrant + 1) * count[0]]
        back = (BLOCK - WINDOW, BLOCK - PLANE)
        top = around.of_blocks(windows, back[0] * up, back[0] * left, count)
        part[:, :, 3] = np.floor((1.0 - top.astype(np.float64)) * _MOST)
        part[:, :, :3] = _planes(around, back[1] * up, back[1] * left, count)
    return made


class _Around:
    """A height map with as much of what lies beyond it as windows reach into."""

    def __init__(self, heights: Heights, edge: Edge) -> None:
        self.margin = WINDOW
        rows, columns = (self._places(side, edge) for side in heights.shape)
        self.heights = heights[rows][:, columns]

    def _places(self, side: int, edge: Edge) -> NDArray[np.int64]:
        places = np.arange(-self.margin, side + BLOCK + self.margin + 1)
        return places % side if edge == "wrap" else np.clip(places, 0, side - 1)

    def highest(self, cells: int) -> Heights:
        """The highest point of the window of so many cells that begins at each texel."""
        made = self.heights
        for axis in (0, 1):
            made = _highest_along(made, cells + 1, axis)
        return made

    def of_blocks(
        self, values: NDArray[np.float32], down: int, right: int, count: list[int]
    ) -> NDArray[np.float32]:
        """The values at the first cell of each block, moved by so many cells."""
        y, x = self.margin + down, self.margin + right
        return values[y : y + BLOCK * count[0] : BLOCK, x : x + BLOCK * count[1] : BLOCK]


def _highest_along(values: Heights, count: int, axis: int) -> Heights:
    """The maximum of `count` values from each on, by doubling; the end is shorter by as many."""
    reach = 1
    while reach < count:
        step = min(reach, count - reach)
        length = values.shape[axis] - step
        values = np.maximum(
            np.take(values, range(length), axis), np.take(values, range(step, step + length), axis)
        )
        reach += step
    return values


def _planes(around: _Around, down: int, right: int, count: list[int]) -> NDArray[np.float64]:
    """Room and slopes of the planes above all blocks' windows, encoded, (rows, columns, 3)."""
    points = PLANE + 1
    places = range(points)
    middle = (points - 1) / 2.0
    spread = points * sum((i - middle) ** 2 for i in places)
    along_u = np.zeros(count)
    along_v = np.zeros(count)
    for j in places:
        for i in places:
            height = around.of_blocks(around.heights, down + j, right + i, count)
            along_u += (i - middle) / spread * height
            along_v += (j - middle) / spread * height
    codes = [np.rint((s / STEEPEST * 0.5 + 0.5) * _MOST) for s in (along_u, along_v)]
    # from here on with the slopes as they are stored
    u, v = ((code * (2.0 / _MOST) - 1.0) * STEEPEST for code in codes)
    top = np.full(count, -np.inf)
    for j in places:
        for i in places:
            height = around.of_blocks(around.heights, down + j, right + i, count)
            np.maximum(top, height - u * (right + i) - v * (down + j), out=top)
    top += _SLACK + _PLACE_SLACK * (np.abs(u) + np.abs(v))
    room = np.floor((1.0 - top - LOWEST) / (HIGHEST - LOWEST) * _MOST)
    return np.stack([room, *codes], -1)
