"""Pages and index as HTML: static, no scripts, nothing from the network, light and dark."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from basrelief.gallery.drawing import FRAMES, Drawn
from basrelief.gallery.page import SOURCES, Headline, Page
from basrelief.gallery.settings import settings_of

GENERATOR = "basrelief gallery"
"""What our pages say they were made by; a page that does not say so is not ours."""

_STYLE = """
:root { color-scheme: light dark; --paper: #fbfaf8; --ink: #23262b; --quiet: #5d636c;
  --line: #dddad4; --card: #ffffff; --link: #9a3d1c; }
@media (prefers-color-scheme: dark) { :root { --paper: #16181b; --ink: #e6e4df; --quiet: #a0a5ad;
  --line: #32363c; --card: #1e2125; --link: #f0a27f; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem clamp(1rem, 4vw, 3rem) 3rem; max-width: 96rem;
  background: var(--paper); color: var(--ink); font: 1rem/1.55 system-ui, sans-serif; }
h1 { font-size: clamp(1.5rem, 4vw, 2.1rem); line-height: 1.2; margin: .6rem 0 .2rem; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .7rem; }
p { max-width: 46rem; margin: .5rem 0; }
a { color: var(--link); text-underline-offset: .15em; }
nav { display: flex; flex-wrap: wrap; gap: .3rem 1.4rem; font-size: .92rem; }
.source, .settings, .cost, dt { color: var(--quiet); }
.look { font-size: 1.12rem; }
.grid { display: grid; gap: 1.1rem; margin: 1.2rem 0; padding: 0; list-style: none;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 25rem), 1fr)); }
.index { grid-template-columns: repeat(auto-fill, minmax(min(100%, 15rem), 1fr)); }
figure, .card { margin: 0; background: var(--card); border: 1px solid var(--line);
  border-radius: .5rem; overflow: hidden; }
img { display: block; width: 100%; height: auto; }
figcaption, .card span { display: block; padding: .6rem .8rem .7rem; }
figcaption strong, .settings, .cost { display: block; }
.settings, .cost { font-size: .86rem; line-height: 1.45; }
.cost { font-variant-numeric: tabular-nums; margin-top: .2rem; }
.card { color: inherit; text-decoration: none; display: block; height: 100%; }
.card:hover, .card:focus-visible { border-color: var(--link); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .25rem 1rem; max-width: 60rem; }
dd { margin: 0; }
footer { margin-top: 2.5rem; font-size: .9rem; color: var(--quiet); }
"""


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
    parts = [settings_of(each.panel.scene), each.panel.settings]
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
    return "\n".join(_lines(title, body)) + "\n"


def _lines(title: str, body: str) -> Iterable[str]:
    yield '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">'
    yield '<meta name="viewport" content="width=device-width, initial-scale=1">'
    yield f'<meta name="generator" content="{GENERATOR}">'
    yield f"<title>{escape(title)} · basrelief</title>\n<style>{_STYLE}</style>\n</head>"
    yield f"<body>\n{body}\n</body>\n</html>"
