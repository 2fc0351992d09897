"""Cross-section of one ray: ray, reads and surface in the plane of ray and normal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.measure.figures import check_figure, has_matplotlib, legend_mark, write_figure
from basrelief.measure.traced import Read, TracedRay

_INK, _QUIET, _PAPER = "#23262b", "#777d86", "#fbfaf8"
_GROUND, _EDGE = "#e4d9c6", "#8a7355"
_ABOVE, _BELOW, _TRUE = "#2f6f9f", "#c2491d", "#1f7a4d"
_MAX_NUMBERS = 24
"""Largest number of reads that are all numbered; of more, some are."""
_MAX_TICKS = 80
"""Largest number of texel borders that are marked."""


def write_section(explained: TracedRay, path: Path) -> Path:
    """Draw and write the cross-section; see `Explanation.save`."""
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
    _write_legend(explained, figure)


class _Section:
    """Drawing within the axes: texels along the ray to the right, heights upwards."""

    def __init__(self, explained: TracedRay, axes: Any) -> None:
        self.traced, self.axes = explained, axes
        places = [self.uv_at(1.0), explained.uv, explained.true_uv, [*explained.hit.uv]]
        ends = explained.along([*places, *(read.uv for read in explained.reads)])
        middle, half = (ends.max() + ends.min()) / 2, max((ends.max() - ends.min()) / 2, 2.0)
        # a short margin before the ray's start, a longer one behind its end
        self.left, self.right = middle - half * 1.2, middle + half * 1.4
        self.labels: list[tuple[float, float]] = []

    def uv_at(self, height: float) -> NDArray[np.float64]:
        return np.array(self.traced.uv) + np.array(self.traced.travel) * (
            self.traced.reference_height - height
        )

    def draw(self) -> None:
        self.ground()
        self.ray()
        self.reads()
        self.ends()
        self.scales()

    def ground(self) -> None:
        """Draw the surface and the polygon."""
        borders = [x for axis in (0, 1) for x in self.texel_borders(axis)]
        near_borders = [x + side for x in borders[:1000] for side in (-1e-5, 1e-5)]
        x = np.sort([*np.linspace(self.left, self.right, 601), *near_borders])
        step = self.traced.direction / self.traced.texels
        height = self.traced.surface(np.array(self.traced.uv) + x[:, None] * step)
        self.axes.fill_between(x, -0.2, height, color=_GROUND, linewidth=0, zorder=1)
        self.axes.plot(x, height, color=_EDGE, linewidth=1.8, zorder=3)
        reference_height = self.traced.reference_height
        self.axes.axhline(reference_height, color=_INK, linewidth=1.0, dashes=(7, 4), zorder=2)
        self.axes.annotate(
            "polygon", (1.0, reference_height), (-5, 3), xycoords=("axes fraction", "data"),
            textcoords="offset points", ha="right", va="bottom", fontsize=9, color=_INK, zorder=9,
        )  # fmt: skip

    def ray(self) -> None:
        """Draw the ray from above the heights to its true hit, and dotted beyond it."""
        true = self.traced.true_height
        length = max(self.traced.length, 1e-6)
        # start where it enters the picture, through its top or its side
        top = min(
            1.14,
            self.traced.reference_height + (self.traced.along(self.traced.uv) - self.left) / length,
        )
        from_x, to_x, end_x = self.traced.along([self.uv_at(h) for h in (top, true, 0.0)])
        self.axes.plot([to_x, end_x], [true, 0.0], color=_QUIET, linewidth=1.0, ls=":", zorder=4)
        self.axes.annotate(
            "", (to_x, true), (from_x, top), zorder=5, annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": _INK, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
        self.axes.annotate(
            "view ray", (from_x, top), (8, 5), va="bottom", textcoords="offset points",
            fontsize=9, zorder=9,
        )  # fmt: skip

    def reads(self) -> None:
        """Draw each read: a dot on the ray, a stem to the surface, and its number."""
        reads = self.traced.reads
        every = max(1, -(-len(reads) // _MAX_NUMBERS))
        for n, read in enumerate(reads, 1):
            x = float(self.traced.along(read.uv))
            color = _ABOVE if read.above else _BELOW
            if read.kind != "record":
                self.axes.plot(
                    [x, x],
                    [read.ray, read.surface],
                    color=color,
                    linewidth=1.0,
                    alpha=0.55,
                    zorder=4,
                )
                self.axes.plot([x], [read.surface], marker="_", color=color, ms=7, zorder=6)
            self.axes.plot(
                [x], [read.ray], marker={"record": "D", "cell": "s"}.get(read.kind, "o"),
                color=color if read.kind != "record" else "white", mec=color,
                ms=5.5 if len(reads) <= 40 else 3.5, zorder=7,
            )  # fmt: skip
            if n % every == 0 or n in (1, len(reads)):
                self.number(n, x, read)

    def number(self, n: int, x: float, read: Read) -> None:
        # numbers of neighbouring reads are stacked
        width, side = (self.right - self.left) * 0.022, 1.0 if read.above else -1.0
        close = sum(abs(x - other) < width and side == s for other, s in self.labels)
        self.labels.append((x, side))
        place = (0.0, 6.0 + 10.0 * close if read.above else -13.0 - 10.0 * close)
        self.axes.annotate(
            str(n), (x, read.ray), place, ha="center", textcoords="offset points", fontsize=8,
            color=_ABOVE if read.above else _BELOW, zorder=8,
        )  # fmt: skip

    def ends(self) -> None:
        """Mark the technique's hit, the true hit, and the distance between them."""
        x_hit, x_true = (
            float(self.traced.along([*self.traced.hit.uv])),
            float(self.traced.along(self.traced.true_uv)),
        )
        height = float(self.traced.hit.height)
        self.axes.plot(
            [x_hit], [height], marker="o", ms=14, mfc="none", mec=_BELOW, mew=2.2, zorder=8,
            clip_on=False,
        )  # fmt: skip
        self.axes.plot(
            [x_true],
            [self.traced.true_height],
            marker="X",
            ms=9,
            color=_TRUE,
            mec="white",
            zorder=10,
        )
        for x, low in ((x_hit, height), (x_true, self.traced.true_height)):
            self.axes.plot([x, x], [low, -0.06], color=_QUIET, linewidth=0.7, ls=":", zorder=4)
        self.axes.plot([x_hit, x_true], [-0.06, -0.06], color=_BELOW, linewidth=3.0, zorder=6)
        self.axes.annotate(
            f"{self.traced.error:.2f} texels", ((x_hit + x_true) / 2, -0.06), (0, -6), ha="center",
            va="top", textcoords="offset points", fontsize=9, color=_BELOW, zorder=9,
        )  # fmt: skip

    def scales(self) -> None:
        """Set up the axes: texels along the ray, heights, and ticks at borders of texels."""
        axes = self.axes
        axes.set_xlim(self.left, self.right)
        axes.set_ylim(-0.16, 1.16)
        axes.set_yticks(np.linspace(0.0, 1.0, 5))
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.set_ylabel("height")
        axes.set_xlabel("texels along the ray, from where it meets the polygon")
        axes.spines[["top", "right"]].set_visible(False)
        for borders in (self.texel_borders(0), self.texel_borders(1)):
            if len(borders) <= _MAX_TICKS:
                axes.vlines(borders, -0.16, -0.135, color=_QUIET, linewidth=0.9, zorder=5)

    def texel_borders(self, axis: int) -> NDArray[np.float64]:
        """Positions along the ray at which it enters another texel along u (0) or v (1)."""
        start = self.traced.uv[axis] * self.traced.texels[axis]
        pace = float(self.traced.direction[axis])
        if abs(pace) < 1e-9:
            return np.zeros(0)
        ends = sorted(start + pace * np.array([self.left, self.right]))
        borders: NDArray[np.float64] = (np.arange(np.ceil(ends[0]), ends[1]) - start) / pace
        return borders


