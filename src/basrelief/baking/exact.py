"""Bounds of a height map for the technique `exact`, rounded to the safe side.

A cell lies between four texel centres. Records are baked for each of the four quadrants of ray
directions. A near record covers a block of 2 × 2 cells, with four 16-bit numbers: a plane that
nothing in the 4 × 4 cells ahead rises above, given by the headroom above it at the back corner of
the block and its two slopes; and the headroom above the highest point of the 10 × 10 cells ahead. A
far record covers a block of 8 × 8 cells, with the headroom above the highest points of the 24²,
48², 96² and 192² cells ahead. Headroom is 1 − height. The shaders are in `techniques.exact_bake`.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.levels import levels_of
from basrelief.baking.passes import run_pass
from basrelief.baking.texels import checked_edge
from basrelief.engine import Engine, engine_of
from basrelief.lang import Shader
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge, HeightField
from basrelief.techniques import exact_bake as shaders
from basrelief.techniques.exact_bake import FAR_REACH, REACH, Blocks, Overlap
from basrelief.techniques.exact_records import BLOCK, FAR, FAR_2, FAR_3, FAR_4, FAR_BLOCK

FAR_WINDOWS = {"least": FAR, "second": FAR_2, "third": FAR_3, "most": FAR_4}
"""Windows of a far record: names, and widths in blocks."""
Heights = NDArray[np.float32]
Records = NDArray[np.uint16]


def bounds(
    heights: Heights, edge: Edge, device: str | Engine = "cpu", *, all_levels: bool = False
) -> Records:
    """Bake the bounds of a height map for the technique `exact`, about 10 bytes per texel.

    For N × M blocks the near records are 2N rows of 2M, one quarter for each quadrant of ray
    directions: u growing at the left and shrinking at the right, v growing at the top and shrinking
    at the bottom. The far records follow below, at the left, in the same order; the rest is 0.

    Parameters
    ----------
    heights
        (h, w), 0 to 1.
    edge
        "wrap" or "clamp".
    device
        As in `render`.
    all_levels
        Whether the records of all lower mip levels follow below.

    Returns
    -------
    array
        (rows, columns, 4) uint16.

    Raises
    ------
    InputError
        For other edges.
    """
    levels = levels_of(heights) if all_levels else [np.ascontiguousarray(heights, np.float32)]
    engine, parts = engine_of(device), []
    for level in levels:
        bake = _BoundsBake(level, edge, engine)
        parts += [bake.near(), bake.far()]
    table = np.zeros(
        (sum(len(part) for part in parts), max(part.shape[1] for part in parts), 4), np.uint16
    )
    row = 0
    for part in parts:
        table[row : row + len(part), : part.shape[1]] = part
        row += len(part)
    return table


class _BoundsBake:
    """Passes from a height map to its records, each a program."""

    def __init__(self, heights: Heights, edge: Edge, engine: Engine) -> None:
        self.edge: Edge = checked_edge(edge)
        self.engine = engine
        self.heights = heights
        self.field = HeightField([heights], edge)

    def near(self) -> Records:
        """Near records of all blocks and quadrants."""
        windows = self.widened(self.blocks(BLOCK, REACH), 1, REACH)
        return self.records(shaders.near_record, BLOCK, windows=windows)

    def far(self) -> Records:
        """Far records of all blocks and quadrants."""
        fields = [self.widened(self.blocks(FAR_BLOCK, FAR_REACH), 1, FAR)]
        for width, target in itertools.pairwise(FAR_WINDOWS.values()):
            fields.append(self.widened(fields[-1], width, target))
        windows = dict(zip(FAR_WINDOWS, fields, strict=True))
        return self.records(shaders.far_record, FAR_BLOCK, **windows)

    def blocks(self, side: int, margin: int) -> HeightField:
        """Maxima of the blocks of side² cells, with a margin of blocks around the map."""
        rows, columns = (n + 2 * margin for n in self.count(side))
        values = {"blocks": Blocks(side, margin), "field": self.field}
        return self.maxima(shaders.block_top, values, (columns, rows))

    def widened(self, windows: HeightField, width: int, target: int) -> HeightField:
        """Maxima of windows `target` blocks wide, from overlapping narrower windows."""
        while width < target:
            step = min(width, target - width)
            values = {"overlap": Overlap(step), "field": windows}
            rows, columns = windows.shape
            windows = self.maxima(shaders.window_top, values, (columns, rows))
            width += step
        return windows

    def maxima(
        self, entry: Shader[..., Any], values: dict[str, Any], size: tuple[int, int]
    ) -> HeightField:
        """Field of the heights that a shader computes."""
        planes = run_pass(self.engine, self.program(entry), values, size)
        return HeightField([planes["height"]], self.edge)

    def records(self, entry: Shader[..., Any], side: int, **windows: HeightField) -> Records:
        """Records of all blocks and quadrants."""
        rows, columns = (2 * n for n in self.count(side))
        values = {"field": self.field, **windows}
        planes = run_pass(self.engine, self.program(entry), values, (columns, rows))
        words = np.stack([planes["low"], planes["high"]], -1)
        return words.view(np.uint16)

    def program(self, entry: Shader[..., Any]) -> Program:
        return Program(entry, edge=self.edge)

    def count(self, side: int) -> tuple[int, int]:
        """Rows and columns of blocks of side² cells."""
        rows, columns = (-(-n // side) for n in self.heights.shape)
        return rows, columns
