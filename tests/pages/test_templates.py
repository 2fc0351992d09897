"""Templates escape values, require all of them, and make pages that run no scripts."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
from jinja2 import UndefinedError

from basrelief.gallery.html import GENERATOR
from basrelief.images import write_data
from basrelief.pages import fill
from basrelief.pages.template import _environment
from helpers.browser import chromium
from helpers.repository import REPOSITORY

PACKAGE = REPOSITORY / "src" / "basrelief"
TEMPLATES = sorted(
    path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("templates/*.jinja")
)
INDEX = "gallery/templates/index.html.jinja"


def index(title: str) -> str:
    """A page with a title from the user."""
    return fill(INDEX, generator=GENERATOR, title=title, sections={title: []})


def test_values_are_escaped() -> None:
    text = index("<b>Stone & \"moss\"</b> 'n' more")
    assert text.count("&lt;b&gt;Stone &amp; &#34;moss&#34;&lt;/b&gt; &#39;n&#39; more") == 2
    assert "<b>" not in text


def test_a_missing_value_is_an_error() -> None:
    with pytest.raises(UndefinedError, match="'title' is undefined"):
        fill(INDEX, generator=GENERATOR, sections={})


@pytest.mark.parametrize("template", TEMPLATES)
def test_templates_compile_and_escape_everything(template: str) -> None:
    _environment().get_template(template)
    source = (PACKAGE / template).read_text("utf-8")
    assert not re.search(r"\|\s*safe\b|autoescape", source)


def test_every_package_with_pages_has_templates() -> None:
    assert {name.split("/")[0] for name in TEMPLATES} == {"gallery", "measure", "pages", "viewer"}


def test_html_is_only_in_templates() -> None:
    """No module writes HTML tags as text."""
    tag = re.compile(
        r"""["'{}\s]</?(a|b|body|div|figure|h[1-6]|i|img|p|script|span|table|td)[\s>]"""
    )
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if tag.search(path.read_text("utf-8"))
    }
    assert found == set()


# --- in a browser ---------------------------------------------------------------------------------

ATTACK = """
{% extends "pages/templates/base.html.jinja" %}
{% block body %}
<img id="near" src="near.png"><img id="far" src="{{ elsewhere }}/near.png">
<script>document.title = "ran"</script>
<a id="link" href="javascript:document.title='ran'" onclick="document.title = 'ran'">run</a>
<form action="{{ elsewhere }}"><button id="send">send</button></form>
{% endblock %}
"""


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def served(tmp_path: Path) -> Iterator[list[str]]:
    """Addresses of two servers of a folder with a picture, one of them foreign."""
    write_data(tmp_path / "near.png", np.full((2, 3, 3), 200, np.uint8))
    servers = [
        ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path)))
        for _ in range(2)
    ]
    for server in servers:
        Thread(target=server.serve_forever, daemon=True).start()
    yield [f"http://127.0.0.1:{server.server_port}" for server in servers]
    for server in servers:
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(()) as opened:
        yield opened


@pytest.mark.parametrize("scheme", ["file", "http"])
def test_a_static_page_shows_its_pictures_and_runs_no_script(
    scheme: str, browser: Any, served: list[str], tmp_path: Path
) -> None:
    """From disk and from a server: only its own pictures, no scripts, no other server."""
    here, elsewhere = served
    template = _environment().from_string(ATTACK)
    values = {"generator": GENERATOR, "title": "still", "elsewhere": elsewhere}
    (tmp_path / "page.html").write_text(template.render(values), "utf-8")
    page = browser.new_page()
    refused: list[str] = []
    page.on("console", lambda message: refused.append(message.text))
    page.goto(f"file://{tmp_path}/page.html" if scheme == "file" else f"{here}/page.html")
    width = "id => document.getElementById(id).naturalWidth"
    assert page.evaluate(width, "near") == 3
    assert page.evaluate(width, "far") == 0
    page.click("#link")
    assert page.evaluate("document.title") == "still · basrelief"
    assert page.evaluate("getComputedStyle(document.body).maxWidth") == "1536px"
    # not by the mouse: Playwright would wait for a page that never opens
    page.evaluate("document.getElementById('send').click()")
    page.wait_for_timeout(50)
    messages = "\n".join(refused)
    for directive in ("img-src", "script-src", "form-action"):
        assert directive in messages
    page.close()
