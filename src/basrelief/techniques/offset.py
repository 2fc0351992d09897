"""The techniques of one read: shift the texture by the height found where the ray comes in."""

from __future__ import annotations

from basrelief.lang import HeightField, clamp, setting, shader, struct
from basrelief.techniques.height import height_under
from basrelief.techniques.ray import Hit, Ray, at, hit_at, t_at
from basrelief.techniques.technique import Nothing, technique


@struct
class Offset:
    """Settings of the techniques of one read."""

    max_offset: float = setting(
        default=1.0, doc="the most that u and v each move, in tiles", low=0.0, high=1.0
    )


@technique()
def flat(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """No parallax at all. Cost: nothing."""
    return hit_at(ray, t_at(ray, ray.reference_height), True, 0)


@technique(reference_height=0.5, most_reads=1)
def offset(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """Take the height where the ray comes in for that where it ends.

    Right where the height does not change between the two, torn apart where it does. Cost: one
    read. T. Kaneko et al., Detailed Shape Representation with Parallax Mapping, 2001; with the
    projection `biased`, what Unity's standard shader does; the clamp is wikibooks'.
    """
    return shifted(field, ray, settings)


@technique(reference_height=0.5, projection="limited", most_reads=1)
def offset_limited(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """The same, the offset never longer than the height: no tearing, little depth at an angle.

    Cost: one read. T. Welsh, Parallax Mapping with Offset Limiting: A Per-Pixel Approximation of
    Uneven Surfaces, 2004.
    """
    return shifted(field, ray, settings)


@shader
def shifted(field: HeightField, ray: Ray, settings: Offset) -> Hit:
    """One read, one shift, each component held to the most allowed."""
    start = t_at(ray, ray.reference_height)
    height = height_under(field, ray, start)
    end = t_at(ray, height)
    most = settings.max_offset
    uv = at(ray, start) + clamp(ray.travel * (end - start), -most, most)
    return Hit(uv, height, end, True, 1)
