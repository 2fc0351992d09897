"""The gallery: pages against golden pictures on both engines, its folder, its coverage.

A picture may differ from the golden one by more than 2 ÷ 255 at 0.5 % of its pixels: at outlines
and layers, where rounding decides between two hits.
"""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.gallery import PAGES, SOURCES, Page
from basrelief.gallery.drawing import seconds_of
from basrelief.gallery.folder import chosen, write
from basrelief.images import read_picture, srgb_encode
from basrelief.measure.colors import PASSED
from basrelief.rendering.render import render
from helpers import goldens
from helpers.command_line import done, refused
from helpers.features import COUNTS
from helpers.goldens import GOLDEN, SIZE, fraction_different, golden, panels_of, strip
from helpers.repository import commands

MAX_SHARE_APART = 0.005
NOT_SHOWN = {"C20"}
"""The viewer's panel, which has no picture."""
FEW = ["strength", "cube"]
VOID = {"img", "meta", "br", "link", "input", "hr"}


def assert_like_golden(page: Page, drawn: np.ndarray) -> None:
    expected = golden(page.name)
    assert drawn.shape == expected.shape, f"{page.name} has other panels; see scripts/goldens"
    share = fraction_different(drawn, expected)
    assert share <= MAX_SHARE_APART, (
        f"{page.name}: {share:.2%} of the pixels differ from its golden"
    )


# --- pictures -------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES.values(), ids=list(PAGES))
def test_pages_equal_their_golden_pictures(page: Page) -> None:
    assert_like_golden(page, strip(page, "cpu"))


@pytest.mark.gpu
@pytest.mark.parametrize("page", PAGES.values(), ids=list(PAGES))
def test_pages_on_the_gpu_equal_the_golden_pictures(page: Page) -> None:
    assert_like_golden(page, strip(page, "gpu"))


def test_a_changed_picture_is_found() -> None:
    """A slightly brighter panel, a panel shifted by a pixel, a missing panel."""
    page, width = PAGES["strength"], SIZE[0]
    expected = golden(page.name)
    assert_like_golden(page, expected)
    brighter, moved = expected.copy(), expected.copy()
    brighter[:, :width] = np.minimum(brighter[:, :width], 250) + 4
    moved[:, :width] = np.roll(moved[:, :width], 1, axis=1)
    for changed in (brighter, moved):
        with pytest.raises(AssertionError, match="pixels differ"):
            assert_like_golden(page, changed)
    with pytest.raises(AssertionError, match="other panels"):
        assert_like_golden(page, expected[:, width:])


def test_panels_of_a_page_differ() -> None:
    """No panel is blank, and no two are equal but those listed here."""
    same = {("scaled", 0, 1)}
    for page in PAGES.values():
        panels = panels_of(golden(page.name))
        assert len(panels) == len([*page.panels(8)])
        for n, one in enumerate(panels):
            assert one.std() > 10.0, f"{page.name}: panel {n + 1} shows nothing"
            for m, other in enumerate(panels[n + 1 :], n + 1):
                alike = fraction_different(one, other) < 0.005
                assert alike == ((page.name, n, m) in same), f"{page.name}: {n + 1} and {m + 1}"


def test_a_missing_golden_names_the_command_that_draws_it() -> None:
    with pytest.raises(AssertionError, match=r"nowhere has no golden picture.*scripts/goldens"):
        golden("nowhere")


def test_every_golden_has_a_page_and_all_are_small() -> None:
    files = [*GOLDEN.iterdir()]
    assert {file.name for file in files} == {f"{name}.png" for name in PAGES}
    assert sum(file.stat().st_size for file in files) < 4 * 2**20


