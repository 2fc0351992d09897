"""The documentation's site is built without warnings, and all of its links have targets."""

from __future__ import annotations

import functools
import importlib
import json
import os
import re
import runpy
import subprocess
import sys
import threading
import tomllib
import zlib
from collections.abc import Iterator
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

from basrelief.engine.cache import cache_folder
from basrelief.techniques import TECHNIQUES
from helpers.browser import SOFTWARE, WITHOUT, chromium
from helpers.repository import REPOSITORY

SOURCES = REPOSITORY / "docs" / "site"
LIVE = sorted(
    page.stem for page in (REPOSITORY / "docs" / "techniques").glob("*.md")
    if page.stem != "horizon"  # a bake, not a technique
)  # fmt: skip
"""The pages that embed the viewer."""
PUBLIC = ("basrelief", "basrelief.techniques", "basrelief.baking", "basrelief.viewer")
LARGEST = 1_500_000
"""Largest size of the viewer's page in bytes, so that it loads quickly."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, as `scripts/docs` builds it."""
    folder = tmp_path_factory.mktemp("site") / "site"
    command = [sys.executable, str(SOURCES / "build.py"), str(folder)]
    variables = {**os.environ, "BASRELIEF_CACHE": str(cache_folder())}
    build = subprocess.run(command, capture_output=True, text=True, timeout=300, env=variables)
    assert build.returncode == 0, build.stdout + build.stderr
    assert "warning" not in (build.stdout + build.stderr).lower()
    return folder


class Page(HTMLParser):
    """The anchors of a page, its links, its resources and the addresses of its viewers."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: set[str] = set()
        self.loaded: set[str] = set()
        self.live: list[str] = []
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.ids |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.add(values["href"])
        if "src" in values:
            self.loaded.add(values["src"])
        if tag == "link" and values.get("rel") in ("stylesheet", "icon", "preload", "preconnect"):
            self.loaded.add(values["href"])
        if tag == "iframe":
            self.live.append(values["data-src"])


@functools.cache
def read(file: Path) -> Page:
    return Page(file)


def pages(site: Path) -> list[Path]:
    """All pages except the viewer's and the error page."""
    files = sorted(site.rglob("*.html"))
    return [file for file in files if file.parent.name != "live" and file.name != "404.html"]


def navigation(entries: Any) -> Iterator[str]:
    """The files that the navigation names."""
    for entry in entries:
        for value in entry.values():
            yield from [value] if isinstance(value, str) else navigation(value)


# --- the table of settings ------------------------------------------------------------------------


def test_the_table_of_settings_is_that_of_the_declarations() -> None:
    """After a change of a setting, run `scripts/docs`."""
    scope = runpy.run_path(str(SOURCES / "settings.py"))
    assert scope["PAGE"].read_text(encoding="utf-8") == scope["text"]()


# --- pages ----------------------------------------------------------------------------------------


def test_the_navigation_names_every_page(site: Path) -> None:
    config = tomllib.loads((SOURCES / "zensical.toml").read_text())
    named = [name.removesuffix(".md") for name in navigation(config["project"]["nav"])]
    names = [file.relative_to(site).with_suffix("").as_posix() for file in pages(site)]
    assert sorted(named) == sorted(name for name in names if not name.startswith("source/"))


def broken_links(site: Path) -> list[str]:
    """The links within a site without a target file or anchor."""
    broken = []
    for file in pages(site):
        page = read(file)
        for link in page.links | page.loaded | set(page.live):
            parts = urlsplit(link)
            if parts.scheme:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            # what follows the # of a viewer's page are settings
            anchor = "" if link in page.live else unquote(parts.fragment)
            if not target.is_file() or (anchor and anchor not in read(target).ids):
                broken.append(f"{file.relative_to(site)}: {link}")
    return broken


def test_every_link_has_a_target(site: Path) -> None:
    assert broken_links(site) == []


