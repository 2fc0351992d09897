"""The record of a preset, and its conversion to a scene."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from basrelief.errors import InputError, new_name, suggestion
from basrelief.images import write_bytes
from basrelief.images.files import check_writable
from basrelief.material import MAPS, Map, Material, load
from basrelief.material.options import ReadOptions, is_path
from basrelief.scene import SURFACES, Layer, Object, Scene, Tiling, technique_named
from basrelief.scene.checks import check_range, check_setting, is_number
from basrelief.scene.presets import checks
from basrelief.scene.resolve import default_technique, default_tiles
from basrelief.settings import Setting, check_choice, settings_of
from basrelief.techniques import Technique

_TABLES = ("maps", "object", "scene", "motion")
_RECORDS = tuple(
    name
    for record in (Object, Scene)
    for name, declared in settings_of(record).items()
    if declared.kind == "numbers"
)
"""Options that are records of numbers, which merge field by field."""


@dataclass(frozen=True)
class Preset:
    """A named set of options for `load`, `Object` and `Scene`.

    Parameters
    ----------
    name : str
        Name of the preset.
    about : str, optional
        Description, one paragraph.
    source : str, optional
        Author and title of the article that it follows.
    values : mapping
        The tables `maps` (options of `load`), `object` and `scene` (fields of `Object` and
        `Scene`), with TOML values, and `motion`, whose `scroll` is the speed of the maps in texture
        coordinates of the shape per second. With `object.lengths = "shape"`, the scale and settings
        that are lengths are fractions of the shape's width instead of a tile's, also those of
        options that override the preset's.
    file : path, optional
        File of the preset; paths in its values are relative to its folder.

    Raises
    ------
    InputError
        For unknown keys, and for values of another type or out of range.
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
        object.__setattr__(self, "values", checks.freeze(self.values, ""))
        checks.check_table(self._table("maps"), checks.MAPS_KEYS, "maps")
        checks.check_table(self._table("object"), checks.OBJECT_KEYS, "object")
        checks.check_table(self._table("scene"), checks.SCENE_KEYS, "scene")
        checks.check_table(self._table("motion"), checks.MOTION_KEYS, "motion")
        check_choice("object.lengths", self.lengths, ("tile", "shape"))
        self._check_scene()

    # --- values

    @property
    def maps(self) -> dict[str, Any]:
        """Options of `load`."""
        return {
            key: self._resolved_path(value) if key in MAPS else value
            for key, value in self._table("maps").items()
        }

    @property
    def scroll(self) -> tuple[float, float]:
        """Speed of all maps along u and v, in texture coordinates of the shape per second."""
        u, v = self._table("motion").get("scroll", (0.0, 0.0))
        return float(u), float(v)

    @property
    def lengths(self) -> str:
        """Unit of the scale and of settings that are lengths: the width of a "tile" or "shape"."""
        return str(self._table("object").get("lengths", "tile"))

    def scene(self, material: Material, **options: Any) -> Scene:
        """The scene of a material with the preset's options.

        Parameters
        ----------
        material : Material
            Material of the object.
        **options
            Options of `Object` and `Scene`, which override the preset's; lengths are in the
            preset's unit.

        Returns
        -------
        Scene

        Raises
        ------
        InputError
            For unknown options and values out of range.
        """
        return scene_of(material, self.options(material, options))

    def options(self, material: Material, overrides: Mapping[str, Any]) -> dict[str, Any]:
        """All options of `Object` and `Scene`: the preset's, with `overrides` applied."""
        return self.in_tiles(self.merged(material, overrides), material)

    def merged(self, material: Material, overrides: Mapping[str, Any]) -> dict[str, Any]:
        """The options of the preset with `overrides` applied, lengths in the preset's unit."""
        defaults = self._preset_options()
        if "layer" in defaults and "layer" not in overrides:
            defaults["layer"] = self._layer(
                load(self._resolved_path(defaults["layer"]["material"]))
            )
        return self._merged(defaults, material, overrides)

    # --- lengths

    def in_tiles(self, options: Mapping[str, Any], material: Material) -> dict[str, Any]:
        """Options with lengths in tile widths, as `Object` takes them.

        Raises InputError for a length that is out of range in tile widths.
        """
        converted = dict(options)
        if self.lengths == "tile":
            return converted
        tiles, _ = _tiles_of(options, material)
        declared = settings_of(Object)["scale"]
        if "scale" in options:
            converted["scale"] = _in_tiles(declared, options["scale"], tiles)
        if "settings" in options:
            technique = technique_named(options.get("technique") or default_technique(material))
            settings = options["settings"]
            converted["settings"] = self.settings_in_tiles(settings, technique, options, material)
        return converted

    def settings_in_tiles(
        self,
        settings: Any,
        technique: Technique[..., Any],
        options: Mapping[str, Any],
        material: Material,
    ) -> Any:
        """Settings of a technique with lengths in tile widths; `options` place the tiles."""
        if self.lengths == "tile":
            return settings
        declared = settings_of(technique.settings)
        if isinstance(settings, technique.settings):
            settings = {name: getattr(settings, name) for name in declared}
        if not isinstance(settings, Mapping):
            return settings
        tiles, tiles_v = _tiles_of(options, material)
        converted = {
            name: _in_tiles(declared[name], value, tiles)
            if name in declared and declared[name].in_tiles
            else value
            for name, value in settings.items()
        }
        ratio = settings.get("max_offset_ratio", 1.0)
        if "max_offset" in settings and "max_offset_ratio" in declared and is_number(ratio):
            # the ratio of two lengths in the shape's coordinates
            converted["max_offset_ratio"] = ratio * tiles_v / tiles
        return converted

    # --- files

    def to_toml(self) -> str:
        """The preset as the text of a TOML file, which `preset` reads back."""
        import tomli_w

        texts = {key: getattr(self, key) for key in ("name", "about", "source")}
        table = {key: text for key, text in texts.items() if text}
        return tomli_w.dumps({**table, **self.values})

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the preset as a TOML file, atomically.

        Parameters
        ----------
        path : str or path
            File to write, which ends in .toml.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            For another suffix, and where the file cannot be written.
        """
        target = Path(path)
        check_preset_file(target)
        text = self.to_toml()
        write_bytes(target, lambda: text.encode())
        return target

    # --- within

    def _table(self, name: str) -> Mapping[str, Any]:
        table: Mapping[str, Any] = self.values.get(name, MappingProxyType({}))
        return table

    def _resolved_path(self, path: Any) -> Any:
        """A path relative to the preset's folder, resolved; samples and numbers are unchanged."""
        if self.file is None or not is_path(path):
            return path
        return str(self.file.parent.resolve() / path)

    def _preset_options(self) -> dict[str, Any]:
        """The options of the preset as Python values; the layer's material is still a path."""
        options = {**self._table("object"), **self._table("scene")}
        options.pop("lengths", None)
        if ".py:" in options.get("technique", ""):
            options["technique"] = technique_named(self._resolved_path(options["technique"]))
        if "tilings" in options:
            options["tilings"] = {
                name: _tiling(value, f"object.tilings.{name}")
                for name, value in options["tilings"].items()
            }
        if "layer" in options:
            checks.check_table(options["layer"], checks.LAYER_KEYS, "object.layer")
            if "material" not in options["layer"]:
                raise InputError("object.layer needs a material: a path, or sample:NAME")
        if "camera" in options:
            options["camera"] = checks.camera_of(options["camera"])
        if "lights" in options:
            options["lights"] = tuple(map(checks.light_of, options["lights"]))
        return options

    def _layer(self, material: Material) -> Layer:
        table = self._table("object")["layer"]
        default = Layer(material)
        tiles = table.get("tiles", default.tiling.tiles)
        return Layer(material, Tiling(tiles, table.get("shift", default.tiling.shift)))

    def _merged(
        self, defaults: dict[str, Any], material: Material, overrides: Mapping[str, Any]
    ) -> dict[str, Any]:
        technique = overrides.get("technique", defaults.get("technique"))
        if technique is None:
            technique = default_technique(material)
        technique = technique_named(technique)
        surface = overrides.get("surface", defaults.get("surface", "standard"))
        # settings that an overriding technique or surface does not have are dropped
        for name, record in (
            ("settings", technique.settings),
            ("surface_parameters", SURFACES.get(surface)),
        ):
            other = {"settings": "technique", "surface_parameters": "surface"}[name]
            if name in defaults and other in overrides and record is not None:
                known = settings_of(record)
                defaults[name] = {
                    key: value for key, value in defaults[name].items() if key in known
                }
        if "technique" in defaults or "technique" in overrides:
            defaults["technique"] = technique
        merged = {
            **defaults,
            **{key: value for key, value in overrides.items() if key != "technique"},
        }
        for name in (*_RECORDS, "tilings"):
            if isinstance(overrides.get(name), Mapping) and name in defaults:
                merged[name] = {**defaults[name], **overrides[name]}
        return merged

    def _check_scene(self) -> None:
        """Build a scene of a small material, so that errors are reported at once."""
        test_material = Material(
            "any", height=Map(np.array([[[0.0], [1.0]]], np.float32), False, "made up")
        )
        ReadOptions(**{key: value for key, value in self._table("maps").items() if key not in MAPS})
        defaults = self._preset_options()
        if "layer" in defaults:
            defaults["layer"] = self._layer(test_material)
        merged = self._merged(defaults, test_material, {})
        scene_of(test_material, self.in_tiles(merged, test_material))


