"""Where the repository is, and what its documents tell the reader to run."""

from __future__ import annotations

import re
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
TESTS = REPOSITORY / "tests"


def commands(page: str) -> list[str]:
    """The indented lines of a page that run basrelief on a terminal."""
    text = (REPOSITORY / page).read_text()
    return re.findall(r"^    (basrelief .*)$", text, flags=re.MULTILINE)


def blocks(page: str) -> list[str]:
    """The Python examples of a page."""
    return re.findall(r"^```python\n(.*?)^```$", (REPOSITORY / page).read_text(), re.M | re.S)
