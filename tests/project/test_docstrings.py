"""Docstrings of public names document each parameter and the result."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from typing import Any

import pytest

PACKAGES = ("basrelief", "basrelief.baking", "basrelief.viewer")
"""Packages whose public functions and classes users call by name."""


def public() -> Iterator[tuple[str, Any]]:
    for package in PACKAGES:
        module = importlib.import_module(package)
        for name in module.__all__:
            obj = getattr(module, name)
            # an exception takes a message, a technique is documented as a shader
            is_error = inspect.isclass(obj) and issubclass(obj, BaseException)
            if callable(obj) and not is_error:
                yield f"{package}.{name}", obj


def sections(doc: str) -> dict[str, str]:
    """The sections of a numpydoc docstring by their titles."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}\n", inspect.cleandoc(doc), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def undocumented(obj: Any) -> list[str]:
    """The parameters of a function or class that its docstring does not name."""
    found = sections(obj.__doc__ or "")
    text = found.get("Parameters", "") + found.get("Attributes", "")
    named = {
        name.strip("*` ")
        for line in text.splitlines()
        if line and not line.startswith(" ")
        for name in line.split(" : ")[0].split(",")
    }
    parameters = inspect.signature(obj).parameters.values()
    return [p.name for p in parameters if p.name not in named and not p.name.startswith("_")]


NAMES = dict(public())


@pytest.mark.parametrize("name", NAMES)
def test_parameters_are_documented(name: str) -> None:
    assert undocumented(NAMES[name]) == []


@pytest.mark.parametrize("name", [n for n, o in NAMES.items() if inspect.isfunction(o)])
def test_results_are_documented(name: str) -> None:
    returns = inspect.signature(NAMES[name]).return_annotation
    found = sections(NAMES[name].__doc__ or "")
    assert returns in ("None", None) or found.keys() & {"Returns", "Yields"}


def test_missing_documentation_is_found() -> None:
    def half(a: int, b: int) -> int:
        """The half of it.

        Parameters
        ----------
        a : int
            A number.
        """
        return a + b

    assert undocumented(half) == ["b"]
    assert "Returns" not in sections(half.__doc__ or "")
