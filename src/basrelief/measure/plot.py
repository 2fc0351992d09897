"""Plot of error against time, with the Pareto front of the techniques."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from basrelief.measure.figures import write_figure
from basrelief.measure.labels import Box, place_labels

SIZE = (760, 380)
"""Width and height of the plot, in the units of its lines and letters: points, 1 ÷ 72 inch."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 40, 26, 52
"""Margins around the axes."""
_FONT_SIZE = 13.0
_RADIUS, _CHOSEN_RADIUS = 5.0, 8.0
_LEADER_DISTANCE = 13.0
"""Distance from which on a line joins a label to its dot."""
_MOST_TICKS = 7


@dataclass(frozen=True)
class Point:
    """A technique with its time in seconds and its error, 0 or more."""

    name: str
    seconds: float
    error: float
    chosen: bool = False


class Palette(NamedTuple):
    """Colours of the pages' style sheet, by their names there."""

    paper: str
    ink: str
    quiet: str
    line: str
    link: str


LIGHT = Palette("#fbfaf8", "#23262b", "#5d636c", "#dddad4", "#9a3d1c")
DARK = Palette("#16181b", "#e6e4df", "#a0a5ad", "#32363c", "#f0a27f")
_INVISIBLE, _INVISIBLE_OPACITY = "#2f9e64", 0.14
"""The band of invisible errors."""


def front(points: Sequence[Point]) -> list[Point]:
    """The Pareto front: points than which no other is faster and better, the fastest first."""
    best: list[Point] = []
    for point in sorted(points, key=lambda p: (p.seconds, p.error)):
        if not best or point.error < best[-1].error:
            best.append(point)
    return best


def write_plot(
    path: Path, points: Sequence[Point], error: str, limit: float | None, palette: Palette
) -> None:
    """Write the plot by matplotlib.

    `error` labels the axis of errors, `limit` is the top of the band of invisible ones. The axis of
    times is logarithmic; that of errors is a square root, which separates small ones.
    """
    inches = (SIZE[0] / 72.0, SIZE[1] / 72.0)
    settings = {
        "figure.dpi": 72.0, "font.size": _FONT_SIZE, "figure.facecolor": palette.paper,
        "axes.facecolor": "none", "text.color": palette.ink, "axes.labelcolor": palette.quiet,
        "xtick.labelcolor": palette.quiet, "ytick.labelcolor": palette.quiet,
        "grid.color": palette.line, "grid.linewidth": 1.0, "axes.grid": True,
        "axes.axisbelow": True, "xtick.major.size": 0.0, "ytick.major.size": 0.0,
        # dots on an axis do not cover its numbers
        "xtick.major.pad": _CHOSEN_RADIUS + 3.0, "ytick.major.pad": _CHOSEN_RADIUS + 3.0,
    }  # fmt: skip
    for side in ("left", "right", "top", "bottom"):
        settings[f"axes.spines.{side}"] = False
    write_figure(
        path, inches, lambda figure: _Plot(figure, points, palette).draw(error, limit), settings
    )


