"""Texture coordinates and cells beyond a map's edge: `wrap` repeats the map, `clamp` its border.

Texture coordinates are mapped into one tile before a map is read. The neighbours of the outer
texels come from the border that each map has (`lang.resources`).
"""

from __future__ import annotations

from basrelief.lang import Map, Vec2, floor, fract, maximum, minimum, saturate, shader


@shader
def in_tile(map: Map, uv: Vec2) -> Vec2:
    """Texture coordinates mapped into the tile, 0 to 1."""
    return fract(uv) if map.edge == "wrap" else saturate(uv)


@shader
def nearest_copy(map: Map, offset: Vec2) -> Vec2:
    """The offset between two points of a repeating map, the shortest way round."""
    # at most half a tile along each axis
    return offset - floor(offset + 0.5) if map.edge == "wrap" else offset


# --- cells, which lie between four texel centres --------------------------------------------------
# in floats: no processor divides integers in many lanes


@shader
def cells_in_map(map: Map, cell: Vec2, extent: Vec2) -> Vec2:
    """The cell of a map of `extent` texels that stands for any cell.

    With `wrap` 0 to extent − 1, exact for cells up to four million. With `clamp` −1 to extent − 1:
    all cells beyond the border are alike.
    """
    if map.edge == "wrap":
        # from the cell's middle, which rounding never moves into the next tile
        return cell - floor((cell + 0.5) * (1.0 / extent)) * extent
    return minimum(maximum(cell, -1.0), extent - 1.0)


@shader
def cell_in_map(map: Map, cell: int, count: int) -> int:
    """`cells_in_map` along one axis, in integers."""
    return int(cells_in_map(map, Vec2(float(cell), 0.0), Vec2(float(count), 1.0)).x)


@shader
def cell_is_baked(map: Map, cell: Vec2, extent: Vec2) -> bool:
    """Whether the record of a cell is valid for it, slopes included; not beyond a clamped border,
    where the heights are constant."""
    within = cell.x >= 0.0 and cell.y >= 0.0 and cell.x < extent.x and cell.y < extent.y
    return map.edge == "wrap" or within
