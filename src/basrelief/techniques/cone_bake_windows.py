"""The highest texel in every window of a height map, by doubling the width of the windows.

A texture of windows holds, for each texel, four windows of w × w texels: the one that begins there,
the one right of it, the one below and the one below right. With the edge `clamp` the texture begins
2w − 1 texels before the map, so that windows which only partly cover the map are included.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec4,
    corners,
    floor,
    shader,
    size,
    stored,
    struct,
)
from basrelief.techniques.edge import cell_in_map

UNIT = 1.0 / 65535.0
"""The unit of 16-bit heights."""


@struct
class WindowLayout:
    """A texture of windows: their `width` in texels, and the number of texels `before` the map at
    which the texture begins."""

    width: int
    before: int


@struct
class WindowHeights:
    """The highest heights of a texel's four windows, in 65535ths."""

    x: float
    y: float
    z: float
    w: float


@shader
def first_windows(at: IVec2, layout: WindowLayout, field: HeightField) -> WindowHeights:
    """Windows of one texel: the heights, rounded up."""
    four = corners(field, IVec2(at.x - layout.before, at.y - layout.before), 0)
    codes = floor(four * -65535.0) * -1.0
    return WindowHeights(codes.x, codes.y, codes.z, codes.w)


@shader
def next_windows(
    at: IVec2, layout: WindowLayout, narrower: WindowLayout, windows: Texture
) -> WindowHeights:
    """Windows of twice the width, from the `narrower` ones."""
    x = at.x - layout.before
    y = at.y - layout.before
    return WindowHeights(
        highest(windows_at(windows, narrower, x, y)),
        highest(windows_at(windows, narrower, x + layout.width, y)),
        highest(windows_at(windows, narrower, x, y + layout.width)),
        highest(windows_at(windows, narrower, x + layout.width, y + layout.width)),
    )


@shader
def windows_at(windows: Texture, layout: WindowLayout, x: int, y: int) -> Vec4:
    """The four windows, in 65535ths, of a texel in or near the map."""
    extent = size(windows, 0)
    texel = IVec2(
        cell_in_map(windows, x + layout.before, extent.x),
        cell_in_map(windows, y + layout.before, extent.y),
    )
    # before a clamped border all windows equal the first
    return stored(windows, IVec2(max(texel.x, 0), max(texel.y, 0)))


@shader
def highest(four: Vec4) -> float:
    """The largest of four heights."""
    return max(max(four.x, four.y), max(four.z, four.w))
