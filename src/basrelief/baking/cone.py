"""Cone maps: for each cell of the surface, the widest cone above it that is free of the surface.

The slope of a cone is in heights per texel, the same in all directions: cones are circular in
texels, whatever the proportions of map, tile and texel. Maps store 1 ÷ (1 + slope), rounded down;
1 is a half space.
"""

from __future__ import annotations

import math
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from basrelief.baking.passes import run_pass
from basrelief.baking.texels import checked_edge
from basrelief.engine.engine import Engine, Planes
from basrelief.engine.select import engine_of
from basrelief.lang import HeightField, Shader, Texture, Vec2
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.techniques import cone_bake, cone_bake_windows
from basrelief.techniques.cone_bake import BLOCKS, Search, SearchBounds, Sector
from basrelief.techniques.cone_bake_windows import WindowLayout

_MAX_CODE = 65535
SECTORS = 16
"""Sectors of the full circle; whether the surface falls is decided for each of them."""
_MARGIN = 10.0
"""Degrees by which a window may extend beyond the sector of its centre: half its diagonal, seen
from a distance of 4½ widths."""
_OVERLAP = 0.01
"""Degrees by which sectors overlap, so that rounding leaves no gap."""

Heights = NDArray[np.float32]


def cone_map(heights: Heights, edge: Edge, device: str | Engine = "cpu") -> NDArray[np.uint16]:
    """Bake the conservative cone map of a height map.

    Texel (j, i) belongs to the cell between the texel centres j and j + 1, i and i + 1. From any
    point of the bilinear surface over that cell, no point of the surface, however far, lies above
    the cone with its tip there and the stored slope. Read the map without interpolation.

    Parameters
    ----------
    heights
        (h, w), 0 to 1.
    edge
        "wrap" or "clamp".
    device
        As in `render`.

    Returns
    -------
    array
        (h, w, 4) uint16: 1 ÷ (1 + slope) in red, green and blue, 1 in alpha.

    Raises
    ------
    InputError
        For other edges.

    References
    ----------
    J. Dummer, Cone Step Mapping, 2006, whose cones hold at texels only. G. Valasek and R. Bán,
    Quick Cone Map Generation on the GPU, Eurographics 2022 Short Papers, who also search windows of
    growing width.
    """
    return _ConeBake(heights, edge, engine_of(device)).conservative()


def relaxed_cone_map(
    heights: Heights, edge: Edge, device: str | Engine = "cpu"
) -> NDArray[np.uint16]:
    """Bake a relaxed cone map: rays may enter the surface within a cone, but rarely leave it there.

    At texel centres this is exact: no texel that is higher than a cone is one behind which the
    surface falls in that direction. As far as texels tell, a ray that goes below the surface
    within a cone does not come out within it, and a binary search between the ends of the step
    finds its first hit. The cone of a cell is the narrowest of its four corners. Between texel
    centres a crest may rise into a cone and a ray come out: none of 130,000 rays on gravel and
    bricks, one in 4,000 on one-texel posts, one in 500 on a checkerboard of texels.

    Parameters
    ----------
    heights
        (h, w), 0 to 1.
    edge
        "wrap" or "clamp".
    device
        As in `render`.

    Returns
    -------
    array
        (h, w, 4) uint16, as `cone_map` returns it.

    Raises
    ------
    InputError
        For other edges.

    References
    ----------
    F. Policarpo and M. M. Oliveira, Relaxed Cone Stepping for Relief Mapping, 2007, who try only
    rays from the top above each texel, so that others may come out within a cone.
    """
    return _ConeBake(heights, edge, engine_of(device)).relaxed()


