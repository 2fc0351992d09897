"""What people write on the command line, as values: sizes, settings, cameras, lights.

Every function takes text and raises InputError, in one line, where it makes no sense.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any

from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.motion import MOTIONS, Motion, Orbiting
from basrelief.scene import (
    LookAt,
    Object,
    Orbit,
    Scene,
    checked_record,
    directional,
    placed,
    point,
    spot,
)
from basrelief.shaders.lighting import Light, Shading
from basrelief.shaders.shadow import Shadowing
from basrelief.shaders.surfaces.standard import Finish

_LIGHTS: dict[str, Callable[..., Light]] = {
    "directional": directional,
    "point": point,
    "spot": spot,
}
_VECTORS = ("position", "target", "up", "color")
"""The numbers of cameras and lights that are three."""


# --- pieces of text ------------------------------------------------------------------------------


def size(text: str) -> tuple[int, int]:
    """(width, height) from "1280x720"."""
    found = re.fullmatch(r"\s*(\d{1,6})\s*[x×,]\s*(\d{1,6})\s*", text)
    if found is None:
        raise InputError(f"--size {text}: write width x height, for example 1280x720")
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
    made = _LIGHTS.get(kind.strip())
    if made is None:
        raise InputError(f"--light {text}: begin with {', '.join(_LIGHTS)}")
    return made(**_arguments(parts, f"--light {kind.strip()}", made))


def motions_from(texts: Sequence[str], frames: int) -> tuple[Motion, ...]:
    """Motions from "orbit" or "scroll,u=0.1,v=0.2"; without any a film goes round its object."""
    if frames == 1:
        if texts:
            raise InputError(f"--motion {texts[0]}: one picture does not move; add --frames 120")
        return ()
    return tuple(_motion_from(text) for text in texts) or (Orbiting(),)


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
            raise InputError(f"{what}: there is no number {name}; there are {', '.join(known)}")
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


def scene(
    material: Material,
    *,
    settings: Sequence[str] = (),
    camera: str | None = None,
    lights: Sequence[str] = (),
    background: str | None = None,
    shading_model: Any = "ggx",
    shadows: Any = "none",
    tiling: str | None = None,
    shift: str | None = None,
    stretch: str | None = None,
    **options: Any,
) -> Scene:
    """The scene that a command line describes; `options` are those of `Object`, as they are."""
    if tiling is not None:
        options["tiling"] = pair(tiling, "--tiling")
    if shift is not None:
        options["shift"] = pair(shift, "--shift")
    plain = Object(material, **options)
    options["technique"] = plain.drawn_with  # a file of one's own runs once
    if stretch is not None:
        options["transform"] = placed(scale=vector(stretch, "--stretch")) @ plain.to_world
    records = {
        "settings": plain.drawn_with.settings,
        "finish": Finish,
        "shading": Shading,
        "shadowing": Shadowing,
    }
    given = _sorted_out(dict(named(text, "--set") for text in settings), records)
    thing = Object(
        material,
        settings=given["settings"],
        finish=checked_record(Finish, given["finish"], "the finish"),
        **given["object"],
        **options,
    )
    of_scene: dict[str, Any] = {}
    if camera is not None:
        of_scene["camera"] = camera_from(camera)
    if lights:
        of_scene["lights"] = tuple(light_from(text) for text in lights)
    if background is not None:
        of_scene["background"] = color(background, "--background")
    return Scene(
        (thing,),
        shading=checked_record(Shading, given["shading"], "the shading"),
        shading_model=shading_model,
        shadows=shadows,
        shadowing=checked_record(Shadowing, given["shadowing"], "the shadows"),
        **of_scene,
    )


def _sorted_out(given: Mapping[str, str], records: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Settings by the record that they belong to; the technique's come first."""
    known = {home: [f.name for f in fields(record)] for home, record in records.items()}
    known["object"] = ["bias"]
    found: dict[str, dict[str, Any]] = {home: {} for home in known}
    for name, text in given.items():
        home = next((home for home, names in known.items() if name in names), None)
        if home is None:
            names = ", ".join(name for names in known.values() for name in names)
            raise InputError(f"--set {name}: there is no such setting here; there are {names}")
        read = number if home == "object" else value
        found[home][name] = read(text, f"--set {name}")
    return found
