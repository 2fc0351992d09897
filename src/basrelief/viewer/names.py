"""Tables of `material.conventions` by which a page reads names of dropped files."""

from __future__ import annotations

from typing import Any

from basrelief.material import conventions
from basrelief.material.conventions import Meaning, Part

PACKED = "packed"
"""The page's slot for occlusion, roughness and metal in red, green and blue."""
_PACKED = {Part("occlusion", "r"), Part("roughness", "g"), Part("metallic", "b")}


def names() -> dict[str, Any]:
    """Spellings with their slots, other significant words, and patterns that split names."""
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
    """The slot of a file, "" for none, and whether its values are inverted.

    Of a file with several maps the page uses the first, unless it is a packed map.
    """
    if set(meaning.parts) == _PACKED:
        return [PACKED, False]
    if not meaning.parts or (len(meaning.parts) > 1 and meaning.parts[0].channel):
        return ["", False]
    first = meaning.parts[0]
    return ["" if first.map == "layer_mask" else first.map, first.inverted]
