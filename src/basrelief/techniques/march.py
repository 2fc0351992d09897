r"""Marches: read the height field along the ray, layer by layer, until the surface is above it.

    height
      1  o . . . . . . . . . . . .  t = 0
           \              ____
         . . o . . . . ./. . .\. .  t = 1/N
               \       /
         . . . . o . ./. . . . . .  t = 2/N, the last layer above the surface
                   \ /
         . . . . . ./o . . . . . .  t = 3/N, the first layer below it, ends the march
                  /

A march of N steps reads the surface at t = 0, 1/N, … (N − 1)/N and ends at the first layer at which
the ray is not above it. The hit lies between this layer and the one before. `steep` takes the layer
itself, `parallax_occlusion` intersects the chord, `relief` searches by halving; `secant` and
`contact` (`refine.py`) search by chords and by finer layers.

No surface is lower than the base at height 0. So a ray that ends there and has hit nothing by its
last layer has its hit in one more step, from height 1/N to 0. `parallax_occlusion` and `contact`
read at its end. `relief` and `secant` search in it without that read. `steep` ends at the last
layer, without a hit.

Features thinner than a step can be missed. A segment that is a `share` of the whole ray takes that
share of the steps; one that ends above the base is read at its end too, from where the next segment
continues.
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
from basrelief.techniques.projection import MIN_COSINE
from basrelief.techniques.ray import Hit, Ray, height_at, hit_at
from basrelief.techniques.technique import technique

MAX_READS = 4096
"""Upper limit of a ray's steps, whatever the settings."""


@struct
class Steps:
    """Settings of a march with a fixed number of steps."""

    steps: int = setting(default=10, doc="number of layers", low=1, high=4096)


@struct
class March:
    """Settings of a march whose steps depend on the angle or on the texels passed over."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(default=32, doc="steps at a grazing view", low=1, high=4096)
    steps_per_texel: float = setting(
        default=0.0,
        doc="steps per texel that the ray passes over; 0 chooses steps by angle",
        low=0.0,
        high=8.0,
    )


@struct
class Relief:
    """Settings of a march followed by a binary search."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(default=32, doc="steps at a grazing view", low=1, high=4096)
    search_steps: int = setting(
        default=5, doc="binary search steps in the last step", low=0, high=24
    )


@struct
class FixedLength:
    """Settings of a march with steps of constant length."""

    steps: int = setting(default=300, doc="maximum number of steps", low=1, high=4096)
    step_length: float = setting(
        default=0.01,
        doc="length of a step along the ray, in tile widths",
        low=1e-5,
        high=1.0,
        in_tiles=True,
    )


@struct
class LastStep:
    """The last step of a march: t and the ray's height above the surface at its end and at its
    start (`previous_`), the step's length in t, and the number of heights read."""

    t: float
    above: float
    previous_t: float
    previous_above: float
    step: float
    reads: int


@technique(most_reads=10)
def steep(field: HeightField, ray: Ray, settings: Steps) -> Hit:
    """Steep parallax mapping: the first layer below the surface.

        t = k/N, k the least with height_at(k/N) ≤ surface(k/N)

    Layers are visible as steps. A surface lower than the last layer is not hit: the ray ends there.
    Cost: up to `steps` reads.

    References
    ----------
    M. McGuire and M. McGuire, Steep Parallax Mapping, 2005.
    """
    end = march(field, ray, step_share(ray, settings.steps))
    return hit_at(ray, end.t, end.above <= 0.0, end.reads)


@technique(most_reads=33)
def parallax_occlusion(field: HeightField, ray: Ray, settings: March) -> Hit:
    """Parallax occlusion mapping: a march, then the intersection with the chord of its last step.

        t = t₁ + (t₂ − t₁) · a₁ ÷ (a₁ − a₂),  a the ray's height above the surface at t₁ and t₂

    Cost: as many reads as steps, and one more where the ray ends at the base.

    References
    ----------
    Z. Brawley and N. Tatarchuk, Parallax Occlusion Mapping: Self-Shadowing, Perspective-Correct
    Bump Mapping Using Reverse Height Map Tracing, 2004.
    """
    end = march_to_end(field, ray, step_count(field, ray, settings))
    found = end.above <= 0.0
    return hit_at(ray, chord(end) if found else end.t, found, end.reads)


