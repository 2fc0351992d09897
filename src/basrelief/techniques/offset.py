r"""Techniques with at most one height read: parallax mapping in its original form.

The height h is read where the ray meets the polygon, and the ray is followed to that height, as if
the surface were level in between.

    reference height --*------------  polygon: h is read here, at uv
                       :`.
                   h ..:..`*........  the result, at uv'
                     __:   :
                    /   \__:_____     surface
"""

from __future__ import annotations

from basrelief.lang import HeightField, Vec2, maximum, minimum, setting, shader, struct
from basrelief.techniques.height import height_under
from basrelief.techniques.ray import Hit, Ray, at, hit_at, t_at
from basrelief.techniques.technique import Nothing, technique


@struct
class Offset:
    """Settings of the techniques with one read."""

    max_offset: float = setting(
        default=1.0,
        doc="maximum offset along u and along v, in tiles",
        low=0.0,
        high=256.0,
        in_tiles=True,
    )
    max_offset_ratio: float = setting(
        default=1.0, doc="maximum offset along v ÷ that along u", low=0.0, high=64.0
    )


@technique()
def flat(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """No parallax: the hit is where the ray meets the polygon.

    Cost: no reads.
    """
    return hit_at(ray, t_at(ray, ray.reference_height), True, 0)


@technique(reference_height=0.5, most_reads=1)
def offset(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """Parallax mapping: follow the ray to the height read at the polygon.

        uv' = uv + travel · (t(h) − t(reference_height)),  h the height at uv

    Exact where the height is the same at both points, distorted where it changes between them.
    With the projection `biased` it is Unity's standard shader. Each component of the offset is
    clamped to `max_offset`, after wikibooks.
    Cost: one read.

    References
    ----------
    T. Kaneko et al., Detailed Shape Representation with Parallax Mapping, 2001.
    """
    return shifted(field, ray, settings)


@technique(reference_height=0.5, projection="limited", most_reads=1)
def offset_limited(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """Parallax mapping with offset limiting: `offset` with the projection `limited`.

    The offset V.xy · scale · (h − reference_height) is never longer than the height difference:
    less distortion, and little depth at grazing angles.
    Cost: one read.

    References
    ----------
    T. Welsh, Parallax Mapping with Offset Limiting: A Per-Pixel Approximation of Uneven Surfaces,
    2004.
    """
    return shifted(field, ray, settings)


@shader
def shifted(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """One read and one shift, each component clamped to ± `max_offset`, along v times
    `max_offset_ratio`."""
    start = t_at(ray, ray.reference_height)
    height = height_under(field, ray, start)
    end = t_at(ray, height)
    limit = Vec2(1.0, settings.max_offset_ratio) * settings.max_offset
    uv = at(ray, start) + minimum(maximum(ray.travel * (end - start), -limit), limit)
    return Hit(uv, height, end, True, 1)
