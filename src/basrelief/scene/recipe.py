"""Instructions to draw a picture again: as a command line, as Python, and as a preset.

The text that a page copies is written by `viewer/web/state.js` instead. Tests draw the pictures of
both, and compare them.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from basrelief.errors import InputError
from basrelief.lang.types import VECTORS, coerce, fields_of
from basrelief.material import MAPS, Material
from basrelief.material.options import is_path
from basrelief.scene.lights import light_arguments
from basrelief.scene.objects import Object
from basrelief.scene.presets import Preset
from basrelief.scene.resolve import default_transform
from basrelief.scene.scene import Scene, default_lights
from basrelief.scene.tilings import Layer, Tiling
from basrelief.scene.transforms import Axis, Transform, placed, rotated
from basrelief.scene.views import LookAt, Orbit
from basrelief.settings import settings_of
from basrelief.shading.lights import Light
from basrelief.techniques import TECHNIQUES, Technique

Options = dict[str, Any]
FOLDER = "FOLDER"
"""Placeholder for the path of a material that was not loaded from files."""
SAMPLE_OPTIONS = ("size", "seed")
"""Options of `basrelief.sample` that `load` and the command line do not have."""
LENGTHS = ("depth", "tile")
"""Options of `load` from which the scale of a relief follows."""


@dataclass(frozen=True)
class Recipe:
    """A scene and the options of drawing it, to be written as text.

    Only what differs from the defaults is written.

    Attributes
    ----------
    scene : Scene
        The scene. A command line describes its first object.
    drawing : mapping
        Options of `basrelief.render` besides the scene, such as `size` and `samples`.
    """

    scene: Scene
    drawing: Mapping[str, Any] = field(default_factory=dict)

    @property
    def command(self) -> str:
        """The command line, with a comment that names what it cannot describe."""
        text = shlex.join(["basrelief", "render", *_command_parts(self.scene, self._drawing())])
        omitted = [*omitted_by_command(self.scene)]
        return f"{text}  # without {', '.join(omitted)}" if omitted else text

    @property
    def python(self) -> str:
        """The line of Python."""
        objects, scene = self.scene.objects, _scene_options(self.scene)
        if len(objects) == 1:
            what = _material_text(objects[0].material, short=True)
            arguments = {**_object_options(objects[0]), **scene}
        else:
            inner = ", ".join([f"({', '.join(map(_object_text, objects))})", *_keywords(scene)])
            what, arguments = f"basrelief.Scene({inner})", {}
        parts = [what, *_keywords({**arguments, **self._drawing()})]
        return f"import basrelief; basrelief.render({', '.join(parts)})"

    def _drawing(self) -> dict[str, Any]:
        """The options of drawing, with the device that a filter needs."""
        needs_gpu = any(obj.filter == "hardware" for obj in self.scene.objects)
        return {**({"device": "gpu"} if needs_gpu else {}), **self.drawing}

    def preset(self, name: str, about: str = "") -> Preset:
        """The preset: the object, the scene, and the options of reading the maps.

        Raises InputError for a scene that a preset cannot describe, as one of several objects.
        """
        return Preset(name, about, values=_preset_values(self.scene))


# --- options that differ from the defaults -------------------------------------------------------


def _object_options(obj: Object) -> Options:
    """Options of an object that differ from the defaults, with records as mappings."""
    options = _changed(obj, obj.resolved)
    if isinstance(obj.technique, Technique):
        options = {"technique": technique_text(obj.technique), **options}
    return options


def _scene_options(scene: Scene) -> Options:
    """Options of a scene that differ from the defaults, with records as mappings."""
    options = _changed(scene, scene)
    if isinstance(scene.camera, Orbit) and not _camera_arguments(scene.camera):
        options.pop("camera", None)
    if scene.lights == default_lights():
        del options["lights"]
    return options


def _changed(owner: Any, resolved: Any) -> Options:
    """Options of an object or a scene that differ from the defaults, except the technique.

    Records of numbers are taken from `resolved`.
    """
    options: Options = {}
    for name, declared in settings_of(type(owner)).items():
        value = getattr(owner, name)
        if declared.kind == "numbers":
            value = _changed_numbers(getattr(resolved, name))
        if name != "technique" and not _is_same(value, declared.default):
            options[name] = value
    return options


def _is_same(value: Any, default: Any) -> bool:
    return bool(python_value(value) == python_value(default))


def _changed_numbers(record: Any) -> dict[str, Any]:
    """Fields of a record of numbers that differ from its defaults."""
    changed = {}
    for name, t in fields_of(type(record)).items():
        declared: Any = settings_of(type(record)).get(name)
        value = python_value(getattr(record, name))
        has_default = declared is not None and not declared.required
        # compared in 32 bits, as the record stores its numbers
        if not has_default or value != python_value(coerce(declared.default, t)):
            changed[name] = value
    return changed


def python_value(value: Any) -> Any:
    """Numbers, vectors and arrays as Python numbers and tuples; other values are unchanged.

    A 32-bit number becomes the shortest decimal that rounds to it.
    """
    if type(value) in VECTORS or (isinstance(value, np.ndarray) and value.ndim):
        return tuple(map(python_value, value))
    if isinstance(value, np.ndarray):
        return python_value(value[()])
    if isinstance(value, np.floating):
        return float(str(value))
    return value.item() if isinstance(value, np.integer) else value


def technique_text(technique: Technique[..., Any]) -> str:
    """The text of the option `technique`: a name in the library, or FILE.py:NAME."""
    if technique in TECHNIQUES.values():
        return technique.name
    file, here = Path(technique.function.__code__.co_filename), Path.cwd()
    return f"{file.relative_to(here) if file.is_relative_to(here) else file}:{technique.name}"


def portable_source(material: Material | None, otherwise: str) -> str:
    """A material's path for text that other users read, or `otherwise` where it has none."""
    origin = None if material is None else material.origin
    return otherwise if origin is None or origin.path is None else portable_path(origin.path)


