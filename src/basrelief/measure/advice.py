"""The recommendation of a comparison: the cheapest technique without visible error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from basrelief.measure.results import Result, Results

VISIBLE = 0.03
"""The mean FLIP error up to which a picture passes for the true one. Chosen by eye on the samples:
at 0.02 you have to search for differences, at 0.05 you see them at once."""
FEW = 0.01
"""The share of missed hits that replaces it where FLIP is not installed."""


@dataclass(frozen=True)
class Advice:
    """The recommended technique, and a cheaper one for steeper views.

    `technique` passes for the truth at all angles, at the least mean time, `seconds`. `limited` is
    a cheaper one that passes up to the angle `up_to`, in degrees; None where there is none.
    """

    technique: str
    seconds: float
    limited: str | None
    limited_seconds: float | None
    up_to: float | None

    def sentence(self, widest: float) -> str:
        """The recommendation in words, for angles up to `widest` degrees."""
        text = (
            f"Ship {self.technique}: its picture passes for the true one at every angle up to "
            f"{widest:g}°, and none that does is faster ({self.seconds * 1e3:.3g} ms a picture)."
        )
        if self.limited is not None and self.limited_seconds is not None:
            less = 100.0 * (1.0 - self.limited_seconds / self.seconds)
            text += (
                f" If no view is flatter than {self.up_to:g}°, {self.limited} is enough and "
                f"takes {less:.0f} % less time ({self.limited_seconds * 1e3:.3g} ms)."
            )
        return text

    def to_dict(self) -> dict[str, Any]:
        """The recommendation as `compare.json` stores it."""
        return dict(vars(self))


def advice(comparison: Results) -> Advice:
    """Recommend the cheapest technique that passes for the truth at every angle.

    `exact` always passes. Of the cheaper techniques, the one that passes up to the widest angle is
    named too, if any; the cheapest of these where several do.
    """
    cost = mean_seconds(comparison)
    widest_pass = {name: _widest_pass(comparison.of(name)) for name in cost}
    widest = max(comparison.angles)
    best = min(
        (n for n in cost if widest_pass[n] >= widest), key=lambda n: cost[n], default="exact"
    )
    cheaper = [n for n in cost if cost[n] < cost[best] and widest_pass[n] > 0.0]
    if not cheaper:
        return Advice(best, cost[best], None, None, None)
    limited = max(cheaper, key=lambda n: (widest_pass[n], -cost[n]))
    return Advice(best, cost[best], limited, cost[limited], widest_pass[limited])


def mean_seconds(comparison: Results) -> Mapping[str, float]:
    """Mean seconds of each technique over all angles."""
    return {
        name: float(np.mean([result.seconds for result in comparison.of(name)]))
        for name in comparison.objects
    }


def passes(result: Result) -> bool:
    """Whether a result's picture passes for the true one."""
    return result.errors.missed <= FEW if result.flip is None else result.flip <= VISIBLE


def _widest_pass(results: Iterable[Result]) -> float:
    """The widest angle, in degrees, up to which all pictures pass; −1 for none."""
    furthest = -1.0
    for result in sorted(results, key=lambda result: result.angle):
        if not passes(result):
            break
        furthest = result.angle
    return furthest
