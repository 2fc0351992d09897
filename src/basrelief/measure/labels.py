"""Placement of labels beside points, without overlaps."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

_GAPS = (5.0, 9.0, 14.0, 20.0, 28.0, 38.0, 50.0, 64.0, *map(float, range(80, 400, 20)))
"""Distances between a point and its label, in the order of trial, in the units of the boxes."""
_SIDES = ((1, 1), (1, 0), (0, 1), (-1, 1), (1, -1), (-1, 0), (0, -1), (-1, -1))
"""Sides of a point in the order of trial, above to the right first."""
_MARGIN = 2.0


class Box(NamedTuple):
    """A rectangle, y upwards."""

    left: float
    bottom: float
    right: float
    top: float

    def overlaps(self, other: Box) -> bool:
        """Whether the two boxes overlap."""
        return (
            self.left < other.right
            and other.left < self.right
            and self.bottom < other.top
            and other.bottom < self.top
        )

    def is_within(self, other: Box) -> bool:
        """Whether this box lies inside the other."""
        return (
            other.left <= self.left
            and self.right <= other.right
            and other.bottom <= self.bottom
            and self.top <= other.top
        )

    def grown(self, margin: float) -> Box:
        """The box enlarged by a margin on all sides."""
        return Box(self.left - margin, self.bottom - margin, self.right + margin, self.top + margin)


def place_labels(
    points: Sequence[tuple[float, float]],
    sizes: Sequence[tuple[float, float]],
    obstacles: Sequence[Box],
    area: Box,
) -> list[Box]:
    """Boxes of labels near their points, by the labels' widths and heights.

    Labels are placed in order, each at the nearest place in `area` that overlaps neither earlier
    labels nor `obstacles`; where there is none, obstacles are ignored.
    """
    placed: list[Box] = []
    for point, size in zip(points, sizes, strict=True):
        places = [box for box in _candidates(point, size) if box.is_within(area)]
        clear = [box for box in places if _is_clear(box, placed)]
        best = [box for box in clear if _is_clear(box, obstacles)]
        first = itertools.chain(best, clear, places, _candidates(point, size))
        placed.append(next(first))
    return placed


def _is_clear(box: Box, others: Sequence[Box]) -> bool:
    return not any(box.grown(_MARGIN).overlaps(other) for other in others)


def _candidates(point: tuple[float, float], size: tuple[float, float]) -> Iterator[Box]:
    """Candidate boxes of a size around a point, the nearest first."""
    (x, y), (width, height) = point, size
    for gap, (right, up) in itertools.product(_GAPS, _SIDES):
        # boxes on a side are centred, those at a corner start at the point
        left = x + gap if right > 0 else x - gap - width if right < 0 else x - width / 2.0
        bottom = y + gap if up > 0 else y - gap - height if up < 0 else y - height / 2.0
        yield Box(left, bottom, left + width, bottom + height)
