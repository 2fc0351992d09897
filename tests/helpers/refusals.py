"""Messages of the front end, taken apart."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from basrelief.lang import ShaderError


class Refusal(NamedTuple):
    """Where an error is, the text under which it has carets, and its first line."""

    file: str
    line: int
    marked: str
    message: str


def refusal_in(error: ShaderError) -> Refusal:
    """The parts of an error, after a check of its three lines against the file."""
    first, source, carets = str(error).split("\n")
    match = re.fullmatch(r"(.*\.py):(\d+): (.*)", first)
    assert match, first
    file, line, message = match.groups()
    assert source.startswith("    ")
    assert source.strip() == Path(file).read_text("utf-8").splitlines()[int(line) - 1].strip()
    assert re.fullmatch(r"\s*\^+", carets)
    return Refusal(file, int(line), source[carets.index("^") : len(carets)], message)
