"""Figures by matplotlib (the extra `plots`), which no other module imports.

The same drawing makes the same file: without a date, without random ids, and without the settings
that a user has made for figures of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from basrelief.errors import InputError
from basrelief.images import write_whole

_SETTINGS: Mapping[str, Any] = {
    "font.family": "sans-serif",
    "svg.hashsalt": "basrelief",
    # text as text: it can be searched and copied
    "svg.fonttype": "none",
}
_OPTIONS: Mapping[str, Mapping[str, Any]] = {
    ".svg": {"metadata": {"Date": None}},
    ".png": {"dpi": 150},
    ".pdf": {"metadata": {"CreationDate": None}},
}
"""Options of matplotlib's `savefig` for each kind of file."""


def has_matplotlib() -> bool:
    """Whether figures can be drawn here."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        return False
    return True


def check_figure(path: Path, what: str) -> None:
    """Raise InputError for a name that is not one of a figure; `what` names it in the message."""
    if path.suffix.lower() not in _OPTIONS:
        raise InputError(f"{path}: {what} is written as {', '.join(_OPTIONS)}")


def write_figure(
    path: Path,
    size: tuple[float, float],
    draw: Callable[[Any], None],
    settings: Mapping[str, Any],
) -> None:
    """Write what `draw` draws on a figure of matplotlib, whole or not at all.

    `size` is in inches, `settings` are those of matplotlib (`rcParams`). Raises InputError where
    the file cannot be written.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({**_SETTINGS, **settings})
        figure = Figure(size)
        draw(figure)
        write_whole(path, lambda partial: figure.savefig(partial, **_OPTIONS[path.suffix.lower()]))


def legend_mark(**style: Any) -> Any:
    """A line that is in a legend alone, in the style of matplotlib's `Line2D`."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **style)