def test_broken_links_are_found(tmp_path: Path) -> None:
    """The check above can fail."""
    (tmp_path / "a.html").write_text('<a href="b.html#no"><a href="c.html"><img src="d.png">')
    (tmp_path / "b.html").write_text('<h1 id="e"><a href="#e"><a href="a.html"><a href="#f">')
    assert sorted(broken_links(tmp_path)) == [
        "a.html: b.html#no", "a.html: c.html", "a.html: d.png", "b.html: #f",
    ]  # fmt: skip


def test_pages_load_nothing_from_other_servers(site: Path) -> None:
    """A page is complete without a network; only its links may lead to other servers."""
    loaded = {link for file in pages(site) for link in read(file).loaded}
    assert {link for link in loaded if re.match(r"(\w+:)?//", link)} == set()
    styles = "".join(file.read_text() for file in site.rglob("*.css"))
    assert re.findall(r"(?:url\(|@import )\W?(?:https?:)?//[^)]*", styles) == []


def test_the_search_finds_techniques(site: Path) -> None:
    index = json.loads((site / "search.json").read_text())
    places = [item["location"] for item in index["items"]]
    assert len(places) > 200
    assert {f"techniques/{name}.html" for name in LIVE} <= {text.split("#")[0] for text in places}
    assert not [text for text in places if text.startswith("source/")]


# --- the reference --------------------------------------------------------------------------------


@pytest.mark.parametrize("package", PUBLIC)
def test_the_reference_has_every_public_name(package: str, site: Path) -> None:
    """A module of the same name does not count."""
    stored = (site / "objects.inv").read_bytes()
    lines = zlib.decompress(stored[stored.index(b"zlib.\n") + 6 :]).decode().splitlines()
    described = {line.split()[0] for line in lines if " py:module " not in line}
    module = importlib.import_module(package)
    missing = []
    for name in module.__all__:
        owners = {package, getattr(getattr(module, name), "__module__", package)}
        if not any(f"{owner}.{name}" in described for owner in owners):
            missing.append(name)
    assert missing == []


# --- the viewer -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LIVE)
def test_pages_of_techniques_embed_the_viewer(name: str, site: Path) -> None:
    """The viewer, which shows the technique, and a still picture for browsers without WebGPU."""
    file = site / "techniques" / f"{name}.html"
    page = read(file)
    (source,) = page.live
    shown = json.loads(unquote(urlsplit(source).fragment) or "{}").get("technique", "relief")
    assert shown == name
    assert (file.parent / urlsplit(source).path).stat().st_size < LARGEST
    assert any(link.endswith(f"technique-{name}.png") for link in page.loaded)


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    """Address at which the site is served."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *words: object) -> None:
            pass

    handler = functools.partial(Quiet, directory=str(site))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


def test_the_viewer_draws_within_a_page(address: str) -> None:
    """It shows the technique and the settings of the command above it."""
    with chromium(SOFTWARE) as browser:
        page = browser.new_page()
        errors: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(f"{address}/techniques/cone.html")
        page.locator("figure.live iframe").scroll_into_view_if_needed()
        page.wait_for_timeout(500)
        (frame,) = (frame for frame in page.frames if "/live/" in frame.url)
        frame.wait_for_function("window.viewer?.drawn")
        state = frame.evaluate("viewer.state")
        assert state["technique"] == "cone"
        assert state["settings"]["cone"]["steps"] == 10
        assert state["reference_height"] == TECHNIQUES["cone"].reference_height
        assert state["camera"]["azimuth"] == 25
        assert not page.locator("figure.live img").is_visible()
        assert errors == []


def test_without_webgpu_the_still_picture_stays(address: str) -> None:
    with chromium(WITHOUT) as browser:
        page = browser.new_page()
        page.goto(f"{address}/techniques/cone.html", wait_until="networkidle")
        assert page.locator("figure.live img").is_visible()
        assert not page.locator("figure.live iframe").is_visible()
        assert not [frame for frame in page.frames if "/live/" in frame.url]
