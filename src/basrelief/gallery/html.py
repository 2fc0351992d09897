"""Pages and index as HTML: static, no scripts, nothing from the network, light and dark."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from basrelief.gallery.drawing import FRAMES, Drawn
from basrelief.gallery.page import SOURCES, Page
from basrelief.gallery.settings import settings_of
from basrelief.pages import fill

GENERATOR = "basrelief gallery"
"""What our pages say they were made by; a page that does not say so is not ours."""


class Figure(NamedTuple):
    """A picture of a page, by its file, and the lines below it."""

    file: str
    caption: str
    settings: str
    cost: str


class Card(NamedTuple):
    """A page as the index shows it."""

    name: str
    title: str
    picture: str


def picture_name(page: Page, number: int) -> str:
    """The file of a page's picture, counted from 1."""
    return f"{page.name}-{number}.png"


def page_html(page: Page, panels: Sequence[Drawn], beside: Sequence[Page]) -> str:
    """A page with its pictures; `beside` are all pages of the folder, for the way on."""
    first = panels[0].frame
    height, width = first.distance.shape
    here = [each.name for each in beside].index(page.name)
    return fill(
        "gallery/templates/page.html.jinja",
        generator=GENERATOR,
        title=page.title,
        page=page,
        origin=_origin(page),
        before=beside[here - 1] if here > 0 else None,
        after=beside[here + 1] if here + 1 < len(beside) else None,
        figures=[_figure(page, n, each) for n, each in enumerate(panels, 1)],
        frames=FRAMES,
        size=(width, height),
        device=first.device,
    )


def index_html(pages: Sequence[Page]) -> str:
    """All pages by their sources, each with its first picture."""
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
    """What a page is after."""
    title = SOURCES[page.source]
    return title if page.source == "beyond" else f"After {title}"


def _card(page: Page) -> Card:
    return Card(page.name, page.title, picture_name(page, 1))


def _figure(page: Page, number: int, each: Drawn) -> Figure:
    parts = [settings_of(each.panel.scene), each.panel.settings, each.picture.meaning]
    settings = " · ".join(part for part in parts if part)
    return Figure(picture_name(page, number), each.panel.caption, settings, _cost(page, each))


def _cost(page: Page, each: Drawn) -> str:
    cost = f"{_reads(each.reads)} · {_time(each.seconds)}"
    if each.headline_seconds is not None and page.headline is not None:
        wide, high = page.headline.size
        rate = f"{1.0 / each.headline_seconds:.3g} frames a second"
        cost += f" · at {wide} × {high}: {_time(each.headline_seconds)}, {rate}"
    return cost


def _reads(reads: float) -> str:
    """Whole numbers as such, so that none and one read are seen to be exact."""
    return (
        f"{reads:.0f} read{'' if reads == 1 else 's'}" if reads % 1 == 0 else f"{reads:.1f} reads"
    )


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"
