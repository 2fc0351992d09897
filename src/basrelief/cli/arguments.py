"""Parsers of command-line values: sizes, settings, cameras, lights, scenes.

They raise InputError, with a message of one line, for text that they cannot parse. `what` names the
option in that line, as in "--angles".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, NoReturn

import numpy as np

from basrelief.errors import InputError, closest, suggestion
from basrelief.lang.types import fields_of
from basrelief.material import Map, Material, load
from basrelief.measure.views import SET_BY_MEASURE, in_proportion
from basrelief.scene import (
    OWN_TILINGS,
    Layer,
    LookAt,
    Object,
    Orbit,
    Scene,
    Tiling,
    placed,
    rotated,
    technique_named,
)
from basrelief.scene.checks import FAR, NEAR, check_setting
from basrelief.scene.lights import LIGHTS
from basrelief.scene.motion import MOTIONS, Motion, Opening, Orbiting, Scrolling
from basrelief.scene.presets import EMPTY_PRESET, Preset, preset, scene_of
from basrelief.scene.resolve import (
    default_technique,
    default_tiles,
    default_transform,
    number_records,
)
from basrelief.scene.transforms import Transform
from basrelief.settings import parameters_of, settings_of
from basrelief.shading.lights import Light
from basrelief.techniques import TECHNIQUES, Technique, flat

# --- simple values -------------------------------------------------------------------------------


def size(text: str) -> tuple[int, int]:
    """(width, height) from "1280x720"."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*[x×,]\s*(\d{1,6})\s*", text)
    if match is None:
        raise InputError(f"--size {text}: write width x height, for example 1280x720")
    return int(match[1]), int(match[2])


