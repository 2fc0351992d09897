"""The cache: its folder, its entries, and the limit of all entries together."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import platformdirs
import pytest
from platformdirs import windows
from platformdirs.macos import MacOS
from platformdirs.unix import Unix
from platformdirs.windows import Windows

from basrelief.engine import cache


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Path of an empty cache folder, which does not exist yet."""
    monkeypatch.setenv("BASRELIEF_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


# --- the folder -----------------------------------------------------------------------------------


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Home folder on Linux, without variables that set the cache folder."""
    for name in ("BASRELIEF_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(platformdirs, "PlatformDirs", Unix)
    return tmp_path


def test_the_folder_on_each_platform(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cache.cache_folder() == home / ".cache" / "basrelief"
    monkeypatch.setattr(platformdirs, "PlatformDirs", MacOS)
    assert cache.cache_folder() == home / "Library" / "Caches" / "basrelief"
    monkeypatch.setattr(platformdirs, "PlatformDirs", Windows)
    local = home / "AppData" / "Local"
    monkeypatch.setattr(windows, "get_win_folder", {"CSIDL_LOCAL_APPDATA": str(local)}.get)
    assert cache.cache_folder() == local / "basrelief"


def test_xdg_cache_home_names_the_users_cache_folder(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(home / "elsewhere"))
    assert cache.cache_folder() == home / "elsewhere" / "basrelief"


@pytest.mark.parametrize("value", ["", "here", "./here", "../here", "~/here"])
def test_an_empty_or_relative_xdg_cache_home_counts_as_unset(
    home: Path, monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", value)
    assert cache.cache_folder() == home / ".cache" / "basrelief"


def test_a_relative_folder_of_platformdirs_is_not_used(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Versions that follow a relative XDG_CACHE_HOME return such a folder."""

    class Follows(Unix):
        @property
        def user_cache_dir(self) -> str:
            return "here/basrelief"

    monkeypatch.setattr(platformdirs, "PlatformDirs", Follows)
    assert cache.cache_folder() == home / ".cache" / "basrelief"


def test_basrelief_cache_names_the_folder(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An absolute path, or one relative to the working directory; empty counts as unset."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(home / "elsewhere"))
    monkeypatch.chdir(home)
    monkeypatch.setenv("BASRELIEF_CACHE", str(home / "mine"))
    assert cache.cache_folder() == home / "mine"
    monkeypatch.setenv("BASRELIEF_CACHE", "deep/mine")
    assert cache.cache_folder() == home / "deep" / "mine"
    monkeypatch.setenv("BASRELIEF_CACHE", "")
    assert cache.cache_folder() == home / "elsewhere" / "basrelief"


def test_without_a_home_folder_nothing_is_cached(monkeypatch: pytest.MonkeyPatch) -> None:
    class Homeless(Unix):
        @property
        def user_cache_dir(self) -> str:
            raise RuntimeError("could not determine the home directory")

    monkeypatch.delenv("BASRELIEF_CACHE", raising=False)
    monkeypatch.setattr(platformdirs, "PlatformDirs", Homeless)
    cache.write(key("a"), {}, b"content")
    assert cache.read(key("a")) is None


# --- entries --------------------------------------------------------------------------------------


def key(*parts: str, kind: str = "cpu") -> str:
    return cache.key_of(kind, *parts)


def names(place: Path) -> set[str]:
    return {file.name for file in place.iterdir()}


def test_keys_depend_on_kind_and_parts() -> None:
    keys = [
        key("ab", "c"), key("a", "bc"), key("abc"), key("ab", "c", ""), key("ab", "c", kind="bake"),
    ]  # fmt: skip
    assert len(set(keys)) == len(keys)
    assert cache.key_of("cpu", b"ab", memoryview(b"c")) == keys[0]


@pytest.mark.parametrize("header", [b"no json\n", b"[1, 2]\n", b"3\n", b""])
def test_an_entry_with_another_header_is_removed(place: Path, header: bytes) -> None:
    cache.write(key("a"), {}, b"content")
    raw = cache._digest(header, b"content") + header + b"content"
    (place / key("a")).write_bytes(raw)
    assert cache.read(key("a")) is None
    assert names(place) == set()


def test_content_is_read_as_it_was_written_from_any_buffer(place: Path) -> None:
    for content in (b"", b"\n\n", memoryview(bytes(range(256)))):
        cache.write(key("a"), {"shape": [2, 3]}, content)
        assert cache.read(key("a")) == ({"shape": [2, 3]}, bytes(content))


# --- the limit ------------------------------------------------------------------------------------

SIZE = 1000
"""Bytes of content of the entries below."""


def total(place: Path) -> int:
    return sum(file.stat().st_size for file in place.iterdir())


def fill(*parts: str, kind: str = "cpu", age: int = 0) -> str:
    """Write an entry that was last used `age` seconds ago."""
    name = key(*parts, kind=kind)
    cache.write(name, {}, b"x" * SIZE)
    used = time.time() - age
    os.utime(cache.cache_folder() / name, (used, used))
    return name


def set_limit(monkeypatch: pytest.MonkeyPatch, entries: float) -> int:
    """Set the limit to about that many entries."""
    limit = int(entries * (SIZE + 100))
    monkeypatch.setattr(cache, "LIMIT", limit)
    return limit


def test_the_least_recently_used_are_removed_of_any_kind(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Programs and bakes share one limit; reading an entry is using it."""
    old_program, old_bake = fill("a", age=400), fill("a", kind="bake", age=300)
    program, bake = fill("b", age=200), fill("b", kind="bake", age=100)
    assert cache.read(old_program) is not None
    set_limit(monkeypatch, 3.5)
    new = fill("c")
    assert names(place) == {old_program, bake, new}
    assert program not in names(place)
    assert old_bake not in names(place)


def test_the_limit_holds_after_every_write(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limit = set_limit(monkeypatch, 10)
    for number in range(40):
        name = fill(str(number))
        assert total(place) <= limit
        assert name in names(place)
    assert total(place) > limit // 2


def test_the_newest_entry_stays(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also if all others have later times, as after a clock was set back."""
    for number in range(4):
        fill(str(number), age=-1000)
    set_limit(monkeypatch, 2)
    new = key("new")
    cache.write(new, {}, b"x" * SIZE)
    os.utime(place / new, (1, 1))
    assert new in names(place)
    assert len(names(place)) < 4
    large = key("large")
    cache.write(large, {}, b"x" * (2 * SIZE))
    assert names(place) == {large}


def test_an_entry_over_the_limit_is_not_stored(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = fill("a")
    set_limit(monkeypatch, 2)
    cache.write(key("b"), {}, b"x" * (3 * SIZE))
    assert names(place) == {before}


def test_other_files_stay_and_do_not_count(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder may contain files of the user."""
    set_limit(monkeypatch, 3)
    place.mkdir()
    others = {"notes.txt", "cpu-program", f"CPU-{'0' * 64}", "bake-" + "0" * 63, "large"}
    for name in others:
        (place / name).write_bytes(b"x" * 5 * SIZE)
        os.utime(place / name, (1, 1))
    (place / key("folder")).mkdir()
    entries = {fill("a", age=2), fill("b", age=1)}
    assert names(place) == others | entries | {key("folder")}
    for number in range(9):
        fill(str(number))
    assert others | {key("folder")} <= names(place)


def test_the_folder_is_seldom_listed(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once at first, and then after each sixteenth of the limit."""
    set_limit(monkeypatch, 160)
    listed = []
    scandir = os.scandir
    monkeypatch.setattr(cache.os, "scandir", lambda path: listed.append(path) or scandir(path))
    for number in range(400):
        fill(str(number))
    assert 1 < len(listed) < 80


def test_entries_of_other_processes_count(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limit = set_limit(monkeypatch, 32)
    fill("first")
    raw = (place / key("first")).read_bytes()
    for number in range(40):
        (place / key("theirs", str(number))).write_bytes(raw)
        os.utime(place / key("theirs", str(number)), (1, 1))
    assert total(place) > limit
    for number in range(3):
        fill(str(number))
    assert total(place) <= limit


def test_abandoned_files_are_removed(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of a killed process are removed, those of a running one are not."""
    place.mkdir()
    old, new = (place / f"{key(name)}.abc" for name in ("old", "new"))
    for file in (old, new):
        file.write_bytes(b"half")
    os.utime(old, (time.time() - 7200,) * 2)
    written = fill("a")
    assert names(place) == {written, new.name}


def test_threads_keep_the_limit(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limit = set_limit(monkeypatch, 10)
    threads = [
        threading.Thread(
            target=lambda n=n: [
                cache.write(key(str(n), str(k)), {}, b"x" * SIZE) for k in range(30)
            ]
        )
        for n in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    fill("last")
    assert total(place) <= limit


WRITER = """
import sys
from basrelief.engine import cache
cache.LIMIT = int(sys.argv[2])
for number in range(150):
    key = cache.key_of("cpu", sys.argv[1], str(number))
    cache.write(key, {"number": number}, b"x" * 1000)
    # ours, or removed meanwhile, never incomplete
    entry = cache.read(key)
    assert entry in (None, ({"number": number}, b"x" * 1000)), entry
    cache.read(cache.key_of("cpu", "both", str(number % 5)))
    cache.write(cache.key_of("cpu", "both", str(number % 5)), {}, b"y" * 1000)
"""


def test_two_processes_share_the_folder(place: Path) -> None:
    """Both write and remove at once: nothing fails, every entry is complete, the limit holds.

    Each may write a sixteenth of the limit before it counts the entries of the other.
    """
    limit = 20 * (SIZE + 100)
    running = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, name, str(limit)],
            env={**os.environ, "BASRELIEF_CACHE": str(place)}, stderr=subprocess.PIPE, text=True,
        )
        for name in ("one", "two")
    ]  # fmt: skip
    for process in running:
        assert process.communicate(timeout=120) == (None, "")
        assert process.returncode == 0
    assert total(place) <= limit + 2 * (limit // 16 + SIZE + 100)
    assert len(names(place)) > 5
    assert all(cache.read(name) is not None for name in names(place))
