"""Keys of the cache depend on the source: an edit changes the keys of what it may affect."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

from basrelief.engine.cache import source_digest
from basrelief.errors import DeviceError
from helpers.repository import REPOSITORY

PACKAGE = REPOSITORY / "src" / "basrelief"

KEYS = """
import basrelief
from basrelief.engine import cache

class Requested(Exception):
    pass

def request(key):
    raise Requested(key)

def key_of(technique):
    "The first key that drawing with a technique reads."
    try:
        basrelief.render(material, technique=technique, size=(4, 4), samples=1, device="cpu")
    except Requested as key:
        return key

cache.read = request
material = basrelief.sample("bricks", 128)
print(basrelief.__file__)
print(key_of("secant"))  # needs no bake: the key of its program
print(key_of("cone"))
"""

EDITS = {
    "a shader": ("techniques/refine.py", "0.5 if replaced", "0.25 if replaced"),
    "a printer": ("lang/llvm.py", '"""', '"""Edited. '),
    "a bake": ("baking/cone.py", '"""', '"""Edited. '),
}


def keys(folder: Path) -> tuple[str, str]:
    """Keys of a program and of a bake, for the package in a folder."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    made = subprocess.run(
        [sys.executable, "-c", KEYS], env=environment, capture_output=True, text=True, check=True
    )
    file, program, bake = made.stdout.split()
    assert Path(file).parent == folder / "basrelief"
    assert program.startswith("cpu-")
    assert bake.startswith("bake-")
    return program, bake


@pytest.fixture(scope="module")
def unedited() -> tuple[str, str]:
    return keys(PACKAGE.parent)


def copy(folder: Path, edit: str | None = None) -> Path:
    """Folder with a copy of the package, with one file edited."""
    shutil.copytree(PACKAGE, folder / "basrelief", ignore=shutil.ignore_patterns("__pycache__"))
    if edit is not None:
        name, text, other = EDITS[edit]
        file = folder / "basrelief" / name
        source = file.read_text("utf-8")
        assert text in source
        file.write_text(source.replace(text, other, 1), "utf-8")
    return folder


def test_a_copy_has_the_same_keys(tmp_path: Path, unedited: tuple[str, str]) -> None:
    assert keys(copy(tmp_path)) == unedited


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_changes_the_keys(edit: str, tmp_path: Path, unedited: tuple[str, str]) -> None:
    """Every edit for bakes; those of shaders and printers for programs."""
    program, bake = keys(copy(tmp_path, edit))
    assert bake != unedited[1]
    assert (program == unedited[0]) == (edit == "a bake")


# --- the digest -----------------------------------------------------------------------------------


def write_package(folder: Path, name: str, files: dict[str, str]) -> ModuleType:
    """Write a package and import it."""
    for path, text in files.items():
        file = folder / name / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return imported(folder, name)


def digest(module: ModuleType) -> str:
    """Digest without the cache of this process."""
    return source_digest.__wrapped__(module)


def imported(path: Path, name: str) -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(path))
        return __import__(name)


def test_each_source_file_and_its_name_are_in_the_digest(tmp_path: Path) -> None:
    sources = {"__init__.py": "", "a.py": "x = 1", "deep/er/b.py": "y = 2", "data.txt": "1"}
    package = write_package(tmp_path, "digested", sources)
    folder = tmp_path / "digested"
    digests = [digest(package)]
    (folder / "data.txt").write_text("2")
    assert digest(package) == digests[0]
    for name, text in (
        ("a.py", "x = 2"),
        ("deep/er/b.py", "y = 3"),
        ("deep/c.py", ""),
    ):
        (folder / name).write_text(text)
        digests.append(digest(package))
    (folder / "deep" / "c.py").rename(folder / "deep" / "d.py")
    digests.append(digest(package))
    # the same text, split differently
    (folder / "a.py").write_text("x = 2y")
    (folder / "deep" / "er" / "b.py").write_text(" = 3")
    digests.append(digest(package))
    assert len(set(digests)) == len(digests) == 6


def test_the_digest_of_a_module_is_that_of_its_file(tmp_path: Path) -> None:
    package = write_package(tmp_path, "some_modules", {"__init__.py": "import some_modules.a",
                                                       "a.py": "", "b.py": ""})  # fmt: skip
    before = digest(package.a)
    (tmp_path / "some_modules" / "b.py").write_text("changed = True")
    assert digest(package.a) == before
    (tmp_path / "some_modules" / "a.py").write_text("changed = True")
    assert digest(package.a) != before


def test_a_package_in_a_zip_archive_has_its_source(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "packed.zip", "w") as archive:
        archive.writestr("packed_source/__init__.py", "")
        archive.writestr("packed_source/deep/__init__.py", "x = 1")
    package = imported(tmp_path / "packed.zip", "packed_source")
    assert len(source_digest(package)) == 64


def test_a_package_without_source_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = write_package(tmp_path, "without_source", {"data.txt": "1"})
    with pytest.raises(DeviceError, match="without_source has no source files"):
        source_digest(package)
    both = write_package(tmp_path, "with_source", {"__init__.py": ""})
    with pytest.raises(DeviceError, match="without_source has no source files"):
        source_digest(both, package)
    lost = ModuleType("with_source.lost")
    lost.__package__ = "with_source"
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(DeviceError, match=r"with_source\.lost has no source files"):
        source_digest(lost)
