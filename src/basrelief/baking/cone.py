"""Cone maps: above each cell of the surface, the widest cone that the surface does not rise into.

A cone's slope is in heights a texel, in any direction: it is circular in texels, whatever the
proportions of map, tile and texel. Stored is 1 ÷ (1 + slope), rounded down: 1 is a cone that is a
half space.
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

_MOST = 65535
SECTORS = 16
"""All around: whether the surface falls away is asked for each by itself."""
_MARGIN = 10.0
"""Degrees by which a window may reach beyond the sector that its middle lies in: half of its
diagonal, seen from 4½ times its width away."""
_ROUNDING = 0.01
"""Degrees by which sectors overlap, so that none falls between them."""

Heights = NDArray[np.float32]


def cone_map(heights: Heights, edge: Edge, device: str | Engine = "cpu") -> NDArray[np.uint16]:
    """The cones of a height map (h, w), 0 to 1, that nothing rises into: (h, w, 4) uint16.

    Texel (j, i) is of the cell between the texel centres j and j + 1, i and i + 1. From every place
    of the bilinear surface over that cell, no place of the surface, as far as it goes on, lies
    above the cone that has its tip there and the slope that is stored. It is read as it stands, not
    interpolated. Red, green and blue hold 1 ÷ (1 + slope), alpha is 1.

    Raises InputError for other edges than "wrap" and "clamp".
    After J. Dummer, Cone Step Mapping, 2006, whose cones are those of texels alone; and G. Valasek
    and R. Bán, Quick Cone Map Generation on the GPU, Eurographics 2022 Short Papers, who search
    windows of growing width too.
    """
    return _Baking(heights, edge, engine_of(device)).conservative()


def relaxed_cone_map(
    heights: Heights, edge: Edge, device: str | Engine = "cpu"
) -> NDArray[np.uint16]:
    """Cones that a ray may enter the surface in, and seldom comes out of: (h, w, 4) uint16.

    Stored and read as `cone_map` stores them. What holds: from each texel's centre no texel that is
    higher than the cone there is one beyond which the surface falls away in that direction. So, as
    far as texels tell, a ray that goes below the surface within a cone does not come out within it,
    and a binary search between the two ends of a step finds its first hit. A cell has the narrowest
    cone of its four corners. What does not: between texel centres a crest may rise into a cone, and
    a ray come out within it: on gravel and bricks none of 130,000 rays did, on one-texel posts one
    in 4,000, on a checkerboard of single texels one in 500.

    Raises InputError as `cone_map`.
    After F. Policarpo and M. M. Oliveira, Relaxed Cone Stepping for Relief Mapping, 2007, who try
    rays from the top above each texel only, so that others may come out again within a cone.
    """
    return _Baking(heights, edge, engine_of(device)).relaxed()


class _Baking:
    """One height map, and the engine that its shaders run on."""

    def __init__(self, heights: Heights, edge: Edge, engine: Engine) -> None:
        self.heights = np.ascontiguousarray(heights, np.float32)
        self.edge: Edge = checked_edge(edge)
        self.engine = engine
        self.field = HeightField([self.heights], edge)
        self.highest = float(self.heights.max())

    def conservative(self) -> NDArray[np.uint16]:
        squared = self._steepest(self.field, None, np.zeros_like(self.heights))
        return self._stored(cone_bake.cone_of, squared, field=self.field)

    def relaxed(self) -> NDArray[np.uint16]:
        squared = np.zeros_like(self.heights)
        for sector in range(SECTORS):
            asked = sector_of(sector)
            falling = self._run(cone_bake.crest_height, sector=asked, field=self.field)["height"]
            squared = self._steepest(HeightField([falling], self.edge), sector, squared)
        return self._stored(cone_bake.relaxed_cone_of, squared)

    def _steepest(self, those: HeightField, sector: int | None, squared: Heights) -> Heights:
        """The steepest line, squared, from each vertex to those of a field."""
        ends = ends_of(sector or 0)
        wide = self._windows(cone_bake_windows.first_windows, 0, field=those)
        k = 0
        while True:
            nearest = float(BLOCKS << k) / 2.0 if k else 0.0
            squared = self._run(
                cone_bake.steepest,
                search=Search(by_sector=sector is not None),
                bounds=SearchBounds(nearest, self.highest, *ends),
                layout=self._held(k),
                field=self.field,
                windows=wide,
                previous=HeightField([squared], self.edge),
            )["squared"]
            if BLOCKS << k > self._furthest():
                return squared
            k += 1
            wide = self._windows(
                cone_bake_windows.next_windows, k, narrower=self._held(k - 1), windows=wide
            )

    def _stored(self, entry: Shader[..., Any], squared: Heights, **more: Any) -> NDArray[np.uint16]:
        """Each cell's cone, from the steepest lines of its corners."""
        made = np.full((*self.heights.shape, 4), _MOST, np.uint16)
        slopes = HeightField([squared], self.edge)
        made[:, :, :3] = self._run(entry, slopes=slopes, **more)["cone"][:, :, None]
        return made

    def _furthest(self) -> int:
        """How far away, along an axis, texels matter: of those that repeat, the nearest do."""
        side = int(max(self.heights.shape))
        match self.edge:
            case "wrap":
                return side // 2
            case "clamp":
                return side - 1
            case _:
                assert_never(self.edge)

    def _held(self, k: int) -> WindowLayout:
        match self.edge:
            case "wrap":
                return WindowLayout(1 << k, 0)
            case "clamp":
                return WindowLayout(1 << k, (2 << k) - 1)
            case _:
                assert_never(self.edge)

    def _windows(self, entry: Shader[..., Any], k: int, **values: Any) -> Texture:
        held = self._held(k)
        planes = self._run(entry, beyond=int(held.before), layout=held, **values)
        made = np.stack([planes[name] for name in "xyzw"], -1)
        return Texture([made.astype(np.uint16)], self.edge)

    def _run(
        self,
        entry: Shader[..., Any],
        beyond: int = 0,
        search: Search | None = None,
        **values: Any,
    ) -> Planes:
        height, width = self.heights.shape
        program = Program(entry, edge=self.edge, variant=search)
        return run_pass(self.engine, program, values, (width + beyond, height + beyond))


def sector_of(sector: int) -> Sector:
    """The directions in which a surface may fall away, of one sector."""
    turned = ((sector, -_MARGIN), (sector, 0.0), (sector + 1, 0.0), (sector + 1, _MARGIN))
    return Sector(*(_direction(*each) for each in turned))


def ends_of(sector: int) -> tuple[Vec2, Vec2]:
    """The directions that windows of one sector lie between."""
    return _direction(sector, -_ROUNDING), _direction(sector + 1, _ROUNDING)


def _direction(sector: int, more: float) -> Vec2:
    """The direction that a sector begins with, turned by some degrees."""
    angle = math.radians(360.0 / SECTORS * sector + more)
    return Vec2(math.cos(angle), math.sin(angle))
