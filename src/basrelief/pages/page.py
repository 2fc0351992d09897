"""Files of pages: written atomically, and never over files of another origin."""

from __future__ import annotations

from pathlib import Path

from basrelief.errors import InputError
from basrelief.images import write_bytes

__all__ = ["check_overwritable", "is_generated_by", "write_page"]


def is_generated_by(file: Path, generator: str) -> bool:
    """Whether a file is a page whose generator is `generator`."""
    return file.is_file() and generator in file.read_text(encoding="utf-8", errors="replace")


def check_overwritable(file: Path, generator: str, what: str) -> None:
    """Raise InputError if a file exists that `generator` did not write; `what` names its pages."""
    if file.is_dir():
        raise InputError(f"{file}: is a folder; name a file in it, as {file / 'page.html'}")
    if file.exists() and not is_generated_by(file, generator):
        raise InputError(f"{file}: exists and is not {what}; choose another name or folder")


def write_page(file: Path, text: str) -> None:
    """Write a page atomically; raises InputError if it cannot be written."""
    write_bytes(file, lambda: text.encode())
