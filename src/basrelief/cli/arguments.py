"""What people write on the command line, as values: sizes, settings, cameras, lights.

Every function takes text and raises InputError, in one line, where it makes no sense.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from basrelief.errors import InputError, suggestion
from basrelief.material import Map, Material, load
from basrelief.scene import (
    OWN_TILINGS,
    SURFACES,
    Layer,
    LookAt,
    Object,
    Orbit,
    Scene,
    Tiling,
    placed,
    rotated,
)
from basrelief.scene.checks import FAR, NEAR
from basrelief.scene.lights import LIGHTS
from basrelief.scene.motion import MOTIONS, Motion, Orbiting, Scrolling
from basrelief.scene.presets import EMPTY_PRESET, Preset, preset, scene_of
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog
from basrelief.shading.lights import Light
from basrelief.shading.self_shadow import Shadowing
from basrelief.techniques.height import Smoothing

_VECTORS = ("position", "target", "up", "color")
"""The numbers of cameras and lights that are three."""


# --- pieces of text ------------------------------------------------------------------------------


def size(text: str) -> tuple[int, int]:
    """(width, height) from "1280x720"."""
    found = re.fullmatch(r"\s*(\d{1,6})\s*[x×,]\s*(\d{1,6})\s*", text)
    if found is None:
        raise InputError(f"--size {text}: write width x height, for example 1280x720")
    return int(found[1]), int(found[2])


def pixel(text: str) -> tuple[int, int]:
    """(x, y) from "640,360"."""
    found = re.fullmatch(r"\s*(\d{1,6})\s*,\s*(\d{1,6})\s*", text)
    if found is None:
        raise InputError(f"--pixel {text}: write x,y, for example 640,360")
    return int(found[1]), int(found[2])


def number(text: str, what: str) -> float:
    """A finite number."""
    try:
        found = float(text)
    except ValueError:
        raise InputError(f"{what} {text}: write a number") from None
    if not math.isfinite(found):
        raise InputError(f"{what} {text}: write a finite number")
    return found


def numbers(text: str, what: str) -> tuple[float, ...]:
    """Numbers apart by commas or slashes."""
    return tuple(number(part, what) for part in re.split(r"[,/]", text))


def share(text: str, what: str) -> float:
    """A share of the whole, 0 to 1, from "0.1%" or "0.001"."""
    plain = text.strip()
    found = number(plain.removesuffix("%"), what) / (100.0 if plain.endswith("%") else 1.0)
    if not 0.0 <= found <= 1.0:
        raise InputError(f"{what} {text}: write 0% to 100%, or 0 to 1")
    return found


def span(text: str, what: str) -> tuple[float, float]:
    """Two numbers from 0 up, the smaller first, from "0-75"; one stands for both."""
    first, dash, last = text.partition("-")
    low = number(first, what)
    high = number(last, what) if dash else low
    if not low <= high:
        raise InputError(f"{what} {text}: write the smaller number first, as 0-75")
    return low, high


def vector(text: str, what: str) -> tuple[float, ...]:
    """Three numbers apart by commas or slashes."""
    found = numbers(text, what)
    if len(found) != 3:
        raise InputError(f"{what} {text}: write three numbers, as 1/2/3")
    return found


def value(text: str, what: str) -> Any:
    """One number, or several."""
    found = numbers(text, what)
    return found[0] if len(found) == 1 else found


def named(text: str, what: str) -> tuple[str, str]:
    """Name and value of "name=value"."""
    name, sign, rest = text.partition("=")
    if not sign or not name.strip() or not rest.strip():
        raise InputError(f"{what} {text}: write NAME=VALUE")
    return name.strip().replace("-", "_"), rest.strip()


def pair(text: str, what: str) -> tuple[float, float]:
    """Two numbers as "2x3" or "2,3"; one stands for both."""
    parts = [number(part, what) for part in re.split(r"[x×,/]", text)]
    if len(parts) > 2:
        raise InputError(f"{what} {text}: write one number, or two as 2x3")
    return parts[0], parts[-1]


def color(text: str, what: str) -> tuple[float, ...] | None:
    """A linear colour of three numbers, a grey of one, or "none"."""
    if text.strip() == "none":
        return None
    found = numbers(text, what)
    if len(found) not in (1, 3) or min(found) < 0.0:
        raise InputError(f"{what} {text}: write one number, three, or none; none of them below 0")
    return found if len(found) == 3 else found * 3


def camera_from(text: str) -> Orbit | LookAt:
    """A camera from "azimuth=30,distance=2", or from "position=1/2/3" and what else it has."""
    parts = text.split(",")
    standing = any(part.partition("=")[0].strip() == "position" for part in parts)
    kind: Callable[..., Orbit | LookAt] = LookAt if standing else Orbit
    return kind(**_arguments(parts, "--camera", kind))


def light_from(text: str) -> Light:
    """A light from "point,position=1/2/3,intensity=2"; the first word says which kind."""
    kind, *parts = text.split(",")
    made = LIGHTS.get(kind.strip())
    if made is None:
        raise InputError(f"--light {text}: begin with {', '.join(LIGHTS)}; or none, alone")
    return made(**_arguments(parts, f"--light {kind.strip()}", made))


def motions_from(
    texts: Sequence[str], frames: int, preset: Preset = EMPTY_PRESET
) -> tuple[Motion, ...]:
    """Motions from "orbit" or "scroll,u=0.1,v=0.2".

    Without any a film scrolls as its preset says, or else goes round its object.
    """
    if frames == 1:
        if texts:
            raise InputError(f"--motion {texts[0]}: one picture does not move; add --frames 120")
        return ()
    usual = Scrolling(*preset.scroll) if any(preset.scroll) else Orbiting()
    return tuple(_motion_from(text) for text in texts) or (usual,)


def _motion_from(text: str) -> Motion:
    name, *parts = text.split(",")
    kind = MOTIONS.get(name.strip())
    if kind is None:
        raise InputError(f"--motion {text}: begin with {', '.join(MOTIONS)}")
    made: Motion = kind(**_arguments(parts, f"--motion {name.strip()}", kind))
    return made


def _arguments(parts: Sequence[str], what: str, kind: Callable[..., Any]) -> dict[str, Any]:
    """NAME=VALUE parts as the arguments of a function."""
    known = inspect.signature(kind).parameters
    given: dict[str, Any] = {}
    for part in parts:
        name, text = named(part, what)
        if name not in known:
            raise InputError(f"{what}: there is no number {name}; {suggestion(name, known)}")
        read = vector if name in _VECTORS else number
        given[name] = read(text, f"{what}: {name}")
    for name, parameter in known.items():
        if parameter.default is parameter.empty and name not in given:
            raise InputError(f"{what}: give it a {name}, for example {name}=1/2/1")
    return given


# --- the whole -----------------------------------------------------------------------------------


def check_lengths(depth: float | None, tile: float | None, scale: float | None) -> None:
    """Raise InputError where --depth and --tile are not given together, or --scale beside them."""
    if (depth is None) != (tile is None):
        raise InputError("--depth and --tile go together: how deep, and how wide a tile, in metres")
    if depth is not None and scale is not None:
        raise InputError("--scale, or --depth and --tile, but not both: they say the same")


def preset_from(text: str | None) -> Preset:
    """A preset from its name or its file; without one, that which says nothing."""
    return EMPTY_PRESET if text is None else preset(text)


_RECORDS = {"smoothing": Smoothing, "shading": Shading, "shadowing": Shadowing, "fog": Fog}
_READERS: dict[str, Callable[[Any], Any]] = {
    "tiling": lambda text: pair(text, "--tiling"),
    "shift": lambda text: pair(text, "--shift"),
    "fade": lambda text: pair(text, "--fade"),
    "camera": camera_from,
    "lights": lambda texts: () if [*texts] == ["none"] else tuple(map(light_from, texts)),
    "background": lambda text: color(text, "--background"),
}
"""What makes a value of an option's text; other options are taken as they are."""


