"""Programs linked by the page's code, against the library's own `linked`."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from importlib.resources import files
from typing import Any

import pytest

from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.techniques.cone_bake import Search, steepest
from basrelief.viewer.printed import ProgramLibrary, program_library
from helpers.browser import SOFTWARE, chromium
from helpers.linking import linked
from helpers.variants import random_programs

LINK = """async ([address, programs, entry, choices]) => {
  const { linked } = await import(address);
  return choices.map((each) => linked(programs, entry, each).code);
}"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as opened:
        yield opened


@pytest.fixture(scope="module")
def library() -> ProgramLibrary:
    return program_library()


def by_page(
    browser: Any, library: ProgramLibrary, entry: str, choices: list[dict[str, Any]]
) -> list[str]:
    """The programs of an entry, linked by `link.js`, one for each set of choices."""
    source = (files("basrelief.viewer") / "web" / "link.js").read_bytes()
    address = f"data:text/javascript;base64,{base64.b64encode(source).decode()}"
    page = browser.new_page()
    try:
        return page.evaluate(LINK, [address, library.to_dict(), entry, choices])
    finally:
        page.close()


def test_the_page_links_the_librarys_programs(browser: Any, library: ProgramLibrary) -> None:
    picked = random_programs(60, 6)
    texts = by_page(browser, library, "pixel", [choices for choices, _ in picked])
    for (_, program), text in zip(picked, texts, strict=True):
        assert text == linked(library.library, program)
    assert len(set(texts)) > 55


@pytest.mark.parametrize("by_sector", [False, True])
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
def test_a_bake_is_linked_too(
    browser: Any, library: ProgramLibrary, edge: Edge, by_sector: bool
) -> None:
    choices = {"map.edge": edge, "map.filter": "sharp", "by_sector": by_sector}
    (text,) = by_page(browser, library, "steepest", [choices])
    program = Program(steepest, edge=edge, variant=Search(by_sector))
    assert text == linked(library.library, program)


@pytest.mark.parametrize("name", ["fog_mode", "map.edge"])
def test_a_missing_choice_is_an_error(browser: Any, library: ProgramLibrary, name: str) -> None:
    ((choices, _),) = random_programs(1, 6)
    del choices[name]
    with pytest.raises(Exception, match=f"the page chooses no {name}"):
        by_page(browser, library, "pixel", [choices])


@pytest.mark.parametrize("name", ["torus", "constructor"])
def test_an_unknown_technique_is_an_error(browser: Any, library: ProgramLibrary, name: str) -> None:
    ((choices, _),) = random_programs(1, 6)
    with pytest.raises(Exception, match="the page has no Settings as undefined"):
        by_page(browser, library, "pixel", [{**choices, "technique": name}])
