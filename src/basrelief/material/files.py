"""Which file becomes which map.

Where several files of a set fit one map, these preferences decide, in this order:

1. the usual name before the second choice (height before bump or depth, albedo before diffuse,
   roughness before gloss), and a file of its own before a channel of a packed one;
2. normals with green up (GL) before green down (DX), unless DX is asked for;
3. more bits before fewer: float, 16, 8;
4. lossless formats before lossy ones;
5. more pixels before fewer.

What still ties is the user's to decide: InputError names the files and the way out.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from basrelief.errors import InputError
from basrelief.images import LOSSY, READABLE, picture_size, read_picture
from basrelief.material.conventions import Green, Meaning, Name, Part, parse_name, parse_names
from basrelief.material.material import MAPS, Note


@dataclass(frozen=True)
class Choice:
    """A file taken for a map, the part of it that is meant, and what its name means as a whole."""

    path: Path
    part: Part
    meaning: Meaning | None


@dataclass(frozen=True)
class Found:
    """The files chosen for a material, and the notes of the search."""

    name: str
    choices: dict[str, Choice]
    notes: tuple[Note, ...]


def search(path: Path, green: Green | None, settled: frozenset[str]) -> Found:
    """Choose the files of the set that `path`, a folder or one picture of the set, stands for.

    Maps in `settled` are given by the user and not chosen. Raises InputError when the path is
    missing, holds no picture, says of no picture which map it is, or leaves a true tie.
    """
    if os.path.isdir(path):
        return _search_folder(path, green, settled)
    if os.path.exists(path):
        return _search_set(path, green, settled)
    raise InputError(f"{path}: there is no such file or folder; check the name")


def _search_folder(folder: Path, green: Green | None, settled: frozenset[str]) -> Found:
    name = folder.resolve().name or "material"
    notes: list[Note] = []
    pictures = _pictures(folder)
    if not pictures:
        inner = [each for each in _entries(folder) if each.is_dir() and _pictures(each)]
        if len(inner) != 1:
            raise InputError(f"{folder}: there is no picture in this folder; name another")
        notes.append(Note(f"looked into {inner[0].name}", "the only folder within with pictures"))
        folder, pictures = inner[0], _pictures(inner[0])
    by_stem = parse_names(path.stem for path in pictures)
    names = {path: by_stem[path.stem] for path in pictures}
    if "base_color" not in settled:
        names = _with_unnamed_color(names, notes)
    if not settled and not any(_parts(each) for each in names.values()):
        raise InputError(
            f"{folder}: no file name says which map it is ({_listed(pictures)});"
            " name one: --base-color FILE, --height FILE"
        )
    notes += _left_out(names)
    return Found(name, _choose(names, green, settled, notes), tuple(notes))


def _search_set(path: Path, green: Green | None, settled: frozenset[str]) -> Found:
    """One picture: with the files beside it whose names say that they belong to it, or alone."""
    own = parse_name(path.stem)
    beside = {each: parse_name(each.stem) for each in _pictures(path.parent) if each != path}
    named = {each: name for each, name in beside.items() if _parts(name)}
    of_its_name = {each: name for each, name in named.items() if name.prefix == own.words}
    of_its_set = {each: name for each, name in named.items() if name.prefix == own.prefix}
    if of_its_name or not _parts(own):
        own = Name(own.words, own.words, Meaning((Part("base_color"),)))
        of_its_set = of_its_name
        why = "it was named, and nothing says that it is another map"
    else:
        why = "it was named, and its name says so"
    notes = [Note(f"{path.name} taken for {' and '.join(_maps(own))}", why)]
    mine = _choose({path: own}, green, settled, notes)
    rest = _choose(of_its_set, green, settled | mine.keys(), notes)
    others = sorted({choice.path for choice in rest.values()} - {path})
    if others:
        listed = ", ".join(each.name for each in others)
        notes.append(Note(f"{listed} taken along", "the name is that of the same set"))
    stems = [each.stem for each in (path, *others)]
    shared = os.path.commonprefix(stems).strip(" _-.")  # noqa: RUF071, by characters is meant
    return Found(shared or path.stem, {**mine, **rest}, tuple(notes))


def _entries(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be read ({error.strerror}); check its rights"
        ) from error


def _pictures(folder: Path) -> list[Path]:
    """Pictures by their suffix, hidden files left out."""
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
    """Take a picture whose name is the material's for the base colour, where no other says so."""
    if any("base_color" in _maps(name) for name in names.values()):
        return names
    unnamed = [path for path, name in names.items() if name.meaning is None]
    prefixes = {name.prefix for name in names.values() if _parts(name)}
    candidates = [path for path in unnamed if names[path].words in prefixes] or unnamed
    if len(candidates) != 1:
        return names
    path = candidates[0]
    notes.append(
        Note(f"{path.name} taken for base_color", "the one picture whose name says no map")
    )
    color = Name(names[path].words, names[path].words, Meaning((Part("base_color"),)))
    return {**names, path: color}


