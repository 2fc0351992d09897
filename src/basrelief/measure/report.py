"""Report of a comparison: a folder with a page, its pictures, and compare.json."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_encode, write_picture
from basrelief.measure.advice import VISIBLE, Advice, advice, mean_seconds, passes
from basrelief.measure.colors import heat
from basrelief.measure.errors import Spread
from basrelief.measure.figures import has_matplotlib
from basrelief.measure.plot import DARK, LIGHT, SIZE, Point, write_plot
from basrelief.measure.results import Result, Results, settings_of
from basrelief.pages import check_overwritable, fill, write_page
from basrelief.threads import map_on_threads

GENERATOR = "basrelief compare"
PICTURES = "pictures"
"""The folder of a comparison's pictures."""
LOWEST, HIGHEST = 0.1, 100.0
"""Errors in texels at the dark and the pale end of error pictures, on a logarithmic scale."""
_QUALITY = 92
_PLOTS = {f"{PICTURES}/time.svg": LIGHT, f"{PICTURES}/time-dark.svg": DARK}
"""The files of the plot and their colours."""


def write(folder: Path, comparison: Results, json: str) -> Path:
    """Write the page, its pictures and compare.json with the text `json`; returns the page's path.

    Raises InputError for a folder that cannot be written to, or with another index.html.
    """
    check_folder(folder)
    index = folder / "index.html"
    pictures = folder / PICTURES
    try:
        pictures.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{folder}: cannot be written to ({reason}); choose another") from None
    # a result is encoded in sRGB while another is compressed
    for _ in map_on_threads(lambda result: _write_pictures(folder, result), comparison.results, 2):
        pass
    write_page(folder / "compare.json", json)
    has_plots = has_matplotlib()
    if has_plots:
        _write_plots(folder, comparison)
    write_page(index, page_html(comparison, has_plots))
    return index


def _write_pictures(folder: Path, result: Result) -> None:
    picture_file, error_file = (folder / name for name in _file_names(result))
    write_picture(picture_file, result.picture.astype(np.float32), quality=_QUALITY)
    write_picture(error_file, error_picture(result.off), quality=_QUALITY)


def check_folder(folder: Path) -> None:
    """Raise InputError for a file in the place of a folder, and one with another index.html."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; name a folder for the comparison")
    check_overwritable(folder / "index.html", GENERATOR, "a comparison's page")


def error_picture(off: NDArray[np.float16]) -> NDArray[np.float32]:
    """uv errors in texels, (H, W), as linear colours, (H, W, 3), on a logarithmic scale."""
    texels = np.maximum(np.nan_to_num(off.astype(np.float64), nan=0.0, posinf=HIGHEST), LOWEST)
    return heat(np.log(texels / LOWEST) / math.log(HIGHEST / LOWEST))


def _file_names(result: Result) -> tuple[str, str]:
    """File names of a result's picture and error picture."""
    name = re.sub(r"[^A-Za-z0-9_.=-]+", "-", result.technique)
    start = f"{PICTURES}/{result.angle:g}-{name}"
    return f"{start}.webp", f"{start}-error.webp"


# --- the page ------------------------------------------------------------------------------------


class Cell(NamedTuple):
    """A cell of the table: the error of one technique at one angle, and its CSS class."""

    text: str
    kind: str


class Row(NamedTuple):
    """A row of the table: one technique."""

    technique: str
    time: str
    cells: list[Cell]
    ship: bool


class Shown(NamedTuple):
    """One technique at one angle: its pictures, each a file and a description, and its numbers."""

    title: str
    settings: str
    files: list[tuple[str, str]]
    facts: list[tuple[str, str]]
    ship: bool


class Angle(NamedTuple):
    """All techniques at one angle; `alike` where none of them has a visible error."""

    degrees: str
    title: str
    alike: bool
    pictures: list[Shown]


def page_html(comparison: Results, has_plots: bool) -> str:
    """The page as HTML, with or without the plot of error against time."""
    best = advice(comparison)
    recommendation, _, reason = best.sentence(max(comparison.angles)).partition(":")
    return fill(
        "measure/templates/report.html.jinja",
        generator=GENERATOR,
        title=f"{comparison.material}: which technique?",
        comparison=comparison,
        advice=(recommendation, reason),
        has_flip=_has_flip(comparison),
        rows=[_row(comparison, name, best) for name in mean_seconds(comparison)],
        plot=_plot(comparison) if has_plots else None,
        angles=[_angle(comparison, angle, best) for angle in comparison.angles],
        ramp=_ramp(),
    )


