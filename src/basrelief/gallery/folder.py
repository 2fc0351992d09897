"""The gallery as a folder: pictures, pages, and an index of its pages."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.gallery import PAGES, SOURCES
from basrelief.gallery.drawing import DrawnPanel, draw_panels
from basrelief.gallery.html import GENERATOR, index_html, page_html, picture_name
from basrelief.gallery.page import Page
from basrelief.pages import check_overwritable, is_generated_by, write_page

Progress = Callable[[str, float], None]
"""Progress callback: the current page and the finished share, 0 to 1."""


def chosen(names: Sequence[str] = (), source: str | None = None) -> list[Page]:
    """Select pages by name and by source; all of them without either.

    Raises InputError for an unknown name or source, and where no page is left.
    """
    for name in names:
        if name not in PAGES:
            raise InputError(f"the gallery has no page {name!r}; there are {', '.join(PAGES)}")
    if source is not None and source not in SOURCES:
        raise InputError(f"no source is called {source!r}; there are {', '.join(SOURCES)}")
    pages = [
        page
        for page in PAGES.values()
        if (not names or page.name in names) and source in (None, page.source)
    ]
    if not pages:
        raise InputError(f"none of {', '.join(names)} is after {source}")
    return pages


def write(
    folder: Path,
    pages: Sequence[Page],
    engine: Engine,
    size: tuple[int, int] = (480, 270),
    samples: int = 4,
    progress: Progress = lambda what, share: None,
) -> Path:
    """Draw pages into a folder and return the path of its index, which lists all its pages.

    Only files of the gallery are overwritten. Raises InputError for a folder that cannot be
    written to, and for one with other files of the same names.
    """
    _check_ours(folder, pages)
    in_folder = _folder_pages(folder, pages)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for number, page in enumerate(pages):
            progress(page.title, number / len(pages))
            report = functools.partial(_report_page, progress, page.title, number, len(pages))
            panels = _pictures(folder, page, draw_panels(page, size, samples, engine, report))
            write_page(folder / f"{page.name}.html", page_html(page, panels, in_folder))
        index = folder / "index.html"
        write_page(index, index_html(in_folder))
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{folder}: cannot be written to ({reason}); choose another") from None
    return index


def _report_page(progress: Progress, what: str, before: int, count: int, share: float) -> None:
    """Report the progress of a page as a share of all pages."""
    progress(what, (before + share) / count)


def _pictures(folder: Path, page: Page, panels: Iterable[DrawnPanel]) -> list[DrawnPanel]:
    """Write each picture when it is drawn."""
    drawn = []
    for number, panel in enumerate(panels, 1):
        panel.picture.image.save(folder / picture_name(page, number))
        drawn.append(panel)
    return drawn


def _folder_pages(folder: Path, pages: Sequence[Page]) -> list[Page]:
    """Pages that the folder will have: those to be drawn, and those drawn earlier."""
    return [
        page
        for page in PAGES.values()
        if page in pages or is_generated_by(folder / f"{page.name}.html", GENERATOR)
    ]


def _check_ours(folder: Path, pages: Sequence[Page]) -> None:
    for name in ("index.html", *(f"{page.name}.html" for page in pages)):
        check_overwritable(folder / name, GENERATOR, "a page of the gallery")
