"""Figures by matplotlib (the extra `plots`), which no other module imports.

Files are reproducible: they carry no date and no random ids, and ignore a user's own settings of
matplotlib.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from basrelief.errors import InputError
from basrelief.images import write_bytes
from basrelief.timings import step

_SETTINGS: Mapping[str, Any] = {
    "font.family": "sans-serif",
    "svg.hashsalt": "basrelief",
    # text stays text, which can be searched and copied
    "svg.fonttype": "none",
}
_OPTIONS: Mapping[str, Mapping[str, Any]] = {
    ".svg": {"metadata": {"Date": None}},
    ".png": {"dpi": 150},
    ".pdf": {"metadata": {"CreationDate": None}},
}
"""Options of matplotlib's `savefig` for each file type."""


def has_matplotlib() -> bool:
    """Whether matplotlib is installed."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        return False
    return True


def check_figure(path: Path, what: str) -> None:
    """Raise InputError for a path that is not a figure's; the message calls the figure `what`."""
    if path.suffix.lower() not in _OPTIONS:
        raise InputError(f"{path}: {what} is written as {', '.join(_OPTIONS)}")


def write_figure(
    path: Path,
    size: tuple[float, float],
    draw: Callable[[Any], None],
    settings: Mapping[str, Any],
) -> None:
    """Write the figure that `draw` draws with matplotlib, atomically.

    `size` is (width, height) in inches, `settings` are those of matplotlib (`rcParams`). Raises
    InputError where the file cannot be written.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({**_SETTINGS, **settings})
        figure = Figure(size)
        draw(figure)
        content = io.BytesIO()
        with step("encode"):
            suffix = path.suffix.lower()
            figure.savefig(content, format=suffix[1:], **_OPTIONS[suffix])
        write_bytes(path, content.getvalue)


def legend_mark(**style: Any) -> Any:
    """A legend entry that is not in the plot, in the style of matplotlib's `Line2D`."""
    from matplotlib.lines import Line2D

    return Line2D([], [], **style)