def scene(
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
    stretch: str | None = None,
    add: Sequence[str] = (),
    **options: Any,
) -> Scene:
    """The scene that a command line describes; what is not given is the preset's.

    `options` are those of `Object` and `Scene`. `measured` says that the material's own depth is
    given, and so comes before the preset's scale.
    """
    given = {
        name: _READERS[name](text) if name in _READERS else text for name, text in options.items()
    }
    if measured:
        given["scale"] = None
    if layer is not None:
        given["layer"] = Layer(load(layer))
    said = preset.options(material, given)
    said["layer"] = _layer(said.get("layer"), layer_tiling, layer_shift)
    plain = Object(material, **_some(said, "technique", "surface"))
    said["technique"] = plain.selected_technique  # a file of one's own runs once
    numbers = _sorted_out(dict(named(text, "--set") for text in settings), plain)
    said |= numbers.pop("object")
    for home, each in numbers.items():
        said[home] = {**said.get(home, {}), **each}
    said["tilings"] = _tilings(material, said, map_tiling, map_shift)
    if stretch is not None:
        lying = Object(material, **_some(said, "technique", "shape")).to_world
        said["transform"] = placed(scale=vector(stretch, "--stretch")) @ lying
    whole = scene_of(material, said)
    return replace(whole, objects=(*whole.objects, *map(object_from, add)))


def plain_settings(texts: Sequence[str]) -> dict[str, float]:
    """Numbers by their names, from "steps=16" and the like."""
    given = dict(named(text, "--set") for text in texts)
    return {name: number(text, f"--set {name}") for name, text in given.items()}


def _some(options: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: options[name] for name in names if name in options}


