"""The gallery as a folder: pictures, pages, and an index of the pages that are there."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.gallery import PAGES, SOURCES
from basrelief.gallery.drawing import Drawn, drawn
from basrelief.gallery.html import GENERATOR, index_html, page_html, picture_name
from basrelief.gallery.page import Page
from basrelief.pages import check_overwritable, is_generated_by, write_page

Progress = Callable[[str, float], None]
"""Hears what is being drawn, and the share of the whole that is done."""


def chosen(names: Sequence[str] = (), source: str | None = None) -> list[Page]:
    """Pages by name and by source; all of them where neither is asked for.

    Raises InputError for a name or a source that is not there, and where nothing is left.
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
    """Draw pages into a folder and return the path of its index, which lists all pages there.

    Only files of the gallery are written over. Raises InputError for a folder that cannot be
    written to, and for one with pages of the same names that are not ours.
    """
    _check_ours(folder, pages)
    here = _beside(folder, pages)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for number, page in enumerate(pages):
            progress(page.title, number / len(pages))
            heard = functools.partial(_passed_on, progress, page.title, number, len(pages))
            panels = _pictures(folder, page, drawn(page, size, samples, engine, heard))
            write_page(folder / f"{page.name}.html", page_html(page, panels, here))
        index = folder / "index.html"
        write_page(index, index_html(here))
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{folder}: cannot be written to ({reason}); choose another") from None
    return index


def _passed_on(progress: Progress, what: str, before: int, count: int, share: float) -> None:
    """A page's own progress as a share of all pages."""
    progress(what, (before + share) / count)


def _pictures(folder: Path, page: Page, panels: Iterable[Drawn]) -> list[Drawn]:
    """Write each picture as soon as it is drawn."""
    made = []
    for number, each in enumerate(panels, 1):
        each.picture.image.save(folder / picture_name(page, number))
        made.append(each)
    return made


def _beside(folder: Path, pages: Sequence[Page]) -> list[Page]:
    """The pages that the folder will have: those about to be drawn, and ours from before."""
    return [
        page
        for page in PAGES.values()
        if page in pages or is_generated_by(folder / f"{page.name}.html", GENERATOR)
    ]


def _check_ours(folder: Path, pages: Sequence[Page]) -> None:
    for name in ("index.html", *(f"{page.name}.html" for page in pages)):
        check_overwritable(folder / name, GENERATOR, "a page of the gallery")
