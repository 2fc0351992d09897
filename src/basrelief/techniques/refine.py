"""Marches that look again within their last step: the surface lies between two layers there.

`relief`, which halves that step, stands with the plain marches in `march.py`.
"""

from __future__ import annotations

from basrelief.lang import HeightField, setting, struct
from basrelief.techniques.height import height_under
from basrelief.techniques.march import (
    MOST_READS,
    crossing,
    march,
    share_of,
    step_count_by_angle,
    steps_by_angle,
)
from basrelief.techniques.ray import Hit, Ray, height_at, hit_at
from basrelief.techniques.technique import technique


@struct
class Secant:
    """Settings of a march followed by regula falsi."""

    min_steps: int = setting(default=8, doc="steps when looking straight down", low=1, high=4096)
    max_steps: int = setting(
        default=32, doc="steps when looking along the surface", low=1, high=4096
    )
    search_steps: int = setting(
        default=3, doc="times that the last step is cut by its chord and read there", low=0, high=24
    )


@struct
class Contact:
    """Settings of a march that is taken again, finer, within its last step."""

    min_steps: int = setting(
        default=4, doc="steps when looking straight down, twice over", low=1, high=4096
    )
    max_steps: int = setting(
        default=16, doc="steps when looking along the surface, twice over", low=1, high=4096
    )


@technique(most_reads=35)
def secant(field: HeightField, ray: Ray, settings: Secant) -> Hit:
    """March to the first layer below the surface, then cut the last step by its chord, read the
    surface there, and cut what is left again: regula falsi.

    Of a chord's two ends the one that stays twice counts half (M. Dowell and P. Jarratt, A Modified
    Regula Falsi Method for Computing the Root of an Equation, 1971, "Illinois"), or one end would
    stay for ever and the other come nearer in ever smaller steps. Cost: the march's reads and one
    for each cut. After E. Risser, M. Shah and S. Pattanaik, Faster Relief Mapping Using the
    Secant Method, 2007.
    """
    steps = steps_by_angle(ray, settings.min_steps, settings.max_steps)
    end = march(field, ray, steps)
    found = end.over <= 0.0
    # there is a step to cut only between a layer above the surface and one below
    rounds = settings.search_steps if found and end.reads > 1 else 0
    above = end.t_before
    over = end.over_before
    below = end.t
    under = -end.over
    moved = 0
    for _ in range(rounds):
        t = crossing(above, over, below, under)
        clearance = height_at(ray, t) - height_under(field, ray, t)
        if clearance > 0.0:
            above = t
            over = clearance
            under = under * (0.5 if moved == 1 else 1.0)
            moved = 1
        else:
            below = t
            under = -clearance
            over = over * (0.5 if moved == -1 else 1.0)
            moved = -1
    t = crossing(above, over, below, under) if found else end.t
    return hit_at(ray, t, found, end.reads + rounds)


@technique(most_reads=31)
def contact(field: HeightField, ray: Ray, settings: Contact) -> Hit:
    """March in coarse steps; from the layer before the first that is below the surface, march
    again, in as many steps to that one step: N + N reads find what N · N layers would.

    What lies between two coarse layers and above neither is missed. Cost: up to twice the number
    of steps in reads, less one. A. Riccardi, Contact Refinement Parallax Mapping, 2019.
    """
    whole = step_count_by_angle(ray, settings.min_steps, settings.max_steps)
    steps = min(max(whole, 1), MOST_READS)
    end = march(field, ray, share_of(ray, steps))
    found = end.over <= 0.0
    finer = end.step / float(steps)
    # the last fine layer is the coarse one, and is known; met at once there is none before it
    count = steps if found and end.reads > 1 else 1
    t = end.t
    below = False
    k = 1
    while k < count and not below:
        t = end.t_before + float(k) * finer
        below = height_at(ray, t) <= height_under(field, ray, t)
        k = k + 1
    return hit_at(ray, t if below else end.t, found, end.reads + k - 1)