def test_reads_are_those_of_the_techniques() -> None:
    """No reads without strength, one for an offset, at most the maximum for a march,
    and one more for the chord on the lowest ground."""
    frames = {
        name: [
            render(panel.scene, size=SIZE, samples=1, device=goldens.engine("cpu"))
            for panel in PAGES[name].panels(64)
        ]
        for name in ("strength", "normal-map", "march")
    }
    assert [frame.mean_reads for frame in frames["strength"]] == [0.0, 1.0, 1.0, 1.0]
    assert not any(frame.reads.any() for frame in frames["normal-map"])
    assert [int(frame.reads.max()) <= maximum for frame, maximum in zip(
        frames["march"], (1, 10, 100, 11, 13), strict=True
    )] == [True] * 5  # fmt: skip


# --- texts of pages -------------------------------------------------------------------------------


def test_every_row_of_the_sources_is_on_a_page() -> None:
    rows = {f"{letter}{n + 1}" for letter in "CWGHL" for n in range(COUNTS[letter])}
    ours = [page for page in PAGES.values() if page.source != "beyond"]
    on_pages = {row for page in ours for row in page.rows}
    assert on_pages == rows - NOT_SHOWN


def test_pages_have_all_texts() -> None:
    for name, page in PAGES.items():
        assert page.name == name
        assert re.fullmatch(r"[a-z0-9-]+", name)
        assert page.source in SOURCES
        assert page.look.endswith(".")
        assert page.look.count(". ") == 0, f"{name}: one sentence on what to look at"
        assert all((page.title, page.article, page.ours))


def test_the_document_is_up_to_date() -> None:
    from basrelief.gallery.document import text

    assert goldens.DOCUMENT.read_text(encoding="utf-8") == text(), "run scripts/goldens"


# --- the folder -----------------------------------------------------------------------------------


class Reader(HTMLParser):
    """A page's tags, checked to be closed in order, its pictures and its links."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.open: list[str] = []
        self.pictures: list[str] = []
        self.links: list[str] = []
        self.tags: set[str] = set()
        self.feed(file.read_text(encoding="utf-8"))
        self.close()
        assert not self.open, f"{file.name}: {self.open} left open"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        self.tags.add(tag)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "img":
            assert "alt" in attributes, f"no alt: {attributes}"
            self.pictures.append(attributes["src"] or "")
        if "href" in attributes:
            self.links.append(attributes["href"] or "")

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small gallery of some pages, one of them with a headline."""
    path = tmp_path_factory.mktemp("gallery") / "deep" / "down"
    shares: list[float] = []
    index = write(
        path,
        chosen(FEW),
        choose_device("cpu"),
        (48, 27),
        1,
        lambda what, share: shares.append(share),
    )
    assert index == path / "index.html"
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    return path


def test_pages_are_well_formed_and_self_contained(folder: Path) -> None:
    for name in (*FEW, "index"):
        page = Reader(folder / f"{name}.html")
        assert page.pictures
        assert {"title", "h1", "style"} <= page.tags
        assert not {"script", "link", "iframe"} & page.tags
        for target in page.pictures + page.links:
            assert (folder / target).is_file(), f"{name} names {target}"
        text = (folder / f"{name}.html").read_text(encoding="utf-8")
        assert "http" not in text.replace("http-equiv", "")


def test_a_page_has_its_panels_with_settings_and_costs(folder: Path) -> None:
    text = (folder / "cube.html").read_text(encoding="utf-8")
    panels = [*PAGES["cube"].panels(8)]
    assert text.count("<figure>") == len(panels) == 4
    assert all(panel.caption in text for panel in panels)
    assert "max steps 20" in text
    assert "0 reads · " in text
    assert re.search(r"at 640 × 480: [\d.e+]+ ms, [\d.e+]+ frames a second", text)
    assert "over 60 frames a second" in text
    assert "cpu: " in text
    assert read_picture(folder / "cube-1.png").pixels.shape[:2] == (27, 48)


