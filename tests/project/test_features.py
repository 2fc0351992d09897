"""The test matrix has every feature once, and each working feature names existing tests."""

from __future__ import annotations

import ast
import re
from typing import NamedTuple

import pytest

from basrelief.gallery import PAGES
from helpers.features import COUNTS
from helpers.repository import REPOSITORY


class Row(NamedTuple):
    """One line of a table."""

    id: str
    what: str
    works: str
    test: str
    page: str


def rows() -> list[Row]:
    """All rows of the tables."""
    lines = (REPOSITORY / "docs" / "contributing" / "features.md").read_text().splitlines()
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line[:1] == "|"]
    return [Row(*each) for each in cells if re.fullmatch(r"[A-Z]\d+", each[0])]


def has_test(node: str) -> bool:
    """Whether `path::name` names a top-level test function of this repository."""
    path, _, name = node.partition("::")
    file = REPOSITORY / path
    if not re.fullmatch(r"tests/(\w+/)*test_\w+\.py", path) or not file.is_file():
        return False
    functions = {n.name for n in ast.parse(file.read_text()).body if isinstance(n, ast.FunctionDef)}
    return name.startswith("test_") and name in functions


def test_every_feature_has_one_row() -> None:
    wanted = [f"{letter}{n}" for letter, count in COUNTS.items() for n in range(1, count + 1)]
    assert [row.id for row in rows()] == wanted


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.id)
def test_working_features_have_tests(row: Row) -> None:
    tests = row.test.replace("`", "").split()
    assert row.works in ("yes", "no")
    assert row.what
    assert tests or row.works == "no", f"{row.id} works, says its row; name the test that holds it"
    missing = [test for test in tests if not has_test(test)]
    assert not missing, f"{row.id} names tests that are not there: {missing}"


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.id)
def test_pages_show_their_rows(row: Row) -> None:
    """Each row links to all pages of the gallery that show it, and to no others."""
    links = re.findall(r"\[([^]]*)\]\(\.\./gallery\.md#([^)]*)\)", row.page)
    assert all(name == anchor for name, anchor in links)
    showing = [name for name, page in PAGES.items() if row.id in page.rows]
    assert [name for name, _ in links] == showing
    headings = (REPOSITORY / "docs" / "gallery.md").read_text().splitlines()
    assert all(f"### {name}" in headings for name in showing)


def test_missing_tests_are_found() -> None:
    """The checks above can fail."""
    assert has_test("tests/project/test_features.py::test_missing_tests_are_found")
    assert not has_test("tests/project/test_features.py::test_of_something_else")
    assert not has_test("tests/project/test_features.py::has_test")
    assert not has_test("tests/test_nowhere.py::test_missing_tests_are_found")
    assert not has_test("")
