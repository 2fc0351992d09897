"""The highest texel of every window of a height map, by doubling the windows' width.

A texture of windows holds for each texel four windows of w × w texels: the one that begins there,
the one right of it, the one below, the one below that. Where the border goes on, the texture
begins 2w − 1 texels before the map, so that windows that reach into the map are among them.
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


@struct
class Windows:
    """How wide windows are, in texels, and how many texels before the map their texture begins."""

    width: int
    before: int


@struct
class Four:
    """Four channels of 16 bits, as whole numbers."""

    x: float
    y: float
    z: float
    w: float


@shader
def first_windows(at: IVec2, made: Windows, field: HeightField) -> Four:
    """Windows of one texel: the heights themselves, rounded up."""
    four = corners(field, IVec2(at.x - made.before, at.y - made.before), 0)
    codes = floor(four * -65535.0) * -1.0
    return Four(codes.x, codes.y, codes.z, codes.w)


@shader
def next_windows(at: IVec2, made: Windows, narrower: Windows, windows: Texture) -> Four:
    """Windows of twice the width."""
    x = at.x - made.before
    y = at.y - made.before
    return Four(
        highest(windows_at(windows, narrower, x, y)),
        highest(windows_at(windows, narrower, x + made.width, y)),
        highest(windows_at(windows, narrower, x, y + made.width)),
        highest(windows_at(windows, narrower, x + made.width, y + made.width)),
    )


@shader
def windows_at(windows: Texture, held: Windows, x: int, y: int) -> Vec4:
    """The four windows, in 65535ths, of a texel of the map or near it."""
    extent = size(windows, 0)
    place = IVec2(
        cell_in_map(windows, x + held.before, extent.x),
        cell_in_map(windows, y + held.before, extent.y),
    )
    # before the first, where the border goes on, the first stands for all
    return stored(windows, IVec2(max(place.x, 0), max(place.y, 0)))


@shader
def highest(four: Vec4) -> float:
    """The highest of four."""
    return max(max(four.x, four.y), max(four.z, four.w))
