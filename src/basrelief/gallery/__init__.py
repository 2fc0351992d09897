"""The gallery: the comparisons of the five articles, as pages with pictures.

Each file of `examples` is one page and an example of the library in Python; new files are found
automatically. Read `page.py` first.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator

from basrelief.gallery import examples
from basrelief.gallery.page import SOURCES, Headline, Page, Panel

__all__ = ["PAGES", "SOURCES", "Headline", "Page", "Panel"]


def _example_pages() -> Iterator[Page]:
    for file in pkgutil.iter_modules(examples.__path__):
        page: Page = importlib.import_module(f"{examples.__name__}.{file.name}").PAGE
        yield page


def _sort_key(page: Page) -> tuple[int, int, str]:
    """Sort key of a page: its source, then its first row."""
    first = next(iter(page.rows))
    return [*SOURCES].index(page.source), int(first[1:]), page.name


PAGES: dict[str, Page] = {page.name: page for page in sorted(_example_pages(), key=_sort_key)}
"""The pages by name, in the order of the articles."""
