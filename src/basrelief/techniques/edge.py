"""What lies beyond a map: the same again, or its border going on.

Texture coordinates are taken into one tile before a map is read; the texels beside the tile's own
come from the border that each map has (`lang.resources`).
"""

from __future__ import annotations

from typing import Any, Literal

from basrelief.lang import Vec2, floor, fract, maximum, minimum, saturate, shader, slot


@slot
def in_tile(uv: Vec2) -> Vec2:
    """Texture coordinates within the one tile that the maps hold, 0 to 1."""


@shader
def wrap(uv: Vec2) -> Vec2:
    """The tile repeats for ever."""
    return fract(uv)


@shader
def clamp(uv: Vec2) -> Vec2:
    """The border goes on for ever."""
    return saturate(uv)


@slot
def nearest_copy(apart: Vec2) -> Vec2:
    """The distance between two places, to the nearest copy of the second."""


@shader
def wrap_apart(apart: Vec2) -> Vec2:
    """Tiles repeat: at most half a tile along each axis."""
    return apart - floor(apart + 0.5)


@shader
def clamp_apart(apart: Vec2) -> Vec2:
    """There is one tile."""
    return apart


# --- the same for cells, which lie between texel centres; counted in floats: no processor ------
# divides whole numbers in many lanes


@slot
def cells_in_map(cell: Vec2, extent: Vec2) -> Vec2:
    """A cell as a map of so many texels has it: its far neighbour may lie one beyond the map."""


@shader
def wrap_cell(cell: Vec2, extent: Vec2) -> Vec2:
    """The same cell of the one tile, 0 to count − 1; of cells up to four million."""
    # from the cell's middle, which no rounding takes into the tile beside
    return cell - floor((cell + 0.5) * (1.0 / extent)) * extent


@shader
def clamp_cell(cell: Vec2, extent: Vec2) -> Vec2:
    """The cells beyond the border are all alike: −1 to count − 1."""
    return minimum(maximum(cell, -1.0), extent - 1.0)


@shader
def cell_in_map(cell: int, count: int) -> int:
    """The same along one axis, in whole numbers."""
    return int(cells_in_map(Vec2(float(cell), 0.0), Vec2(float(count), 1.0)).x)


@slot
def cell_is_baked(cell: Vec2, extent: Vec2) -> bool:
    """Whether what is baked for a cell of the map is true of this one, its slopes too."""


@shader
def wrap_baked(cell: Vec2, extent: Vec2) -> bool:
    """All tiles are alike."""
    return True


@shader
def clamp_baked(cell: Vec2, extent: Vec2) -> bool:
    """Beyond the border the heights no longer change."""
    return cell.x >= 0.0 and cell.y >= 0.0 and cell.x < extent.x and cell.y < extent.y


# --- bound ----------------------------------------------------------------------------------------


def edges_of(edge: Literal["wrap", "clamp"]) -> dict[Any, Any]:
    """The slots of this module as an edge binds them."""
    both = {
        "wrap": (wrap, wrap_apart, wrap_cell, wrap_baked),
        "clamp": (clamp, clamp_apart, clamp_cell, clamp_baked),
    }
    return dict(zip((in_tile, nearest_copy, cells_in_map, cell_is_baked), both[edge], strict=True))
