"""Places of labels beside points, clear of one another and of what is drawn."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

_GAPS = (5.0, 9.0, 14.0, 20.0, 28.0, 38.0, 50.0, 64.0, *map(float, range(80, 400, 20)))
"""Distances between a point and its label that are tried, in the units of the boxes."""
_SIDES = ((1, 1), (1, 0), (0, 1), (-1, 1), (1, -1), (-1, 0), (0, -1), (-1, -1))
"""Sides of a point that are tried at each distance, to the right and above first."""
_MARGIN = 2.0


class Box(NamedTuple):
    """A rectangle, y upwards."""

    left: float
    bottom: float
    right: float
    top: float

    def overlaps(self, other: Box) -> bool:
        """Whether the two have an area in common."""
        return (
            self.left < other.right
            and other.left < self.right
            and self.bottom < other.top
            and other.bottom < self.top
        )

    def is_within(self, other: Box) -> bool:
        """Whether all of it lies in the other."""
        return (
            other.left <= self.left
            and self.right <= other.right
            and other.bottom <= self.bottom
            and self.top <= other.top
        )

    def grown(self, margin: float) -> Box:
        """The rectangle with a margin on all sides."""
        return Box(self.left - margin, self.bottom - margin, self.right + margin, self.top + margin)


def place_labels(
    points: Sequence[tuple[float, float]],
    sizes: Sequence[tuple[float, float]],
    drawn: Sequence[Box],
    area: Box,
) -> list[Box]:
    """The boxes of labels, each near its point, by their widths and heights.

    Labels are placed in their order, each at the nearest place in `area` that is clear of the ones
    before and of what is `drawn`; where there is none, of the ones before alone.
    """
    placed: list[Box] = []
    for point, size in zip(points, sizes, strict=True):
        places = [box for box in _around(point, size) if box.is_within(area)]
        clear = [box for box in places if _is_clear(box, placed)]
        best = [box for box in clear if _is_clear(box, drawn)]
        first = itertools.chain(best, clear, places, _around(point, size))
        placed.append(next(first))
    return placed


def _is_clear(box: Box, others: Sequence[Box]) -> bool:
    return not any(box.grown(_MARGIN).overlaps(other) for other in others)


def _around(point: tuple[float, float], size: tuple[float, float]) -> Iterator[Box]:
    """Boxes of a size around a point, the nearest first."""
    (x, y), (width, height) = point, size
    for gap, (right, up) in itertools.product(_GAPS, _SIDES):
        # on a side a box is centred, towards a corner it begins at the point
        left = x + gap if right > 0 else x - gap - width if right < 0 else x - width / 2.0
        bottom = y + gap if up > 0 else y - gap - height if up < 0 else y - height / 2.0
        yield Box(left, bottom, left + width, bottom + height)
