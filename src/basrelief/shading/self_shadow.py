"""Self-shadow: the visibility of a light through the height field, by a ray towards the light.

The ray starts at the hit of the view ray and rises to the top of the relief. With h(t) the surface
height below it and r(t) its own height,

    hard:  0 if h(t) > r(t) + offset for any t, else 1
    soft:  ½ − (x √(1 − x²) + asin x) ÷ π,  x = max over t of δ(t) ÷ a, from −1 to 1

A soft shadow is that of a light of the angular radius a. A blocker's edge stands δ above the centre
of its disc, so the surface sees the part of the disc above that chord, from 1 at x = −1 to 0 at
x = 1. With the elevation e of the light, and C what the ray climbs, along the ray's length L

    L = D · C ÷ sin e,  δ(t) = (h(t) − r(t) − offset) · D · cos e ÷ (t · L)
                             = (h(t) − r(t) − offset) · sin e · cos e ÷ (t · C)

where D is the height range, which cancels. The ray goes on above the relief, at t > 1, until the
ray to the lower rim of the disc leaves it too. Only the blocker that covers most counts, as if its
edge were straight and level.

Most techniques march, with one step for each texel that the ray passes over. An exact technique
traces the ray of a hard shadow itself, from the top of the relief down to the hit.

S. Halliwell, Parallax Offset, 2014 (second march).
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    Texture,
    Vec2,
    asin,
    clamp,
    length,
    setting,
    shader,
    size,
    sqrt,
    struct,
    tan,
)
from basrelief.shading.variant import Variant
from basrelief.techniques.columns import MAX_COLUMNS, column_top, grid_line, next_column, t_exits
from basrelief.techniques.height import extent_of, height_under, ray_level, surface_height
from basrelief.techniques.ray import MIN_DROP, Ray, at, height_at
from basrelief.techniques.technique import Settings, displace

MAX_READS = 4096
"""Upper limit of the steps to one light, whatever the settings."""
POSITION_ERROR = 2.5e-7
"""The error of a position along a ray in float32, as a fraction of the largest one."""
PI = 3.14159265358979
MIN_LIGHT_ANGLE = 0.1
"""Lower limit of a light's angle in degrees."""
FAR_BELOW = 1e9
"""A height below every surface."""
MAX_END = 4.0
"""Upper limit of t for soft shadows, for lights at the horizon."""
MIN_T = 1e-6
"""Lower limit of t in divisions."""
HEIGHT_ERROR = 2e-6
"""The error of a height at a position without error."""


@struct
class Shadowing:
    """Settings of the self-shadow."""

    max_shadow_steps: int = setting(
        default=64,
        doc="limit of the steps to a light, one per texel",
        low=1,
        high=4096,
    )
    light_angle: float = setting(
        default=10.0,
        doc="angle that lights span in soft shadows, in degrees",
        low=0.1,
        high=90.0,
    )
    shadow_offset: float = setting(
        default=0.001,
        doc="height above the ray that casts no shadow yet",
        low=0.0,
        high=1.0,
    )


@struct
class LightVisibility:
    """The visibility of a light, 0 to 1, and the number of heights read for it."""

    visibility: float
    reads: int


@shader
def light_visibility(
    field: HeightField,
    baked: Texture,
    ray: Ray,
    settings: Settings,
    shadowing: Shadowing,
    variant: Variant,
) -> LightVisibility:
    """The visibility of a light along a ray that rises towards it, out of the relief."""
    if variant.exact_shadows:
        return exact_visibility(field, baked, ray, settings)
    if variant.columns:
        if variant.shadows == "hard":
            return hard_visibility_on_columns(field, ray, shadowing)
        return soft_visibility_on_columns(field, ray, shadowing)
    if variant.shadows == "hard":
        return hard_visibility(field, ray, shadowing)
    return soft_visibility(field, ray, shadowing)


# --- by a march ----------------------------------------------------------------------------------


@shader
def hard_visibility(field: HeightField, ray: Ray, shadowing: Shadowing) -> LightVisibility:
    """0 if the surface is above the ray at any step, else 1."""
    count = shadow_step_count(field, ray, 1.0, shadowing)
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
    """The part of a light's disc above the blocker that covers most of it."""
    end = rim_end(ray, shadowing)
    count = shadow_step_count(field, ray, end, shadowing)
    step = end / float(count)
    angle = angle_per_height(ray, shadowing)
    edge = -1.0
    for k in range(count):
        t = (float(k) + 1.0) * step
        above = height_under(field, ray, t) - height_at(ray, t) - shadowing.shadow_offset
        edge = max(edge, above * angle / t)
    return LightVisibility(part_above(edge), count)


@shader
def angle_per_height(ray: Ray, shadowing: Shadowing) -> float:
    """The angle that a height above the ray covers at t = 1, in radii of the light's disc."""
    sine = ray.cosine
    cosine = sqrt(max(1.0 - sine * sine, 0.0))
    return sine * cosine / (max(-ray.drop, MIN_DROP) * disc_radius(shadowing))


@shader
def disc_radius(shadowing: Shadowing) -> float:
    """The angular radius of a light's disc, in radians."""
    return max(shadowing.light_angle, MIN_LIGHT_ANGLE) * (PI / 360.0)


