"""What a comparison comes to: the cheapest technique with the least visible error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from basrelief.measure.results import Result, Results

VISIBLE = 0.03
"""The mean FLIP error up to which a picture passes for the true one. Chosen by eye on the samples:
at 0.02 one has to search for differences, at 0.05 they are seen at once."""
FEW = 0.01
"""The share of missed hits that stands for it where FLIP is not installed."""


@dataclass(frozen=True)
class Advice:
    """What to ship: `technique` passes for the truth at all `angles`, at the least mean cost.

    `limited` is a cheaper one that does so up to the angle `up_to`, None where there is none.
    """

    technique: str
    seconds: float
    limited: str | None
    limited_seconds: float | None
    up_to: float | None

    def sentence(self, widest: float) -> str:
        """The same in words, for angles up to `widest`."""
        text = (
            f"Ship {self.technique}: its picture passes for the true one at every angle up to "
            f"{widest:g}°, and none that does is faster ({self.seconds * 1e3:.3g} ms a picture)."
        )
        if self.limited is not None and self.limited_seconds is not None:
            less = 100.0 * (1.0 - self.limited_seconds / self.seconds)
            text += (
                f" If nobody looks flatter than {self.up_to:g}°, {self.limited} will do, which "
                f"takes {less:.0f} % less time ({self.limited_seconds * 1e3:.3g} ms)."
            )
        return text

    def to_dict(self) -> dict[str, Any]:
        """As `compare.json` holds it."""
        return dict(vars(self))


def advice(comparison: Results) -> Advice:
    """The cheapest technique that passes for the truth at every angle; `exact` always does.

    And, where there is one, a cheaper one that does so up to some angle: that which gets furthest,
    the cheapest of those.
    """
    cost = mean_seconds(comparison)
    reach = {name: _reach(comparison.of(name)) for name in cost}
    widest = max(comparison.angles)
    best = min((n for n in cost if reach[n] >= widest), key=lambda n: cost[n], default="exact")
    cheaper = [n for n in cost if cost[n] < cost[best] and reach[n] > 0.0]
    if not cheaper:
        return Advice(best, cost[best], None, None, None)
    limited = max(cheaper, key=lambda n: (reach[n], -cost[n]))
    return Advice(best, cost[best], limited, cost[limited], reach[limited])


def mean_seconds(comparison: Results) -> Mapping[str, float]:
    """The mean time of each technique over all angles."""
    return {
        name: float(np.mean([each.seconds for each in comparison.of(name)]))
        for name in comparison.objects
    }


def passes(result: Result) -> bool:
    """Whether a picture passes for the true one."""
    return result.errors.missed <= FEW if result.flip is None else result.flip <= VISIBLE


def _reach(results: Iterable[Result]) -> float:
    """The widest angle up to which all pictures pass; −1 for none."""
    furthest = -1.0
    for each in sorted(results, key=lambda each: each.angle):
        if not passes(each):
            break
        furthest = each.angle
    return furthest