def _tiles_of(options: Mapping[str, Any], material: Material) -> tuple[float, float]:
    """Tiles along u and v that options of `Object` place on a shape, without their sign."""
    shape, tiling = options.get("shape", "plane"), options.get("tiling")
    known = settings_of(Object)
    check_setting(known["shape"], shape)
    check_setting(known["tiling"], tiling)
    u, v = default_tiles(shape, material) if tiling is None else tiling
    tiles_u, tiles_v = Tiling((u, v)).checked("tiling").tiles
    return abs(float(tiles_u)), abs(float(tiles_v))


def _in_tiles(declared: Setting, value: Any, tiles: float) -> Any:
    """A length in widths of the shape, in tile widths; what is no number is unchanged."""
    if not is_number(value):
        return value
    low, high = (None if end is None else end / tiles for end in (declared.low, declared.high))
    check_range(f"{declared.name}, in widths of the shape,", value, low, high)
    return value * tiles


def _tiling(table: Any, key: str) -> Tiling:
    checks.check_table(table, checks.TILING_KEYS, key)
    return Tiling(**table)


def check_preset_file(path: Path) -> None:
    """Raise InputError where a preset cannot be saved."""
    if path.suffix != ".toml":
        raise InputError(f"{path}: a preset is a .toml file; choose a name that ends in .toml")
    check_writable(path)


def scene_of(material: Material, options: Mapping[str, Any]) -> Scene:
    """A scene of one material from options of `Object` and `Scene`."""
    of_object, of_scene = settings_of(Object), settings_of(Scene)
    scene_options = {k: value for k, value in options.items() if k in of_scene}
    object_options = {k: value for k, value in options.items() if k not in scene_options}
    for name in object_options:
        if name not in of_object:
            known = sorted({*of_object, *of_scene})
            # drawing functions take a device, and pass on unknown options
            hint = new_name(name, ("device",)) or suggestion(name, known)
            raise InputError(f"no option {name!r}; {hint}")
    return Scene((Object(material, **object_options),), **scene_options)