def portable_path(path: str) -> str:
    """A path without the names of folders above the current one; others are unchanged."""
    if not Path(path).is_absolute():
        return _argument(path)
    file, here = Path(path), Path.cwd()
    return _argument(str(file.relative_to(here) if file.is_relative_to(here) else file.name))


# --- the command line ----------------------------------------------------------------------------


def _command_parts(scene: Scene, drawing: Mapping[str, Any]) -> Iterator[str]:
    obj = scene.objects[0]
    origin = obj.material.origin
    yield _argument(origin.path) if origin is not None and origin.path else FOLDER
    options = {**_object_options(obj), **_scene_options(scene)}
    # a scale, and the depth of a hole, replace that of the material, and are refused beside it
    replaced = LENGTHS if {"scale", "opening"} & options.keys() else ()
    for name, value in (origin.options if origin is not None else {}).items():
        if name not in (*SAMPLE_OPTIONS, *replaced):
            yield from _option(name, value)
    declared = {**settings_of(Object), **settings_of(Scene)}
    for name, value in options.items():
        if declared[name].kind == "numbers":
            for setting, number in value.items():
                yield from ("--set", f"{setting}={joined(number, '/')}")
        elif name == "tilings":
            yield from _map_tilings(value, obj.resolved.tiling)
        elif name == "layer":
            yield from _layer_parts(value)
        elif name == "transform":
            for placement, text in (placement_options(obj) or {}).items():
                yield from _option(placement, text)
        elif name == "camera":
            yield from ("--camera", ",".join(_arguments(_camera_arguments(value))))
        elif name == "lights":
            yield from _light_parts(value)
        else:
            yield from _option(name, value, "x" if name == "tiling" else ",")
    for name, value in drawing.items():
        yield from _option(name, value, "x")


def _argument(path: str) -> str:
    """A path that is not read as an option, though it starts with a minus."""
    return f"./{path}" if path.startswith("-") else path


def _option(name: str, value: Any, separator: str = ",") -> Iterator[str]:
    option = f"--{name.replace('_', '-')}"
    if value is True:
        yield option
        return
    text = "none" if value is None else joined(value, separator)
    # a value that starts with a minus would be read as an option
    yield from (f"{option}={text}",) if text.startswith("-") else (option, text)


def joined(value: Any, separator: str) -> str:
    """Numbers joined by a separator; a text unchanged."""
    if isinstance(value, str):
        return value
    value = python_value(value)
    numbers = value if isinstance(value, tuple | list) else (value,)
    return separator.join(_number_text(number) for number in numbers)


def _number_text(number: Any) -> str:
    return repr(python_value(number)).removesuffix(".0")


def _arguments(values: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"{name}={joined(value, '/')}" for name, value in values.items())


