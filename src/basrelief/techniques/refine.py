"""Marches with a second search within their last step, between a layer above the surface and one
below it.

`relief`, whose search halves that step, is with the plain marches in `march.py`.
"""

from __future__ import annotations

from basrelief.lang import HeightField, setting, struct
from basrelief.techniques.height import height_under
from basrelief.techniques.march import (
    MAX_READS,
    crossing,
    last_step_to_base,
    march,
    march_to_end,
    search_rounds,
    step_count_by_angle,
    step_share,
    steps_by_angle,
)
from basrelief.techniques.ray import Hit, Ray, height_at, hit_at
from basrelief.techniques.technique import technique


@struct
class Secant:
    """Settings of a march followed by regula falsi."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(default=32, doc="steps at a grazing view", low=1, high=4096)
    search_steps: int = setting(
        default=3, doc="secant search steps in the last step", low=0, high=24
    )


@struct
class Contact:
    """Settings of a march with a second, finer march in its last step."""

    min_steps: int = setting(
        default=4, doc="steps of each march when looking straight down", low=1, high=4096
    )
    max_steps: int = setting(
        default=16, doc="steps of each march at a grazing view", low=1, high=4096
    )


@technique(most_reads=35)
def secant(field: HeightField, ray: Ray, settings: Secant) -> Hit:
    """A march, then a secant search (regula falsi) in its last step.

        t = t₁ + (t₂ − t₁) · a₁ ÷ (a₁ − a₂),  a₁ > 0 ≥ a₂ the ray's heights above the surface

    The surface is read at t, and t replaces t₁ or t₂, whichever has the same sign; then again. The
    height of an end that stays twice in a row is halved ("Illinois"); otherwise that end would stay
    for ever and the other approach in ever smaller steps. A last step that ends at the base, which
    is not read, is first cut there: a₂ = 0.
    Cost: one read for each step and each cut.

    References
    ----------
    E. Risser, M. Shah and S. Pattanaik, Faster Relief Mapping Using the Secant Method, 2007.
    M. Dowell and P. Jarratt, A Modified Regula Falsi Method for Computing the Root of an Equation,
    1971.
    """
    steps = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    end = last_step_to_base(ray, march(field, ray, steps))
    found = end.above <= 0.0
    rounds = search_rounds(end, settings.search_steps)
    t_above = end.previous_t
    above = end.previous_above
    t_below = end.t
    below = -end.above
    # which end was replaced last: 1 the upper, −1 the lower
    replaced = 0
    for _ in range(rounds):
        t = crossing(t_above, above, t_below, below)
        clearance = height_at(ray, t) - height_under(field, ray, t)
        if clearance > 0.0:
            t_above = t
            above = clearance
            below = below * (0.5 if replaced == 1 else 1.0)
            replaced = 1
        else:
            t_below = t
            below = -clearance
            above = above * (0.5 if replaced == -1 else 1.0)
            replaced = -1
    t = crossing(t_above, above, t_below, below) if found else end.t
    return hit_at(ray, t, found, end.reads + rounds)


@technique(most_reads=32)
def contact(field: HeightField, ray: Ray, settings: Contact) -> Hit:
    """Contact refinement: a coarse march, then a march of as many steps within its last step.

        t = t₁ + j ÷ N · step,  t₁ the layer before the last, j the least with the ray below

    2 N reads resolve what N² layers would. A feature between two coarse layers that reaches neither
    is missed.
    Cost: up to 2 N reads for N steps.

    References
    ----------
    A. Riccardi, Contact Refinement Parallax Mapping, 2019.
    """
    whole = step_count_by_angle(ray, settings.min_steps, settings.max_steps)
    steps = min(max(whole, 1), MAX_READS)
    end = march_to_end(field, ray, step_share(ray, steps))
    found = end.above <= 0.0
    fine_step = end.step / float(steps)
    # the last fine layer is the coarse one, already read
    count = max(search_rounds(end, steps), 1)
    t = end.t
    below = False
    k = 1
    while k < count and not below:
        t = end.previous_t + float(k) * fine_step
        below = height_at(ray, t) <= height_under(field, ray, t)
        k = k + 1
    return hit_at(ray, t if below else end.t, found, end.reads + k - 1)
