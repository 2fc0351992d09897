"""Missed hits: a picture held against the true one, pixel by pixel.

For pages, which have no float64; `measure.errors` computes the same for the library.
"""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    IVec2,
    Vec2,
    bits_float,
    dot,
    length,
    shader,
    struct,
)
from basrelief.lang.types import leaves
from basrelief.shading.intersection import Placement, View
from basrelief.shading.pixel import Pixel
from basrelief.shading.relief import Depth
from basrelief.shading.view_ray import view_ray
from basrelief.techniques.edge import nearest_copy

WITHIN = 1.0
"""Texels by which a hit may be off before it counts as missed."""
_PLANES = [name for name, _ in leaves(Pixel)]
U = _PLANES.index("uv.x")
V = _PLANES.index("uv.y")
HIT = _PLANES.index("hit")


@struct
class DrawnWord:
    """A value in the planes of the picture: the bits of a float, or an int."""

    bits: int


@struct
class TrueWord:
    """A value in the planes of the truth, likewise."""

    bits: int


@struct
class PictureSize:
    """The size of a picture in pixels, and that of its height map in texels."""

    width: int
    height: int
    texels: Vec2


@struct
class MissedHit:
    """Whether a pixel misses the true hit, and whether its ray passed through a feature."""

    missed: bool
    passed: bool


@shader
def missed_hit(
    at: IVec2,
    view: View,
    placement: Placement,
    depth: Depth,
    picture: PictureSize,
    drawn: Buffer[DrawnWord],
    truth: Buffer[TrueWord],
) -> MissedHit:
    """One pixel of a picture `drawn` by a technique against the `truth`, as planes of `Pixel`.

    Missed: displaced coordinates more than a texel from the true ones, the shortest way round where
    the map repeats, or nothing drawn. Passed: further than the true hit along the true ray, which
    is straight, whatever the technique's projection.
    """
    area = picture.width * picture.height
    k = at.y * picture.width + at.x
    if truth[HIT * area + k].bits == 0:
        return MissedHit(False, False)
    if drawn[HIT * area + k].bits == 0:
        return MissedHit(True, False)
    off = drawn_uv(drawn, area, k) - true_uv(truth, area, k)
    ray = view_ray(at, view, placement, depth)
    along = dot(off * picture.texels, ray.fall * picture.texels)
    return MissedHit(length(nearest_copy(off) * picture.texels) > WITHIN, along > 0.0)


@shader
def drawn_uv(planes: Buffer[DrawnWord], area: int, k: int) -> Vec2:
    """The displaced texture coordinates of a pixel."""
    return Vec2(bits_float(planes[U * area + k].bits), bits_float(planes[V * area + k].bits))


@shader
def true_uv(planes: Buffer[TrueWord], area: int, k: int) -> Vec2:
    """The true texture coordinates of a pixel."""
    return Vec2(bits_float(planes[U * area + k].bits), bits_float(planes[V * area + k].bits))
