"""Imports point one way, and the contracts that check it can fail."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import grimp
import pytest

from helpers.repository import REPOSITORY

LINT_IMPORTS = "from importlinter.cli import lint_imports_command; lint_imports_command()"


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    """Check the import contracts of the package in a folder."""
    command = [sys.executable, "-c", LINT_IMPORTS, "--no-cache", "--no-logo"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A folder with a copy of the package and of the contracts."""
    shutil.copytree(REPOSITORY / "src" / "basrelief", tmp_path / "basrelief")
    shutil.copy(REPOSITORY / "pyproject.toml", tmp_path)
    return tmp_path


def test_contracts_hold(copy: Path) -> None:
    result = lint_imports(copy)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    ("module", "planted", "broken"),
    [
        ("lang/planted.py", "import basrelief.engine", "Imports point one way"),
        ("engine/planted.py", "from basrelief import images", "Imports point one way"),
        ("material/planted.py", "import wgpu", "Only engine.gpu imports wgpu"),
        ("lang/planted.py", "import wgpu.utils", "Only engine.gpu imports wgpu"),
        ("material/planted.py", "import av.filter", "Only rendering.film imports av"),
        (
            "measure/planted.py",
            "import matplotlib.ticker",
            "Only measure.figures imports matplotlib",
        ),
        ("lang/planted.py", "import llvmlite", "Only engine.cpu imports llvmlite"),
        ("planted.py", "", "Imports point one way"),
        (
            "measure/oracle.py",
            "import basrelief.measure.truth",
            "Modules of a package import one another in one direction",
        ),
    ],
)
def test_planted_import_is_found(copy: Path, module: str, planted: str, broken: str) -> None:
    with (copy / "basrelief" / module).open("a") as file:
        file.write(f"\n\ndef late() -> None:\n    {planted or 'pass'}\n")
    result = lint_imports(copy)
    assert result.returncode == 1
    assert f"{broken} BROKEN" in result.stdout


def test_top_level_modules_are_few() -> None:
    """Besides packages there are only errors, lazy imports, threads, timings, the version and
    `__main__`."""
    loose = {path.stem for path in (REPOSITORY / "src" / "basrelief").glob("*.py")}
    assert loose == {
        "__init__", "__main__", "_version", "errors", "lazy", "threads", "timings"
    }  # fmt: skip


def test_folders_of_tests_are_those_of_the_source() -> None:
    """`tests/` has a folder for each package it tests, one for the project, one for the articles,
    and one for helpers."""
    packages = {
        path.parent.name for path in (REPOSITORY / "src" / "basrelief").glob("*/__init__.py")
    }
    folders = {path.parent.name for path in (REPOSITORY / "tests").glob("*/test_*.py")}
    assert folders - packages == {"articles", "project"}
    assert not list((REPOSITORY / "tests").glob("test_*.py"))


def test_lang_imports_only_errors_and_settings() -> None:
    """The shader subset imports nothing else of the package."""
    graph = grimp.build_graph("basrelief")
    within = {"basrelief.lang"} | graph.find_descendants("basrelief.lang")
    imported = {i for module in within for i in graph.find_modules_directly_imported_by(module)}
    assert imported - within <= {"basrelief.errors", "basrelief.settings"}
