"""What people write on the command line, as values: sizes, settings, cameras, lights."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any

from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.scene import (
    LookAt,
    Object,
    Orbit,
    Scene,
    checked_record,
    directional,
    point,
    spot,
)
from basrelief.shaders.lighting import Light, Shading
from basrelief.shaders.surfaces.standard import Finish

_LIGHTS: dict[str, Callable[..., Light]] = {
    "directional": directional,
    "point": point,
    "spot": spot,
}


def size(text: str) -> tuple[int, int]:
    """(width, height) from "1280x720"."""
    found = re.fullmatch(r"\s*(\d{1,6})\s*[x×,]\s*(\d{1,6})\s*", text)
    if found is None:
        raise InputError(f"--size {text}: write width x height, for example 1280x720")
    return int(found[1]), int(found[2])


def number(text: str, what: str) -> float:
    """A number; raises InputError for anything else."""
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{what}={text}: write a number") from None


def value(text: str, what: str) -> Any:
    """One number, or several apart by commas or slashes."""
    parts = [number(part, what) for part in re.split(r"[,/]", text)]
    return parts[0] if len(parts) == 1 else tuple(parts)


def named(text: str, what: str) -> tuple[str, str]:
    """Name and value of "name=value"."""
    name, sign, rest = text.partition("=")
    if not sign or not name.strip() or not rest.strip():
        raise InputError(f"{what} {text}: write NAME=VALUE")
    return name.strip().replace("-", "_"), rest.strip()


def scene(
    material: Material,
    *,
    settings: Sequence[str],
    camera: str | None,
    lights: Sequence[str],
    background: str | None,
    shading_model: Any,
    tiling: str | None,
    **options: Any,
) -> Scene:
    """The scene that a command line describes."""
    if tiling is not None:
        options["tiling"] = _tiles(tiling)
    plain = Object(material, **options)
    given = dict(named(text, "--set") for text in settings)
    homes = {
        "settings": plain.drawn_with.settings,
        "finish": Finish,
        "shading": Shading,
    }
    sorted_out = _sorted_out(given, homes)
    options["settings"] = sorted_out["settings"]
    options["finish"] = checked_record(Finish, sorted_out["finish"], "the finish")
    if "bias" in sorted_out["object"]:
        options["bias"] = sorted_out["object"]["bias"]
    of_scene: dict[str, Any] = {}
    if camera is not None:
        of_scene["camera"] = _camera(camera)
    if lights:
        of_scene["lights"] = tuple(_light(text) for text in lights)
    if background is not None:
        of_scene["background"] = None if background == "none" else _color(background)
    shading = checked_record(Shading, sorted_out["shading"], "the shading")
    thing = Object(material, **options)
    return Scene((thing,), shading=shading, shading_model=shading_model, **of_scene)


def _sorted_out(given: Mapping[str, str], homes: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Settings by the record that they belong to; the technique's come first."""
    found: dict[str, dict[str, Any]] = {home: {} for home in [*homes, "object"]}
    known = {home: [f.name for f in fields(record)] for home, record in homes.items()}
    known["object"] = ["bias"]
    for name, text in given.items():
        home = next((home for home, names in known.items() if name in names), None)
        if home is None:
            names = ", ".join(name for names in known.values() for name in names)
            raise InputError(f"--set {name}: there is no such setting here; there are {names}")
        found[home][name] = value(text, name)
    return found


def _tiles(text: str) -> tuple[float, float]:
    parts = [number(part, "--tiling") for part in re.split(r"[x×,]", text)]
    if len(parts) not in (1, 2):
        raise InputError(f"--tiling {text}: write one number, or two as 2x3")
    return parts[0], parts[-1]


def _color(text: str) -> tuple[float, float, float]:
    parts = value(text, "--background")
    three = parts if isinstance(parts, tuple) else (parts,) * 3
    if len(three) != 3:
        raise InputError(f"--background {text}: write one number, three, or none")
    return three


def _camera(text: str) -> Orbit | LookAt:
    given: dict[str, Any] = {}
    for part in text.split(","):
        name, rest = named(part, "--camera")
        given[name] = value(rest, name)
    kind: Any = LookAt if "position" in given else Orbit
    unknown = [name for name in given if name not in kind.__dataclass_fields__]
    if unknown:
        names = ", ".join(kind.__dataclass_fields__)
        raise InputError(f"--camera {unknown[0]}: there is no such number; there are {names}")
    camera: Orbit | LookAt = kind(**given)
    return camera


def _light(text: str) -> Light:
    kind, *rest = text.split(",")
    if kind not in _LIGHTS:
        raise InputError(f"--light {text}: begin with {', '.join(_LIGHTS)}")
    given: dict[str, Any] = {}
    for part in rest:
        name, written = named(part, "--light")
        given[name] = value(written, name)
    try:
        return _LIGHTS[kind](**given)
    except TypeError:
        raise InputError(f"--light {text}: a {kind} light does not take these") from None
