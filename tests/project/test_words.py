"""Phrases of the project's own language that the field's words have replaced do not come back."""

from __future__ import annotations

import re

import pytest

from basrelief.errors import RENAMED
from helpers.repository import REPOSITORY

REPLACED = {
    "to be had": "is available",
    "left away": "omitted",
    "by and by": "gradually",
    "told once": "reported once",
    "as at the start": "reset",
    "shall not say": "to override",
    "user can mend": "user can fix",
    "without more": "by default",
    "given up:": "just missed:",
    "take away": "export",
    'beside it"': "compare with",
    "objects' fall on": "where shadows land",
    "--engine": "--device",
    "choose_engine": "choose_device",
    "engineerror": "DeviceError",
}
"""A phrase in lower case, and what is written in its place."""
RENAMES = "src/basrelief/errors.py"
"""The file with the table of renamed names, which may have these."""
WRITTEN = (
    "README.md", "CONTRIBUTING.md", "CONVENTIONS.md", "docs/**/*.md",
    "src/**/*.py", "src/**/*.js", "src/**/*.jinja", "benchmarks/*.md",
)  # fmt: skip
"""All but the changelog, which names what was replaced."""


@pytest.mark.parametrize("pattern", WRITTEN)
def test_no_replaced_phrase_is_written_again(pattern: str) -> None:
    files = [*REPOSITORY.glob(pattern)]
    assert files
    again = []
    for file in files:
        # a phrase may run over the end of a line, also of a comment
        text = re.sub(r"\s+(#|//|\*)?\s*", " ", file.read_text(encoding="utf-8")).lower()
        name = file.relative_to(REPOSITORY)
        again += [
            f"{name}: {phrase!r}: write {better!r}"
            for phrase, better in REPLACED.items()
            if phrase in text and not (name.as_posix() == RENAMES and better in RENAMED.values())
        ]
    assert again == []
