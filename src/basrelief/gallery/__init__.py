"""The gallery: every comparison that the five articles show, as pages with pictures.

Each file of `examples` is one page, and an example of how to use the library from Python; a file
that is put there is found. Read `page.py` first.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator

from basrelief.gallery import examples
from basrelief.gallery.page import SOURCES, Headline, Page, Panel

__all__ = ["PAGES", "SOURCES", "Headline", "Page", "Panel"]


def _found() -> Iterator[Page]:
    for file in pkgutil.iter_modules(examples.__path__):
        page: Page = importlib.import_module(f"{examples.__name__}.{file.name}").PAGE
        yield page


def _place(page: Page) -> tuple[int, int, str]:
    """Where a page stands: by its source, and there by its first row."""
    first = next(iter(page.rows))
    return [*SOURCES].index(page.source), int(first[1:]), page.name


PAGES: dict[str, Page] = {page.name: page for page in sorted(_found(), key=_place)}
"""The pages by name, in the order of the articles."""
