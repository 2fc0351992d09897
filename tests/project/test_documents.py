"""The commands, examples and links of the documentation work as written."""

from __future__ import annotations

import functools
import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import basrelief
from basrelief.images import read_picture
from basrelief.techniques import TECHNIQUES
from helpers.command_line import done, write_material
from helpers.repository import REPOSITORY, blocks, commands

SMALL = {
    "render": ["--size", "24x18", "--samples", "1"],
    "compare": ["--size", "16x9", "--samples", "1", "--angles", "60", "--technique", "exact"],
    "tune": ["--size", "16x9", "--technique", "relief"],
    "explain": ["--size", "24x18", "--pixel", "12,9"],
}
"""Options that replace those of a page, by command."""
DOCUMENTS = sorted(
    path.relative_to(REPOSITORY).as_posix()
    for pattern in ("*.md", "docs/**/*.md", "benchmarks/*.md")
    for path in REPOSITORY.glob(pattern)
)
ELSEWHERE = (
    "README.md", "docs/bake.md", "docs/command-line.md", "docs/compare.md", "docs/presets.md",
    "docs/draw.md", "docs/gallery.md", "docs/viewer.md", "docs/write-a-technique.md",
)  # fmt: skip
"""Pages whose commands other tests run, with the files that these write."""
PAGES = [page for page in DOCUMENTS if page.startswith("docs/") and page not in ELSEWHERE]
LINES = sorted({line for page in PAGES for line in commands(page)})
UNTESTED = ("README.md", "docs/bake.md", "docs/presets.md")
"""Pages among these whose Python examples no other test runs."""
EXAMPLES = [page for page in (*UNTESTED, *PAGES) if blocks(page)]
LINK = re.compile(r"\]\(([^()\s]+)\)")
ANCHOR = re.compile(r'<a id="([^"]+)">')
HEADING = re.compile(r"^#+ (.+)$", re.M)


@pytest.fixture(scope="module", autouse=True)
def _smaller_samples() -> Iterator[None]:
    """Give samples that commands name 32 texels a side, and draw each once."""
    with pytest.MonkeyPatch.context() as patch:
        sample = functools.cache(functools.partial(basrelief.sample, size=32))
        patch.setattr(sys.modules["basrelief.material.loading"], "sample", sample)
        yield


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with FOLDER, a small material of all maps."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("basrelief.measure.tune.ANGLE_STEP", 90.0)
    write_material(tmp_path / "FOLDER")
    (tmp_path / "FOLDER" / "wall_Height.png").rename(tmp_path / "FOLDER" / "wall_height.png")
    return tmp_path


# --- commands and examples ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "line",
    [pytest.param(line, marks=pytest.mark.gpu if "--device gpu" in line else ()) for line in LINES],
)
def test_commands_that_pages_show(line: str, here: Path) -> None:
    """Each command succeeds, and writes the file or the folder that it names."""
    words = shlex.split(line)[1:]
    if "--frames" in words:
        words[words.index("--frames") + 1] = "3"
    assert done(*words, *SMALL.get(words[0], []))
    if "-o" not in words:
        return
    written = here / words[words.index("-o") + 1]
    assert written.exists()
    if written.suffix == ".png":
        assert np.ptp(read_picture(written).pixels) > 0, "the picture is of one colour"


@pytest.mark.parametrize("page", EXAMPLES)
def test_python_that_pages_show(page: str, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The examples of a page run one after another, with small pictures."""
    render = basrelief.render
    small = {"size": (24, 18), "samples": 1}
    monkeypatch.setattr(
        basrelief, "render", lambda *arguments, **options: render(*arguments, **options | small)
    )
    scope: dict[str, object] = {"__name__": "example"}
    for example in blocks(page):
        # the tests of techniques run a technique from a file
        if "@technique" not in example:
            exec(compile(example, page, "exec"), scope)


def test_every_technique_has_a_page() -> None:
    text = "".join((REPOSITORY / page).read_text() for page in PAGES if "techniques/" in page)
    assert {name for name in TECHNIQUES if f"--technique {name} " not in text} == {"flat"}
    index, guide = ((REPOSITORY / f"docs/{f}.md").read_text() for f in ("index", "which-technique"))
    for page in (REPOSITORY / "docs" / "techniques").glob("*.md"):
        assert f"techniques/{page.name}" in index
        assert f"techniques/{page.name}" in guide or page.stem == "horizon"


# --- links ----------------------------------------------------------------------------------------


def anchors(text: str) -> set[str]:
    """The anchors of a page, as GitHub makes them."""
    headings = [re.sub(r"[^\w\- ]", "", each.lower()).strip() for each in HEADING.findall(text)]
    return {each.replace(" ", "-") for each in headings} | set(ANCHOR.findall(text))


def broken_links(page: str, text: str) -> list[str]:
    """The relative links of a page without a target file or heading."""
    broken = []
    for link in LINK.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = (REPOSITORY / page).parent / name if name else REPOSITORY / page
        if not target.exists() or (anchor and anchor not in anchors(target.read_text())):
            broken.append(link)
    return broken


@pytest.mark.parametrize("page", DOCUMENTS)
def test_links_have_targets(page: str) -> None:
    assert broken_links(page, (REPOSITORY / page).read_text()) == []


def test_broken_links_are_found() -> None:
    """The checks above can fail."""
    text = "[a](bake.md) [b](no.md) [c](bake.md#no) [d](#e) [f](https://x.org) ![g](images/no.png)"
    assert broken_links("docs/index.md", text) == ["no.md", "bake.md#no", "#e", "images/no.png"]
    assert broken_links("docs/index.md", "# E\n[d](bake.md#normals)") == []
    assert anchors('# `a`: b, c\n<a id="d">') == {"a-b-c", "d"}