@shader
def rim_end(ray: Ray, shadowing: Shadowing) -> float:
    """The t at which the ray to the lower rim of a light's disc leaves the relief.

    tan e ÷ tan(e − a) = (1 + T A) ÷ (1 − A ÷ T),  T = tan e, A = tan a
    """
    sine = ray.cosine
    slope = sine / max(sqrt(max(1.0 - sine * sine, 0.0)), 1e-6)
    rim = tan(disc_radius(shadowing))
    return min((1.0 + slope * rim) / max(1.0 - rim / slope, 1e-6), MAX_END)


@shader
def part_above(edge: float) -> float:
    """The part of a disc above a chord; `edge` is the chord's distance from the centre in radii."""
    x = clamp(edge, -1.0, 1.0)
    return 0.5 - (x * sqrt(1.0 - x * x) + asin(x)) * (1.0 / PI)


@shader
def shadow_step_count(field: HeightField, ray: Ray, end: float, shadowing: Shadowing) -> int:
    """One step for each texel that the ray passes over until t = `end`, within the limits."""
    texels = length(ray.travel * extent_of(field, ray_level(field, ray))) * end
    most = min(max(shadowing.max_shadow_steps, 1), MAX_READS)
    return int(min(texels, float(most - 1))) + 1


# --- by an exact technique -----------------------------------------------------------------------


@shader
def exact_visibility(
    field: HeightField, baked: Texture, ray: Ray, settings: Settings
) -> LightVisibility:
    """0 if anything is in the way, else 1, by the technique's hit of the reversed ray."""
    hit = displace(field, baked, reversed_ray(ray, end_error(field, ray)), settings)
    return LightVisibility(0.0 if hit.found else 1.0, hit.reads + 4)


@shader
def reversed_ray(ray: Ray, lift: float) -> Ray:
    """The ray from the light down to the start of a rising ray, or `lift` above it."""
    end = ray.height + lift
    # from a start at height 1 it stays above: at height 1 it would touch the ground that it leaves
    top = max(end, 1.0)
    return Ray(
        uv=at(ray, 1.0),
        travel=-ray.travel,
        height=top,
        drop=top - end,
        cosine=ray.cosine,
        scale=ray.scale,
        lod=ray.lod,
        fade=ray.fade,
    )


@shader
def end_error(field: HeightField, ray: Ray) -> float:
    """The height by which rounding may put the end of the reversed ray below the surface.

    The end lies in a small rectangle around the start of `ray`; the surface is highest in one of
    its corners.
    """
    far = at(ray, 1.0)
    u = POSITION_ERROR * max(abs(ray.uv.x), abs(far.x))
    v = POSITION_ERROR * max(abs(ray.uv.y), abs(far.y))
    left = max(
        surface_height(field, ray.uv + Vec2(-u, -v), ray.lod, ray.fade),
        surface_height(field, ray.uv + Vec2(-u, v), ray.lod, ray.fade),
    )
    right = max(
        surface_height(field, ray.uv + Vec2(u, -v), ray.lod, ray.fade),
        surface_height(field, ray.uv + Vec2(u, v), ray.lod, ray.fade),
    )
    return max(max(left, right) - ray.height, 0.0) + HEIGHT_ERROR


# --- on columns -----------------------------------------------------------------------------------


@struct
class Blocker:
    """The highest blocker of a ray: its height above the ray ÷ t, and the count of heights read."""

    above: float
    reads: int


@shader
def hard_visibility_on_columns(
    field: HeightField, ray: Ray, shadowing: Shadowing
) -> LightVisibility:
    """0 if any column is above the ray, else 1: exact, whatever the number of steps."""
    blocker = highest_blocker(field, ray, shadowing.shadow_offset, 1.0, 0.0)
    return LightVisibility(1.0 if blocker.above <= 0.0 else 0.0, blocker.reads)


@shader
def soft_visibility_on_columns(
    field: HeightField, ray: Ray, shadowing: Shadowing
) -> LightVisibility:
    """The part of a light's disc above the column that covers most of it."""
    angle = angle_per_height(ray, shadowing)
    end = rim_end(ray, shadowing)
    blocker = highest_blocker(field, ray, shadowing.shadow_offset, end, 1.0 / max(angle, 1e-9))
    return LightVisibility(part_above(blocker.above * angle), blocker.reads)


@shader
def highest_blocker(
    field: HeightField, ray: Ray, offset: float, end: float, limit: float
) -> Blocker:
    """The column that is highest above the ray where the ray enters it, by height ÷ t, until `end`.

    The column in which the ray starts does not count. The search ends once `limit` is exceeded.
    """
    extent = size(field, 0)
    line = grid_line(extent, ray.uv, ray.travel)
    column = line.first
    highest = -FAR_BELOW
    reads = 0
    t = 0.0
    while reads < MAX_COLUMNS and t < end and highest <= limit:
        exits = t_exits(line, column)
        t = max(min(exits.x, exits.y), t)
        column = next_column(line, column, exits)
        if t < end:
            above = column_top(field, extent, column) - height_at(ray, t) - offset
            highest = max(highest, above / max(t, MIN_T))
        reads = reads + 1
    return Blocker(highest, reads)
