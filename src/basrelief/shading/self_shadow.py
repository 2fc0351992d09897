"""Self-shadow: from where the view ray ended, on towards a light, through the same height field.

S. Halliwell's second march; N. Tatarchuk, Practical Parallax Occlusion Mapping for Highly Detailed
Surface Rendering, 2006, for the soft form.
"""

from __future__ import annotations

from basrelief.lang import HeightField, saturate, setting, shader, size, struct
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import MAX_COLUMNS, leaving, line_over, next_column, top_of
from basrelief.techniques.height import height_under
from basrelief.techniques.ray import Ray, height_at

MOST_READS = 4096
"""However many steps are asked for, no light takes more."""


@struct
class Shadowing:
    """The numbers of the self-shadow."""

    shadow_steps: int = setting(
        default=16, doc="heights read on the way to each light", low=1, high=4096
    )
    shadow_softness: float = setting(
        default=8.0,
        doc="how dark what stands above the ray makes it",
        low=0.0,
        high=64.0,
    )
    shadow_offset: float = setting(
        default=0.02, doc="heights this close to the ray cast no shadow", low=0.0, high=1.0
    )


@struct
class Reaching:
    """How much of a light reaches a point, 0 to 1, and how many heights were read to know."""

    share: float
    reads: int


@shader
def shadow(field: HeightField, ray: Ray, shadowing: Shadowing, variant: Variant) -> Reaching:
    """How much of a light reaches the start of a ray that rises to the light, out of the relief."""
    if variant.columns:
        if variant.shadows == "hard":
            return hard_on_columns(field, ray, shadowing)
        return soft_on_columns(field, ray, shadowing)
    if variant.shadows == "hard":
        return hard(field, ray, shadowing)
    return soft(field, ray, shadowing)


@shader
def hard(field: HeightField, ray: Ray, shadowing: Shadowing) -> Reaching:
    """All of it, or none once anything stands above the ray."""
    count = min(max(shadowing.shadow_steps, 1), MOST_READS)
    step = 1.0 / float(count)
    reads = 0
    for k in range(count):
        t = (float(k) + 1.0) * step
        reads = reads + 1
        if height_under(field, ray, t) > height_at(ray, t) + shadowing.shadow_offset:
            return Reaching(0.0, reads)
    return Reaching(1.0, reads)


@shader
def soft(field: HeightField, ray: Ray, shadowing: Shadowing) -> Reaching:
    """Less the more stands above the ray, what is near counting most."""
    count = min(max(shadowing.shadow_steps, 1), MOST_READS)
    step = 1.0 / float(count)
    darkest = 0.0
    for k in range(count):
        t = (float(k) + 1.0) * step
        above = height_under(field, ray, t) - height_at(ray, t) - shadowing.shadow_offset
        darkest = max(darkest, above * (1.0 - t))
    return Reaching(1.0 - saturate(darkest * shadowing.shadow_softness), count)


# --- where texels are boxes -----------------------------------------------------------------------


@shader
def hard_on_columns(field: HeightField, ray: Ray, shadowing: Shadowing) -> Reaching:
    """All of it, or none once a box stands above the ray: exact, however many steps are asked."""
    most = highest_column_above(field, ray, shadowing.shadow_offset, 0.0)
    return Reaching(1.0 if most.share <= 0.0 else 0.0, most.reads)


@shader
def soft_on_columns(field: HeightField, ray: Ray, shadowing: Shadowing) -> Reaching:
    """Less the more of a box stands above the ray, what is near counting most."""
    softness = shadowing.shadow_softness
    most = highest_column_above(field, ray, shadowing.shadow_offset, 1.0 / max(softness, 1e-6))
    return Reaching(1.0 - saturate(most.share * softness), most.reads)


@shader
def highest_column_above(field: HeightField, ray: Ray, offset: float, enough: float) -> Reaching:
    """How far boxes stand above the ray where it comes to them, the most of it, and the reads.

    The box that the ray leaves does not count, and the walk ends once it is more than `enough`.
    """
    extent = size(field, 0)
    line = line_over(extent, ray.uv, ray.travel)
    cell = line.cell
    most = 0.0
    reads = 0
    t = 0.0
    while reads < MAX_COLUMNS and t < 1.0 and most <= enough:
        leave = leaving(line, cell)
        t = max(min(leave.x, leave.y), t)
        cell = next_column(line, cell, leave)
        above = top_of(field, extent, cell) - height_at(ray, t) - offset
        most = max(most, above * max(1.0 - t, 0.0))
        reads = reads + 1
    return Reaching(most, reads)
