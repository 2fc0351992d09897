"""The articles' code shares nothing with the library that it is compared with."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ARTICLES = Path(__file__).parent
DRAWS = "agreement"
"""The file that draws, and so uses the library."""
CODE = sorted(
    file.stem
    for file in ARTICLES.glob("*.py")
    if not file.stem.startswith("test_") and file.stem != DRAWS
)


def imports(source: str) -> set[str]:
    """The modules that a file imports."""
    nodes = list(ast.walk(ast.parse(source)))
    plain = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
    return plain | {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}


@pytest.mark.parametrize("name", CODE)
def test_code_of_articles_imports_no_library(name: str) -> None:
    for module in imports((ARTICLES / f"{name}.py").read_text()):
        package, _, rest = module.partition(".")
        assert package in ("__future__", "collections", "dataclasses", "numpy", "articles")
        assert rest != DRAWS


def test_an_import_of_the_library_is_seen() -> None:
    assert imports((ARTICLES / f"{DRAWS}.py").read_text()) >= {"basrelief", "basrelief.images"}
