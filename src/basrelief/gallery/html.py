"""Pages and index as HTML: static, no scripts, nothing from the network, light and dark."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from basrelief.gallery.drawing import FRAMES, Drawn
from basrelief.gallery.page import SOURCES, Headline, Page
from basrelief.gallery.settings import settings_of
from basrelief.pages import document

GENERATOR = "basrelief gallery"
"""What our pages say they were made by; a page that does not say so is not ours."""


def picture_name(page: Page, number: int) -> str:
    """The file of a page's picture, counted from 1."""
    return f"{page.name}-{number}.png"


def _origin(page: Page) -> str:
    """What a page is after."""
    title = SOURCES[page.source]
    return title if page.source == "beyond" else f"After {title}"


def page_html(page: Page, panels: Sequence[Drawn], beside: Sequence[Page]) -> str:
    """A page with its pictures; `beside` are all pages of the folder, for the way on."""
    first = panels[0].frame
    height, width = first.depth.shape
    figures = "\n".join(_figure(page, n, each) for n, each in enumerate(panels, 1))
    rows = "\n".join(f"<dt>{row}</dt><dd>{escape(how)}.</dd>" for row, how in page.rows.items())
    body = f"""{_way(page, beside)}
<h1>{escape(page.title)}</h1>
<p class="source">{escape(_origin(page))}</p>
<p class="look">{escape(page.look)}</p>
{_headline(page.headline)}
<div class="grid">
{figures}
</div>
<h2>{"What is said of it" if page.source == "beyond" else "What the article shows"}</h2>
<p>{escape(page.article)}</p>
<h2>What these pictures show</h2>
<p>{escape(page.ours)}</p>
<h2>What is at work</h2>
<dl>
{rows}
</dl>
<footer><p>Reads are of heights, the mean over the pixels that are covered, self-shadows included.
Times are the median of {FRAMES} frames of {width} × {height} pixels with one sample each, shadow
maps included, as Python gets them: {escape(first.engine)}.</p></footer>"""
    return _document(page.title, body)


def index_html(pages: Sequence[Page]) -> str:
    """All pages by their sources, each with its first picture."""
    parts = ["<h1>Parallax mapping, compared</h1>"]
    parts.append("<p>Every comparison that five articles show, drawn by basrelief.</p>")
    for source, title in SOURCES.items():
        cards = "\n".join(_card(page) for page in pages if page.source == source)
        if cards:
            parts.append(f'<h2>{escape(title)}</h2>\n<ul class="grid index">\n{cards}\n</ul>')
    return _document("Gallery", "\n".join(parts))


def _figure(page: Page, number: int, each: Drawn) -> str:
    height, width = each.frame.depth.shape
    name, caption = picture_name(page, number), escape(each.panel.caption)
    parts = [settings_of(each.panel.scene), each.panel.settings, each.picture.meaning]
    settings = escape(" · ".join(part for part in parts if part))
    cost = f"{_reads(each.reads)} · {_time(each.seconds)}"
    if each.headline_seconds is not None and page.headline is not None:
        wide, high = page.headline.size
        rate = f"{1.0 / each.headline_seconds:.3g} frames a second"
        cost += f" · at {wide} × {high}: {_time(each.headline_seconds)}, {rate}"
    return f"""<figure>
<a href="{name}"><img src="{name}" width="{width}" height="{height}" loading="lazy"
alt="{escape(page.title)}: {caption}"></a>
<figcaption><strong>{caption}</strong><span class="settings">{settings}</span>
<span class="cost">{cost}</span></figcaption>
</figure>"""


def _reads(reads: float) -> str:
    """Whole numbers as such, so that none and one read are seen to be exact."""
    return (
        f"{reads:.0f} read{'' if reads == 1 else 's'}" if reads % 1 == 0 else f"{reads:.1f} reads"
    )


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"


def _headline(headline: Headline | None) -> str:
    if headline is None:
        return ""
    wide, high = headline.size
    return f"<p>The article, at {wide} × {high}: {escape(headline.figure)}. Ours stand below.</p>"


def _way(page: Page, beside: Sequence[Page]) -> str:
    """Links to the index, the page before and the page after."""
    names = [each.name for each in beside]
    here = names.index(page.name)
    links = ['<a href="index.html">All comparisons</a>']
    if here > 0:
        links.append(f'<a href="{names[here - 1]}.html">← {escape(beside[here - 1].title)}</a>')
    if here + 1 < len(names):
        links.append(f'<a href="{names[here + 1]}.html">{escape(beside[here + 1].title)} →</a>')
    return f"<nav>{''.join(links)}</nav>"


def _card(page: Page) -> str:
    image = f'<img src="{picture_name(page, 1)}" loading="lazy" alt="">'
    shown = f"<span>{escape(page.title)}</span>"
    return f'<li><a class="card" href="{page.name}.html">{image}{shown}</a></li>'


def _document(title: str, body: str) -> str:
    return document(title, body, GENERATOR)