class _Plot:
    """Drawing of the axes, the band, the front, and points with their names."""

    def __init__(self, figure: Any, points: Sequence[Point], palette: Palette) -> None:
        (width, height), sides = SIZE, (_LEFT + _RIGHT, _BOTTOM + _TOP)
        self.axes = figure.add_axes(
            (_LEFT / width, _BOTTOM / height, 1 - sides[0] / width, 1 - sides[1] / height)
        )
        self.points, self.palette, self.best = points, palette, front(points)

    def draw(self, error: str, limit: float | None) -> None:
        self.set_scales(limit)
        if limit is not None:
            self.axes.axhspan(
                0.0, limit, color=_INVISIBLE, alpha=_INVISIBLE_OPACITY, linewidth=0, zorder=1
            )
        self.axes.set_xlabel("milliseconds a picture; faster to the left", labelpad=8)
        self.axes.set_ylabel(error, labelpad=8)
        steps = self.front_corners()
        self.axes.plot(
            *zip(*steps, strict=True), color=self.palette.link, linewidth=1.5, dashes=(3.5, 2.5),
            clip_on=False, zorder=2,
        )  # fmt: skip
        for point in self.points:
            self.draw_dot(point)
        self.draw_names(steps)

    def set_scales(self, limit: float | None) -> None:
        """Set up the axes, errors from 0 up, with round numbers."""
        times = [point.seconds * 1e3 for point in self.points]
        low, high = min(times) / 1.15, max(times) * 1.15
        most = max(max(point.error for point in self.points), limit or 0.0, 1e-6) * 1.08
        axes = self.axes
        axes.set_xscale("log")
        axes.set_yscale("function", functions=(_signed_root, _signed_square))
        axes.set_xlim(low, high)
        axes.set_ylim(0.0, most)
        axes.set_xticks(_ticks(low, high), [f"{tick:g}" for tick in _ticks(low, high)])
        errors = [tick for tick in (0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0) if tick <= most]
        axes.set_yticks(errors, [f"{tick:g}" for tick in errors])
        axes.minorticks_off()

    def front_corners(self) -> list[tuple[float, float]]:
        """Corners of the front, from the upper edge to the right one."""
        (_, right), (_, top) = self.axes.get_xlim(), self.axes.get_ylim()
        corners = [(self.best[0].seconds * 1e3, top)]
        for point in self.best:
            corners.append((point.seconds * 1e3, corners[-1][1]))
            corners.append((point.seconds * 1e3, point.error))
        return [*corners, (right, corners[-1][1])]

    def draw_dot(self, point: Point) -> None:
        is_best = point in self.best or point.chosen
        self.axes.plot(
            [point.seconds * 1e3], [point.error], marker="o", ms=2.0 * _radius(point),
            mfc=self.palette.link if is_best else self.palette.paper,
            mec=self.palette.link if is_best else self.palette.quiet,
            mew=0.0 if is_best else 1.5, clip_on=False, zorder=4,
        )  # fmt: skip

    def draw_names(self, steps: Sequence[tuple[float, float]]) -> None:
        """Draw names that overlap neither one another nor points nor the front."""
        # the front first: other names may be further from their points
        points = sorted(self.points, key=lambda point: (point not in self.best, point.error))
        texts = [self.add_name(point) for point in points]
        extents = [text.get_window_extent() for text in texts]
        sizes = [(extent.width, extent.height) for extent in extents]
        at = [self.position(point.seconds * 1e3, point.error) for point in points]
        dots = [
            Box(x, y, x, y).grown(_radius(point)) for (x, y), point in zip(at, points, strict=True)
        ]
        corners = [self.position(*corner) for corner in steps]
        edges = [_edge(*ends) for ends in itertools.pairwise(corners)]
        area = Box(_LEFT, _BOTTOM, SIZE[0], SIZE[1])
        boxes = place_labels(at, sizes, [*dots, *edges], area)
        for text, box, place, point in zip(texts, boxes, at, points, strict=True):
            text.set_position((box.left, box.bottom))
            self.draw_leader(place, box, _radius(point))

    def add_name(self, point: Point) -> Any:
        return self.axes.text(
            0.0, 0.0, point.name, transform=None, va="bottom", zorder=5,
            color=self.palette.ink if point in self.best or point.chosen else self.palette.quiet,
            fontweight="bold" if point.chosen else "normal",
        )  # fmt: skip

    def draw_leader(self, start: tuple[float, float], box: Box, radius: float) -> None:
        """Draw a line from a far label to its point."""
        near = (min(max(start[0], box.left), box.right), min(max(start[1], box.bottom), box.top))
        line = np.subtract(near, start)
        length = float(np.hypot(*line))
        if length > radius + _LEADER_DISTANCE:
            edge = start + line * (radius / length)
            self.axes.plot(
                [edge[0], near[0]], [edge[1], near[1]], color=self.palette.quiet,
                linewidth=0.8, transform=None, clip_on=False, zorder=3,
            )  # fmt: skip

    def position(self, milliseconds: float, error: float) -> tuple[float, float]:
        """Position of a time and an error, in points from the figure's lower left corner."""
        x, y = self.axes.transData.transform((milliseconds, error))
        return float(x), float(y)


def _signed_root(value: Any) -> Any:
    # matplotlib evaluates negative values too, which have no root
    return np.sign(value) * np.sqrt(np.abs(value))


def _signed_square(value: Any) -> Any:
    return np.sign(value) * np.square(value)


def _radius(point: Point) -> float:
    return _CHOSEN_RADIUS if point.chosen else _RADIUS


def _edge(start: tuple[float, float], end: tuple[float, float]) -> Box:
    """Box around a line along an axis."""
    (x, y), (u, v) = start, end
    return Box(min(x, u), min(y, v), max(x, u), max(y, v)).grown(1.0)


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers from `low` to `high`: at least three where possible, at most seven."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks: list[float] = []
    for steps in ((1,), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7), [1 + k / 10 for k in range(90)]):
        ticks = [m * 10.0**p for p in powers for m in steps if low <= m * 10.0**p <= high]
        if len(ticks) >= 3:
            break
    return ticks[:: math.ceil(len(ticks) / _MOST_TICKS) or 1]
