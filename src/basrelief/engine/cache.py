"""A folder of compiled programs, found by content.

An entry is written whole or not at all, checked when read, and thrown away when damaged. A folder
that cannot be written or is missing only means that programs are compiled anew.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

_DIGEST = 32


def cache_folder() -> Path:
    """Where compiled programs are kept; the variable BASRELIEF_CACHE overrides the place."""
    if os.environ.get("BASRELIEF_CACHE"):
        return Path(os.environ["BASRELIEF_CACHE"])
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return base / "basrelief"


def read(key: str) -> tuple[dict[str, Any], bytes] | None:
    """The header and content stored under a key; None where there is none that is whole."""
    path = cache_folder() / key
    try:
        raw = path.read_bytes()
    except OSError:
        return None
    digest, rest = raw[:_DIGEST], raw[_DIGEST:]
    if hashlib.sha256(rest).digest() != digest:
        with contextlib.suppress(OSError):
            path.unlink()
        return None
    head, _, content = rest.partition(b"\n")
    try:
        return json.loads(head), content
    except ValueError:
        return None


def write(key: str, header: dict[str, Any], content: bytes) -> None:
    """Store a header and content under a key; silently nothing where the folder is read-only."""
    rest = json.dumps(header).encode() + b"\n" + content
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=folder)
    except OSError:
        return
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(rest).digest() + rest)
        os.replace(temporary, folder / key)
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        if not isinstance(error, OSError):
            raise