class _ConeBake:
    """Passes of the bake of one height map, on an engine."""

    def __init__(self, heights: Heights, edge: Edge, engine: Engine) -> None:
        self.heights = np.ascontiguousarray(heights, np.float32)
        self.edge: Edge = checked_edge(edge)
        self.engine = engine
        self.field = HeightField([self.heights], edge)
        self.highest = float(self.heights.max())

    def conservative(self) -> NDArray[np.uint16]:
        squared = self._steepest(self.field, None, np.zeros_like(self.heights))
        return self._encode(cone_bake.cone_of, squared, field=self.field)

    def relaxed(self) -> NDArray[np.uint16]:
        squared = np.zeros_like(self.heights)
        for sector in range(SECTORS):
            directions = sector_of(sector)
            planes = self._run(cone_bake.crest_height, sector=directions, field=self.field)
            falling = HeightField([planes["height"]], self.edge)
            squared = self._steepest(falling, sector, squared)
        return self._encode(cone_bake.relaxed_cone_of, squared)

    def _steepest(self, targets: HeightField, sector: int | None, squared: Heights) -> Heights:
        """Squared slope of the steepest line from each vertex to the vertices of a field."""
        bounds = sector_bounds(sector or 0)
        windows = self._windows(cone_bake_windows.first_windows, 0, field=targets)
        k = 0
        while True:
            nearest = float(BLOCKS << k) / 2.0 if k else 0.0
            squared = self._run(
                cone_bake.steepest,
                search=Search(by_sector=sector is not None),
                bounds=SearchBounds(nearest, self.highest, *bounds),
                layout=self._layout(k),
                field=self.field,
                windows=windows,
                previous=HeightField([squared], self.edge),
            )["squared"]
            if BLOCKS << k > self._max_distance():
                return squared
            k += 1
            windows = self._windows(
                cone_bake_windows.next_windows, k, narrower=self._layout(k - 1), windows=windows
            )

    def _encode(
        self, entry: Shader[..., Any], squared: Heights, **values: Any
    ) -> NDArray[np.uint16]:
        """Cone map from the squared slopes at the corners of each cell."""
        cones = np.full((*self.heights.shape, 4), _MAX_CODE, np.uint16)
        slopes = HeightField([squared], self.edge)
        cones[:, :, :3] = self._run(entry, slopes=slopes, **values)["cone"][:, :, None]
        return cones

    def _max_distance(self) -> int:
        """Largest distance along an axis to search: for a map that repeats, half its side."""
        side = int(max(self.heights.shape))
        match self.edge:
            case "wrap":
                return side // 2
            case "clamp":
                return side - 1
            case _:
                assert_never(self.edge)

    def _layout(self, k: int) -> WindowLayout:
        match self.edge:
            case "wrap":
                return WindowLayout(1 << k, 0)
            case "clamp":
                return WindowLayout(1 << k, (2 << k) - 1)
            case _:
                assert_never(self.edge)

    def _windows(self, entry: Shader[..., Any], k: int, **values: Any) -> Texture:
        layout = self._layout(k)
        planes = self._run(entry, margin=int(layout.before), layout=layout, **values)
        windows = np.stack([planes[name] for name in "xyzw"], -1)
        return Texture([windows.astype(np.uint16)], self.edge)

    def _run(
        self,
        entry: Shader[..., Any],
        margin: int = 0,
        search: Search | None = None,
        **values: Any,
    ) -> Planes:
        height, width = self.heights.shape
        program = Program(entry, edge=self.edge, variant=search)
        return run_pass(self.engine, program, values, (width + margin, height + margin))


def sector_of(sector: int) -> Sector:
    """Directions of a sector for `crest_height`, with a margin on both sides."""
    directions = ((sector, -_MARGIN), (sector, 0.0), (sector + 1, 0.0), (sector + 1, _MARGIN))
    return Sector(*(_direction(*d) for d in directions))


def sector_bounds(sector: int) -> tuple[Vec2, Vec2]:
    """First and last direction of a sector for the centres of windows."""
    return _direction(sector, -_OVERLAP), _direction(sector + 1, _OVERLAP)


def _direction(sector: int, offset: float) -> Vec2:
    """First direction of a sector, rotated by `offset` degrees."""
    angle = math.radians(360.0 / SECTORS * sector + offset)
    return Vec2(math.cos(angle), math.sin(angle))
