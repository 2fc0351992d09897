"""Programs as the page's code puts them together, against the library's own `linked`."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from importlib.resources import files
from typing import Any

import pytest

from basrelief.lang.library import linked
from basrelief.viewer.printed import Printed, printed
from helpers.browser import SOFTWARE, chromium
from helpers.variants import random_choices

LINK = """async ([address, programs, entry, choices]) => {
  const { linked } = await import(address);
  return choices.map((each) => linked(programs, entry, each).code);
}"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(SOFTWARE) as made:
        yield made


@pytest.fixture(scope="module")
def made() -> Printed:
    return printed()


def by_page(browser: Any, made: Printed, entry: str, choices: list[dict[str, Any]]) -> list[str]:
    """The texts that `link.js` makes of an entry, by choices as a page has them."""
    source = (files("basrelief.viewer") / "web" / "link.js").read_bytes()
    address = f"data:text/javascript;base64,{base64.b64encode(source).decode()}"
    page = browser.new_page()
    try:
        return page.evaluate(LINK, [address, made.told(), entry, choices])
    finally:
        page.close()


def test_the_page_makes_the_text_that_the_library_makes(browser: Any, made: Printed) -> None:
    picked = random_choices(60, 6)
    texts = by_page(browser, made, "pixel", [told for told, _ in picked])
    for (_, choices), text in zip(picked, texts, strict=True):
        assert text == linked(made.library, "pixel", made.bound(choices), choices)
    assert len(set(texts)) > 55


def test_a_bake_needs_no_variant(browser: Any, made: Printed) -> None:
    (_, choices), *_ = random_choices(1, 6)
    for in_sector, name in ((False, "everywhere"), (True, "in_sector")):
        told = {"edge": choices.edge, "in_sector": in_sector}
        (text,) = by_page(browser, made, "steepest", [told])
        bound = {**made.bound(choices), "is_asked": name}
        assert text == linked(made.library, "steepest", bound)


def test_a_choice_that_a_page_lacks_is_an_error(browser: Any, made: Printed) -> None:
    (told, _), *_ = random_choices(1, 6)
    del told["fog"]
    with pytest.raises(Exception, match="the page chooses no fog"):
        by_page(browser, made, "pixel", [told])
