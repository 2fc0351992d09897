"""The marches: read along the ray, layer by layer, until the surface is above it.

A march of N steps reads at t = 0, 1/N, … (N − 1)/N. Features thinner than a step can be missed;
where nothing is met the last position is the result. A ray that is only a part of the whole way
takes its share of the steps; one that ends above the base is read at its end too, from where the
next part goes on.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    Vec2,
    floor,
    length,
    mix,
    saturate,
    setting,
    shader,
    size,
    struct,
)
from basrelief.techniques.height import height_under
from basrelief.techniques.projection import SHALLOWEST
from basrelief.techniques.ray import Hit, Ray, height_at, hit_at
from basrelief.techniques.technique import technique

MOST_READS = 4096
"""However the number of steps comes about, no ray takes more."""


@struct
class Steps:
    """Settings of a march with a fixed number of steps."""

    steps: int = setting(
        default=10, doc="layers that the range of heights is cut into", low=1, high=4096
    )


@struct
class March:
    """Settings of a march whose steps follow the angle, or the texels passed over."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(
        default=32, doc="steps when looking along the surface", low=1, high=4096
    )
    steps_per_texel: float = setting(
        default=0.0,
        doc="steps for each texel passed over, instead of by angle; 0: by angle",
        low=0.0,
        high=8.0,
    )


@struct
class Relief:
    """Settings of a march followed by a binary search."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(
        default=32, doc="steps when looking along the surface", low=1, high=4096
    )
    search_steps: int = setting(default=5, doc="halvings of the last step", low=0, high=24)


@struct
class FixedLength:
    """Settings of a march whose steps are all of one length."""

    steps: int = setting(default=300, doc="steps at most", low=1, high=4096)
    step_length: float = setting(
        default=0.01, doc="length of a step along the ray, in tile widths", low=1e-5, high=1.0
    )


@struct
class Layers:
    """Where a march stopped: `t`, how far the ray is `over` the surface there, and both one layer
    before."""

    t: float
    over: float
    t_before: float
    over_before: float
    step: float
    reads: int


@technique(most_reads=10)
def steep(field: HeightField, ray: Ray, settings: Steps) -> Hit:
    """March to the first layer that is below the surface, and stay there: visible layers.

    Cost: up to `steps` reads. M. McGuire and M. McGuire, Steep Parallax Mapping, 2005.
    """
    end = march(field, ray, share_of(ray, settings.steps))
    return hit_at(ray, end.t, end.over <= 0.0, end.reads)


@technique(most_reads=32)
def parallax_occlusion(field: HeightField, ray: Ray, settings: March) -> Hit:
    """March to the first layer below the surface, then cut the last step with the surface chord.

    Cost: up to the number of steps in reads. Z. Brawley and N. Tatarchuk, Parallax Occlusion
    Mapping: Self-Shadowing, Perspective-Correct Bump Mapping Using Reverse Height Map Tracing,
    2004.
    """
    end = march(field, ray, step_count(field, ray, settings))
    found = end.over <= 0.0
    return hit_at(ray, chord(end) if found else end.t, found, end.reads)


@technique(most_reads=37)
def relief(field: HeightField, ray: Ray, settings: Relief) -> Hit:
    """March to the first layer below the surface, then halve the last step again and again.

    Cost: the march's reads and one for each halving. F. Policarpo, M. M. Oliveira and J. L. D.
    Comba, Real-Time Relief Mapping on Arbitrary Polygonal Surfaces, 2005.
    """
    steps = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    end = march(field, ray, steps)
    found = end.over <= 0.0
    # there is a step to halve only between a layer above the surface and one below
    rounds = settings.search_steps if found and end.reads > 1 else 0
    t = end.t
    below = True
    half = end.step
    for _ in range(rounds):
        half = half * 0.5
        t = t + (-half if below else half)
        below = height_at(ray, t) <= height_under(field, ray, t)
    return hit_at(ray, t, found, end.reads + rounds)


@technique(most_reads=300)
def fixed_length(field: HeightField, ray: Ray, settings: FixedLength) -> Hit:
    """March in steps of one length along the ray, then weigh the last two places.

    Goes as deep as its steps reach, on each part of a way: what lies further is not found, and the
    last place stays.
    Cost: up to `steps` reads. Habrador, Advanced shaders in Unity: 3. Parallax mapping.
    """
    # the whole way is scale ÷ cosine tile widths long
    step = settings.step_length * max(ray.cosine, SHALLOWEST) / (ray.scale * ray.share)
    end = layers(field, ray, min(settings.steps, int(1.0 / step) + 2), step)
    found = end.over <= 0.0
    return hit_at(ray, chord(end) if found else end.t, found, end.reads)


# --- what the marches share ----------------------------------------------------------------------


@shader
def march(field: HeightField, ray: Ray, steps: int) -> Layers:
    """Go along all of the ray in a number of steps."""
    return layers(field, ray, steps, 1.0 / float(min(max(steps, 1), MOST_READS)))


@shader
def layers(field: HeightField, ray: Ray, steps: int, step: float) -> Layers:
    """Go on layer by layer, to the first that is not above the surface, or to the last."""
    count = min(max(steps, 1), MOST_READS)
    # a ray that comes down to the base needs no look there; no other is left before its end
    goes_on = height_at(ray, 1.0) > 0.0
    last = count + 1 if goes_on else count
    furthest = 1.0 if goes_on else 1.0 + step
    t = 0.0
    over = ray.height - height_under(field, ray, t)
    t_before = t
    over_before = over
    k = 1
    while k < last and over > 0.0:
        t_before = t
        over_before = over
        t = min(float(k) * step, furthest)
        over = height_at(ray, t) - height_under(field, ray, t)
        k = k + 1
    return Layers(t, over, t_before, over_before, step, k)


@shader
def chord(end: Layers) -> float:
    """The t at which the ray cuts the straight line between the last two surface points."""
    return crossing(end.t_before, end.over_before, end.t, -end.over)


@shader
def crossing(above: float, over: float, below: float, under: float) -> float:
    """The t at which the ray meets the surface that it is `over` at t = `above` and `under` at
    t = `below`, if both run straight."""
    share = saturate(over / max(over + under, 1e-9))
    return mix(above, below, share)


@shader
def share_of(ray: Ray, steps: int) -> int:
    """A ray's own share of the steps of the whole way, at least one."""
    return max(-int(floor(-float(min(steps, MOST_READS)) * ray.share)), 1)


@shader
def steps_by_angle(ray: Ray, min_steps: int, max_steps: int) -> int:
    """A ray's own share of the steps by angle."""
    return share_of(ray, step_count_by_angle(ray, min_steps, max_steps))


@shader
def step_count_by_angle(ray: Ray, min_steps: int, max_steps: int) -> int:
    """More steps the flatter the view: from the most along the surface to the least head-on.

    N. Tatarchuk, Practical Parallax Occlusion Mapping for Highly Detailed Surface Rendering, 2006.
    """
    return int(mix(float(max_steps), float(min_steps), saturate(ray.cosine)) + 0.5)


@shader
def step_count(field: HeightField, ray: Ray, settings: March) -> int:
    """The number of steps by angle, or by the texels that the ray passes over."""
    extent = size(field, 0)
    travel = length(ray.travel * Vec2(float(extent.x), float(extent.y)))
    by_texels = int(travel * settings.steps_per_texel)
    # a choice, not a branch: on a GPU the branch costs up to 8 % of a march
    by_angle = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    return by_texels if settings.steps_per_texel > 0.0 else by_angle
