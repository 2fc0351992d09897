"""A folder of compiled programs, found by content.

An entry is written whole or not at all, checked when read, and thrown away when damaged. A folder
that cannot be written or is missing only means that programs are compiled anew.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any

_DIGEST = 32


def cache_folder() -> Path:
    """The folder of cached files, as an absolute path; it need not exist.

    The environment variable BASRELIEF_CACHE names it, a relative path starting at the working
    directory. Where the variable is unset or empty, it is `basrelief` in the user's cache folder.
    """
    named = os.environ.get("BASRELIEF_CACHE")
    return Path(named).absolute() if named else _user_folder()


def _user_folder() -> Path:
    from platformdirs import PlatformDirs

    folder = PlatformDirs("basrelief", appauthor=False, opinion=False).user_cache_path
    if folder.is_absolute():
        return folder
    # a relative XDG_CACHE_HOME counts as unset (XDG Base Directory Specification 0.8), which not
    # every version of platformdirs respects
    return Path.home() / ".cache" / "basrelief"


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
