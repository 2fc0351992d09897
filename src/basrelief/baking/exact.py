"""The bounds that the technique `exact` goes by, rounded to the safe side.

A cell lies between four texel centres. For each block of 2 × 2 cells and each of the four quadrants
that a ray can run towards, a near record of four 16-bit numbers holds: the room above a plane, at
the block's back corner, and the plane's two slopes along the way, nothing in the 4 × 4 cells ahead
rising above the plane; and the room above the highest point of the 10 × 10 cells ahead. For each
block of 8 × 8 cells a far record holds the room above the highest points of the 24², 48², 96² and
192² cells ahead. Room is 1 less a height. `techniques.exact_bake` has the shaders.
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
"""The windows of a far record by name, and their widths in blocks."""
Heights = NDArray[np.float32]
Records = NDArray[np.uint16]


def bounds(
    heights: Heights, edge: Edge, device: str | Engine = "cpu", *, all_levels: bool = False
) -> Records:
    """The records of a height map (h, w), 0 to 1, as one table (rows, columns, 4) of uint16.

    Of N × M blocks the near records are 2N rows of 2M: u and v growing, u shrinking beside them, v
    shrinking below. The far ones, in the same order, lie below at the left; what is left is 0. With
    `all_levels` those of each lower level of the map's pyramid follow below. Some 10 bytes a texel.
    `device` is as in `render`. Raises InputError for other edges.
    """
    levels = levels_of(heights) if all_levels else [np.ascontiguousarray(heights, np.float32)]
    engine, parts = engine_of(device), []
    for level in levels:
        making = _Making(level, edge, engine)
        parts += [making.near(), making.far()]
    made = np.zeros(
        (sum(len(part) for part in parts), max(part.shape[1] for part in parts), 4), np.uint16
    )
    row = 0
    for part in parts:
        made[row : row + len(part), : part.shape[1]] = part
        row += len(part)
    return made


class _Making:
    """The steps from a height map to its records, each a program of its own."""

    def __init__(self, heights: Heights, edge: Edge, engine: Engine) -> None:
        self.edge: Edge = checked_edge(edge)
        self.engine = engine
        self.heights = heights
        self.field = HeightField([heights], edge)

    def near(self) -> Records:
        """The near records."""
        windows = self.widened(self.blocks(BLOCK, REACH), 1, REACH)
        return self.records(shaders.near_record, BLOCK, windows=windows)

    def far(self) -> Records:
        """The far records."""
        found = [self.widened(self.blocks(FAR_BLOCK, FAR_REACH), 1, FAR)]
        for width, wanted in itertools.pairwise(FAR_WINDOWS.values()):
            found.append(self.widened(found[-1], width, wanted))
        windows = dict(zip(FAR_WINDOWS, found, strict=True))
        return self.records(shaders.far_record, FAR_BLOCK, **windows)

    def blocks(self, side: int, margin: int) -> HeightField:
        """The highest points of the blocks of so many cells, and of a margin of blocks around."""
        rows, columns = (n + 2 * margin for n in self.count(side))
        values = {"blocks": Blocks(side, margin), "field": self.field}
        return self.tops(shaders.block_top, values, (columns, rows))

    def widened(self, windows: HeightField, width: int, wanted: int) -> HeightField:
        """Windows of a wanted width in blocks, from narrower ones that overlap."""
        while width < wanted:
            apart = min(width, wanted - width)
            values = {"overlap": Overlap(apart), "field": windows}
            rows, columns = windows.shape
            windows = self.tops(shaders.window_top, values, (columns, rows))
            width += apart
        return windows

    def tops(
        self, entry: Shader[..., Any], values: dict[str, Any], size: tuple[int, int]
    ) -> HeightField:
        planes = run_pass(self.engine, self.program(entry), values, size)
        return HeightField([planes["height"]], self.edge)

    def records(self, entry: Shader[..., Any], side: int, **windows: HeightField) -> Records:
        """The records of all blocks and quadrants."""
        rows, columns = (2 * n for n in self.count(side))
        values = {"field": self.field, **windows}
        planes = run_pass(self.engine, self.program(entry), values, (columns, rows))
        words = np.stack([planes["low"], planes["high"]], -1)
        return words.view(np.uint16)

    def program(self, entry: Shader[..., Any]) -> Program:
        return Program(entry, edge=self.edge)

    def count(self, side: int) -> tuple[int, int]:
        rows, columns = (-(-n // side) for n in self.heights.shape)
        return rows, columns