def _map_tilings(tilings: Mapping[str, Tiling], main: Tiling) -> Iterator[str]:
    for name, tiling in tilings.items():
        yield from ("--map-tiling", f"{name}={joined(tiling.tiles, 'x')}")
        if python_value(tiling.shift) != python_value(main.shift):
            yield from ("--map-shift", f"{name}={joined(tiling.shift, ',')}")


def _layer_parts(layer: Layer) -> Iterator[str]:
    origin = layer.material.origin
    yield from ("--layer", _argument(origin.path) if origin and origin.path else "LAYER")
    yield from _option("layer_tiling", layer.tiling.tiles, "x")
    if any(layer.tiling.shift):
        yield from _option("layer_shift", layer.tiling.shift)


def _camera_arguments(camera: Orbit | LookAt) -> Options:
    """The numbers of a camera that differ from the defaults, or that it needs."""
    values = {name: python_value(getattr(camera, name)) for name in settings_of(type(camera))}
    return {
        name: values[name]
        for name, declared in settings_of(type(camera)).items()
        if declared.required or values[name] != declared.default
    }


def _light_parts(lights: tuple[Light, ...]) -> Iterator[str]:
    if not lights:
        yield from ("--light", "none")
    for light in lights:
        kind, arguments = light_arguments(light)
        yield from ("--light", ",".join([kind, *_arguments(arguments)]))


def placement_options(obj: Object) -> dict[str, str] | None:
    """The options --stretch and --turn that give the transform of an object.

    They scale the default transform along the world's axes, then rotate it about one of them. None
    for other transforms.
    """
    default = default_transform(obj.shape, obj.material)
    relative = obj.resolved.transform @ np.linalg.inv(default)
    for axis, factors, degrees in _scaled_rotations(relative):
        if np.allclose(rotated(axis, degrees) @ placed(scale=factors), relative, atol=1e-12):
            stretch = {} if factors == (1.0, 1.0, 1.0) else {"stretch": joined(factors, ",")}
            turn = {"turn": f"{axis}/{_number_text(degrees)}"} if degrees else {}
            return {**stretch, **turn}
    return None


def _scaled_rotations(
    matrix: Transform,
) -> Iterator[tuple[Axis, tuple[float, float, float], float]]:
    """Candidates for an axis, factors and degrees whose scaling and rotation make a matrix."""

    def rounded(number: float) -> float:
        # adding 0 makes −0 a 0
        return float(f"{number:.9g}") + 0.0

    x, y, z = (rounded(factor) for factor in np.diag(matrix)[:3])
    yield "x", (x, y, z), 0.0
    axes: tuple[tuple[Axis, int, int], ...] = (("x", 1, 2), ("y", 2, 0), ("z", 0, 1))
    for axis, a, b in axes:
        factors = [x, y, z]
        factors[a] = rounded(np.hypot(matrix[a, a], matrix[b, a]))
        if factors[a] == 0.0:
            continue
        area = matrix[a, a] * matrix[b, b] - matrix[a, b] * matrix[b, a]
        factors[b] = rounded(area / factors[a])
        degrees = rounded(np.degrees(np.arctan2(matrix[b, a], matrix[a, a])))
        yield axis, (factors[0], factors[1], factors[2]), degrees


def omitted_by_command(scene: Scene) -> Iterator[str]:
    """Names of the parts of a scene that a command line cannot describe."""
    obj = scene.objects[0]
    yield from omitted_of_sources(obj)
    if obj.transform is not None and placement_options(obj) is None:
        yield "the transform of the object"
    if len(scene.objects) > 1:
        yield "the further objects"


def omitted_of_sources(obj: Object) -> Iterator[str]:
    """Names of the parts of an object's materials that paths and options of `load` do not give."""
    origin = obj.material.origin
    if origin is None:
        yield "the material, which was not loaded from files"
    elif origin.path is None:
        yield "a folder: all maps were named one by one"
    elif origin.options.keys() & {*SAMPLE_OPTIONS}:
        yield "the size and seed of the sample"
    if obj.layer is not None:
        origin = obj.layer.material.origin
        if origin is None or origin.options:
            yield "how the layer is read"


# --- Python --------------------------------------------------------------------------------------


def _keywords(options: Mapping[str, Any]) -> list[str]:
    return [f"{name}={value_text(value)}" for name, value in options.items()]


