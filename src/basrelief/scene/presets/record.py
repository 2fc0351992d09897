"""What a preset is, and how it becomes a scene."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from basrelief.errors import InputError, new_name, suggestion
from basrelief.images import write_whole
from basrelief.material import MAPS, Map, Material, load
from basrelief.material.load import ReadOptions
from basrelief.scene import SURFACES, Layer, Object, Scene, Tiling, technique_named
from basrelief.scene.checks import check_choice
from basrelief.scene.presets import checks
from basrelief.techniques import flat, relief

_TABLES = ("maps", "object", "scene", "motion")
_RECORDS = ("settings", "smoothing", "surface_parameters", "shading", "shadowing", "fog")
"""The options that are records of numbers: of two of them the second changes the first."""
_LENGTHS = ("max_offset", "step_length")
"""The settings that are lengths in tile widths."""
_SAMPLE = "sample:"


@dataclass(frozen=True)
class Preset:
    """What an article or a user settles on: `values` has the tables `maps`, `object`, `scene`.

    These hold options of `load`, fields of `Object` and fields of `Scene`, by their names, as TOML
    can say them; `motion.scroll` is how far the maps move in a second, in the shape's own
    coordinates. With `object.lengths = "shape"` scale and lengths are fractions of the shape, and
    not, as everywhere else, of a tile of the height map. `about` is one paragraph; `source` says
    after whom. Raises InputError for keys that there are not, and for values out of range.
    """

    name: str
    about: str = ""
    source: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    file: Path | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        for key in ("name", "about", "source"):
            if not isinstance(getattr(self, key), str):
                raise InputError(f"{key} is {getattr(self, key)!r}: give a text")
        if not isinstance(self.values, Mapping):
            raise InputError(f"values are {self.values!r}: give {', '.join(_TABLES)}")
        for key in self.values:
            if key not in _TABLES:
                known = ("name", "about", "source", *_TABLES)
                raise InputError(f"no key {key!r}; {suggestion(key, known)}")
        object.__setattr__(self, "values", checks.frozen(self.values, ""))
        checks.checked(self._table("maps"), checks.OF_MAPS, "maps")
        checks.checked(self._table("object"), checks.OF_OBJECT, "object")
        checks.checked(self._table("scene"), checks.OF_SCENE, "scene")
        checks.checked(self._table("motion"), checks.OF_MOTION, "motion")
        check_choice("object.lengths", self._lengths, ("tile", "shape"))
        self._try()

    # --- what it says

    @property
    def maps(self) -> dict[str, Any]:
        """Options of `load`."""
        return {
            key: self._from_here(each) if key in MAPS else each
            for key, each in self._table("maps").items()
        }

    @property
    def scroll(self) -> tuple[float, float]:
        """How far all maps move in a second, along u and v of the shape's own coordinates."""
        u, v = self._table("motion").get("scroll", (0.0, 0.0))
        return float(u), float(v)

    def scene(self, material: Material, **options: Any) -> Scene:
        """A scene of a material; `options` are those of `Object` and `Scene`, and win.

        Raises InputError for options that there are not, and for values out of range.
        """
        return scene_of(material, self.options(material, options))

    def options(self, material: Material, given: Mapping[str, Any]) -> dict[str, Any]:
        """All options of `Object` and `Scene`: those given, over those of the preset."""
        ours = self._ours()
        if "layer" in ours and "layer" not in given:
            ours["layer"] = self._layer(load(self._from_here(ours["layer"]["material"])))
        return self._merged(ours, material, given)

    # --- files

    def to_toml(self) -> str:
        """The preset as the text of a TOML file, which `preset` reads back."""
        import tomli_w

        texts = {key: getattr(self, key) for key in ("name", "about", "source")}
        said = {key: text for key, text in texts.items() if text}
        return tomli_w.dumps({**said, **self.values})

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the preset as a TOML file, whole or not at all; returns the path.

        Raises InputError for a name that does not end in .toml, and where it cannot be written.
        """
        target = Path(path)
        if target.suffix != ".toml":
            raise InputError(f"{target}: a preset is a .toml file; name it so")
        text = self.to_toml()
        write_whole(target, lambda partial: partial.write_text(text, "utf-8", newline="\n"))
        return target

    # --- within

    def _table(self, name: str) -> Mapping[str, Any]:
        found: Mapping[str, Any] = self.values.get(name, MappingProxyType({}))
        return found

    @property
    def _lengths(self) -> str:
        return str(self._table("object").get("lengths", "tile"))

    def _from_here(self, path: str) -> str:
        """A path as seen from the preset's own folder; names of samples stay."""
        if path.startswith(_SAMPLE) or self.file is None:
            return path
        return str(self.file.parent.resolve() / path)

    def _ours(self) -> dict[str, Any]:
        """The options that the preset says, all but the layer's material made."""
        made = {**self._table("object"), **self._table("scene")}
        made.pop("lengths", None)
        if ".py:" in made.get("technique", ""):
            made["technique"] = technique_named(self._from_here(made["technique"]))
        if "tilings" in made:
            made["tilings"] = {
                name: _tiling(each, f"object.tilings.{name}")
                for name, each in made["tilings"].items()
            }
        if "layer" in made:
            checks.checked(made["layer"], checks.OF_LAYER, "object.layer")
            if "material" not in made["layer"]:
                raise InputError("object.layer needs a material: a path, or sample:NAME")
        if "camera" in made:
            made["camera"] = checks.camera_of(made["camera"])
        if "lights" in made:
            made["lights"] = tuple(map(checks.light_of, made["lights"]))
        return made

    def _layer(self, material: Material) -> Layer:
        said = self._table("object")["layer"]
        plain = Layer(material)
        tiles = said.get("tiles", plain.tiling.tiles)
        return Layer(material, Tiling(tiles, said.get("shift", plain.tiling.shift)))

    def _merged(
        self, ours: dict[str, Any], material: Material, given: Mapping[str, Any]
    ) -> dict[str, Any]:
        technique = given.get("technique", ours.get("technique"))
        if technique is None:
            technique = flat if material.height is None else relief
        technique = technique_named(technique)
        surface = given.get("surface", ours.get("surface", "standard"))
        # what another technique or surface than the preset's own does not have is left out
        for name, record in (
            ("settings", technique.settings),
            ("surface_parameters", SURFACES.get(surface)),
        ):
            other = {"settings": "technique", "surface_parameters": "surface"}[name]
            if name in ours and other in given and record is not None:
                known = record.__dataclass_fields__
                ours[name] = {key: each for key, each in ours[name].items() if key in known}
        if self._lengths == "shape":
            self._to_tiles(ours, material, given)
        if "technique" in ours or "technique" in given:
            ours["technique"] = technique
        made = {**ours, **{key: each for key, each in given.items() if key != "technique"}}
        for name in (*_RECORDS, "tilings"):
            if isinstance(given.get(name), Mapping) and name in ours:
                made[name] = {**ours[name], **given[name]}
        return made

    def _to_tiles(self, ours: dict[str, Any], material: Material, given: Mapping[str, Any]) -> None:
        """Lengths that are fractions of the shape as fractions of a tile of the heights."""
        lie = {k: {**ours, **given}[k] for k in ("shape", "tiling") if k in {**ours, **given}}
        tiles = abs(float(Object(material, **lie).tiles[0]))
        if "scale" in ours:
            ours["scale"] = ours["scale"] * tiles
        settings = dict(ours.get("settings", {}))
        for name in _LENGTHS:
            if name in settings:
                settings[name] = min(settings[name] * tiles, 1.0)
        ours["settings"] = settings

    def _try(self) -> None:
        """Make a scene of a small material, so that what does not fit is told at once."""
        bumpy = Material(
            "any", height=Map(np.array([[[0.0], [1.0]]], np.float32), False, "made up")
        )
        ReadOptions(**{key: each for key, each in self._table("maps").items() if key not in MAPS})
        ours = self._ours()
        if "layer" in ours:
            ours["layer"] = self._layer(bumpy)
        scene_of(bumpy, self._merged(ours, bumpy, {}))


def _tiling(said: Any, key: str) -> Tiling:
    checks.checked(said, checks.OF_TILING, key)
    return Tiling(**said)


def scene_of(material: Material, options: Mapping[str, Any]) -> Scene:
    """A scene of one material from options of `Object` and `Scene`."""
    of_scene = {k: each for k, each in options.items() if k in Scene.__dataclass_fields__}
    of_object = {k: each for k, each in options.items() if k not in of_scene}
    names = set(Object.__dataclass_fields__) - {"material"}
    for name in of_object:
        if name not in names:
            known = sorted(names | set(Scene.__dataclass_fields__) - {"objects"})
            # functions that draw take a device, and pass on what they do not know
            hint = new_name(name, ("device",)) or suggestion(name, known)
            raise InputError(f"no option {name!r}; {hint}")
    return Scene((Object(material, **of_object),), **of_scene)
