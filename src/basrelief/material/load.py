"""Files → Material: choose, read, bring into one convention, and say what was decided."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from basrelief.errors import InputError
from basrelief.images import Picture, read_picture
from basrelief.material import channels
from basrelief.material.channels import NormalPacking
from basrelief.material.conventions import Part, parse_name
from basrelief.material.evidence import Agreement, agreement
from basrelief.material.files import Choice, Found, search
from basrelief.material.material import MAPS, Map, Material, Note
from basrelief.material.samples import sample

NormalConvention = Literal["auto", "gl", "dx"]
HeightPolarity = Literal["auto", "height", "depth"]
HeightChannel = Literal["auto", "r", "g", "b", "a", "luminance", "a_or_r"]
Packing = Literal["rgb", "ag", "rg", "ag_or_rgb"]
PathLike = str | os.PathLike[str]

SAMPLE = "sample:"
"""`load` takes names of procedural samples with this in front."""

USED_WELL = 0.9
"""Height maps that use less of their range than this get a note."""


@dataclass(frozen=True)
class Reading:
    """How files are read where their names leave it open: the options of `load`."""

    normal_convention: NormalConvention = "auto"
    height_polarity: HeightPolarity = "auto"
    height_channel: HeightChannel = "auto"
    normal_packing: Packing = "rgb"
    stretch_height: bool = False

    def __post_init__(self) -> None:
        for name, known in (
            ("normal_convention", get_args(NormalConvention)),
            ("height_polarity", get_args(HeightPolarity)),
            ("height_channel", get_args(HeightChannel)),
            ("normal_packing", get_args(Packing)),
        ):
            if getattr(self, name) not in known:
                raise InputError(
                    f"{name} is one of {', '.join(known)}, not {getattr(self, name)!r}"
                )


def load(
    path: PathLike | None = None,
    *,
    normal_convention: NormalConvention = "auto",
    height_polarity: HeightPolarity = "auto",
    height_channel: HeightChannel = "auto",
    normal_packing: Packing = "rgb",
    stretch_height: bool = False,
    depth: float | None = None,
    tile: float | None = None,
    base_color: PathLike | None = None,
    normal: PathLike | None = None,
    height: PathLike | None = None,
    occlusion: PathLike | None = None,
    roughness: PathLike | None = None,
    metallic: PathLike | None = None,
    emission: PathLike | None = None,
    opacity: PathLike | None = None,
    layer_mask: PathLike | None = None,
) -> Material:
    """Load a material.

    `path` is a folder with one set of maps; or one picture, which brings along the files beside it
    that belong to it by their names; or `sample:` and the name of a procedural sample; or None
    when all maps are named. The last nine arguments name a file for one map, whatever names say, or
    `sample:NAME` for that map of a sample.

    `normal_convention`: is green up ("gl") or down ("dx")? "auto" asks the name, then compares
    with the heights. `height_polarity`: is white high ("height") or deep ("depth")? "auto" asks
    the name, then compares with the normals. `height_channel`: "auto" is the only channel of a
    grey picture, green otherwise; "a_or_r" the alpha where it varies, red otherwise.
    `normal_packing`: see `channels.normals`; "ag_or_rgb" is "ag" where the alpha varies, "rgb"
    otherwise. `stretch_height` lets heights that use a part of their range fill 0 to 1. `depth` (of
    the full height range) and `tile` (width) are metres.

    Heights and other data are never decoded from sRGB, colours of 8 and 16 bits are. No height
    map is no error. What was decided stands in the material's `notes`.
    Raises InputError for what cannot be used: see `files.search`, `read_picture`, `Material`.
    """
    reading = Reading(
        normal_convention, height_polarity, height_channel, normal_packing, stretch_height
    )
    files = (
        base_color, normal, height, occlusion, roughness, metallic, emission, opacity, layer_mask,
    )  # fmt: skip
    given = {kind: os.fspath(f) for kind, f in zip(MAPS, files, strict=True) if f is not None}
    drawn = {kind: f for kind, f in given.items() if f.startswith(SAMPLE)}
    named = {kind: Path(f) for kind, f in given.items() if kind not in drawn}
    if path is None and not given:
        raise InputError("nothing to load: name a folder, a picture or a map")
    if path is not None and os.fspath(path).startswith(SAMPLE):
        material = sample(os.fspath(path).removeprefix(SAMPLE))
        builder = _Builder(reading, material.name, list(material.notes), dict(material.maps()))
        depth = material.depth if depth is None else depth
        tile = material.tile if tile is None else tile
        choices: dict[str, Choice] = {}
    else:
        found = _find(path, reading, given)
        builder = _Builder(reading, found.name, list(found.notes))
        choices = {kind: each for kind, each in found.choices.items() if kind not in drawn}
    builder.add_samples(drawn)
    return builder.build({**choices, **_named(named)}, depth, tile)


def _find(path: PathLike | None, reading: Reading, named: dict[str, str]) -> Found:
    if path is None:
        return Found(Path(next(iter(named.values())).removeprefix(SAMPLE)).stem, {}, ())
    green = None if reading.normal_convention == "auto" else reading.normal_convention
    return search(Path(path), green, frozenset(named))


def _named(named: dict[str, Path]) -> dict[str, Choice]:
    """Files that the user names: the map is given, their names may still tell channel and sense."""
    choices = {}
    for kind, path in named.items():
        meaning = parse_name(path.stem).meaning
        parts = [part for part in meaning.parts if part.map == kind] if meaning else []
        choices[kind] = Choice(path, parts[0] if parts else Part(kind), meaning)
    return choices


@dataclass
class _Builder:
    """Reads the chosen files, each once, and gathers the maps and the notes."""

    reading: Reading
    name: str
    notes: list[Note] = field(default_factory=list)
    maps: dict[str, Map] = field(default_factory=dict)
    pictures: dict[Path, Picture] = field(default_factory=dict)

    def build(
        self, choices: dict[str, Choice], depth: float | None, tile: float | None
    ) -> Material:
        choices = dict(choices)
        for kind in ("base_color", "emission"):
            if kind in choices:
                self.add_color(kind, choices[kind])
        for kind in ("occlusion", "roughness", "metallic", "opacity", "layer_mask"):
            if kind in choices:
                self.add_scalar(kind, choices[kind])
        if "normal" in choices:
            self.add_normal(choices["normal"])
        if "height" in choices:
            self.add_height(choices["height"])
        self.take_alphas(choices)
        self.settle_directions(choices)
        self.finish_height()
        return Material(self.name, **self.maps, depth=depth, tile=tile, notes=tuple(self.notes))

    def note(self, what: str, why: str) -> None:
        self.notes.append(Note(what, why))

    def picture(self, choice: Choice) -> Picture:
        if choice.path not in self.pictures:
            self.pictures[choice.path] = read_picture(choice.path)
        return self.pictures[choice.path]

    def add_samples(self, drawn: dict[str, str]) -> None:
        """Maps that are those of samples, each `sample:NAME`."""
        for kind, name in drawn.items():
            each = getattr(sample(name.removeprefix(SAMPLE)), kind)
            if each is None:
                raise InputError(f"{name} has no {kind} map; choose another sample, or a file")
            self.maps[kind] = each
            self.note(f"{kind} from {name}", "asked for")

    def add_color(self, kind: str, choice: Choice) -> None:
        pixels = channels.three_channels(self.picture(choice))
        encoded = pixels.dtype != np.float32
        self.maps[kind] = Map(pixels, encoded, choice.path.name)
        why = "whole numbers, so sRGB" if encoded else "floats, so linear already"
        self.note(f"{kind} from {choice.path.name}", why)

    def add_scalar(self, kind: str, choice: Choice) -> None:
        channel = choice.part.channel or "r"
        picture = self.picture(choice)
        if kind == "opacity" and not choice.part.channel and picture.alpha is not None:
            channel = "a"  # a cut-out is often stored as the alpha of a plain picture
        pixels = channels.one_channel(picture, channel)
        source = choice.path.name
        if choice.part.channel:
            source += f" ({channel.upper()})"
        if choice.part.inverted:
            pixels = channels.inverted(pixels)
            source = f"1 − {source}"
        self.maps[kind] = Map(pixels, False, source)
        why = "the name says that it is packed" if choice.part.channel else "read as linear data"
        if choice.part.inverted:
            why = "the name says gloss, the opposite of roughness"
        self.note(f"{kind} from {source}", why)

    def add_normal(self, choice: Choice) -> None:
        packing = self.packing(choice)
        pixels = channels.normals(self.picture(choice), packing)
        self.maps["normal"] = Map(pixels, False, choice.path.name)
        why = "x, y, z as stored" if packing == "rgb" else f"x, y from {packing.upper()}, z rebuilt"
        self.note(f"normal from {choice.path.name}", why)

    def packing(self, choice: Choice) -> NormalPacking:
        """How this picture's normals are stored."""
        wanted = self.reading.normal_packing
        if wanted != "ag_or_rgb":
            return wanted
        return "ag" if self.alpha_varies(choice) else "rgb"

    def alpha_varies(self, choice: Choice) -> bool:
        alpha = self.picture(choice).alpha
        return alpha is not None and not channels.constant(alpha)

    def add_height(self, choice: Choice) -> None:
        picture = self.picture(choice)
        wanted = self.reading.height_channel
        channel: str
        if wanted == "a_or_r":
            channel = "a" if self.alpha_varies(choice) else "r"
            why = "its alpha varies" if channel == "a" else "its alpha holds nothing"
        elif wanted != "auto":
            channel, why = wanted, "asked for"
        elif choice.part.channel:
            channel, why = choice.part.channel, "the name says that it is packed"
        elif picture.opaque.shape[2] == 1:
            channel, why = "g", "its one channel"
        else:
            channel, why = "g", "green, by default, of a picture with several channels"
        pixels = channels.one_channel(picture, channel)
        grey = picture.opaque.shape[2] == 1 and channel != "a"
        source = choice.path.name if grey else f"{choice.path.name} ({channel.upper()})"
        self.maps["height"] = Map(pixels, False, source)
        self.note(f"height from {source}", f"{why}; {self.maps['height'].bits} bits, linear")

    def take_alphas(self, choices: dict[str, Choice]) -> None:
        """Heights in the alpha of the normal map, opacity in that of the base colour."""
        carrier = choices.get("normal")
        if carrier is None or self.packing(carrier) != "ag":
            self.take_alpha("height", "normal", choices)
        self.take_alpha("opacity", "base_color", choices)

    def take_alpha(self, kind: str, carrier: str, choices: dict[str, Choice]) -> None:
        choice = choices.get(carrier)
        alpha = self.picture(choice).alpha if choice else None
        if choice is None or alpha is None or channels.constant(alpha):
            return
        source = f"{choice.path.name} (A)"
        if kind not in self.maps:
            choices[kind] = Choice(choice.path, Part(kind, "a"), None)
            self.maps[kind] = Map(np.ascontiguousarray(alpha), False, source)
            self.note(f"{kind} from {source}", f"the alpha of the {carrier} map varies")
        elif self.maps[kind].source != source:
            self.note(f"left out {source}", f"there is a {kind} map of its own")

    def settle_directions(self, choices: dict[str, Choice]) -> None:
        """Turn depths to heights and green up: as told, as named, or as the maps show."""
        found = None
        if "height" in self.maps and "normal" in self.maps:
            found = agreement(self.maps["height"].pixels, self.maps["normal"].pixels)
        if "height" in choices:
            self.settle_polarity(choices["height"], found)
        if "normal" in choices:
            self.settle_green(choices["normal"], found)

    def settle_polarity(self, choice: Choice, found: Agreement | None) -> None:
        wanted = self.reading.height_polarity
        if wanted != "auto":
            deep, why = wanted == "depth", f"asked for {wanted}"
        elif choice.part.inverted:
            deep, why = True, "the name says depth"
        elif found is not None and found.heights_are_depths:
            deep, why = True, f"the normals show it: {found}"
        else:
            deep, why = False, "the default"
        if deep:
            pixels = channels.inverted(self.maps["height"].pixels)
            self.maps["height"] = replace(self.maps["height"], pixels=pixels)
        self.note("white is deep, turned round" if deep else "white is high", why)

    def settle_green(self, choice: Choice, found: Agreement | None) -> None:
        wanted, named = self.reading.normal_convention, choice.meaning and choice.meaning.green
        shown_down = found is not None and found.green_is_down
        if wanted != "auto":
            down, why = wanted == "dx", f"asked for {wanted.upper()}"
        elif named:
            down, why = named == "dx", f"the name says {named.upper()}"
            if found is not None and found.clear and shown_down != down:
                why += f", though the heights speak against it: {found}"
        elif shown_down:
            down, why = True, f"the heights show DX: {found}"
        elif found is not None and found.clear:
            down, why = False, f"the heights agree: {found}"
        else:
            down, why = False, "GL by default; nothing says otherwise"
        if down:
            pixels = channels.with_green_turned(self.maps["normal"].pixels)
            self.maps["normal"] = replace(self.maps["normal"], pixels=pixels)
        self.note("normals with green down, turned up" if down else "normals with green up", why)

    def finish_height(self) -> None:
        """See that heights lie within 0 to 1, and say how much of that they use."""
        if "height" not in self.maps:
            self.note("no height map", "no file for it; there is no relief to draw")
            return
        height = self.maps["height"]
        low, high = height.range()
        uses = f"{height.source} uses {low:.3g} to {high:.3g}"
        if low == high:
            self.note("the relief is flat", f"{height.source} is {low:.3g} everywhere")
        if low < 0 or high > 1:
            self.stretch("heights lie within 0 to 1", uses)
        elif self.reading.stretch_height and low < high:
            self.stretch("asked for", uses)
        elif low < high and high - low < USED_WELL:
            share = f"{100 * (high - low):.0f} % of the range"
            fill = "stretch_height (--stretch-height) fills it"
            self.note(f"the relief is {share}", f"{uses}; {fill}")

    def stretch(self, why: str, uses: str) -> None:
        height = self.maps["height"]
        self.maps["height"] = replace(height, pixels=channels.stretched(height.pixels))
        self.note("heights stretched to 0…1", f"{why}; {uses}")
