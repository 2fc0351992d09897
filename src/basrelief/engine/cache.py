"""Files that are kept between runs: compiled programs and bakes, found by their content.

An entry is written whole or not at all, checked when it is read, and removed when it is damaged.
All entries together take at most `LIMIT` bytes; the least recently used are removed first. Where
the folder cannot be read or written, nothing is kept and everything is made anew.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import re
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from basrelief.errors import DeviceError

LIMIT = 2 * 1024**3
"""Bytes that all entries may take together."""
_PART = 16
"""The share of the limit, as a divisor, that is written before the folder is listed again, and
that removing entries leaves free: listing 5000 entries takes 0.07 s, so it is not done for each."""
_ABANDONED = 3600.0
"""Seconds after which an unfinished file belongs to no process that is still writing it."""
_DIGEST = 32
"""Bytes of the digest that an entry begins with."""
Bytes = bytes | memoryview
_ENTRY = re.compile(r"[a-z]+-[0-9a-f]{64}")
_UNFINISHED = re.compile(_ENTRY.pattern + r"\.\w+")


def cache_folder() -> Path:
    """The folder of cached files, as an absolute path; it need not exist.

    The environment variable BASRELIEF_CACHE names it, a relative path starting at the working
    directory. Where the variable is unset or empty, it is `basrelief` in the user's cache folder.
    Raises RuntimeError where the user has no home folder.
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


def key_of(kind: str, *parts: str | Bytes) -> str:
    """The key of an entry: its kind, a word in lower case, and a digest of all it is made from."""
    digest = hashlib.sha256()
    for part in parts:
        content = memoryview(part.encode() if isinstance(part, str) else part)
        digest.update(content.nbytes.to_bytes(8, "little"))
        digest.update(content)
    return f"{kind}-{digest.hexdigest()}"


@functools.cache
def source_digest(*modules: ModuleType) -> str:
    """A digest of the source of modules and packages, those within packages included.

    What is kept depends on the code that made it. Raises DeviceError for a package without source
    files: its digest would not change with its code.
    """
    digest = hashlib.sha256()
    for module in modules:
        sources = list(_sources(module))
        if not sources:
            raise DeviceError(
                f"{module.__name__} has no source files, by which results are found in the cache; "
                "install it with its .py files"
            )
        for name, source in sources:
            digest.update(f"{name} {len(source)}\n".encode())
            digest.update(source)
    return digest.hexdigest()


def _sources(module: ModuleType) -> Iterator[tuple[str, bytes]]:
    """Name and content of each source file, in a fixed order."""
    # a zip archive has files, but no folders on disk
    if hasattr(module, "__path__"):
        yield from _sources_within(files(module), module.__name__)
    else:
        file = files(module.__package__ or "") / f"{module.__name__.rpartition('.')[2]}.py"
        if file.is_file():
            yield module.__name__, file.read_bytes()


def _sources_within(folder: Traversable, name: str) -> Iterator[tuple[str, bytes]]:
    for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
        if entry.is_dir():
            yield from _sources_within(entry, f"{name}.{entry.name}")
        elif entry.name.endswith(".py"):
            yield f"{name}.{entry.name}", entry.read_bytes()


# --- entries --------------------------------------------------------------------------------------


def read(key: str) -> tuple[dict[str, Any], bytes] | None:
    """Header and content of an entry, which is then the last used; None where none is whole."""
    try:
        path = cache_folder() / key
        with path.open("rb") as file:
            digest, header, content = file.read(_DIGEST), file.readline(), file.read()
    except (OSError, RuntimeError):
        return None
    found = _checked_header(digest, header, content)
    if found is None:
        _remove(path)
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return found, content


def write(key: str, header: dict[str, Any], content: Bytes) -> None:
    """Store an entry, then remove the least recently used ones beyond the limit.

    Stores nothing where the folder cannot be written, or where the entry alone is over the limit.
    """
    head = json.dumps(header).encode() + b"\n"
    size = _DIGEST + len(head) + memoryview(content).nbytes
    if size > LIMIT:
        return
    try:
        folder = cache_folder()
        folder.mkdir(parents=True, exist_ok=True)
        _write_whole(folder / key, head, content)
    except (OSError, RuntimeError):
        return
    _make_room(folder, key, size)


def _checked_header(digest: bytes, header: bytes, content: bytes) -> dict[str, Any] | None:
    """The header of an entry; None where the entry is not what was written."""
    if _digest(header, content) != digest:
        return None
    try:
        found = json.loads(header)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def _write_whole(path: Path, header: bytes, content: Bytes) -> None:
    handle, unfinished = tempfile.mkstemp(dir=path.parent, prefix=f"{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            for part in (_digest(header, content), header, content):
                file.write(part)
        os.replace(unfinished, path)
    except BaseException:
        _remove(Path(unfinished))
        raise


def _digest(header: bytes, content: Bytes) -> bytes:
    digest = hashlib.sha256(header)
    digest.update(content)
    return digest.digest()


def _remove(path: Path) -> bool:
    """Remove a file; whether it is gone, which on Windows one that is open is not."""
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)
        return True
    return False


# --- the limit ------------------------------------------------------------------------------------


@dataclass
class _Account:
    """Bytes of all entries when the folder was last listed, and bytes written since."""

    listed: int | None = None
    written: int = 0

    def is_due(self) -> bool:
        """Whether to list the folder. Other processes write too, so not only at the limit."""
        if self.listed is None:
            return True
        return self.listed + self.written > LIMIT or self.written > LIMIT // _PART


class _Entry(NamedTuple):
    used: int
    """Nanoseconds since the epoch, of the last write or read."""
    size: int
    path: Path


_accounts: defaultdict[Path, _Account] = defaultdict(_Account)
_lock = threading.Lock()


def _make_room(folder: Path, key: str, size: int) -> None:
    """Keep the folder within the limit after `size` bytes were written under a key."""
    with _lock:
        account = _accounts[folder]
        account.written += size
        if account.is_due():
            with contextlib.suppress(OSError):
                account.listed, account.written = _trim(folder, key), 0


def _trim(folder: Path, newest: str) -> int:
    """Remove the least recently used entries beyond the limit, never `newest`; returns bytes left.

    Only files named as entries are counted and removed: the folder may be the user's own.
    """
    entries = sorted(_entries(folder))
    total = sum(entry.size for entry in entries)
    if total <= LIMIT:
        return total
    for entry in entries:
        if total <= LIMIT - LIMIT // _PART:
            break
        if entry.path.name != newest and _remove(entry.path):
            total -= entry.size
    return total


def _entries(folder: Path) -> Iterator[_Entry]:
    """All entries; unfinished files that a process left behind are removed on the way."""
    with os.scandir(folder) as listed:
        for file in listed:
            # another process may have removed it by now
            with contextlib.suppress(OSError):
                known = file.stat(follow_symlinks=False)
                if _ENTRY.fullmatch(file.name) and file.is_file(follow_symlinks=False):
                    yield _Entry(known.st_mtime_ns, known.st_size, Path(file.path))
                elif _UNFINISHED.fullmatch(file.name) and _is_abandoned(known):
                    _remove(Path(file.path))


def _is_abandoned(known: os.stat_result) -> bool:
    return time.time() - known.st_mtime > _ABANDONED
