"""Missed hits: a picture held against the true one, pixel by pixel.

For pages, which have no float64; `measure.errors` computes the same for the library.
"""

from __future__ import annotations

from basrelief.lang import Buffer, IVec2, Map, Vec2, dot, length, shader, struct
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import Placement, View
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.variant import Variant
from basrelief.shading.view_ray import view_ray
from basrelief.techniques.edge import nearest_copy

WITHIN = 1.0
"""Texels by which a hit may be off before it counts as missed."""


@struct
class DrawnHit:
    """A pixel as drawn: displaced texture coordinates, and 1 where there is a hit."""

    uv: Vec2
    hit: int


@struct
class TrueHit:
    """The same of the true picture."""

    uv: Vec2
    hit: int


@struct
class PictureSize:
    """The width of a picture in pixels, and the size of its height map in texels."""

    width: int
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
    relief: ReliefParameters,
    picture: PictureSize,
    drawn: Buffer[DrawnHit],
    truth: Buffer[TrueHit],
    geometry: Geometry,
    map: Map,
    variant: Variant,
) -> MissedHit:
    """One pixel of a picture `drawn` by a technique, held against the `truth`; both row by row.

    Missed: displaced coordinates more than a texel from the true ones, the shortest way round where
    the map repeats, or nothing drawn. Passed: further than the true hit along the true ray, which
    is straight, whatever the technique's projection.
    """
    k = at.y * picture.width + at.x
    if truth[k].hit == 0:
        return MissedHit(False, False)
    if drawn[k].hit == 0:
        return MissedHit(True, False)
    off = drawn[k].uv - truth[k].uv
    ray = view_ray(at, view, placement, relief, geometry, variant)
    along = dot(off * picture.texels, ray.travel * picture.texels)
    return MissedHit(length(nearest_copy(map, off) * picture.texels) > WITHIN, along > 0.0)
