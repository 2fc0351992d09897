"""The package as installed: its version, its public names and the files of the wheel."""

from __future__ import annotations

import importlib.metadata
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest

import basrelief
from basrelief._version import __version__
from helpers.repository import REPOSITORY

HEAVY = ("numpy", "llvmlite", "wgpu", "OpenImageIO", "rich", "platformdirs", "tomli_w", "jinja2")


def test_version() -> None:
    assert basrelief.__version__ == __version__ == importlib.metadata.version("basrelief")


def test_all_lists_the_public_names() -> None:
    """Every name in `__all__` exists, and no other name of the package is public."""
    for name in basrelief.__all__:
        assert getattr(basrelief, name) is not None
    ours = {
        name
        for name, value in vars(basrelief).items()
        if not name.startswith("_")
        and not isinstance(value, ModuleType)
        and getattr(value, "__module__", "").startswith("basrelief")
    }
    assert ours <= set(basrelief.__all__)
    assert set(basrelief.__all__) <= set(dir(basrelief))
    assert len(set(basrelief.__all__)) == len(basrelief.__all__)


def test_no_module_hides_a_public_name() -> None:
    """After importing every module, each public name is still the same object."""
    code = """
import importlib, pkgutil, types
import basrelief
for module in pkgutil.walk_packages(basrelief.__path__, "basrelief."):
    if not module.name.endswith(".__main__"):
        importlib.import_module(module.name)
for name in basrelief.__all__:
    assert not isinstance(getattr(basrelief, name), types.ModuleType), name
material = basrelief.load("sample:bricks")
basrelief.render(material, size=(2, 2), samples=1, device="cpu")
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_unknown_name() -> None:
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = basrelief.no_such_name


@pytest.mark.parametrize("module", ["basrelief", "basrelief.cli"])
def test_python_m_is_the_command(module: str) -> None:
    result = subprocess.run(
        [sys.executable, "-m", module, "--version"], capture_output=True, text=True, check=True
    )
    assert result.stdout == f"basrelief {__version__}\n"


def test_import_is_light() -> None:
    """`import basrelief` imports no heavy module."""
    code = f"import sys, basrelief; print([m for m in {HEAVY} if m in sys.modules])"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"


def test_help_is_light() -> None:
    """`basrelief --help` imports nothing that only some commands need."""
    late = (*HEAVY, "matplotlib", "av", "anywidget")
    code = f"""
import sys
from basrelief.cli.main import main
sys.argv = ["basrelief", "--help"]
try:
    main()
finally:
    print([m for m in {set(late) - {"rich"}} if m in sys.modules], file=sys.stderr)
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 0
    assert "compare" in result.stdout
    assert result.stderr.strip() == "[]"


def test_wheel(tmp_path: Path) -> None:
    """The wheel has every module, the type marker and the licence, and no other file."""
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=REPOSITORY, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    names = set(zipfile.ZipFile(wheel).namelist())
    source = REPOSITORY / "src"
    modules = {path.relative_to(source).as_posix() for path in source.rglob("*.py")}
    assert modules <= names
    data = {path.relative_to(source).as_posix() for path in source.rglob("*.toml")}
    assert len(data) == len(basrelief.PRESETS)
    assert data <= names
    kinds = ("*.html.jinja", "*.css", "*.js")
    web = {path.relative_to(source).as_posix() for kind in kinds for path in source.rglob(kind)}
    assert {name.rpartition(".")[2] for name in web} == {"jinja", "css", "js"}
    assert web <= names
    assert not [name for name in names if name.endswith((".ts", ".json"))]
    assert "basrelief/py.typed" in names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert {name.split("/")[0].split("-")[0] for name in names} == {"basrelief"}
    # templates are found in the wheel itself, not only in a folder
    code = """
from basrelief.pages import fill
template = "gallery/templates/index.html.jinja"
print(fill.__code__.co_filename, fill(template, generator="", title="A", sections={}))
"""
    environment = {**os.environ, "PYTHONPATH": str(wheel)}
    result = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert result.stdout.startswith(str(wheel))
    assert "<title>A · basrelief</title>" in result.stdout
