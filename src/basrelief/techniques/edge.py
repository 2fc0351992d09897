"""What lies beyond a map: the same again, or its border going on.

Texture coordinates are taken into one tile before a map is read; the texels beside the tile's own
come from the border that each map has (`lang.resources`).
"""

from __future__ import annotations

from basrelief.lang import Map, Vec2, floor, fract, maximum, minimum, saturate, shader


@shader
def in_tile(map: Map, uv: Vec2) -> Vec2:
    """Texture coordinates within the one tile that a map holds, 0 to 1."""
    return fract(uv) if map.edge == "wrap" else saturate(uv)


@shader
def nearest_copy(map: Map, offset: Vec2) -> Vec2:
    """The offset from a place to the nearest copy of another, given that to one of its copies."""
    # tiles that repeat: at most half a tile along each axis
    return offset - floor(offset + 0.5) if map.edge == "wrap" else offset


# --- the same for cells, which lie between texel centres; counted in floats: no processor ------
# divides whole numbers in many lanes


@shader
def cells_in_map(map: Map, cell: Vec2, extent: Vec2) -> Vec2:
    """A cell as a map of so many texels has it: its far neighbour may lie one beyond the map.

    Where tiles repeat that is 0 to count − 1, of cells up to four million; else, the cells beyond
    the border being all alike, −1 to count − 1.
    """
    if map.edge == "wrap":
        # from the cell's middle, which no rounding takes into the tile beside
        return cell - floor((cell + 0.5) * (1.0 / extent)) * extent
    return minimum(maximum(cell, -1.0), extent - 1.0)


@shader
def cell_in_map(map: Map, cell: int, count: int) -> int:
    """The same along one axis, in whole numbers."""
    return int(cells_in_map(map, Vec2(float(cell), 0.0), Vec2(float(count), 1.0)).x)


@shader
def cell_is_baked(map: Map, cell: Vec2, extent: Vec2) -> bool:
    """Whether what is baked for a cell of the map is true of this one, its slopes too: beyond a
    border that goes on the heights no longer change."""
    within = cell.x >= 0.0 and cell.y >= 0.0 and cell.x < extent.x and cell.y < extent.y
    return map.edge == "wrap" or within
