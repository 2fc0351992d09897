"""The cross-section of one ray, as the articles draw it: the surface cut along the ray's plane."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.measure.figures import check_figure, has_matplotlib, legend_mark, write_figure
from basrelief.measure.traced import Sample, TracedRay

_INK, _QUIET, _PAPER = "#23262b", "#777d86", "#fbfaf8"
_GROUND, _EDGE = "#e4d9c6", "#8a7355"
_ABOVE, _BELOW, _TRUE = "#2f6f9f", "#c2491d", "#1f7a4d"
_MOST_NUMBERS = 24
"""More samples than that have only some of their numbers written beside them."""
_MOST_LINES = 80
"""More texels than that are not marked one by one."""


def write_section(explained: TracedRay, path: Path) -> Path:
    """Draw and write, whole or not at all; see `Explanation.save`."""
    check_figure(path, "a cross-section")
    if not has_matplotlib():
        raise InputError(
            "a cross-section is drawn by matplotlib; pip install 'basrelief[plots]', "
            "or print it as a table"
        )
    write_figure(path, _INCHES, lambda figure: _draw(explained, figure), _SETTINGS)
    return path


_INCHES = (10.0, 5.6)
_SETTINGS = {
    "font.size": 10.0, "figure.facecolor": _PAPER, "axes.edgecolor": _QUIET, "text.color": _INK,
    "xtick.color": _QUIET, "ytick.color": _QUIET, "axes.labelcolor": _INK,
}  # fmt: skip


def _draw(explained: TracedRay, figure: Any) -> None:
    _Section(explained, figure.add_axes((0.07, 0.21, 0.9, 0.66), facecolor="white")).draw()
    _words(explained, figure)


class _Section:
    """The drawing within the axes: texels along the ray's way, heights upwards."""

    def __init__(self, explained: TracedRay, axes: Any) -> None:
        self.of, self.axes = explained, axes
        places = [self.uv_at(1.0), explained.uv, explained.true_uv, [*explained.hit.uv]]
        ends = explained.along([*places, *(one.uv for one in explained.samples)])
        middle, half = (ends.max() + ends.min()) / 2, max((ends.max() - ends.min()) / 2, 2.0)
        # a little of what lies before, more of what the ray would have come to
        self.left, self.right = middle - half * 1.2, middle + half * 1.4
        self.labels: list[tuple[float, float]] = []

    def uv_at(self, height: float) -> NDArray[np.float64]:
        return np.array(self.of.uv) + np.array(self.of.travel) * (self.of.reference_height - height)

    def draw(self) -> None:
        self.ground()
        self.ray()
        self.samples()
        self.ends()
        self.scales()

    def ground(self) -> None:
        """The surface that is cut, and the polygon."""
        walls = [x for axis in (0, 1) for x in self.walls(axis)]
        beside = [x + side for x in walls[:1000] for side in (-1e-5, 1e-5)]
        x = np.sort([*np.linspace(self.left, self.right, 601), *beside])
        step = self.of.direction / self.of.texels
        height = self.of.surface(np.array(self.of.uv) + x[:, None] * step)
        self.axes.fill_between(x, -0.2, height, color=_GROUND, linewidth=0, zorder=1)
        self.axes.plot(x, height, color=_EDGE, linewidth=1.8, zorder=3)
        reference_height = self.of.reference_height
        self.axes.axhline(reference_height, color=_INK, linewidth=1.0, dashes=(7, 4), zorder=2)
        self.axes.annotate(
            "the polygon", (1.0, reference_height), (-5, 3), xycoords=("axes fraction", "data"),
            textcoords="offset points", ha="right", va="bottom", fontsize=9, color=_INK, zorder=9,
        )  # fmt: skip

    def ray(self) -> None:
        """The ray from above the heights to where it truly ends, and faintly on."""
        true = self.of.true_height
        length = max(self.of.length, 1e-6)
        # from where it comes into the picture, through its top or its side
        top = min(1.14, self.of.reference_height + (self.of.along(self.of.uv) - self.left) / length)
        from_x, to_x, end_x = self.of.along([self.uv_at(h) for h in (top, true, 0.0)])
        self.axes.plot([to_x, end_x], [true, 0.0], color=_QUIET, linewidth=1.0, ls=":", zorder=4)
        self.axes.annotate(
            "", (to_x, true), (from_x, top), zorder=5, annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": _INK, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        self.axes.annotate(
            "view ray", (from_x, top), (8, 5), va="bottom", textcoords="offset points",
            fontsize=9, zorder=9,
        )  # fmt: skip

    def samples(self) -> None:
        """Each read: a dot on the ray, a stem to the surface there, and its number."""
        all_samples = self.of.samples
        every = max(1, -(-len(all_samples) // _MOST_NUMBERS))
        for n, one in enumerate(all_samples, 1):
            x = float(self.of.along(one.uv))
            color = _ABOVE if one.above else _BELOW
            if one.kind != "record":
                self.axes.plot(
                    [x, x], [one.ray, one.surface], color=color, linewidth=1.0, alpha=0.55, zorder=4
                )
                self.axes.plot([x], [one.surface], marker="_", color=color, ms=7, zorder=6)
            self.axes.plot(
                [x], [one.ray], marker={"record": "D", "cell": "s"}.get(one.kind, "o"),
                color=color if one.kind != "record" else "white", mec=color,
                ms=5.5 if len(all_samples) <= 40 else 3.5, zorder=7,
            )  # fmt: skip
            if n % every == 0 or n in (1, len(all_samples)):
                self.number(n, x, one)

    def number(self, n: int, x: float, one: Sample) -> None:
        # numbers of reads that lie close together stand over one another
        width, side = (self.right - self.left) * 0.022, 1.0 if one.above else -1.0
        close = sum(abs(x - other) < width and side == s for other, s in self.labels)
        self.labels.append((x, side))
        place = (0.0, 6.0 + 10.0 * close if one.above else -13.0 - 10.0 * close)
        self.axes.annotate(
            str(n), (x, one.ray), place, ha="center", textcoords="offset points", fontsize=8,
            color=_ABOVE if one.above else _BELOW, zorder=8,
        )  # fmt: skip

    def ends(self) -> None:
        """Where the technique ended, where it should have, and how far that is."""
        ended, true = float(self.of.along([*self.of.hit.uv])), float(self.of.along(self.of.true_uv))
        height = float(self.of.hit.height)
        self.axes.plot(
            [ended], [height], marker="o", ms=14, mfc="none", mec=_BELOW, mew=2.2, zorder=8,
            clip_on=False,
        )  # fmt: skip
        self.axes.plot(
            [true], [self.of.true_height], marker="X", ms=9, color=_TRUE, mec="white", zorder=10
        )
        for x, low in ((ended, height), (true, self.of.true_height)):
            self.axes.plot([x, x], [low, -0.06], color=_QUIET, linewidth=0.7, ls=":", zorder=4)
        self.axes.plot([ended, true], [-0.06, -0.06], color=_BELOW, linewidth=3.0, zorder=6)
        self.axes.annotate(
            f"{self.of.error:.2f} texels", ((ended + true) / 2, -0.06), (0, -6), ha="center",
            va="top", textcoords="offset points", fontsize=9, color=_BELOW, zorder=9,
        )  # fmt: skip

    def scales(self) -> None:
        """Texels along, heights up, and a faint line where the ray comes to another texel."""
        axes = self.axes
        axes.set_xlim(self.left, self.right)
        axes.set_ylim(-0.16, 1.16)
        axes.set_yticks(np.linspace(0.0, 1.0, 5))
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.set_ylabel("height")
        axes.set_xlabel("texels along the ray, from where it meets the polygon")
        axes.spines[["top", "right"]].set_visible(False)
        for walls in (self.walls(0), self.walls(1)):
            if len(walls) <= _MOST_LINES:
                axes.vlines(walls, -0.16, -0.135, color=_QUIET, linewidth=0.9, zorder=5)

    def walls(self, axis: int) -> NDArray[np.float64]:
        """Where the ray comes to another texel along u (0) or v (1)."""
        start = self.of.uv[axis] * self.of.texels[axis]
        pace = float(self.of.direction[axis])
        if abs(pace) < 1e-9:
            return np.zeros(0)
        ends = sorted(start + pace * np.array([self.left, self.right]))
        walls: NDArray[np.float64] = (np.arange(np.ceil(ends[0]), ends[1]) - start) / pace
        return walls


def _words(explained: TracedRay, figure: Any) -> None:
    """The headline, what is to be seen, and what the marks mean."""
    figure.text(0.07, 0.945, explained.verdict, fontsize=13, fontweight="bold", va="center")
    x, y = explained.pixel
    kinds = {one.kind for one in explained.samples}
    figure.text(
        0.07, 0.9,
        f"{explained.material}, pixel {x},{y}, cut along the ray's way · {explained.told}",
        fontsize=9.5, color=_QUIET, va="center",
    )  # fmt: skip
    heights = [one for one in explained.samples if one.kind == "height"]
    marks = []
    if any(one.above for one in heights):
        marks.append(("o", _ABOVE, _ABOVE, "a read, the ray above the surface"))
    if any(not one.above for one in heights):
        marks.append(("o", _BELOW, _BELOW, "a read, the ray below it"))
    if "cell" in kinds:
        marks.append(("s", _ABOVE, _ABOVE, "a cell solved"))
    if "record" in kinds:
        marks.append(("D", "white", _ABOVE, "a baked record read"))
    marks.append(("o", "none", _BELOW, f"where {explained.technique} ends"))
    marks.append(("X", _TRUE, "white", "the true first hit"))
    handles = [
        legend_mark(ls="", marker=m, mfc=face, mec=edge, ms=9 if m == "X" else 7, label=text)
        for m, face, edge, text in marks
    ]
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.06, 0.045), ncols=len(handles),
        frameon=False, fontsize=9, handletextpad=0.3, columnspacing=1.4,
    )  # fmt: skip
    note = "Numbers: the order of the reads. Short ticks: where the ray comes to another texel."
    figure.text(0.07, 0.03, note, fontsize=8.5, color=_QUIET, va="center")
