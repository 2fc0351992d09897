"""The text of docs/gallery.md: what each page shows, and what the article shows."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterator
from pathlib import Path

from basrelief.gallery import PAGES, SOURCES
from basrelief.gallery.page import Page, heading

_HEAD = """\
# The gallery

`basrelief gallery OUT` draws the comparisons of the five articles as pages with pictures, settings
and costs. Each page is one file of `src/basrelief/gallery/examples`, an example of the library in
Python. The strips below are the golden pictures that tests compare with, at a small size. This text
is generated from those files by `scripts/goldens`.
"""


def text() -> str:
    """The document in Markdown."""
    return "\n".join([_HEAD, *_sections()])


def _sections() -> Iterator[str]:
    for source, title in SOURCES.items():
        yield f"## {heading(source)}\n\n{title}.\n"
        for page in PAGES.values():
            if page.source == source:
                yield "\n".join(_section(page))


def _section(page: Page) -> Iterator[str]:
    file = Path(inspect.getfile(page.panels)).name
    yield f"### {page.name}\n"
    yield _wrapped(f"**{page.title}.** {page.look}")
    yield f"![{page.title}](../tests/golden/{page.name}.png)\n"
    yield _wrapped(f"*The article:* {page.article}")
    yield _wrapped(f"*Here:* {page.ours}")
    for row, how in page.rows.items():
        yield textwrap.fill(f"- {row}: {how}", 98, subsequent_indent="  ")
    yield f"\n[The example](../src/basrelief/gallery/examples/{file})\n"


def _wrapped(paragraph: str) -> str:
    return textwrap.fill(paragraph, 100, break_on_hyphens=False, break_long_words=False) + "\n"
