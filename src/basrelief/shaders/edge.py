"""What lies beyond a map: the same again, or its border going on.

Texture coordinates are taken into one tile before a map is read; the texels beside the tile's own
come from the border that each map has (`lang.resources`).
"""

from __future__ import annotations

from typing import Any

from basrelief.lang import Vec2, fract, saturate, shader, slot
from basrelief.lang.resources import Edge


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


# --- the same for cells, which lie between texel centres ------------------------------------------


@slot
def cell_in_map(cell: int, count: int) -> int:
    """A cell along one axis as a map of so many texels has it, from −1 to count − 1."""


@shader
def wrap_cell(cell: int, count: int) -> int:
    """The same cell of the one tile."""
    return cell % count


@shader
def clamp_cell(cell: int, count: int) -> int:
    """The cells beyond the border are all alike."""
    return min(max(cell, -1), count - 1)


@slot
def next_cell(cell: int, count: int) -> int:
    """The same, of a cell that lies no further beyond the map than the map is long."""


@shader
def wrap_next(cell: int, count: int) -> int:
    """Less a tile: a division for each step would be slow."""
    return cell - count if cell >= count else cell + count if cell < 0 else cell


@slot
def cell_is_baked(cell: int, count: int) -> bool:
    """Whether what is baked for a cell of the map is true of this one, its slopes too."""


@shader
def wrap_baked(cell: int, count: int) -> bool:
    """All tiles are alike."""
    return True


@shader
def clamp_baked(cell: int, count: int) -> bool:
    """Beyond the border the heights no longer change."""
    return cell >= 0 and cell < count


# --- binding them ---------------------------------------------------------------------------------


_OF_CELLS = (cell_in_map, next_cell, cell_is_baked)


def edges_of(beyond: Edge) -> dict[Any, Any]:
    """What a program binds for an edge: for coordinates and for cells."""
    if beyond == "wrap":
        cells = (wrap_cell, wrap_next, wrap_baked)
        return {in_tile: wrap, **dict(zip(_OF_CELLS, cells, strict=True))}
    cells = (clamp_cell, clamp_cell, clamp_baked)
    return {in_tile: clamp, **dict(zip(_OF_CELLS, cells, strict=True))}
