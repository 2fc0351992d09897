"""Missed hits: a picture compared with the true picture, pixel by pixel.

For pages, which have no float64; `measure.errors` computes the same in the library.
"""

from __future__ import annotations

from basrelief.lang import Buffer, IVec2, Map, Vec2, dot, length, shader, struct
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import CameraSample, Placement
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.variant import Variant
from basrelief.shading.view_ray import view_ray
from basrelief.techniques.edge import nearest_copy

MAX_UV_ERROR = 1.0
"""Texels: a hit further off than this counts as missed (CONVENTIONS.md, Errors)."""


@struct
class DrawnHit:
    """A drawn pixel: its displaced texture coordinates, and `hit` 1 where the object is hit."""

    uv: Vec2
    hit: int


@struct
class TrueHit:
    """The same for the true picture."""

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
    sample: CameraSample,
    placement: Placement,
    relief: ReliefParameters,
    picture: PictureSize,
    drawn: Buffer[DrawnHit],
    truth: Buffer[TrueHit],
    geometry: Geometry,
    map: Map,
    variant: Variant,
) -> MissedHit:
    """Compare a pixel of a picture `drawn` by a technique with the `truth`; both are row by row.

    Missed: the displaced coordinates are more than a texel from the true ones, the shortest way
    round where the map repeats, or nothing is drawn. Passed: they lie behind the true hit along the
    true ray, which is straight whatever the technique's projection.
    """
    k = at.y * picture.width + at.x
    if truth[k].hit == 0:
        return MissedHit(False, False)
    if drawn[k].hit == 0:
        return MissedHit(True, False)
    error = drawn[k].uv - truth[k].uv
    ray = view_ray(at, sample, placement, relief, geometry, variant)
    along = dot(error * picture.texels, ray.travel * picture.texels)
    return MissedHit(length(nearest_copy(map, error) * picture.texels) > MAX_UV_ERROR, along > 0.0)
