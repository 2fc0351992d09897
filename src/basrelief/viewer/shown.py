"""What a page shows, as a scene: the other way of `viewer.state`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, assert_never

from basrelief.errors import InputError
from basrelief.scene import LookAt, Orbit, Scene, Tiling, directional, point, spot
from basrelief.scene.checks import one_of, within
from basrelief.shading.kinds import LightKind, values_of
from basrelief.shading.lights import Light
from basrelief.viewer.state import plain_camera, plain_light, techniques_of

OF_OBJECT = (
    "shape", "projection", "scale", "level", "bias", "heights", "smoothing", "edge", "tiling",
    "shift", "mapping", "alpha", "surface",
)  # fmt: skip
OF_SCENE = (
    "shadows", "shading_model", "shading", "shadowing", "occlusion_kind", "fog", "air",
)  # fmt: skip
"""The settings that objects and scenes have by the same names."""
_LIGHTS: dict[LightKind, Callable[[], Light]] = {
    "directional": directional,
    "point": lambda: point((0.0, 1.0, 0.0)),
    "spot": lambda: spot((0.0, 1.0, 0.0)),
}
"""The kinds, and what a light of each has where nothing is said."""


def shown_scene(state: Mapping[str, Any], scene: Scene) -> Scene:
    """The scene that a page of `scene` shows in a state, with the material of `scene`.

    Raises InputError for values out of range.
    """
    thing = scene.objects[0]
    technique = techniques_of(thing)[state["technique"]]
    over = thing.layer and replace(thing.layer, tiling=tiling_of(state["layer_tiling"]))
    own = {name: tiling_of(each) for name, each in state["tilings"].items()}
    of_object = {name: state[name] for name in OF_OBJECT}
    if state["heights"] not in technique.takes_heights:
        of_object["heights"] = "sharp"
    shown = replace(
        thing,
        **of_object,
        technique=technique,
        settings=state["settings"][state["technique"]],
        finish=state["finish"][state["surface"]],
        fade=tuple(state["fade"]) if state["fades"] else None,
        tilings=own if state["apart"] else {},
        layer=over if state["layer"] else None,
        # a transform is that of the shape that it was made for
        transform=thing.transform if state["shape"] == thing.shape else None,
    )
    # black is what a page shows where there is nothing behind
    behind = tuple(state["background"])
    none = scene.background is None and not any(behind)
    return replace(
        scene,
        objects=(shown,),
        camera=camera_of(state["camera"]),
        lights=tuple(light_of(each) for each in state["lights"]),
        background=None if none else behind,
        **{name: state[name] for name in OF_SCENE},
    )


def tiling_of(said: Any) -> Tiling:
    """A tiling from a page's, or itself. Raises InputError for what makes none."""
    try:
        pairs = (said.tiles, said.shift) if isinstance(said, Tiling) else _pairs(**said)
        (u, v), (right, down) = pairs
        made = Tiling((float(u), float(v)), (float(right), float(down)))
    except (TypeError, ValueError):
        raise InputError(f"a tiling is {said!r}: give a Tiling((2, 2))") from None
    return made.checked("tiling")


def _pairs(tiles: Any = (1.0, 1.0), shift: Any = (0.0, 0.0)) -> tuple[Any, Any]:
    return tiles, shift


def camera_of(said: Any) -> Orbit:
    """A page's camera from a camera, or from an orbit's numbers by name.

    Raises InputError for what makes none.
    """
    if not isinstance(said, Orbit | LookAt):
        known = Orbit.__dataclass_fields__
        if not isinstance(said, Mapping) or not all(name in known for name in said):
            raise InputError(f"camera is {said!r}: give an Orbit or a LookAt")
        said = Orbit(**said)
    try:
        said.camera((16, 9))
        plain = plain_camera(said)
    except (TypeError, ValueError):
        raise InputError(f"camera is {said!r}: give it finite numbers") from None
    return Orbit(**{**plain, "target": tuple(plain["target"])})


def light_of(said: Mapping[str, Any]) -> Light:
    """A light from a page's. Raises InputError for numbers that make none."""
    color, intensity, falloff = said["color"], said["intensity"], said["falloff"]
    within("intensity", float(intensity), 0.0, None)
    one_of("the kind of a light", said["kind"], values_of(LightKind))
    kind: LightKind = said["kind"]
    match kind:
        case "directional":
            return directional(said["azimuth"], said["elevation"], color, intensity)
        case "point":
            return point(said["position"], color, intensity, falloff)
        case "spot":
            # the way is that of a light from far away at these angles
            way = directional(said["azimuth"], said["elevation"]).direction
            target = [p + float(d) for p, d in zip(said["position"], way, strict=True)]
            angle, softness = said["angle"], said["softness"]
            return spot(said["position"], target, color, intensity, falloff, angle, softness)
        case _:
            assert_never(kind)


def said_light(given: Any) -> dict[str, Any]:
    """A page's light from a light, or from a mapping of what a page's light has.

    What a mapping leaves out is as the kind's own function has it. Raises InputError for what
    makes no light.
    """
    if isinstance(given, Light):
        return plain_light(given)
    if not isinstance(given, Mapping):
        raise InputError(f"a light is {given!r}: give one made by directional, point or spot")
    kind = given.get("kind", "directional")
    one_of("the kind of a light", kind, values_of(LightKind))
    usual = plain_light(_LIGHTS[kind]())
    for name in given:
        one_of("a light's number", name, tuple(usual))
    made = {**usual, **given}
    try:
        light_of(made)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(f"a light is {given!r}: give it finite numbers") from None
    return made
