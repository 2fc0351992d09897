"""Pages and index as HTML, without scripts and network, in light and dark colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from basrelief.gallery.drawing import FRAMES, DrawnPanel
from basrelief.gallery.page import SOURCES, Page
from basrelief.gallery.settings import settings_of
from basrelief.pages import fill

GENERATOR = "basrelief gallery"
"""Generator tag by which pages of the gallery are recognised."""


class Figure(NamedTuple):
    """A picture of a page: its file and the lines below it."""

    file: str
    caption: str
    settings: str
    cost: str
    command: str


class Card(NamedTuple):
    """Entry of a page in the index."""

    name: str
    title: str
    picture: str


def picture_name(page: Page, number: int) -> str:
    """File name of a page's picture, counted from 1."""
    return f"{page.name}-{number}.png"


def page_html(page: Page, panels: Sequence[DrawnPanel], in_folder: Sequence[Page]) -> str:
    """A page with its pictures; `in_folder` are all pages of the folder, for navigation."""
    first = panels[0].frame
    height, width = first.distance.shape
    place = [other.name for other in in_folder].index(page.name)
    return fill(
        "gallery/templates/page.html.jinja",
        generator=GENERATOR,
        title=page.title,
        page=page,
        origin=_origin(page),
        before=in_folder[place - 1] if place > 0 else None,
        after=in_folder[place + 1] if place + 1 < len(in_folder) else None,
        figures=[_figure(page, n, panel) for n, panel in enumerate(panels, 1)],
        frames=FRAMES,
        size=(width, height),
        device=first.device,
    )


def index_html(pages: Sequence[Page]) -> str:
    """The index: pages by source, each with its first picture."""
    sections = {
        title: [_card(page) for page in pages if page.source == source]
        for source, title in SOURCES.items()
    }
    return fill(
        "gallery/templates/index.html.jinja",
        generator=GENERATOR,
        title="Gallery",
        sections={title: cards for title, cards in sections.items() if cards},
    )


def _origin(page: Page) -> str:
    """The source of a page in words."""
    title = SOURCES[page.source]
    return title if page.source == "beyond" else f"After {title}"


def _card(page: Page) -> Card:
    return Card(page.name, page.title, picture_name(page, 1))


def _figure(page: Page, number: int, drawn: DrawnPanel) -> Figure:
    parts = [settings_of(drawn.panel.scene), drawn.panel.settings, drawn.picture.meaning]
    settings = " · ".join(part for part in parts if part)
    return Figure(
        picture_name(page, number), drawn.panel.caption, settings, _cost(page, drawn), drawn.command
    )


def _cost(page: Page, drawn: DrawnPanel) -> str:
    cost = f"{_reads(drawn.reads)} · {_time(drawn.seconds)}"
    if drawn.headline_seconds is not None and page.headline is not None:
        wide, high = page.headline.size
        rate = f"{1.0 / drawn.headline_seconds:.3g} frames a second"
        cost += f" · at {wide} × {high}: {_time(drawn.headline_seconds)}, {rate}"
    return cost


def _reads(reads: float) -> str:
    """Reads in words; exact numbers without a decimal point."""
    return (
        f"{reads:.0f} read{'' if reads == 1 else 's'}" if reads % 1 == 0 else f"{reads:.1f} reads"
    )


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"
