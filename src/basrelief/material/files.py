"""Assignment of image files to maps.

Where several files of a set fit one map, these preferences decide, in this order:

1. the usual name before the fallback (height before bump or depth, albedo before diffuse,
   roughness before gloss), and a separate file before a channel of a packed one;
2. normals with green up (GL) before green down (DX), unless DX is requested;
3. more bits before fewer: float, 16, 8;
4. lossless formats before lossy ones;
5. more pixels before fewer.

A remaining tie is an InputError that names the files and the option that decides.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from basrelief.errors import InputError
from basrelief.images import LOSSY, READABLE, picture_size, read_picture
from basrelief.material.conventions import Green, Meaning, Name, Part, parse_name, parse_names
from basrelief.material.material import Note
from basrelief.material.options import MAPS


@dataclass(frozen=True)
class Choice:
    """A file chosen for a map, the part of it that holds the map, and the meaning of its name."""

    path: Path
    part: Part
    meaning: Meaning | None


@dataclass(frozen=True)
class FileSet:
    """Files chosen for a material, and the notes of the search."""

    name: str
    choices: dict[str, Choice]
    notes: tuple[Note, ...]


def search(path: Path, green: Green | None, assigned: frozenset[str]) -> FileSet:
    """Choose the files of a set; `path` is its folder or one of its pictures.

    Maps in `assigned` are set by the user and skipped. Raises InputError for a path that does not
    exist, a folder without pictures, file names that identify no map, and ties.
    """
    if os.path.isdir(path):
        return _search_folder(path, green, assigned)
    if os.path.exists(path):
        return _search_set(path, green, assigned)
    raise InputError(f"{path}: there is no such file or folder; check the name")


def _search_folder(folder: Path, green: Green | None, assigned: frozenset[str]) -> FileSet:
    name = folder.resolve().name or "material"
    notes: list[Note] = []
    pictures = _pictures(folder)
    if not pictures:
        inner = [file for file in _entries(folder) if file.is_dir() and _pictures(file)]
        if len(inner) != 1:
            raise InputError(f"{folder}: no picture in this folder; name another")
        notes.append(Note(f"searched {inner[0].name}", "the only subfolder with pictures"))
        folder, pictures = inner[0], _pictures(inner[0])
    by_stem = parse_names(path.stem for path in pictures)
    names = {path: by_stem[path.stem] for path in pictures}
    if "base_color" not in assigned:
        names = _with_unnamed_color(names, notes)
    if not assigned and not any(_parts(file) for file in names.values()):
        raise InputError(
            f"{folder}: no file name identifies a map ({_listed(pictures)});"
            " name one: --base-color FILE, --height FILE"
        )
    notes += _ignored_notes(names)
    return FileSet(name, _choose(names, green, assigned, notes), tuple(notes))


def _search_set(path: Path, green: Green | None, assigned: frozenset[str]) -> FileSet:
    """One picture, with the files in its folder that belong to the same set by their names."""
    own = parse_name(path.stem)
    neighbours = {file: parse_name(file.stem) for file in _pictures(path.parent) if file != path}
    named = {file: name for file, name in neighbours.items() if _parts(name)}
    of_its_name = {file: name for file, name in named.items() if name.prefix == own.words}
    of_its_set = {file: name for file, name in named.items() if name.prefix == own.prefix}
    if of_its_name or not _parts(own):
        own = Name(own.words, own.words, Meaning((Part("base_color"),)))
        of_its_set = of_its_name
        why = "the picture that was named, with no other map in its name"
    else:
        why = "by its name"
    notes = [Note(f"{path.name} used as {' and '.join(_maps(own))}", why)]
    own_choices = _choose({path: own}, green, assigned, notes)
    other_choices = _choose(of_its_set, green, assigned | own_choices.keys(), notes)
    others = sorted({choice.path for choice in other_choices.values()} - {path})
    if others:
        listed = ", ".join(file.name for file in others)
        notes.append(Note(f"{listed} loaded too", "the same set, by its name"))
    stems = [file.stem for file in (path, *others)]
    shared = os.path.commonprefix(stems).strip(" _-.")  # noqa: RUF071, compared by characters on purpose
    return FileSet(shared or path.stem, {**own_choices, **other_choices}, tuple(notes))


def _entries(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be read ({error.strerror}); check its rights"
        ) from error


def _pictures(folder: Path) -> list[Path]:
    """Pictures by their suffix, without hidden files."""
    return [
        path
        for path in _entries(folder)
        if path.suffix.lower() in READABLE and not path.name.startswith(".") and path.is_file()
    ]


def _parts(name: Name) -> tuple[Part, ...]:
    return name.meaning.parts if name.meaning else ()


def _maps(name: Name) -> list[str]:
    return [part.map for part in _parts(name)]


def _listed(paths: Iterable[Path]) -> str:
    names = sorted(path.name for path in paths)
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")


def _with_unnamed_color(names: dict[Path, Name], notes: list[Note]) -> dict[Path, Name]:
    """Use a picture that is named after the material as base colour, where no other file is one."""
    if any("base_color" in _maps(name) for name in names.values()):
        return names
    unnamed = [path for path, name in names.items() if name.meaning is None]
    prefixes = {name.prefix for name in names.values() if _parts(name)}
    candidates = [path for path in unnamed if names[path].words in prefixes] or unnamed
    if len(candidates) != 1:
        return names
    path = candidates[0]
    notes.append(
        Note(f"{path.name} used as base_color", "the only picture without a map in its name")
    )
    color = Name(names[path].words, names[path].words, Meaning((Part("base_color"),)))
    return {**names, path: color}


def _ignored_notes(names: dict[Path, Name]) -> list[Note]:
    unknown = [path for path, name in names.items() if name.meaning is None]
    unused = [path for path, name in names.items() if name.meaning and not _parts(name)]
    notes = []
    if unknown:
        notes.append(Note(f"ignored {_listed(unknown)}", "no map in the name"))
    if unused:
        notes.append(Note(f"ignored {_listed(unused)}", "maps of this kind are not used"))
    return notes


def _choose(
    names: dict[Path, Name], green: Green | None, assigned: frozenset[str], notes: list[Note]
) -> dict[str, Choice]:
    """The preferred file for each map that is not settled, with a note where several fit."""
    candidates: dict[str, list[Choice]] = {kind: [] for kind in MAPS}
    prefixes = {path: name.prefix for path, name in names.items()}
    for path, name in names.items():
        meaning = _classified_bump(path, name.meaning)
        if meaning != name.meaning:
            notes.append(
                Note(f"{path.name} used as normal", "a bump map by its name, but coloured")
            )
        for part in meaning.parts if meaning else ():
            candidates[part.map].append(Choice(path, part, meaning))
    return {
        kind: _best(kind, fits, prefixes, green, notes)
        for kind, fits in candidates.items()
        if fits and kind not in assigned
    }


def _best(
    kind: str,
    fits: list[Choice],
    prefixes: dict[Path, tuple[str, ...]],
    green: Green | None,
    notes: list[Note],
) -> Choice:
    if len(fits) == 1:
        return fits[0]
    ranks = {choice.path: _rank(choice, green) for choice in fits}
    best, second = sorted(fits, key=lambda choice: (ranks[choice.path], choice.path.name))[:2]
    first, other = best.path, second.path
    if ranks[first] == ranks[other]:
        option = f"--{kind.replace('_', '-')} FILE"
        if prefixes[first] != prefixes[other]:
            option = f"one picture of the set instead of the folder, or {option}"
        raise InputError(
            f"{first.parent}: {first.name} and {other.name} both fit the {kind} map; name {option}"
        )
    pairs = zip(ranks[first], ranks[other], _reasons(green), strict=True)
    why = next(reason for left, right, reason in pairs if left != right)
    notes.append(Note(f"{first.name} before {other.name} for {kind}", why))
    return best


def _reasons(green: Green | None) -> tuple[str, ...]:
    """Reasons for a preference, in the order of `_rank`."""
    return (
        "the usual name, or a separate file",
        f"{'DX' if green == 'dx' else 'GL'} is preferred",
        "more bits",
        "a lossless format",
        "more pixels",
    )


def _rank(choice: Choice, preferred: Green | None) -> tuple[int, ...]:
    """Rank of a choice by the preferences of this module; smaller is better."""
    preferred = preferred or "gl"
    size = picture_size(choice.path)
    green = choice.meaning.green if choice.meaning else None
    second = choice.meaning.second if choice.meaning else False
    return (
        2 * second + (choice.part.channel != ""),
        0 if green == preferred else 1 if green is None else 2,
        -size.bits,
        choice.path.suffix.lower() in LOSSY,
        -size.width * size.height,
    )


def _classified_bump(path: Path, meaning: Meaning | None) -> Meaning | None:
    """The meaning of a "bump" map by its pixels: normals if coloured (Unity), heights if grey."""
    if meaning is None or not meaning.bump or picture_size(path).channels < 3:
        return meaning
    pixels = read_picture(path).pixels
    if (pixels[:, :, 0] == pixels[:, :, 2]).all():
        return meaning
    return replace(meaning, parts=(Part("normal"),))