def pixel(text: str) -> tuple[int, int]:
    """(x, y) from "640,360"."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*,\s*(\d{1,6})\s*", text)
    if match is None:
        raise InputError(f"--pixel {text}: write x,y, for example 640,360")
    return int(match[1]), int(match[2])


def number(text: str, what: str) -> float:
    """A finite number."""
    try:
        parsed = float(text)
    except ValueError:
        raise InputError(f"{what} {text}: write a number") from None
    if not math.isfinite(parsed):
        raise InputError(f"{what} {text}: write a finite number")
    return parsed


def numbers(text: str, what: str) -> tuple[float, ...]:
    """Numbers separated by commas or slashes."""
    return tuple(number(part, what) for part in re.split(r"[,/]", text))


def fraction(text: str, what: str) -> float:
    """A fraction, 0 to 1, from "0.1%" or "0.001"."""
    stripped = text.strip()
    parsed = number(stripped.removesuffix("%"), what) / (100.0 if stripped.endswith("%") else 1.0)
    if not 0.0 <= parsed <= 1.0:
        raise InputError(f"{what} {text}: write 0% to 100%, or 0 to 1")
    return parsed


def span(text: str, what: str) -> tuple[float, float]:
    """(low, high) from "0-75", neither below 0; one number is both."""
    first, dash, last = text.partition("-")
    if dash and not (first.strip() and last.strip()):
        raise InputError(f"{what} {text}: write numbers from 0 up, for example 0-75")
    low = number(first, what)
    high = number(last, what) if dash else low
    if not low <= high:
        raise InputError(f"{what} {text}: write the smaller number first, for example 0-75")
    return low, high


def vector(text: str, what: str) -> tuple[float, ...]:
    """Three numbers separated by commas or slashes."""
    parsed = numbers(text, what)
    if len(parsed) != 3:
        raise InputError(f"{what} {text}: write three numbers, for example 1/2/3")
    return parsed


def value(text: str, what: str) -> Any:
    """One number, or a tuple of several."""
    parsed = numbers(text, what)
    return parsed[0] if len(parsed) == 1 else parsed


def name_and_value(text: str, what: str) -> tuple[str, str]:
    """Name and value from "name=value"; dashes in the name become underscores."""
    name, sign, rest = text.partition("=")
    if not sign or not name.strip() or not rest.strip():
        raise InputError(f"{what} {text}: write NAME=VALUE")
    return name.strip().replace("-", "_"), rest.strip()


def pair(text: str, what: str) -> tuple[float, float]:
    """Two numbers from "2x3" or "2,3"; one number is both."""
    parts = [number(part, what) for part in re.split(r"[x×,/]", text)]
    if len(parts) > 2:
        raise InputError(f"{what} {text}: write one number, or two, for example 2x3")
    return parts[0], parts[-1]


def color(text: str, what: str) -> tuple[float, ...] | None:
    """A linear colour from three numbers or, for a grey, one; None from "none"."""
    if text.strip() == "none":
        return None
    parsed = numbers(text, what)
    if len(parsed) not in (1, 3) or min(parsed) < 0.0:
        raise InputError(f"{what} {text}: write one or three numbers from 0 up, or none")
    return parsed if len(parsed) == 3 else parsed * 3


def camera_from(text: str) -> Orbit | LookAt:
    """An orbit from "azimuth=30,distance=2", or a `LookAt` from "position=1/2/3,target=0/0/0"."""
    parts = text.split(",")
    has_position = any(part.partition("=")[0].strip() == "position" for part in parts)
    kind: Callable[..., Orbit | LookAt] = LookAt if has_position else Orbit
    return kind(**_arguments(parts, "--camera", kind))


def light_from(text: str) -> Light:
    """A light from "point,position=1/2/3,intensity=2"; the first word is its kind."""
    kind, *parts = text.split(",")
    make = LIGHTS.get(kind.strip())
    if make is None:
        hint = f"begin with {', '.join(LIGHTS)}; or give none alone"
        raise InputError(f"--light {text}: {hint}{closest(kind.strip(), LIGHTS)}")
    return make(**_arguments(parts, f"--light {kind.strip()}", make))


def motions_from(
    texts: Sequence[str], frames: int, preset: Preset = EMPTY_PRESET, *, measured: bool = False
) -> tuple[Motion, ...]:
    """Motions from "orbit" or "scroll,u=0.1,v=0.2".

    Without texts, a film scrolls as the preset sets it, or else the camera orbits the object. With
    `measured`, the command line sets the material's depth, which a hole does not have.
    """
    if frames == 1:
        if texts:
            raise InputError(
                f"--motion {texts[0]}: a single picture has no motion; add --frames 120"
            )
        return ()
    default = Scrolling(*preset.scroll) if any(preset.scroll) else Orbiting()
    motions = tuple(_motion_from(text) for text in texts) or (default,)
    if measured and any(isinstance(motion, Opening) for motion in motions):
        _refuse_lengths("--motion opening")
    return motions


def _motion_from(text: str) -> Motion:
    name, *parts = text.split(",")
    kind = MOTIONS.get(name.strip())
    if kind is None:
        hint = suggestion(name.strip(), MOTIONS, "begin with")
        raise InputError(f"--motion {text}: {hint}")
    motion: Motion = kind(**_arguments(parts, f"--motion {name.strip()}", kind))
    return motion


def _arguments(parts: Sequence[str], what: str, kind: Callable[..., Any]) -> dict[str, Any]:
    """Keyword arguments of a function from NAME=VALUE parts."""
    known = settings_of(kind) if isinstance(kind, type) else parameters_of(kind)
    parsed: dict[str, Any] = {}
    for part in parts:
        name, text = name_and_value(part, what)
        if name not in known:
            raise InputError(f"{what}: there is no parameter {name}; {suggestion(name, known)}")
        parse = vector if known[name].kind == "triple" else number
        parsed[name] = parse(text, f"{what}: {name}")
    for name, declared in known.items():
        if declared.required and name not in parsed:
            raise InputError(f"{what}: add a {name}, for example {name}=1/2/1")
    return parsed


# --- scenes --------------------------------------------------------------------------------------


def check_lengths(depth: float | None, tile: float | None, scale: float | None) -> None:
    """Raise InputError for --depth without --tile or the reverse, and for both with --scale."""
    if (depth is None) != (tile is None):
        raise InputError(
            "give --depth and --tile together: height range and width of a tile, in metres"
        )
    if depth is not None and scale is not None:
        raise InputError("give either --scale or --depth and --tile, not both: they set the same")


def _refuse_lengths(option: str) -> NoReturn:
    """Raise InputError for --depth and --tile with an option that opens a hole."""
    raise InputError(
        "--depth and --tile are those of the material, not of a hole; "
        f"give --scale, or omit {option}"
    )


def preset_from(text: str | None) -> Preset:
    """The preset of a name or a file; the empty preset for None."""
    return EMPTY_PRESET if text is None else preset(text)


_DECLARED = {**settings_of(Object), **settings_of(Scene)}


def _parsed(name: str, text: Any) -> Any:
    """The value of an option of `Object` or `Scene`; other options are used as they are."""
    declared = _DECLARED.get(name)
    if declared is None:
        return text
    match name, declared.kind:
        case "camera", _:
            return camera_from(text)
        case "lights", _:
            return () if [*text] == ["none"] else tuple(map(light_from, text))
        case _, "choice":
            # as in names of techniques, case does not count, and hyphens are underscores
            spelled = text.lower().replace("-", "_")
            return spelled if spelled in declared.choices else text
        case _, "pair":
            return pair(text, declared.option)
        case _, "triple":
            return color(text, declared.option)
    return text


def scene(
    material: Material,
    *,
    stretch: str | None = None,
    turn: str | None = None,
    add: Sequence[str] = (),
    **options: Any,
) -> Scene:
    """The scene that a command line describes.

    `stretch` scales the shape, `turn` then rotates it, and each of `add` is a further object; the
    other parameters are those of `scene_options`.
    """
    merged = scene_options(material, **options)
    if stretch is not None or turn is not None:
        shape = merged.get("shape", "plane")
        check_setting(_DECLARED["shape"], shape)
        transform = default_transform(shape, material)
        if stretch is not None:
            factors = vector(stretch, "--stretch")
            if not all(NEAR <= abs(factor) <= FAR for factor in factors):
                raise InputError(
                    f"--stretch {stretch}: write numbers other than 0, {FAR:g} at most"
                )
            transform = placed(scale=factors) @ transform
        if turn is not None:
            transform = _rotation(turn, "--turn") @ transform
        merged["transform"] = transform
    main_scene = scene_of(material, merged)
    return replace(main_scene, objects=(*main_scene.objects, *map(object_from, add)))


def scene_options(
    material: Material,
    *,
    preset: Preset = EMPTY_PRESET,
    measured: bool = False,
    settings: Sequence[str] = (),
    map_tiling: Sequence[str] = (),
    map_shift: Sequence[str] = (),
    layer: str | None = None,
    layer_tiling: str | None = None,
    layer_shift: str | None = None,
    **options: Any,
) -> dict[str, Any]:
    """The options of `Object` and `Scene` from a preset, changed by those of a command line.

    `options` are their fields as text or numbers; lengths are in the preset's unit. With
    `measured`, the command line sets the material's depth, which replaces the preset's scale.
    """
    parsed = {name: _parsed(name, text) for name, text in options.items()}
    if measured:
        parsed["scale"] = None
    if layer is not None:
        parsed["layer"] = Layer(load(layer))
    merged = preset.merged(material, parsed)
    if measured and merged.get("opening") is not None:
        _refuse_lengths("--opening")
    merged["layer"] = _layer(merged.get("layer"), layer_tiling, layer_shift)
    # loaded here once: loading runs a user's file
    technique = technique_named(merged.get("technique") or default_technique(material))
    merged["technique"] = technique
    values_by_record = _by_record(
        dict(name_and_value(text, "--set") for text in settings),
        technique,
        merged.get("surface", "standard"),
    )
    for record, values in values_by_record.items():
        merged[record] = {**merged.get(record, {}), **values}
    merged["tilings"] = _tilings(material, merged, map_tiling, map_shift)
    return preset.in_tiles(merged, material)


class MeasuredOptions(NamedTuple):
    """Options of a command that measures techniques.

    `techniques` are the measured ones, None for all. `settings` are those of all techniques,
    `preset_settings` those of a preset. `measured` are the options of `Object` and `Scene` without
    those that a measurement sets itself, `drawn` are all of them, for a picture of the material.
    """

    techniques: list[str] | None
    settings: dict[str, Any]
    preset_settings: dict[str, Any]
    measured: dict[str, Any]
    drawn: dict[str, Any]


def measured_options(
    material: Material,
    techniques: Sequence[str] | None,
    settings: Sequence[str],
    *,
    preset: Preset = EMPTY_PRESET,
    **options: Any,
) -> MeasuredOptions:
    """The options of a measurement; parameters are those of `scene_options`.

    A name in `settings` that one of the techniques has is a setting of the techniques, not of the
    scene. Lengths are in the preset's unit, as in `scene_options`.
    """
    of_preset = preset.merged(material, {})
    surface = options.get("surface") or of_preset.get("surface", "standard")
    check_setting(_DECLARED["surface"], surface)
    named = [technique_named(text.partition(",")[0]) for text in techniques or TECHNIQUES]
    known = {name for technique in named for name in fields_of(technique.settings)}
    records = number_records(flat, surface).values()
    others = {name for record in records for name in fields_of(record)}
    values = dict(name_and_value(text, "--set") for text in settings)
    for name in values.keys() - known - others - _DECLARED.keys():
        hint = suggestion(name, sorted(known | others))
        raise InputError(f"--set {name}: there is no such setting here; {hint}")
    of_techniques = {
        name: value(text, f"--set {name}") for name, text in values.items() if name in known
    }
    rest = [f"{name}={text}" for name, text in values.items() if name not in known]
    merged = scene_options(material, settings=rest, technique="flat", preset=preset, **options)
    drawn = {k: option for k, option in merged.items() if k not in ("technique", "settings")}
    measured = {name: option for name, option in drawn.items() if name not in SET_BY_MEASURE}
    u, v = merged.get("tiling") or default_tiles(merged.get("shape", "plane"), material)
    # a measurement tiles the heights itself, and other maps in proportion
    measured = in_proportion(measured, 1.0 / u, 1.0 / v)
    numbers = of_preset.get("settings", {})
    preset_settings = {name: number for name, number in numbers.items() if name in known}
    shared = {**preset_settings, **of_techniques}

    def in_tiles(own: Mapping[str, Any], technique: Technique[..., Any]) -> dict[str, Any]:
        """Settings of a technique, beside the shared ones, with lengths in tile widths."""
        names = preset.settings_in_tiles(own, technique, merged, material)
        converted = preset.settings_in_tiles({**shared, **own}, technique, merged, material)
        return {name: converted[name] for name in names}

    spelled = [_respelled(text, in_tiles) for text in techniques] if techniques else None
    for values in (preset_settings, of_techniques):
        converted = [in_tiles(values, technique) for technique in named]
        for technique, changed in zip(named, converted, strict=True):
            has = fields_of(technique.settings)
            values.update({name: number for name, number in changed.items() if name in has})
    return MeasuredOptions(spelled, of_techniques, preset_settings, measured, drawn)


def _respelled(
    text: str, change: Callable[[Mapping[str, Any], Technique[..., Any]], Mapping[str, Any]]
) -> str:
    """The text of a technique with settings of its own, such as "relief,max_steps=64", changed."""
    # imported here, since drawing a picture does not need it
    from basrelief.measure.compare import own_settings

    name, own = own_settings(text)
    if not own:
        return text
    changed = change(own, technique_named(name))
    return ",".join([name, *(f"{key}={value!r}" for key, value in changed.items())])


def _layer(layer: Layer | None, tiling: str | None, shift: str | None) -> Layer | None:
    """A layer with the tiling and the shift of the options."""
    if layer is None:
        if tiling is not None or shift is not None:
            raise InputError("--layer-tiling, --layer-shift: there is no layer; add --layer FOLDER")
        return None
    placement = layer.tiling
    if tiling is not None:
        placement = replace(placement, tiles=pair(tiling, "--layer-tiling"))
    if shift is not None:
        placement = replace(placement, shift=pair(shift, "--layer-shift"))
    return replace(layer, tiling=placement)


def _tilings(
    material: Material, options: Mapping[str, Any], tilings: Sequence[str], shifts: Sequence[str]
) -> dict[str, Tiling]:
    """Tilings of single maps; tiles or a shift that is not set is that of the heights."""
    own: dict[str, Tiling] = dict(options.get("tilings", {}))
    if not tilings and not shifts:
        return own
    shape = options.get("shape", "plane")
    check_setting(_DECLARED["shape"], shape)
    tiles = options.get("tiling") or default_tiles(shape, material)
    main = Tiling(tiles, options.get("shift", (0.0, 0.0)))
    for option, field, texts in (
        ("--map-tiling", "tiles", tilings),
        ("--map-shift", "shift", shifts),
    ):
        for text in texts:
            name, numbers_text = name_and_value(text, option)
            if name not in OWN_TILINGS:
                raise InputError(f"{option} {name}: the maps are {', '.join(OWN_TILINGS)}")
            parsed = pair(numbers_text, f"{option} {name}")
            own[name] = replace(own.get(name, main), **{field: parsed})
    return own


def _by_record(
    settings: Mapping[str, str], technique: Technique[..., Any], surface: str
) -> dict[str, dict[str, Any]]:
    """Values of settings by the field of `Object` or `Scene` whose record has them.

    Where several records have a setting of the same name, the technique's is set.
    """
    check_setting(_DECLARED["surface"], surface)
    records = number_records(technique, surface)
    known = {owner: [*fields_of(record)] for owner, record in records.items()}
    values: dict[str, dict[str, Any]] = {owner: {} for owner in known}
    for name, text in settings.items():
        owner = next((owner for owner, names in known.items() if name in names), None)
        if owner is None and name in _DECLARED:
            raise InputError(
                f"--set {name}: it is an option of its own; write {_DECLARED[name].option}"
            )
        if owner is None:
            hint = suggestion(name, [name for names in known.values() for name in names])
            raise InputError(f"--set {name}: there is no such setting here; {hint}")
        values[owner][name] = value(text, f"--set {name}")
    return values


# --- added objects -------------------------------------------------------------------------------

_PARAMETERS = ("position", "size", "turn", "material", "color")
"""Parameters of --add besides those of `Object`, its records and its maps."""
_LAYER = ("layer", "layer_tiling", "layer_shift")
_MAP_PLACEMENTS = {
    f"{name}_{word}": (name, field)
    for name in OWN_TILINGS
    for word, field in (("tiling", "tiles"), ("shift", "shift"))
}
"""Map and field of `Tiling` by the parameter of --add that sets it."""
_PARSERS: dict[str, Callable[[str, str], Any]] = {
    "choice": lambda text, what: text, "text": lambda text, what: text,
    "number": number, "pair": pair,
}  # fmt: skip
"""Parsers of the settings of `Object` that --add takes, by kind."""


def object_from(text: str) -> Object:
    """An added object from "sphere,position=0/0.1/0,size=0.3,material=sample:tiles".

    The first word is its shape. Parameters are its `position` in world units, its `size` as a
    factor, a rotation about an axis (`turn=x/30`, degrees; a plane is horizontal before it), the
    settings of `Object` that are numbers, pairs or words, the numbers of its technique, its surface
    and smooth heights, tiling and shift of single maps (`normal_tiling=2x3`), and a `layer` with
    `layer_tiling` and `layer_shift`. Without a `material` the object has one `color`; with a
    material, the color multiplies the maps.
    """
    shape, *parts = text.split(",")
    shape, what = shape.strip(), f"--add {shape.strip()}"
    values = dict(name_and_value(part, what) for part in parts)
    check_setting(_DECLARED["shape"], shape)
    surface = values.get("surface", "standard")
    check_setting(_DECLARED["surface"], surface)
    parsers = {
        name: _PARSERS[declared.kind]
        for name, declared in settings_of(Object).items()
        if declared.kind in _PARSERS and name != "shape"
    }
    material = load(values["material"]) if "material" in values else _white_material()
    technique = technique_named(values.get("technique") or default_technique(material))
    records = {
        owner: [*fields_of(record)]
        for owner, record in number_records(technique, surface).items()
        if owner in settings_of(Object)
    }
    numbers_known = {name: owner for owner, names in records.items() for name in names}
    known = (*_PARAMETERS, *parsers, *_LAYER, *_MAP_PLACEMENTS, *numbers_known)
    options: dict[str, Any] = {"shape": shape, "technique": technique}
    if "color" in values or ("material" not in values and surface == "standard"):
        color_text = values.get("color", _GREY)
        options["surface_parameters"] = {"base_color": value(color_text, f"{what}: color")}
    for name, text_of_value in values.items():
        if name not in known:
            raise InputError(f"{what}: there is no parameter {name}; {suggestion(name, known)}")
        if name in parsers and name != "technique":
            options[name] = parsers[name](text_of_value, f"{what}: {name}")
        elif name in numbers_known:
            record = options.setdefault(numbers_known[name], {})
            record[name] = value(text_of_value, f"{what}: {name}")
    options["tilings"] = _added_tilings(values, options, material, what)
    options["layer"] = _added_layer(values, what)
    obj = Object(material, **options)
    return replace(obj, transform=_added_transform(values, what) @ obj.resolved.transform)


_GREY = "0.5"
"""Colour of an object with neither material nor colour: dark enough not to be overexposed."""


def _added_tilings(
    values: Mapping[str, str], options: Mapping[str, Any], material: Material, what: str
) -> dict[str, Tiling]:
    """Tilings of single maps; tiles or a shift that is not set is that of the heights."""
    tiles = options.get("tiling") or default_tiles(options["shape"], material)
    main = Tiling(tiles, options.get("shift", (0.0, 0.0)))
    own: dict[str, Tiling] = {}
    for parameter, (name, field) in _MAP_PLACEMENTS.items():
        if parameter in values:
            parsed = pair(values[parameter], f"{what}: {parameter}")
            own[name] = replace(own.get(name, main), **{field: parsed})
    return own


def _added_layer(values: Mapping[str, str], what: str) -> Layer | None:
    """The second layer of an added object."""
    placed_by = [name for name in _LAYER[1:] if name in values]
    if "layer" not in values:
        if placed_by:
            raise InputError(f"{what}: {placed_by[0]}: there is no layer; add layer=FOLDER")
        return None
    layer = Layer(load(values["layer"]))
    fields = {"layer_tiling": "tiles", "layer_shift": "shift"}
    placement = {fields[name]: pair(values[name], f"{what}: {name}") for name in placed_by}
    return replace(layer, tiling=replace(layer.tiling, **placement))


def _added_transform(values: Mapping[str, str], what: str) -> Any:
    """The transform of an added object: scale, then rotation, then translation."""
    position = vector(values.get("position", "0/0/0"), f"{what}: position")
    size = value(values.get("size", "1"), f"{what}: size")
    if not isinstance(size, float) and len(size) != 3:
        raise InputError(
            f"{what}: size {values['size']}: write one number, or three, for example 1/2/3"
        )
    if not np.all((np.asarray(size) >= NEAR) & (np.asarray(size) <= FAR)):
        raise InputError(f"{what}: size {values['size']}: write numbers above 0, up to {FAR:g}")
    turn = _rotation(values["turn"], f"{what}: turn") if "turn" in values else np.eye(4)
    return placed(position) @ turn @ placed(scale=size)


def _rotation(text: str, what: str) -> Transform:
    """The rotation of "x/30", an axis of the world and degrees."""
    axis, slash, degrees = text.partition("/")
    if axis not in ("x", "y", "z") or not slash:
        raise InputError(f"{what} {text}: write an axis and degrees, for example x/30")
    return rotated(axis, number(degrees, what))  # type: ignore[arg-type]


def _white_material() -> Material:
    """A white material, for the surface parameters to multiply."""
    white = Map(np.ones((1, 1, 3), np.float32), False, "one colour")
    return Material("plain", base_color=white)
