"""Loading of materials: choose files, read them, convert them to one convention, note decisions."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, fields, replace
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from basrelief.errors import InputError
from basrelief.images import Picture, read_picture
from basrelief.material import channels
from basrelief.material.channels import NormalPacking
from basrelief.material.conventions import Part, parse_name
from basrelief.material.evidence import SlopeCorrelation, slope_correlation
from basrelief.material.files import Choice, FileSet, search
from basrelief.material.material import Map, Material, Note
from basrelief.material.options import (
    MAPS,
    SAMPLE,
    HeightChannel,
    HeightPolarity,
    NormalConvention,
    Packing,
    ReadOptions,
    is_path,
    number_in_place_of_map,
)
from basrelief.material.samples import sample
from basrelief.threads import map_on_threads
from basrelief.timings import step

PathLike = str | os.PathLike[str]
MapSource = PathLike | float
_DEFAULT_OPTIONS = ReadOptions()

WELL_USED_RANGE = 0.9
"""Height maps that use a smaller part of their range get a note."""


@step("load")
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
    height: MapSource | None = None,
    occlusion: MapSource | None = None,
    roughness: MapSource | None = None,
    metallic: MapSource | None = None,
    emission: PathLike | None = None,
    opacity: MapSource | None = None,
    layer_mask: MapSource | None = None,
    dust: MapSource | None = None,
) -> Material:
    """Load a material from files.

    Maps are recognised by the file names of ambientCG, Poly Haven, Substance, Unity, Unreal and
    Blender users. Colours of 8 and 16 bits are decoded from sRGB, heights and other data never.
    A missing height map is no error.

    Parameters
    ----------
    path : path or str, optional
        A folder with one set of maps; or one picture, which loads the other files of its set too;
        or "sample:NAME" for a procedural sample. Omit it to name every map.
    normal_convention : {"auto", "gl", "dx"}, default "auto"
        Whether green is up ("gl") or down ("dx"). "auto" goes by the file name, and then by a
        comparison with the heights.
    height_polarity : {"auto", "height", "depth"}, default "auto"
        Whether white is high ("height") or deep ("depth"). "auto" goes by the file name, and then
        by a comparison with the normals.
    height_channel : {"auto", "r", "g", "b", "a", "luminance", "a_or_r"}, default "auto"
        Channel that holds the heights. "auto" is the channel of a grey picture, and green of
        others; "a_or_r" is alpha where it varies, and red elsewhere.
    normal_packing : {"rgb", "ag", "rg", "ag_or_rgb"}, default "rgb"
        Channels that hold the normals. "ag" and "rg" hold x and y, and z is reconstructed;
        "ag_or_rgb" is "ag" where the alpha varies, and "rgb" elsewhere.
    stretch_height : bool, default False
        Stretch heights that use a part of their range to 0 to 1.
    depth : float, optional
        Full height range in metres, above 0.
    tile : float, optional
        Width of the maps in metres, above 0.
    base_color, normal, emission : path or str, optional
        File of one map, to override what the file names imply; or a folder or "sample:NAME" for
        the map of that material.
    height, occlusion, roughness, metallic, opacity, layer_mask, dust : path, str or float, optional
        The same for the maps of one channel, or a number from 0 to 1 in place of a map. A material
        without a dust map gives its heights as dust.

    Returns
    -------
    Material
        Its `notes` list every decision and the reason for it.

    Raises
    ------
    InputError
        For paths that do not exist, pictures that cannot be read, file names that identify no map
        or leave a tie, options out of range, and maps that do not fit together.
    """
    options = ReadOptions(
        normal_convention, normal_packing, height_polarity, height_channel, stretch_height
    )
    requested = {
        name: value
        for name, value in {"depth": depth, "tile": tile, **vars(options)}.items()
        if value is not None and value != getattr(_DEFAULT_OPTIONS, name, None)
    }
    files = (
        base_color, normal, height, occlusion, roughness, metallic, emission, opacity, layer_mask,
        dust,
    )  # fmt: skip
    sources = {kind: _source(kind, f) for kind, f in zip(MAPS, files, strict=True) if f is not None}
    named_files = {k: Path(f) for k, f in sources.items() if is_path(f) and not os.path.isdir(f)}
    if path is None and not sources:
        raise InputError("nothing to load: name a folder, a picture or a map")
    if path is not None and os.fspath(path).startswith(SAMPLE):
        material = sample(os.fspath(path).removeprefix(SAMPLE))
        builder = _Builder(options, material.name, list(material.notes), dict(material.maps()))
        depth = material.depth if depth is None else depth
        tile = material.tile if tile is None else tile
        choices: dict[str, Choice] = {}
        unused = [f.name for f in fields(options) if getattr(options, f.name) != f.default]
        if unused and not named_files:
            builder.note(f"no use for {', '.join(unused)}", "a sample is generated, not read")
    else:
        file_set = _file_set(path, options, sources)
        builder = _Builder(options, file_set.name, list(file_set.notes))
        choices = {kind: each for kind, each in file_set.choices.items() if kind not in sources}
    for kind, source in sources.items():
        if kind not in named_files:
            builder.add_source(kind, source)
    material = builder.build({**choices, **_named_choices(named_files)}, depth, tile)
    return material.with_origin(None if path is None else os.fspath(path), {**requested, **sources})


def _source(kind: str, source: Any) -> str | float:
    """The path of a map, the name of a sample, or the number in its place."""
    if isinstance(source, Real) and not isinstance(source, bool | np.bool_):
        return float(source)
    try:
        text = os.fspath(source)
    except TypeError:
        raise InputError(f"{kind} is {source!r}: give a file, or a number") from None
    number = number_in_place_of_map(text)
    return text if number is None else number


def _file_set(
    path: PathLike | None, options: ReadOptions, sources: dict[str, str | float]
) -> FileSet:
    if path is None:
        names = [f for f in sources.values() if isinstance(f, str)]
        return FileSet(Path(next(iter(names), "plain").removeprefix(SAMPLE)).stem, {}, ())
    green = None if options.normal_convention == "auto" else options.normal_convention
    return search(Path(path), green, frozenset(sources))


def _map_of(kind: str, path: str, material: Material) -> Map:
    """A map of another material, which `path` names; heights serve as dust."""
    found: Map | None = getattr(material, kind)
    if found is None and kind == "dust":
        found = material.height
    if found is None:
        raise InputError(f"{path} has no {kind} map; choose another sample, folder or file")
    return found


def _constant_map(kind: str, value: float) -> Map:
    """A map of one texel."""
    if MAPS[kind].channels > 1:
        raise InputError(f"{kind} is {value:g}: give a file; a number is for maps of one channel")
    if not 0.0 <= value <= 1.0:
        raise InputError(f"{kind} is {value:g}: give a number from 0 to 1, or a file")
    return Map(np.full((1, 1, 1), value, np.float32), False, f"{value:g}")


def _named_choices(named_files: dict[str, Path]) -> dict[str, Choice]:
    """Choices for the files that the user names; channel and polarity still follow their names."""
    choices = {}
    for kind, path in named_files.items():
        meaning = parse_name(path.stem).meaning
        parts = [part for part in meaning.parts if part.map == kind] if meaning else []
        choices[kind] = Choice(path, parts[0] if parts else Part(kind), meaning)
    return choices


@dataclass
class _Builder:
    """Builds a material: reads each chosen file once, and collects maps and notes."""

    options: ReadOptions
    name: str
    notes: list[Note] = field(default_factory=list)
    maps: dict[str, Map] = field(default_factory=dict)
    pictures: dict[Path, Picture] = field(default_factory=dict)
    """Pictures by file."""

    def build(
        self, choices: dict[str, Choice], depth: float | None, tile: float | None
    ) -> Material:
        choices = dict(choices)
        self.read_pictures(choices)
        for kind in ("base_color", "emission"):
            if kind in choices:
                self.add_color(kind, choices[kind])
        for kind in ("occlusion", "roughness", "metallic", "opacity", "layer_mask", "dust"):
            if kind in choices:
                self.add_scalar(kind, choices[kind])
        if "normal" in choices:
            self.add_normal(choices["normal"])
        if "height" in choices:
            self.add_height(choices["height"])
        self.add_alpha_channels(choices)
        self.resolve_conventions(choices)
        self.check_height_range()
        return Material(self.name, **self.maps, depth=depth, tile=tile, notes=tuple(self.notes))

    def note(self, what: str, why: str) -> None:
        self.notes.append(Note(what, why))

    def read_pictures(self, choices: dict[str, Choice]) -> None:
        """Read all files at once, on several threads: decoding is most of the work of loading."""
        paths = list(dict.fromkeys(choice.path for choice in choices.values()))
        self.pictures = dict(zip(paths, map_on_threads(read_picture, paths), strict=True))

    def picture(self, choice: Choice) -> Picture:
        return self.pictures[choice.path]

    def add_source(self, kind: str, source: str | float) -> None:
        """Add a map that no file of its own holds: of another material, or a number."""
        if isinstance(source, str):
            self.maps[kind] = _map_of(kind, source, load(source, **vars(self.options)))
            self.note(f"{kind} from {source}", "requested")
        else:
            self.maps[kind] = _constant_map(kind, source)
            self.note(f"{kind} {source:g}", "requested")

    def add_color(self, kind: str, choice: Choice) -> None:
        pixels = channels.extract_rgb(self.picture(choice))
        encoded = pixels.dtype != np.float32
        self.maps[kind] = Map(pixels, encoded, choice.path.name)
        why = "integers are sRGB" if encoded else "floats are linear"
        self.note(f"{kind} from {choice.path.name}", why)

    def add_scalar(self, kind: str, choice: Choice) -> None:
        channel = choice.part.channel or "r"
        picture = self.picture(choice)
        if kind == "opacity" and not choice.part.channel and picture.alpha is not None:
            channel = "a"  # a cut-out is often stored as the alpha of an otherwise empty picture
        pixels = channels.extract_channel(picture, channel)
        source = choice.path.name
        if choice.part.channel:
            source += f" ({channel.upper()})"
        if choice.part.inverted:
            pixels = channels.inverted(pixels)
            source = f"1 − {source}"
        self.maps[kind] = Map(pixels, False, source)
        why = "a packed map, by its name" if choice.part.channel else "read as linear data"
        if choice.part.inverted:
            why = "gloss by its name, the inverse of roughness"
        self.note(f"{kind} from {source}", why)

    def add_normal(self, choice: Choice) -> None:
        packing = self.packing(choice)
        pixels = channels.extract_normals(self.picture(choice), packing)
        self.maps["normal"] = Map(pixels, False, choice.path.name)
        why = (
            "x, y, z as stored"
            if packing == "rgb"
            else f"x, y from {packing.upper()}, z reconstructed"
        )
        self.note(f"normal from {choice.path.name}", why)

    def packing(self, choice: Choice) -> NormalPacking:
        """The packing of this picture's normals."""
        requested = self.options.normal_packing
        if requested != "ag_or_rgb":
            return requested
        return "ag" if self.alpha_varies(choice) else "rgb"

    def alpha_varies(self, choice: Choice) -> bool:
        alpha = self.picture(choice).alpha
        return alpha is not None and not channels.is_constant(alpha)

    def add_height(self, choice: Choice) -> None:
        picture = self.picture(choice)
        requested = self.options.height_channel
        channel: str
        if requested == "a_or_r":
            channel = "a" if self.alpha_varies(choice) else "r"
            why = "its alpha varies" if channel == "a" else "its alpha is constant"
        elif requested != "auto":
            channel, why = requested, "requested"
        elif choice.part.channel:
            channel, why = choice.part.channel, "a packed map, by its name"
        elif picture.opaque.shape[2] == 1:
            channel, why = "g", "its only channel"
        else:
            channel, why = "g", "green, the default for pictures with several channels"
        pixels = channels.extract_channel(picture, channel)
        grey = picture.opaque.shape[2] == 1 and channel != "a"
        source = choice.path.name if grey else f"{choice.path.name} ({channel.upper()})"
        self.maps["height"] = Map(pixels, False, source)
        self.note(f"height from {source}", f"{why}; {self.maps['height'].bits} bits, linear")

    def add_alpha_channels(self, choices: dict[str, Choice]) -> None:
        """Add heights from the normal map's alpha, and opacity from the base colour's."""
        carrier = choices.get("normal")
        if carrier is None or self.packing(carrier) != "ag":
            self.add_alpha_channel("height", "normal", choices)
        self.add_alpha_channel("opacity", "base_color", choices)

    def add_alpha_channel(self, kind: str, carrier: str, choices: dict[str, Choice]) -> None:
        choice = choices.get(carrier)
        alpha = self.picture(choice).alpha if choice else None
        if choice is None or alpha is None or channels.is_constant(alpha):
            return
        source = f"{choice.path.name} (A)"
        if kind not in self.maps:
            choices[kind] = Choice(choice.path, Part(kind, "a"), None)
            self.maps[kind] = Map(np.ascontiguousarray(alpha), False, source)
            self.note(f"{kind} from {source}", f"the alpha of the {carrier} map varies")
        elif self.maps[kind].source != source:
            self.note(f"ignored {source}", f"a separate {kind} map exists")

    def resolve_conventions(self, choices: dict[str, Choice]) -> None:
        """Convert depths to heights and green to up: by option, by name, or by correlation."""
        correlation = None
        if "height" in self.maps and "normal" in self.maps:
            correlation = slope_correlation(self.maps["height"].pixels, self.maps["normal"].pixels)
        if "height" in choices:
            self.resolve_polarity(choices["height"], correlation)
        if "normal" in choices:
            self.resolve_green(choices["normal"], correlation)

    def resolve_polarity(self, choice: Choice, correlation: SlopeCorrelation | None) -> None:
        requested = self.options.height_polarity
        if requested != "auto":
            deep, why = requested == "depth", f"requested: {requested}"
        elif choice.part.inverted:
            deep, why = True, "depth by its name"
        elif correlation is not None and correlation.heights_are_depths:
            deep, why = True, f"by comparison with the normals: {correlation}"
        else:
            deep, why = False, "the default"
        if deep:
            pixels = channels.inverted(self.maps["height"].pixels)
            self.maps["height"] = replace(self.maps["height"], pixels=pixels)
        self.note("white is deep, so inverted" if deep else "white is high", why)

    def resolve_green(self, choice: Choice, correlation: SlopeCorrelation | None) -> None:
        requested = self.options.normal_convention
        named_green = choice.meaning and choice.meaning.green
        shown_down = correlation is not None and correlation.green_is_down
        if requested != "auto":
            down, why = requested == "dx", f"requested: {requested.upper()}"
        elif named_green:
            down, why = named_green == "dx", f"{named_green.upper()} by its name"
            if correlation is not None and correlation.is_significant and shown_down != down:
                why += f", although the heights contradict it: {correlation}"
        elif shown_down:
            down, why = True, f"DX by comparison with the heights: {correlation}"
        elif correlation is not None and correlation.is_significant:
            down, why = False, f"confirmed by the heights: {correlation}"
        else:
            down, why = False, "GL is the default"
        if down:
            pixels = channels.with_green_flipped(self.maps["normal"].pixels)
            self.maps["normal"] = replace(self.maps["normal"], pixels=pixels)
        self.note("normals with green down, so inverted" if down else "normals with green up", why)

    def check_height_range(self) -> None:
        """Bring heights into 0 to 1, and note a poorly used range."""
        if "height" not in self.maps:
            self.note("no height map", "no file for it, so the material is drawn flat")
            return
        height = self.maps["height"]
        low, high = height.range()
        uses = f"{height.source} uses {low:.3g} to {high:.3g}"
        if low == high:
            self.note("the heights are constant", f"{height.source} is {low:.3g} everywhere")
        if low < 0 or high > 1:
            self.stretch("heights have to be 0 to 1", uses)
        elif self.options.stretch_height and low < high:
            self.stretch("requested", uses)
        elif low < high and high - low < WELL_USED_RANGE:
            percent = f"{100 * (high - low):.0f} %"
            advice = "stretch them with stretch_height (--stretch-height)"
            self.note(f"the heights use {percent} of the range", f"{uses}; {advice}")

    def stretch(self, why: str, uses: str) -> None:
        height = self.maps["height"]
        self.maps["height"] = replace(height, pixels=channels.stretched(height.pixels))
        self.note("heights stretched to 0…1", f"{why}; {uses}")