def _write_legend(explained: TracedRay, figure: Any) -> None:
    """Write the headline, the subject, and the legend."""
    figure.text(0.07, 0.945, explained.verdict, fontsize=13, fontweight="bold", va="center")
    x, y = explained.pixel
    kinds = {read.kind for read in explained.reads}
    figure.text(
        0.07, 0.9,
        f"{explained.material}, pixel {x},{y}, cut along the ray · {explained.technique_text}",
        fontsize=9.5, color=_QUIET, va="center",
    )  # fmt: skip
    heights = [read for read in explained.reads if read.kind == "height"]
    marks = []
    if any(read.above for read in heights):
        marks.append(("o", _ABOVE, _ABOVE, "read, the ray above the surface"))
    if any(not read.above for read in heights):
        marks.append(("o", _BELOW, _BELOW, "read, the ray below it"))
    if "cell" in kinds:
        marks.append(("s", _ABOVE, _ABOVE, "cell solved"))
    if "record" in kinds:
        marks.append(("D", "white", _ABOVE, "baked record read"))
    marks.append(("o", "none", _BELOW, f"hit of {explained.technique}"))
    marks.append(("X", _TRUE, "white", "true first hit"))
    handles = [
        legend_mark(ls="", marker=m, mfc=face, mec=edge, ms=9 if m == "X" else 7, label=text)
        for m, face, edge, text in marks
    ]
    figure.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.06, 0.045), ncols=len(handles),
        frameon=False, fontsize=9, handletextpad=0.3, columnspacing=1.4,
    )  # fmt: skip
    note = "Numbers: order of the reads. Short ticks: borders of texels along the ray."
    figure.text(0.07, 0.03, note, fontsize=8.5, color=_QUIET, va="center")
