"""Atomic writing of files."""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable
from pathlib import Path

from basrelief.errors import InputError
from basrelief.timings import step


def check_writable(path: Path) -> None:
    """Raise InputError if a file cannot be written at a path."""
    folder = path.parent
    if not os.path.isdir(folder):
        raise InputError(f"{path}: the folder {folder} does not exist; make it first")
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder; name a file")
    if not os.access(folder, os.W_OK):
        raise InputError(f"{path}: the folder {folder} cannot be written; choose another place")


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file atomically: `write` makes a temporary file beside `path`, which replaces it.

    Raises InputError if the path cannot be written or `write` raises an OSError.
    """
    check_writable(path)
    partial = path.parent / f".{path.stem[:40]}-{secrets.token_hex(4)}{path.suffix}"
    try:
        write(partial)
        os.replace(partial, path)
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{path}: cannot be written ({why}); choose another place") from error
    finally:
        partial.unlink(missing_ok=True)


def write_bytes(path: Path, encode: Callable[[], bytes]) -> None:
    """Write a file atomically, with the bytes that `encode` returns; see `write_whole`."""

    def write(partial: Path) -> None:
        content = encode()
        with step("write"):
            partial.write_bytes(content)

    write_whole(path, write)
