"""Words of the project's own that the field's words have replaced do not come back.

Identifiers are found by the syntax tree, prose by phrases, misspellings by codespell.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from basrelief.errors import RENAMED
from helpers.repository import REPOSITORY

PHRASES = {
    "to be had": "is available",
    "left away": "omitted",
    "by and by": "gradually",
    "told once": "reported once",
    "as at the start": "reset",
    "shall not say": "to override",
    "user can mend": "user can fix",
    "without more": "by default",
    "given up:": "just missed:",
    "take away": "export",
    'beside it"': "compare with",
    "objects' fall on": "where shadows land",
    "what goes by": "the reader or caller by its name",
    " is told ": "is reported",
    "are told": "are reported",
    "laid over": "composited",
    "--engine": "--device",
    "choose_engine": "choose_device",
    "engineerror": "DeviceError",
}
"""A phrase in lower case, and what to write in its place."""
RENAMES = "src/basrelief/errors.py"
"""The file with the table of renamed names, which may have these."""
WRITTEN = (
    "README.md", "CONTRIBUTING.md", "CONVENTIONS.md", "docs/**/*.md",
    "src/**/*.py", "src/**/*.js", "src/**/*.jinja", "benchmarks/*.md",
)  # fmt: skip
"""All but the changelog, which names what was replaced."""

IDENTIFIERS = {
    "Meeting": "Intersection",
    "meet": "intersect",
    "met": "intersection, or a noun for what was hit",
    "Displaced": "ReliefHit",
    "together": "a static condition",
    "apart": "own_tilings",
    "unread": "a static condition",
    "unasked": "a static condition",
    "everything": "a static condition",
    "nothing_else": "a static condition",
    "boxed": "columns",
    "fall": "travel",
    "depth_seen": "faded_relief",
    "beyond": "relief_distance",
    "further": "relief_distance",
    "Spot": "SurfacePoint",
    "spot_on": "surface_point",
    "Finish": "SurfaceParameters",
    "finish": "surface_parameters",
    "Reach": "ShadowMapTexel",
    "Reaching": "LightVisibility",
    "unhidden": "visibility",
    "CastView": "ShadowMapView",
    "cast_values": "shadow_map_values",
    "past_others": "shadow_map_visibility",
    "SLACK": "SHADOW_BIAS_TEXELS",
    "openness": "directional_visibility",
    "open_from_above": "directional_visibility",
    "slanted": "stretched_normal",
    "leave": "t_exit",
    "leaving": "t_exits",
    "air": "fog",
    "high_ground": "mountain_color",
    "thing": "obj",
    "things": "objects",
    "told": "reported",
    "said": "options",
    "asked": "requested",
    "noted": "recorded",
    "held": "clamped",
    "lay_over": "composite",
    "frame_of": "tangent_frame",
    "pyramids": "textures",
    "from_far_to_near": "back_to_front",
    "choose_engine": "choose_device",
    "EngineError": "DeviceError",
}
"""A name that is not to come back, and the field's name for it."""
ALLOWED = {"viewer/notebook.py": {"apart"}}
"""Uses of such a name that are right, by file."""
OPENINGS = re.compile(r"(What|How) ")
"""First words of a docstring that do not say what is computed."""


def files(*patterns: str) -> list[Path]:
    found = [file for pattern in patterns for file in sorted(REPOSITORY.glob(pattern))]
    assert found
    return found


def identifiers(source: str) -> Iterator[tuple[int, str]]:
    """The names that a module defines or assigns, with their lines."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.arg(arg=name):
                yield node.lineno, name
            case ast.Name(id=name, ctx=ast.Store()) | ast.alias(asname=str(name)):
                yield node.lineno, name


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """The docstrings of a module, its classes and functions, with their lines."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            text = ast.get_docstring(node)
            if text is not None:
                yield node.body[0].lineno, text


# --- the checks ----------------------------------------------------------------------------------


@pytest.mark.parametrize("pattern", WRITTEN)
def test_no_replaced_phrase_is_written_again(pattern: str) -> None:
    again = []
    for file in files(pattern):
        # a phrase may run over the end of a line, also of a comment
        text = re.sub(r"\s+(#|//|\*)?\s*", " ", file.read_text(encoding="utf-8")).lower()
        name = file.relative_to(REPOSITORY)
        again += [
            f"{name}: {phrase!r}: write {better!r}"
            for phrase, better in PHRASES.items()
            if phrase in text and not (name.as_posix() == RENAMES and better in RENAMED.values())
        ]
    assert again == []


def test_no_replaced_identifier_is_used_again() -> None:
    again = [
        f"{file.relative_to(REPOSITORY)}:{line}: {name}: write {IDENTIFIERS[name]}"
        for file in files("src/**/*.py")
        for line, name in identifiers(file.read_text(encoding="utf-8"))
        if name in IDENTIFIERS
        and name not in ALLOWED.get(file.relative_to(REPOSITORY / "src/basrelief").as_posix(), ())
    ]
    assert again == []


def test_docstrings_begin_with_what_is_computed() -> None:
    riddles = [
        f"{file.relative_to(REPOSITORY)}:{line}: {text.splitlines()[0]}"
        for file in files("src/**/*.py")
        for line, text in docstrings(file.read_text(encoding="utf-8"))
        if OPENINGS.match(text)
    ]
    assert riddles == []


def test_nothing_is_misspelt() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "codespell_lib", *map(str, files(*WRITTEN, "CHANGELOG.md"))],
        cwd=REPOSITORY, capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "")


# --- the checks can fail --------------------------------------------------------------------------


def test_identifiers_are_found_where_they_are_defined() -> None:
    source = "import a as met\ndef meet(thing):\n    x.said = 1\n    told = 2\nclass Spot: ..."
    assert sorted(name for _, name in identifiers(source)) == [
        "Spot", "meet", "met", "thing", "told",
    ]  # fmt: skip


def test_docstrings_are_found() -> None:
    source = '"""What it is."""\ndef f():\n    """How it goes."""\n    "no docstring"'
    assert [bool(OPENINGS.match(text)) for _, text in docstrings(source)] == [True, True]
