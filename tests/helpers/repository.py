"""Folder of the repository, and the commands and examples in its documents."""

from __future__ import annotations

import re
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
TESTS = REPOSITORY / "tests"


def commands(page: str) -> list[str]:
    """The indented or fenced lines of a page that run basrelief on a terminal."""
    text = (REPOSITORY / page).read_text()
    fenced = re.findall(r"^```(?:sh|bash|console)?\n(.*?)^```$", text, re.M | re.S)
    return [
        *re.findall(r"^ {4,}(basrelief .*)$", text, re.M),
        *re.findall(r"^(basrelief .*)$", "".join(fenced), re.M),
    ]


def blocks(page: str) -> list[str]:
    """The Python examples of a page."""
    return re.findall(r"^```python\n(.*?)^```$", (REPOSITORY / page).read_text(), re.M | re.S)
