"""Self-shadow: the visibility of a light through the height field, by a march towards the light.

The ray starts at the hit of the view ray and rises to the top of the relief. With h(t) the surface
height below it and r(t) its own height,

    hard:  0 if h(t) > r(t) + offset for any t, else 1
    soft:  1 − softness · max over t of (h(t) − r(t) − offset) · (1 − t)

The factor 1 − t weights near blockers more: their shadow edges are sharper.

S. Halliwell, Parallax Offset, 2014 (second march); N. Tatarchuk, Practical Parallax Occlusion
Mapping for Highly Detailed Surface Rendering, 2006 (soft form).
"""

from __future__ import annotations

from basrelief.lang import HeightField, saturate, setting, shader, size, struct
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import MAX_COLUMNS, column_top, grid_line, next_column, t_exits
from basrelief.techniques.height import height_under
from basrelief.techniques.ray import Ray, height_at

MAX_READS = 4096
"""Upper limit of the steps to one light, whatever the settings."""


@struct
class Shadowing:
    """Settings of the self-shadow."""

    shadow_steps: int = setting(default=16, doc="steps towards each light", low=1, high=4096)
    shadow_softness: float = setting(
        default=8.0,
        doc="darkness of soft shadows per height above the ray",
        low=0.0,
        high=64.0,
    )
    shadow_offset: float = setting(
        default=0.02, doc="height above the ray that casts no shadow yet", low=0.0, high=1.0
    )


@struct
class LightVisibility:
    """The visibility of a light, 0 to 1, and the number of heights read for it."""

    visibility: float
    reads: int


@shader
def light_visibility(
    field: HeightField, ray: Ray, shadowing: Shadowing, variant: Variant
) -> LightVisibility:
    """The visibility of a light along a ray that rises towards it, out of the relief."""
    if variant.columns:
        if variant.shadows == "hard":
            return hard_visibility_on_columns(field, ray, shadowing)
        return soft_visibility_on_columns(field, ray, shadowing)
    if variant.shadows == "hard":
        return hard_visibility(field, ray, shadowing)
    return soft_visibility(field, ray, shadowing)


@shader
def hard_visibility(field: HeightField, ray: Ray, shadowing: Shadowing) -> LightVisibility:
    """0 if the surface is above the ray at any step, else 1."""
    count = min(max(shadowing.shadow_steps, 1), MAX_READS)
    step = 1.0 / float(count)
    reads = 0
    for k in range(count):
        t = (float(k) + 1.0) * step
        reads = reads + 1
        if height_under(field, ray, t) > height_at(ray, t) + shadowing.shadow_offset:
            return LightVisibility(0.0, reads)
    return LightVisibility(1.0, reads)


@shader
def soft_visibility(field: HeightField, ray: Ray, shadowing: Shadowing) -> LightVisibility:
    """Less the higher a blocker stands above the ray, weighted by its nearness."""
    count = min(max(shadowing.shadow_steps, 1), MAX_READS)
    step = 1.0 / float(count)
    occlusion = 0.0
    for k in range(count):
        t = (float(k) + 1.0) * step
        above = height_under(field, ray, t) - height_at(ray, t) - shadowing.shadow_offset
        occlusion = max(occlusion, above * (1.0 - t))
    return LightVisibility(1.0 - saturate(occlusion * shadowing.shadow_softness), count)


# --- on columns -----------------------------------------------------------------------------------


@struct
class Blocker:
    """The highest blocker of a ray: its weighted height above the ray, 0 without a blocker, and the
    number of heights read."""

    above: float
    reads: int


@shader
def hard_visibility_on_columns(
    field: HeightField, ray: Ray, shadowing: Shadowing
) -> LightVisibility:
    """0 if any column is above the ray, else 1: exact, whatever the number of steps."""
    blocker = highest_blocker(field, ray, shadowing.shadow_offset, 0.0)
    return LightVisibility(1.0 if blocker.above <= 0.0 else 0.0, blocker.reads)


@shader
def soft_visibility_on_columns(
    field: HeightField, ray: Ray, shadowing: Shadowing
) -> LightVisibility:
    """Less the higher a column stands above the ray, weighted by its nearness."""
    softness = shadowing.shadow_softness
    blocker = highest_blocker(field, ray, shadowing.shadow_offset, 1.0 / max(softness, 1e-6))
    return LightVisibility(1.0 - saturate(blocker.above * softness), blocker.reads)


@shader
def highest_blocker(field: HeightField, ray: Ray, offset: float, limit: float) -> Blocker:
    """The largest weighted height of a column above the ray where the ray enters the column.

    The column in which the ray starts does not count. The search ends once `limit` is exceeded.
    """
    extent = size(field, 0)
    line = grid_line(extent, ray.uv, ray.travel)
    column = line.first
    highest = 0.0
    reads = 0
    t = 0.0
    while reads < MAX_COLUMNS and t < 1.0 and highest <= limit:
        exits = t_exits(line, column)
        t = max(min(exits.x, exits.y), t)
        column = next_column(line, column, exits)
        above = column_top(field, extent, column) - height_at(ray, t) - offset
        highest = max(highest, above * max(1.0 - t, 0.0))
        reads = reads + 1
    return Blocker(highest, reads)