def value_text(value: Any) -> str:
    """A value as Python source."""
    match python_value(value):
        case str() as text:
            return json.dumps(text, ensure_ascii=False)
        case bool() | None as flag:
            return str(flag)
        case int() | float() as number:
            return _number_text(number)
        case tuple() | list() as items:
            inner = ", ".join(map(value_text, items))
            return f"({inner},)" if len(items) == 1 else f"({inner})"
        case Mapping() as items:
            pairs = (f"{json.dumps(key)}: {value_text(item)}" for key, item in items.items())
            return f"{{{', '.join(pairs)}}}"
        case Tiling() as tiling:
            return _call("Tiling", {"tiles": tiling.tiles, "shift": tiling.shift})
        case Layer() as layer:
            return f"basrelief.Layer({_material_text(layer.material)}, {value_text(layer.tiling)})"
        case Orbit() | LookAt() as camera:
            return _call(type(camera).__name__, _camera_arguments(camera))
        case Light() as light:
            kind, arguments = light_arguments(light)
            return _call(kind, arguments)
        case other:
            raise InputError(f"{other!r} cannot be written as Python")


def _call(name: str, arguments: Mapping[str, Any]) -> str:
    return f"basrelief.{name}({', '.join(_keywords(arguments))})"


def _object_text(obj: Object) -> str:
    parts = [_material_text(obj.material), *_keywords(_object_options(obj))]
    return f"basrelief.Object({', '.join(parts)})"


def _material_text(material: Material, *, short: bool = False) -> str:
    """The call that makes a material; `short` is a path where that is enough."""
    origin = material.origin
    if origin is None:
        return json.dumps(FOLDER) if short else f"basrelief.load({json.dumps(FOLDER)})"
    options = _keywords(origin.options)
    if origin.options.keys() & {*SAMPLE_OPTIONS}:
        name = (origin.path or "").removeprefix("sample:")
        return f"basrelief.sample({', '.join([json.dumps(name), *options])})"
    source = [] if origin.path is None else [json.dumps(origin.path, ensure_ascii=False)]
    if short and source and not options:
        return source[0]
    return f"basrelief.load({', '.join([*source, *options])})"


# --- presets -------------------------------------------------------------------------------------


def _preset_values(scene: Scene) -> dict[str, Any]:
    if len(scene.objects) != 1:
        raise InputError("a preset describes one object; remove the others")
    (obj,) = scene.objects
    origin = obj.material.origin
    of_object, of_scene = _object_options(obj), _scene_options(scene)
    if "background" in of_scene and of_scene["background"] is None:
        raise InputError("a preset has no transparent background; choose a colour")
    if isinstance(technique := of_object.get("technique"), str) and ":" in technique:
        file, _, name = technique.rpartition(":")
        of_object["technique"] = f"{Path(file).resolve()}:{name}"
    if "tilings" in of_object:
        of_object["tilings"] = {name: _table(t) for name, t in of_object["tilings"].items()}
    if "layer" in of_object:
        layer = of_object["layer"]
        source = layer.material.origin
        if source is None or source.options:
            raise InputError("a preset names the folder of its layer; load the layer from one")
        of_object["layer"] = {"material": _absolute(source.path or ""), **_table(layer.tiling)}
    if "camera" in of_scene:
        of_scene["camera"] = _camera_arguments(of_scene["camera"])
    if "lights" in of_scene:
        of_scene["lights"] = [
            {"kind": kind, **arguments} for kind, arguments in map(light_arguments, scene.lights)
        ]
    reading = {
        name: _absolute(value) if name in MAPS else value
        for name, value in (origin.options if origin is not None else {}).items()
        if name not in (*SAMPLE_OPTIONS, *LENGTHS)
    }
    if origin is not None and origin.options.keys() & {*LENGTHS}:
        of_object.setdefault("scale", obj.resolved.scale)
    tables = {"maps": reading, "object": of_object, "scene": of_scene}
    return {name: _toml(values) for name, values in tables.items() if values}


def _table(tiling: Tiling) -> dict[str, Any]:
    return {"tiles": tiling.tiles, "shift": tiling.shift}


def _absolute(path: Any) -> Any:
    """A path from the root; samples and numbers are unchanged."""
    return str(Path(path).resolve()) if is_path(path) else path


def _toml(value: Any) -> Any:
    """A value in the types of TOML, with arrays for tuples."""
    match python_value(value):
        case Mapping() as table:
            return {name: _toml(item) for name, item in table.items()}
        case tuple() | list() as items:
            return [_toml(item) for item in items]
        case scalar:
            return scalar