def test_panels_are_timed_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first frame of each panel warms up; the median of the others counts."""
    now, order = [0.0], []
    takes = {"slow": iter([9.0, 5.0, 5.0, 40.0, 5.0, 5.0]), "fast": iter([7.0] + [2.0] * 5)}

    def draw(scene: str, **options: object) -> None:
        order.append(scene)
        now[0] += next(takes[scene])

    monkeypatch.setattr("basrelief.gallery.drawing.render", draw)
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    assert seconds_of(["slow", "fast"], SIZE, choose_device("cpu")) == [5.0, 2.0]  # type: ignore[list-item]
    assert order == ["slow", "fast"] * 6


def test_pages_explain_the_colours_of_debug_pictures(tmp_path: Path) -> None:
    write(tmp_path, chosen(["errors"]), choose_device("cpu"), (32, 18), 1)
    text = (tmp_path / "errors.html").read_text(encoding="utf-8")
    meanings = (
        "heights read in a pixel",
        "orange: passed",
        "uv overshoot, from",
        "depth error, from",
    )
    assert [text.count(meaning) for meaning in meanings] == [1, 2, 1, 1]
    orange = np.rint(srgb_encode(np.array(PASSED)) * 255.0)
    color, missed = (read_picture(tmp_path / f"errors-{n}.png").pixels for n in (1, 3))
    assert (missed == orange).all(-1).mean() > 0.1
    assert not (color == orange).all(-1).any()


def test_the_reader_can_fail(tmp_path: Path) -> None:
    for text in ("<p><b></p></b>", "<p>", "</p>", '<img src="a.png">'):
        (tmp_path / "a.html").write_text(text)
        with pytest.raises(AssertionError):
            Reader(tmp_path / "a.html")


def test_only_files_of_the_gallery_are_overwritten(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    command = ["gallery", tmp_path, "--device", "cpu", "--size", "32x18", "--samples", "1"]
    assert done(*command, "--only", "clamped") == f"{tmp_path}/index.html\n"
    # a second run adds a page to the index and keeps the first
    done(*command, "--only", "normal-map")
    assert (tmp_path / "notes.txt").read_text() == "mine"
    links = Reader(tmp_path / "index.html").links
    assert links == ["normal-map.html", "clamped.html"]
    (tmp_path / "index.html").write_text("<p>mine</p>")
    assert "index.html: exists and is not a page of the gallery" in refused(*command)
    assert (tmp_path / "index.html").read_text() == "<p>mine</p>"


def test_commands_that_pages_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def record(folder: Path, pages: list[Page], engine: object, *numbers: object) -> Path:
        calls.append((len(pages), numbers[:2]))
        return folder / "index.html"

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("basrelief.gallery.folder.write", record)
    for line in commands("docs/command-line.md"):
        if line.startswith("basrelief gallery"):
            assert done(*line.split()[1:]) == "OUT/index.html\n"
    of_halliwell = sum(page.source == "halliwell" for page in PAGES.values())
    small, large = ((480, 270), 4), ((960, 540), 16)
    assert calls == [(len(PAGES), small), (of_halliwell, small), (2, large)]


def test_impossible_requests_are_refused(tmp_path: Path) -> None:
    assert "the gallery has no page 'cubes'; there are" in refused(
        "gallery", tmp_path, "--only", "cubes"
    )
    assert "no source is called 'me'" in refused("gallery", tmp_path, "--source", "me")
    assert "none of cube is after catlike" in refused(
        "gallery", tmp_path, "--only", "cube", "--source", "catlike"
    )
    (tmp_path / "file").write_text("")
    assert "cannot be written to" in refused(
        "gallery", tmp_path / "file", "--only", "cube", "--device", "cpu"
    )
    assert not [*tmp_path.glob("*.html")]


def test_pages_are_chosen_by_source() -> None:
    assert chosen() == [*PAGES.values()]
    assert {page.source for page in chosen(source="halliwell")} == {"halliwell"}
    with pytest.raises(InputError):
        chosen(["bricks"], "gamedev")
