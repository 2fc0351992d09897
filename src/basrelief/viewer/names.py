"""What the name of a dropped file says, for a page: the tables of `material.conventions`."""

from __future__ import annotations

from typing import Any

from basrelief.material import conventions
from basrelief.material.conventions import Meaning, Part

PACKED = "packed"
"""The page's name for occlusion, roughness and metal in red, green and blue."""
_PACKED = {Part("occlusion", "r"), Part("roughness", "g"), Part("metallic", "b")}


def names() -> dict[str, Any]:
    """Spellings and what a page takes them for, other words that count, how names are cut."""
    return {
        "meanings": {text: place_of(meaning) for text, meaning in conventions.MEANINGS.items()},
        "unreal": dict(conventions.UNREAL),
        "green": dict(conventions.GREEN),
        "inverted": sorted(conventions.INVERTED),
        "formats": sorted(conventions.FORMATS),
        "resolutions": sorted(conventions.RESOLUTIONS),
        "longest": conventions.MAX_WORDS,
        "word": conventions.WORD.pattern,
        "sizes": conventions.SIZES.pattern,
    }


def place_of(meaning: Meaning) -> list[Any]:
    """The map that a page takes a file for, "" for none, and whether it is turned over.

    Of a file that holds several maps the page takes the first, unless it is one that it knows.
    """
    if set(meaning.parts) == _PACKED:
        return [PACKED, False]
    if not meaning.parts or (len(meaning.parts) > 1 and meaning.parts[0].channel):
        return ["", False]
    first = meaning.parts[0]
    return ["" if first.map == "layer_mask" else first.map, first.inverted]
