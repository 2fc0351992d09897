"""Pages of HTML: static, no scripts, nothing from the network, light and dark.

What the gallery and comparisons share: the style, the document around a body, and how a page is
written without touching one that is not ours.
"""

from __future__ import annotations

from html import escape
from pathlib import Path

from basrelief.errors import InputError
from basrelief.images import write_whole

__all__ = ["STYLE", "check_ours", "document", "is_ours", "write_page"]

STYLE = """
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


def document(title: str, body: str, generator: str, style: str = "") -> str:
    """A whole page; `generator` says what it was made by, `style` is added to the common one."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="{generator}">
<title>{escape(title)} · basrelief</title>
<style>{STYLE}{style}</style>
</head>
<body>
{body}
</body>
</html>
"""


def is_ours(file: Path, generator: str) -> bool:
    """Whether a file is a page that says it was made by `generator`."""
    return file.is_file() and generator in file.read_text(encoding="utf-8", errors="replace")


def check_ours(file: Path, generator: str, what: str) -> None:
    """Raise InputError where there is a file that is not ours; `what` says what ours would be."""
    if file.is_dir():
        raise InputError(f"{file}: is a folder; name a file in it, as {file / 'page.html'}")
    if file.exists() and not is_ours(file, generator):
        raise InputError(f"{file}: is there, and not {what}; choose another name or folder")


def write_page(file: Path, text: str) -> None:
    """Write a page, whole or not at all; raises InputError where it cannot be written."""
    write_whole(file, lambda partial: _write(partial, text))


def _write(partial: Path, text: str) -> None:
    partial.write_text(text, "utf-8", newline="\n")