def _has_flip(comparison: Results) -> bool:
    return comparison.results[0].flip is not None


def _row(comparison: Results, name: str, best: Advice) -> Row:
    seconds = mean_seconds(comparison)[name]
    cells = [_cell(result) for result in comparison.of(name)]
    return Row(name, _time(seconds), cells, name == best.technique)


def _cell(result: Result) -> Cell:
    text = _share(result.errors.missed) if result.flip is None else f"{result.flip:.3f}"
    near = result.flip is not None and result.flip <= 2.0 * VISIBLE
    return Cell(text, "fine-cell" if passes(result) else "near-cell" if near else "")


def _plot(comparison: Results) -> dict[str, Any]:
    """Files, size and error name of the plot."""
    light, dark = _PLOTS
    return {"light": light, "dark": dark, "size": SIZE, "error": _error_name(comparison)}


def _error_name(comparison: Results) -> str:
    return "mean visible error (FLIP)" if _has_flip(comparison) else "missed hits"


def _write_plots(folder: Path, comparison: Results) -> None:
    """Write the plots of mean error over all angles against time."""
    best = advice(comparison)
    points = []
    for name, seconds in mean_seconds(comparison).items():
        errors = [
            result.errors.missed if result.flip is None else result.flip
            for result in comparison.of(name)
        ]
        points.append(Point(name, seconds, float(np.mean(errors)), name == best.technique))
    limit = VISIBLE if _has_flip(comparison) else None
    for file, palette in _PLOTS.items():
        write_plot(folder / file, points, _error_name(comparison), limit, palette)


def _angle(comparison: Results, angle: float, best: Advice) -> Angle:
    results = sorted(comparison.at(angle), key=lambda result: result.technique != "exact")
    title = "Head-on" if angle == 0.0 else f"{angle:g}° from head-on"
    alike = all(result.errors.uv.worst <= LOWEST for result in results)
    return Angle(
        f"{angle:g}", title, alike, [_shown(comparison, result, best) for result in results]
    )


def _ramp() -> dict[str, Any]:
    """The colour scale of error pictures: CSS colours, and texels along it."""
    stops = srgb_encode(heat(np.linspace(0.0, 1.0, 17)).astype(np.float64)) * 255.0
    colors = ", ".join("rgb({:.0f} {:.0f} {:.0f})".format(*stop) for stop in stops)
    return {"colors": colors, "texels": [f"{n:g}" for n in (LOWEST, 1.0, 10.0, HIGHEST)]}


def _shown(comparison: Results, result: Result, best: Advice) -> Shown:
    picture_file, error_file = _file_names(result)
    name = result.technique
    return Shown(
        title=f"{name}, the true picture" if name == "exact" else name,
        settings=_settings(comparison, name),
        files=[
            (picture_file, f"{name} at {result.angle:g} degrees"),
            (error_file, f"error of each pixel of {name}"),
        ],
        facts=list(_facts(result)),
        ship=name == best.technique,
    )


def _facts(result: Result) -> Iterator[tuple[str, str]]:
    errors = result.errors
    if result.flip is not None:
        yield "visible error (FLIP)", f"{result.flip:.3f}"
    yield "missed hits", _share(errors.missed)
    if errors.missed > 0.0:
        yield "… passed through", _share(errors.passed)
        yield "… stopped short", _share(errors.short)
    if errors.wrong_light is not None:
        yield "in wrong light", _share(errors.wrong_light)
    yield "uv error, texels", _spread(errors.uv, 1.0)
    yield "depth error, % of a tile", _spread(errors.depth, 100.0)
    yield "heights read in a pixel", f"{errors.reads:.1f}"
    yield "time", _time(result.seconds)


def _settings(comparison: Results, name: str) -> str:
    obj = comparison.objects[name]
    parts = [f"{key} {value:g}" for key, value in settings_of(obj).items()]
    if obj.projection != "full":
        parts.append(f"projection {obj.projection}")
    if obj.reference_height != 1.0:
        parts.append(f"reference height {obj.reference_height:g}")
    return " · ".join(parts)


def _share(share: float) -> str:
    percent = 100.0 * share
    if percent == 0.0:
        return "none"
    return "under 0.01 %" if percent < 0.01 else f"{percent:.2g} %" if percent < 10 else (
        f"{percent:.0f} %"
    )  # fmt: skip


def _spread(spread: Spread, times: float) -> str:
    numbers = (spread.median, spread.percentile_99, spread.worst)
    return " · ".join(_short(number * times) for number in numbers)


def _short(number: float) -> str:
    return f"{number:.2f}" if number < 10.0 else f"{number:.0f}"


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"