def _layer(layer: Layer | None, tiling: str | None, shift: str | None) -> Layer | None:
    """A layer that lies as it is told to."""
    if layer is None:
        if tiling is not None or shift is not None:
            raise InputError("--layer-tiling, --layer-shift: there is no layer; add --layer FOLDER")
        return None
    lies = layer.tiling
    if tiling is not None:
        lies = replace(lies, tiles=pair(tiling, "--layer-tiling"))
    if shift is not None:
        lies = replace(lies, shift=pair(shift, "--layer-shift"))
    return replace(layer, tiling=lies)


def _tilings(
    material: Material, said: Mapping[str, Any], tilings: Sequence[str], shifts: Sequence[str]
) -> dict[str, Tiling]:
    """Single maps' own tilings; what is not said of them is as the heights lie."""
    made: dict[str, Tiling] = dict(said.get("tilings", {}))
    if not tilings and not shifts:
        return made
    main = Object(material, **_some(said, "technique", "shape", "tiling", "shift")).main_tiling
    for option, field, texts in (
        ("--map-tiling", "tiles", tilings),
        ("--map-shift", "shift", shifts),
    ):
        for text in texts:
            name, numbers_text = named(text, option)
            if name not in OWN_TILINGS:
                raise InputError(f"{option} {name}: the maps are {', '.join(OWN_TILINGS)}")
            found = pair(numbers_text, f"{option} {name}")
            made[name] = replace(made.get(name, main), **{field: found})
    return made


def _sorted_out(given: Mapping[str, str], obj: Object) -> dict[str, dict[str, Any]]:
    """Settings by the record that they belong to; the technique's come first."""
    records = {
        "settings": obj.selected_technique.settings,
        "surface_parameters": SURFACES[obj.surface],
        **_RECORDS,
    }
    known = {home: [f.name for f in fields(record)] for home, record in records.items()}
    known["object"] = ["bias"]
    found: dict[str, dict[str, Any]] = {home: {} for home in known}
    for name, text in given.items():
        home = next((home for home, names in known.items() if name in names), None)
        if home is None:
            hint = suggestion(name, [name for names in known.values() for name in names])
            raise InputError(f"--set {name}: there is no such setting here; {hint}")
        read = number if home == "object" else value
        found[home][name] = read(text, f"--set {name}")
    return found


# --- further objects -----------------------------------------------------------------------------

_TEXTS = ("technique", "projection", "heights", "edge", "mapping", "alpha", "casts")
_NUMBERS = ("scale", "reference_height", "bias")
_PAIRS = ("tiling", "shift")
_OWN = ("position", "size", "turn", "material", "color")


def object_from(text: str) -> Object:
    """A further object from "sphere,position=0/0.1/0,size=0.3,material=sample:tiles".

    The first word is its shape. It stands at `position` in world units, `size` times as large,
    turned about an axis (`turn=x/30`, degrees; a plane lies as it always does before that). Without
    a `material` it is of one `color`; with one, that multiplies the maps.
    """
    shape, *parts = text.split(",")
    shape, what = shape.strip(), f"--add {shape.strip()}"
    given = dict(named(part, what) for part in parts)
    for name in given:
        known = (*_OWN, *_TEXTS, *_NUMBERS, *_PAIRS)
        if name not in known:
            raise InputError(f"{what}: there is no {name}; {suggestion(name, known)}")
    material = load(given["material"]) if "material" in given else _plain()
    options: dict[str, Any] = {"shape": shape, **_some(given, *_TEXTS)}
    for read, names in ((number, _NUMBERS), (pair, _PAIRS)):
        texts = _some(given, *names)
        options |= {name: read(text, f"{what}: {name}") for name, text in texts.items()}
    if "color" in given or "material" not in given:
        options["surface_parameters"] = {
            "base_color": value(given.get("color", _GREY), f"{what}: color")
        }
    plain = Object(material, **options)
    return replace(plain, transform=_placed(given, what) @ plain.to_world)


_GREY = "0.5"
"""The colour of a further object that has neither material nor colour: no light burns it out."""


def _placed(given: Mapping[str, str], what: str) -> Any:
    """Turned, then sized, then moved."""
    position = vector(given.get("position", "0/0/0"), f"{what}: position")
    size = value(given.get("size", "1"), f"{what}: size")
    if not isinstance(size, float) and len(size) != 3:
        raise InputError(f"{what}: size {given['size']}: write one number, or three as 1/2/3")
    if not np.all((np.asarray(size) >= NEAR) & (np.asarray(size) <= FAR)):
        raise InputError(f"{what}: size {given['size']}: write numbers above 0, up to {FAR:g}")
    turn = np.eye(4)
    if "turn" in given:
        axis, _, degrees = given["turn"].partition("/")
        if axis not in ("x", "y", "z"):
            raise InputError(f"{what}: turn {given['turn']}: write an axis and degrees, as x/30")
        turn = rotated(axis, number(degrees, f"{what}: turn"))  # type: ignore[arg-type]
    return placed(position) @ turn @ placed(scale=size)


def _plain() -> Material:
    """A material of one colour: white, for the finish to multiply."""
    white = Map(np.ones((1, 1, 3), np.float32), False, "one colour")
    return Material("plain", base_color=white)
