"""Words that standard terms have replaced do not come back, in source, tests and documents.

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
RENAMES = ("src/basrelief/errors.py", "tests/cli/test_renamed.py")
"""The table of renamed names and its tests, which may have these."""
THIS = "tests/project/test_words.py"
"""This file, which may have all of them."""
WRITTEN = (
    "README.md", "CONTRIBUTING.md", "CONVENTIONS.md", "docs/**/*.md",
    "src/**/*.py", "src/**/*.js", "src/**/*.jinja", "benchmarks/*.md", "tests/**/*.py",
)  # fmt: skip
"""All texts but the changelog, which names what was replaced."""
SOURCES = ("src/**/*.py", "tests/**/*.py")

IDENTIFIERS = {
    "Meeting": "Intersection",
    "meeting": "intersection",
    "meet": "intersect",
    "met": "intersection, or a noun for what was hit",
    "Displaced": "ReliefHit",
    "with_relief": "a static condition",
    "without_relief": "a static condition",
    "as_it_is": "a static condition",
    "anywhere": "a static condition",
    "Choices": "Variant",
    "together": "a static condition",
    "apart": "own_tilings",
    "unread": "a static condition",
    "unasked": "a static condition",
    "everything": "a static condition",
    "nothing_else": "a static condition",
    "nothing": "what is empty or 0",
    "boxed": "columns",
    "fall": "travel",
    "fallen": "descent",
    "Depth": "ReliefParameters",
    "depth_seen": "faded_relief",
    "beyond": "relief_distance",
    "further": "relief_distance",
    "Spot": "SurfacePoint",
    "spot_on": "surface_point",
    "Finish": "SurfaceParameters",
    "finish": "surface_parameters",
    "Reach": "ShadowMapTexel",
    "Reaching": "LightVisibility",
    "reaching": "visibility",
    "reaching_past_others": "shadow_map_visibility",
    "unhidden": "visibility",
    "CastView": "ShadowMapView",
    "cast_values": "shadow_map_values",
    "past_others": "shadow_map_visibility",
    "SLACK": "SHADOW_BIAS_TEXELS",
    "openness": "directional_visibility",
    "open_from_above": "directional_visibility",
    "slanted": "stretched_normal",
    "facing": "cosine, or shading_normal",
    "bent": "the operation, such as blended",
    "turned": "rotated",
    "lies": "chart",
    "laid": "chart",
    "leave": "t_exit",
    "leaving": "t_exits",
    "air": "fog",
    "high_ground": "mountain_color",
    "thing": "obj",
    "things": "objects",
    "thing_of": "object_of",
    "told": "reported",
    "said": "options",
    "asked": "requested",
    "noted": "recorded",
    "held": "clamped",
    "given": "arguments, options or values",
    "kept": "cached or stored",
    "room": "headroom or clearance",
    "way": "direction or ray",
    "ways": "directions or rays",
    "firsts": "first_hits",
    "landed": "hits or overshoot",
    "followed": "traced",
    "ended": "hit",
    "proven": "the bound, or the hit",
    "lay_over": "composite",
    "frame_of": "tangent_frame",
    "pyramids": "textures",
    "from_far_to_near": "back_to_front",
    "choose_engine": "choose_device",
    "EngineError": "DeviceError",
    **dict.fromkeys(
        ("Way", "Sights", "Ahead", "Four", "Octave", "Top", "Walk", "Seen", "Lay"),
        "the contents of the record",
    ),
}
"""A name that is not to come back, and the field's name for it."""
ALLOWED = {"src/basrelief/viewer/notebook.py": {"apart"}}
"""Names that a file may use: `apart` is a key of saved links of the viewer."""
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
            if phrase in text
            and name.as_posix() != THIS
            and not (name.as_posix() in RENAMES and better in RENAMED.values())
        ]
    assert again == []


def test_no_replaced_identifier_is_used_again() -> None:
    again = [
        f"{file.relative_to(REPOSITORY)}:{line}: {name}: write {IDENTIFIERS[name]}"
        for file in files(*SOURCES)
        for line, name in identifiers(file.read_text(encoding="utf-8"))
        if name in IDENTIFIERS
        and name not in ALLOWED.get(file.relative_to(REPOSITORY).as_posix(), ())
    ]
    assert again == []


def test_docstrings_do_not_open_with_what_or_how() -> None:
    riddles = [
        f"{file.relative_to(REPOSITORY)}:{line}: {text.splitlines()[0]}"
        for file in files(*SOURCES)
        for line, text in docstrings(file.read_text(encoding="utf-8"))
        if OPENINGS.match(text)
    ]
    assert riddles == []


def test_no_word_is_misspelt() -> None:
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
