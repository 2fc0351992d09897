"""The folder of cached files: where it lies."""

from __future__ import annotations

from pathlib import Path

import platformdirs
import pytest
from platformdirs import windows
from platformdirs.macos import MacOS
from platformdirs.unix import Unix
from platformdirs.windows import Windows

from basrelief.engine import cache

# --- the folder -----------------------------------------------------------------------------------


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder on Linux, with nothing set that names the cache."""
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
    """Absolute as it stands, relative from the working directory; empty counts as unset."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(home / "elsewhere"))
    monkeypatch.chdir(home)
    monkeypatch.setenv("BASRELIEF_CACHE", str(home / "mine"))
    assert cache.cache_folder() == home / "mine"
    monkeypatch.setenv("BASRELIEF_CACHE", "deep/mine")
    assert cache.cache_folder() == home / "deep" / "mine"
    monkeypatch.setenv("BASRELIEF_CACHE", "")
    assert cache.cache_folder() == home / "elsewhere" / "basrelief"