def _left_out(names: dict[Path, Name]) -> list[Note]:
    unknown = [path for path, name in names.items() if name.meaning is None]
    unused = [path for path, name in names.items() if name.meaning and not _parts(name)]
    notes = []
    if unknown:
        notes.append(Note(f"left out {_listed(unknown)}", "the name says no map"))
    if unused:
        notes.append(Note(f"left out {_listed(unused)}", "this kind of map is not used"))
    return notes


def _choose(
    names: dict[Path, Name], green: Green | None, settled: frozenset[str], notes: list[Note]
) -> dict[str, Choice]:
    """The preferred file for each map that is not settled, with a note where several fit."""
    candidates: dict[str, list[Choice]] = {kind: [] for kind in MAPS}
    prefixes = {path: name.prefix for path, name in names.items()}
    for path, name in names.items():
        meaning = _bump_by_its_looks(path, name.meaning)
        if meaning != name.meaning:
            notes.append(Note(f"{path.name} taken for normal", "a bump map, but a coloured one"))
        for part in meaning.parts if meaning else ():
            candidates[part.map].append(Choice(path, part, meaning))
    return {
        kind: _best(kind, fitting, prefixes, green, notes)
        for kind, fitting in candidates.items()
        if fitting and kind not in settled
    }


def _best(
    kind: str,
    fitting: list[Choice],
    prefixes: dict[Path, tuple[str, ...]],
    green: Green | None,
    notes: list[Note],
) -> Choice:
    if len(fitting) == 1:
        return fitting[0]
    ranks = {choice.path: _rank(choice, green) for choice in fitting}
    best, second = sorted(fitting, key=lambda choice: (ranks[choice.path], choice.path.name))[:2]
    one, other = best.path, second.path
    if ranks[one] == ranks[other]:
        option = f"--{kind.replace('_', '-')} FILE"
        if prefixes[one] != prefixes[other]:
            option = f"one picture of the set in place of the folder, or {option}"
        raise InputError(
            f"{one.parent}: {one.name} and {other.name} both fit the {kind} map; name {option}"
        )
    pairs = zip(ranks[one], ranks[other], _reasons(green), strict=True)
    why = next(reason for left, right, reason in pairs if left != right)
    notes.append(Note(f"{one.name} before {other.name} for {kind}", why))
    return best


def _reasons(green: Green | None) -> tuple[str, ...]:
    """Why a file is preferred, in words, in the order of `_rank`."""
    return (
        "it is the usual name, or a file of its own",
        f"{'DX' if green == 'dx' else 'GL'} is preferred",
        "it has more bits",
        "its format loses nothing",
        "it has more pixels",
    )


def _rank(choice: Choice, wanted: Green | None) -> tuple[int, ...]:
    """The preferences of this module, as numbers: smaller is better."""
    wanted = wanted or "gl"
    size = picture_size(choice.path)
    green = choice.meaning.green if choice.meaning else None
    second = choice.meaning.second if choice.meaning else False
    return (
        2 * second + (choice.part.channel != ""),
        0 if green == wanted else 1 if green is None else 2,
        -size.bits,
        choice.path.suffix.lower() in LOSSY,
        -size.width * size.height,
    )


def _bump_by_its_looks(path: Path, meaning: Meaning | None) -> Meaning | None:
    """Unity calls a normal map "bump", others a height map: coloured ones are normals."""
    if meaning is None or not meaning.bump or picture_size(path).channels < 3:
        return meaning
    pixels = read_picture(path).pixels
    if (pixels[:, :, 0] == pixels[:, :, 2]).all():
        return meaning
    return replace(meaning, parts=(Part("normal"),))
