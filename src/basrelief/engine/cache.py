"""Disk cache of compiled programs and bakes, keyed by the content that they are made from.

An entry is written atomically, verified when it is read, and removed when it is damaged. All
entries together take at most `LIMIT` bytes; the least recently used are removed first. If the
folder cannot be read or written, nothing is cached and everything is computed again.
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
_LISTING_DIVISOR = 16
"""Divisor of the limit that gives the bytes that may be written before the folder is listed again,
and that are left free after entries are removed. Listing 5000 entries takes 0.07 s, too much for
each write."""
_ABANDONED_AFTER = 3600.0
"""Age in seconds from which an unfinished file counts as left behind by a process that ended."""
_DIGEST_SIZE = 32
"""Bytes of the digest at the start of an entry."""
Bytes = bytes | memoryview
_ENTRY = re.compile(r"[a-z]+-[0-9a-f]{64}")
_UNFINISHED = re.compile(_ENTRY.pattern + r"\.\w+")


def cache_folder() -> Path:
    """Absolute path of the cache folder, which need not exist.

    It is the environment variable BASRELIEF_CACHE, relative to the working directory, or else
    `basrelief` in the user's cache folder. Raises RuntimeError if the user has no home folder.
    """
    path = os.environ.get("BASRELIEF_CACHE")
    return Path(path).absolute() if path else _user_folder()


def _user_folder() -> Path:
    from platformdirs import PlatformDirs

    folder = PlatformDirs("basrelief", appauthor=False, opinion=False).user_cache_path
    if folder.is_absolute():
        return folder
    # the XDG Base Directory Specification 0.8 ignores a relative XDG_CACHE_HOME; not every version
    # of platformdirs does
    return Path.home() / ".cache" / "basrelief"


def key_of(kind: str, *parts: str | Bytes) -> str:
    """Key of an entry: its kind, a word in lower case, and a digest of what it depends on."""
    digest = hashlib.sha256()
    for part in parts:
        content = memoryview(part.encode() if isinstance(part, str) else part)
        digest.update(content.nbytes.to_bytes(8, "little"))
        digest.update(content)
    return f"{kind}-{digest.hexdigest()}"


@functools.cache
def source_digest(*modules: ModuleType) -> str:
    """Digest of the source of modules and packages, with their subpackages.

    Cached results depend on the code that computed them. Raises DeviceError for a package without
    source files, whose digest would not change with its code.
    """
    digest = hashlib.sha256()
    for module in modules:
        sources = list(_sources(module))
        if not sources:
            raise DeviceError(
                f"{module.__name__} has no source files, which the keys of the cache depend on; "
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
    """Header and content of an entry, marked as used; None if it is missing or damaged."""
    try:
        path = cache_folder() / key
        with path.open("rb") as file:
            digest, header, content = file.read(_DIGEST_SIZE), file.readline(), file.read()
    except (OSError, RuntimeError):
        return None
    parsed = _parse_header(digest, header, content)
    if parsed is None:
        _remove(path)
        return None
    with contextlib.suppress(OSError):
        os.utime(path)
    return parsed, content


def write(key: str, header: dict[str, Any], content: Bytes) -> None:
    """Store an entry, then remove the least recently used ones above the limit.

    Stores nothing if the folder cannot be written or the entry alone exceeds the limit.
    """
    head = json.dumps(header).encode() + b"\n"
    size = _DIGEST_SIZE + len(head) + memoryview(content).nbytes
    if size > LIMIT:
        return
    try:
        folder = cache_folder()
        folder.mkdir(parents=True, exist_ok=True)
        _write_whole(folder / key, head, content)
    except (OSError, RuntimeError):
        return
    _enforce_limit(folder, key, size)


def _parse_header(digest: bytes, header: bytes, content: bytes) -> dict[str, Any] | None:
    """Header of an entry; None if the entry is damaged."""
    if _digest(header, content) != digest:
        return None
    try:
        parsed = json.loads(header)
    except ValueError:
        return None
    return parsed if isinstance(parsed, dict) else None


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
    """Remove a file; returns whether it is gone: on Windows, open files cannot be removed."""
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)
        return True
    return False


# --- the limit ------------------------------------------------------------------------------------


@dataclass
class _Usage:
    """Bytes of all entries at the last listing of the folder, and bytes written since."""

    listed: int | None = None
    written: int = 0

    def needs_listing(self) -> bool:
        """Whether to list the folder; not only at the limit, because other processes write too."""
        if self.listed is None:
            return True
        return self.listed + self.written > LIMIT or self.written > LIMIT // _LISTING_DIVISOR


class _Entry(NamedTuple):
    used: int
    """Time of the last write or read, in nanoseconds since the epoch."""
    size: int
    path: Path


_usage_by_folder: defaultdict[Path, _Usage] = defaultdict(_Usage)
_lock = threading.Lock()


def _enforce_limit(folder: Path, key: str, size: int) -> None:
    """Keep the folder below the limit after `size` bytes were written under a key."""
    with _lock:
        usage = _usage_by_folder[folder]
        usage.written += size
        if usage.needs_listing():
            with contextlib.suppress(OSError):
                usage.listed, usage.written = _trim(folder, key), 0


def _trim(folder: Path, newest: str) -> int:
    """Remove the least recently used entries above the limit, except `newest`; returns bytes left.

    Counts and removes only files that have names of entries: the folder may hold other files.
    """
    entries = sorted(_entries(folder))
    total = sum(entry.size for entry in entries)
    if total <= LIMIT:
        return total
    for entry in entries:
        if total <= LIMIT - LIMIT // _LISTING_DIVISOR:
            break
        if entry.path.name != newest and _remove(entry.path):
            total -= entry.size
    return total


def _entries(folder: Path) -> Iterator[_Entry]:
    """All entries; also removes unfinished files that a process left behind."""
    with os.scandir(folder) as listed:
        for file in listed:
            # another process may have removed it by now
            with contextlib.suppress(OSError):
                status = file.stat(follow_symlinks=False)
                if _ENTRY.fullmatch(file.name) and file.is_file(follow_symlinks=False):
                    yield _Entry(status.st_mtime_ns, status.st_size, Path(file.path))
                elif _UNFINISHED.fullmatch(file.name) and _is_abandoned(status):
                    _remove(Path(file.path))


def _is_abandoned(status: os.stat_result) -> bool:
    return time.time() - status.st_mtime > _ABANDONED_AFTER
