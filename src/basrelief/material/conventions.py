"""Map types and conventions inferred from the file names of textures.

Names are split into words at `_`, `-`, `.`, spaces, changes of case and numbers; resolutions and
file formats are dropped. The last known words decide, so `rough_wood_diff_1k` is a base colour.
The naming of ambientCG, Poly Haven, Substance, Unity, Unreal, Megascans and Blender users is
covered, and the usual packed maps.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from basrelief.material.options import MAPS

Green = Literal["gl", "dx"]


@dataclass(frozen=True)
class Part:
    """One map in a file: its name, its channel ("" for the file's own), whether it is inverted."""

    map: str
    channel: str = ""
    inverted: bool = False


@dataclass(frozen=True)
class Meaning:
    """Contents of a file, by its name.

    Without `parts` the picture is not used. `second` marks a name that yields to the usual one.
    `green` is the direction of a normal map's green, where the name states it. `bump` marks a name
    that stands for heights with some tools and for normals with others.
    """

    parts: tuple[Part, ...]
    second: bool = False
    green: Green | None = None
    bump: bool = False


@dataclass(frozen=True)
class Name:
    """A parsed file name: its words, those before the map type, and its meaning."""

    words: tuple[str, ...]
    prefix: tuple[str, ...]
    meaning: Meaning | None


def _single(map: str, *, inverted: bool = False, second: bool = False) -> Meaning:
    return Meaning((Part(map, inverted=inverted),), second=second)


def _packed(**channels: str) -> Meaning:
    """`_packed(r="occlusion")`; "gloss" is an inverted roughness."""
    return Meaning(
        tuple(
            Part("roughness", channel, inverted=True) if map == "gloss" else Part(map, channel)
            for channel, map in channels.items()
        )
    )


_NORMAL_HEIGHT = Meaning((Part("normal"), Part("height", "a")))
_COLOR_OPACITY = Meaning((Part("base_color"), Part("opacity", "a")))
_ORM = _packed(r="occlusion", g="roughness", b="metallic")
_RMA = _packed(r="roughness", g="metallic", b="occlusion")
_MRAO = _packed(r="metallic", g="roughness", b="occlusion")
_METAL_ROUGH = _packed(g="roughness", b="metallic")
_METAL_GLOSS = _packed(r="metallic", a="gloss")
_MASK_MAP = _packed(r="metallic", g="occlusion", a="gloss")
_UNUSED = Meaning(())

_SPELLINGS: Mapping[str, Meaning] = {
    "albedo alb basecolor basecolour basecol base color colour col maintex": _single("base_color"),
    "diffuse diff dif": _single("base_color", second=True),
    "normal normals nor norm nrm nrml nml": _single("normal"),
    "height heights hgt displacement displace displ disp dis parallax relief elevation": _single(
        "height"
    ),
    "bump bmp": Meaning((Part("height"),), second=True, bump=True),
    "depth dpt cavitydepth parallaxdepth": _single("height", inverted=True, second=True),
    "occlusion ambientocclusion ambientocc ao mixedao occ": _single("occlusion"),
    "roughness rough rgh": _single("roughness"),
    "gloss glossiness smoothness": _single("roughness", inverted=True, second=True),
    "metallic metalness metal metall metalic mtl": _single("metallic"),
    "emission emissive emit emissivecolor emissioncolor glow": _single("emission"),
    "opacity alpha transparency cutout": _single("opacity"),
    "detailmask layermask": _single("layer_mask"),
    "dustmask dustmap": _single("dust"),
    "normalheight normalh nh nrmh normaldisplacement normaldisp": _NORMAL_HEIGHT,
    "albedotransparency albedoalpha albedoopacity coloropacity coloralpha": _COLOR_OPACITY,
    "basecoloralpha basecoloropacity diffusealpha": _COLOR_OPACITY,
    "orm arm aorm occlusionroughnessmetallic occlusionroughnessmetalness": _ORM,
    "aoroughnessmetallic aoroughmetal aoroughnessmetalness": _ORM,
    "rma rmao roughnessmetallicao roughnessmetallicocclusion": _RMA,
    "mra mrao metallicroughnessao metallicroughnessocclusion": _MRAO,
    "metallicroughness metalroughness metalrough metalnessroughness": _METAL_ROUGH,
    "metallicsmoothness metallicgloss metalsmoothness metallicglossiness": _METAL_GLOSS,
}
_NOT_USED = (
    "specular spec specularlevel reflection refl ior f0 sss subsurface scattering "
    "translucency translucent transmission thickness curvature cavity id detail "
    "anisotropy anisotropic sheen fuzz clearcoat coat position worldnormal bentnormal "
    "cone relaxedcone horizon bounds "
    "basrelief preview previews thumb thumbnail render rendered renders sphere screenshot"
)
"""Names of maps that no surface reads, and of other pictures that lie beside maps."""


def _table() -> dict[str, Meaning]:
    """Meanings by spelling, each also with the suffixes "map", "tex" and "texture".

    Every map is found under its own name, and under those of `_SPELLINGS`; but "dust" alone is
    part of the names of materials.
    """
    table = {"maskmap": _MASK_MAP}
    own = [(name.replace("_", ""), _single(name)) for name in MAPS if name != "dust"]
    # a map's own name counts for more than a list of maps that are not used
    for spellings, meaning in ((_NOT_USED, _UNUSED), *own, *_SPELLINGS.items()):
        for spelling in spellings.split():
            for suffix in ("", "map", "tex", "texture"):
                table[spelling + suffix] = meaning
    return table


MEANINGS = _table()

UNREAL = {
    "d": "color",
    "bc": "color",
    "n": "normal",
    "h": "height",
    "r": "roughness",
    "m": "metallic",
    "e": "emission",
}
"""Suffixes of names that begin with T_, after Epic's naming guide."""

GREEN: Mapping[str, Green] = {
    "gl": "gl",
    "ogl": "gl",
    "opengl": "gl",
    "dx": "dx",
    "directx": "dx",
}
INVERTED = frozenset({"inv", "inverted", "inverse", "invert"})
MAX_WORDS = 4
"""Most words that form one map type."""

WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+[kK](?![a-z])|\d+")
SIZES = re.compile(
    r"(?<![A-Za-z0-9])(\d{2,5}[xX]\d{2,5}|\d+[- ]?bits?|\d+K)(?![a-z0-9])", re.IGNORECASE
)
FORMATS = frozenset({"jpg", "jpeg", "png", "tif", "tiff", "exr", "tga"})
RESOLUTIONS = frozenset(str(2**power) for power in range(7, 15))


def words(stem: str) -> tuple[str, ...]:
    """The words of a file name without its suffix, in lower case, without sizes and formats."""
    text = re.sub(r"(?i)d3d", "Directx", SIZES.sub(" ", stem))
    return tuple(
        word.lower()
        for word in WORD.findall(text)
        if word.lower() not in FORMATS and word not in RESOLUTIONS
    )


def parse_name(stem: str) -> Name:
    """Parse one file name by itself."""
    return _read(words(stem))


def parse_names(stems: Iterable[str]) -> dict[str, Name]:
    """Parse the file names of one folder together.

    Words that all names begin with belong to the material, not to the map: next to
    `rusty_metal_normal`, `rusty_metal` is no metal map. They are ignored, unless names other than
    the one that consists of these words alone would lose their meaning.
    """
    words_of = {stem: words(stem) for stem in stems}
    separate = {stem: _read(name_words) for stem, name_words in words_of.items()}
    shared = _shared_prefix(list(words_of.values()))
    without_prefix: dict[str, Name] = {}
    for stem, name_words in words_of.items():
        rest = _read(name_words[len(shared) :])
        without_prefix[stem] = Name(name_words, shared + rest.prefix, rest.meaning)
    lost = [
        stem
        for stem in without_prefix
        if separate[stem].meaning and not without_prefix[stem].meaning
    ]
    is_name_of_set = len(lost) == 1 and words_of[lost[0]] == shared
    others = any(name.meaning and name.meaning.parts for name in without_prefix.values())
    return without_prefix if not lost or (is_name_of_set and others) else separate


def _shared_prefix(names: list[tuple[str, ...]]) -> tuple[str, ...]:
    if len(names) < 2:
        return ()
    count = 0
    for column in zip(*names, strict=False):
        if len(set(column)) > 1:
            break
        count += 1
    return names[0][:count]


def _read(name: tuple[str, ...]) -> Name:
    """Find the last known run of words, the longest first."""
    if len(name) > 2 and name[0] == "t" and name[-1] in UNREAL:
        return Name(name, name[:-1], MEANINGS[UNREAL[name[-1]]])
    for end in range(len(name), 0, -1):
        for start in range(max(end - MAX_WORDS, 0), end):
            meaning = MEANINGS.get("".join(name[start:end])) or _with_green(name[start:end])
            if meaning is not None:
                prefix, tail = name[:start], name[end:]
                return Name(name, prefix, _qualified(meaning, prefix[-1:] + tail))
    return Name(name, name, None)


def _with_green(name: tuple[str, ...]) -> Meaning | None:
    """Meaning of a normal map with its convention in the same word, such as "normalgl"."""
    for spelling, green in GREEN.items():
        stem = "".join(name).removesuffix(spelling)
        if stem != "".join(name) and stem in MEANINGS:
            meaning = MEANINGS[stem]
            if any(part.map == "normal" for part in meaning.parts):
                return replace(meaning, green=green)
    return None


def _qualified(meaning: Meaning, neighbours: tuple[str, ...]) -> Meaning:
    """The meaning with the green direction and the inversion that neighbouring words state."""
    if any(part.map == "normal" for part in meaning.parts):
        for word in neighbours:
            meaning = replace(meaning, green=meaning.green or GREEN.get(word))
    if any(word in INVERTED for word in neighbours):
        meaning = replace(
            meaning,
            parts=tuple(
                replace(part, inverted=not part.inverted)
                if part.map in ("height", "roughness")
                else part
                for part in meaning.parts
            ),
        )
    return meaning
