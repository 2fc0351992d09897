"""Reading the height field: the bilinear surface through its texel centres."""

from __future__ import annotations

from basrelief.lang import HeightField, IVec2, Vec2, corners, floor, mix, shader, size
from basrelief.shaders.edge import in_tile


@shader
def height_at(field: HeightField, uv: Vec2) -> float:
    """The height, 0 to 1, at texture coordinates; texel centres lie at (i + ½) ÷ N.

    From the finest level, written out as 0: on a GPU that reads all four texels at once.
    """
    extent = size(field, 0)
    tile = in_tile(uv)
    x = tile.x * float(extent.x) - 0.5
    y = tile.y * float(extent.y) - 0.5
    left = floor(x)
    top = floor(y)
    four = corners(field, IVec2(int(left), int(top)), 0)
    upper = mix(four.x, four.y, x - left)
    lower = mix(four.z, four.w, x - left)
    return mix(upper, lower, y - top)