@technique(most_reads=37)
def relief(field: HeightField, ray: Ray, settings: Relief) -> Hit:
    """Relief mapping: a march, then a binary search in its last step.

        t ← t − δ if the ray is below the surface at t, else t + δ;  δ = 1/2, 1/4, … of the step

    Cost: one read for each step and each halving.

    References
    ----------
    F. Policarpo, M. M. Oliveira and J. L. D. Comba, Real-Time Relief Mapping on Arbitrary Polygonal
    Surfaces, 2005.
    """
    steps = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    end = last_step_to_base(ray, march(field, ray, steps))
    found = end.above <= 0.0
    rounds = search_rounds(end, settings.search_steps)
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
    """March in steps of constant length, then the intersection with the chord of the last step.

        step in t = step_length ÷ (length of the ray) = step_length · cosine ÷ (scale · share)

    The march reaches `steps · step_length` and no further: a surface beyond that is not found, and
    the last position is the result.
    Cost: up to `steps` reads.

    References
    ----------
    Habrador, Advanced shaders in Unity: 3. Parallax mapping.
    """
    # the whole ray is scale ÷ cosine tile widths long
    step = settings.step_length * max(ray.cosine, MIN_COSINE) / (ray.scale * ray.share)
    # the first step that ends behind the segment: at its end, or below the base at full length
    count = int(min(1.0 / step, float(MAX_READS))) + 1
    t_end = 1.0 if continues(ray) else float(count) * step
    end = layers(field, ray, min(max(settings.steps, 1), count + 1), step, count, t_end)
    found = end.above <= 0.0
    return hit_at(ray, chord(end) if found else end.t, found, end.reads)


# --- parts of the marches ------------------------------------------------------------------------


@shader
def continues(ray: Ray) -> bool:
    """Whether the segment ends above the base at height 0, so that the ray goes on past it."""
    return height_at(ray, 1.0) > 0.0


@shader
def march(field: HeightField, ray: Ray, steps: int) -> LastStep:
    """March in equal steps to the last layer above the base, or to the end of a segment that ends
    above it."""
    count = min(max(steps, 1), MAX_READS)
    reads = count + 1 if continues(ray) else count
    return layers(field, ray, reads, 1.0 / float(count), count, 1.0)


@shader
def march_to_end(field: HeightField, ray: Ray, steps: int) -> LastStep:
    """March in equal steps to the end of the segment, where a ray that ends at the base hits."""
    count = min(max(steps, 1), MAX_READS)
    return layers(field, ray, count + 1, 1.0 / float(count), count, 1.0)


@shader
def layers(
    field: HeightField, ray: Ray, reads: int, step: float, count: int, t_end: float
) -> LastStep:
    """March layer by layer to the first at which the ray is not above the surface, with at most
    `reads` reads; layer `count` is at `t_end`."""
    t = 0.0
    above = ray.height - height_under(field, ray, t)
    previous_t = t
    previous_above = above
    k = 1
    while k < reads and above > 0.0:
        previous_t = t
        previous_above = above
        # not k · step, which rounding may put before the end
        t = t_end if k == count else float(k) * step
        above = height_at(ray, t) - height_under(field, ray, t)
        k = k + 1
    return LastStep(t, above, previous_t, previous_above, step, k)


@shader
def last_step_to_base(ray: Ray, end: LastStep) -> LastStep:
    """The last step of a march; after a march without a hit, the step from its last layer to the
    base, if the ray ends there.

    `above` is 0 at the base, which is not read: the surface is there or higher.
    """
    if end.above <= 0.0 or continues(ray):
        return end
    return LastStep(1.0, 0.0, end.t, end.above, end.step, end.reads)


@shader
def search_rounds(end: LastStep, search_steps: int) -> int:
    """The number of search steps: none without a hit, nor for one at the first layer, which has no
    layer above the surface before it."""
    return search_steps if end.above <= 0.0 and end.t > 0.0 else 0


@shader
def chord(end: LastStep) -> float:
    """The t at which the ray intersects the chord of the surface over the last step."""
    return crossing(end.previous_t, end.previous_above, end.t, -end.above)


@shader
def crossing(t_above: float, above: float, t_below: float, below: float) -> float:
    """The zero of the straight line through `above` at `t_above` and −`below` at `t_below`."""
    fraction = saturate(above / max(above + below, 1e-9))
    return mix(t_above, t_below, fraction)


@shader
def step_share(ray: Ray, steps: int) -> int:
    """The segment's share of the whole ray's steps, rounded up, at least one."""
    return max(-int(floor(-float(min(steps, MAX_READS)) * ray.share)), 1)


@shader
def steps_by_angle(ray: Ray, min_steps: int, max_steps: int) -> int:
    """The segment's share of the steps by angle."""
    return step_share(ray, step_count_by_angle(ray, min_steps, max_steps))


@shader
def step_count_by_angle(ray: Ray, min_steps: int, max_steps: int) -> int:
    """max_steps + (min_steps − max_steps) · V · N, truncated: more steps at flatter angles.

    N. Tatarchuk, Practical Parallax Occlusion Mapping for Highly Detailed Surface Rendering, 2006.
    """
    # unlike `mix` exact for min_steps = max_steps, which it might truncate to one less
    return int(float(max_steps) + float(min_steps - max_steps) * saturate(ray.cosine))


@shader
def step_count(field: HeightField, ray: Ray, settings: March) -> int:
    """The number of steps by angle, or by the texels that the ray passes over."""
    extent = size(field, 0)
    travel = length(ray.travel * Vec2(float(extent.x), float(extent.y)))
    by_texels = int(travel * settings.steps_per_texel)
    # a selection, not a branch: on a GPU the branch costs up to 8 % of a march
    by_angle = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    return by_texels if settings.steps_per_texel > 0.0 else by_angle
