"""Error against time as SVG, with the Pareto front: what nothing else is both faster and better."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

_WIDTH, _HEIGHT = 760, 380
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 170, 26, 52
_LINE, _LABEL = 15, 170
"""Pixels between the lines of labels, and the most that one is long."""


@dataclass(frozen=True)
class Point:
    """One dot: its name, time in seconds, and an error from 0 up."""

    name: str
    seconds: float
    error: float
    chosen: bool = False


def front(points: Sequence[Point]) -> list[Point]:
    """The points than which no other is both no slower and better, from the fastest on."""
    found: list[Point] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        if not found or point.error < found[-1].error:
            found.append(point)
    return found


def plot(points: Sequence[Point], error: str, limit: float | None = None) -> str:
    """The plot; `error` says what is measured, `limit` where it stops being visible.

    Times on a logarithmic axis, errors on one by square roots, so that small ones are told apart.
    """
    times = [p.seconds * 1e3 for p in points]
    low, high = min(times) / 1.15, max(times) * 1.15
    most = max(max(p.error for p in points), limit or 0.0, 1e-6) * 1.08
    wide, tall = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM

    def x(milliseconds: float) -> float:
        return _LEFT + wide * math.log(milliseconds / low) / math.log(high / low)

    def y(value: float) -> float:
        return _TOP + tall * (1.0 - math.sqrt(value / most))

    parts = [
        f'<svg class="plot" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" '
        f'aria-label="{escape(error)} against time">'
    ]
    for tick in _ticks(low, high):
        parts.append(_vertical(x(tick), f"{tick:g}"))
    for tick in (0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0):
        if tick <= most:
            parts.append(_horizontal(y(tick), f"{tick:g}"))
    if limit is not None:
        parts.append(
            f'<rect class="fine" x="{_LEFT}" y="{y(limit):.1f}" width="{wide}" '
            f'height="{_TOP + tall - y(limit):.1f}"/>'
        )
    best = front(points)
    steps = [f"M{x(best[0].seconds * 1e3):.1f} {_TOP}"]
    for point in best:
        steps.append(f"H{x(point.seconds * 1e3):.1f}V{y(point.error):.1f}")
    steps.append(f"H{_LEFT + wide}")
    parts.append(f'<path class="front" d="{"".join(steps)}"/>')
    parts += [
        f'<circle class="{_kind(point, best)}" cx="{x(point.seconds * 1e3):.1f}" '
        f'cy="{y(point.error):.1f}" r="{8 if point.chosen else 5}"/>'
        for point in points
    ]
    # labels from the lowest up, each no nearer to the one below than a line
    room: list[tuple[float, float]] = []
    for point in sorted(points, key=lambda p: p.error):
        px, line = x(point.seconds * 1e3) + 8.0, y(point.error) - 6.0
        while any(abs(line - other) < _LINE and abs(px - at) < _LABEL for at, other in room):
            line -= 1.0
        room.append((px, line))
        parts.append(
            f'<text class="{_kind(point, best)}" x="{px:.1f}" y="{line:.1f}">'
            f"{escape(point.name)}</text>"
        )
    middle = _LEFT + wide / 2
    parts.append(
        f'<text class="axis" x="{middle:.0f}" y="{_HEIGHT - 8}" text-anchor="middle">'
        "milliseconds a picture, the faster the further left</text>"
        f'<text class="axis" transform="translate(14 {_TOP + tall / 2:.0f}) rotate(-90)" '
        f'text-anchor="middle">{escape(error)}</text></svg>'
    )
    return "\n".join(parts)


def _kind(point: Point, best: Sequence[Point]) -> str:
    """How a dot is drawn: chosen, on the front, or off it."""
    return "chosen" if point.chosen else "on" if point in best else "off"


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers between two, three at least where they can be had."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    found: list[float] = []
    for steps in ((1,), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7), [1 + k / 10 for k in range(90)]):
        found = [m * 10.0**p for p in powers for m in steps if low <= m * 10.0**p <= high]
        if len(found) >= 3:
            break
    return found


def _vertical(x: float, text: str) -> str:
    bottom = _HEIGHT - _BOTTOM
    return (
        f'<path class="grid-line" d="M{x:.1f} {_TOP}V{bottom}"/>'
        f'<text class="tick" x="{x:.1f}" y="{bottom + 17}" text-anchor="middle">{text}</text>'
    )


def _horizontal(y: float, text: str) -> str:
    return (
        f'<path class="grid-line" d="M{_LEFT} {y:.1f}H{_WIDTH - _RIGHT}"/>'
        f'<text class="tick" x="{_LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{text}</text>'
    )
