"""Scenes: what is drawn, from where, in what light. Frozen values; nothing here draws.

    Scene(objects=(Object(material, shape="sphere", technique="relief"),), camera=Orbit(azimuth=30))

Angles are in degrees, colours linear Rec. 709, the world is right-handed with y up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.cameras import look, orbit
from basrelief.errors import InputError
from basrelief.lang import Mat3, Vec2, Vec3
from basrelief.lang.types import VECTORS, fields_of, is_record
from basrelief.material import Material
from basrelief.shaders.camera import Camera
from basrelief.shaders.lighting import DIRECTIONAL, POINT, SPOT, Light, Shading
from basrelief.shaders.pixel import Depth, Placement
from basrelief.shaders.shadow import Shadowing
from basrelief.shaders.surfaces.standard import Finish
from basrelief.shaders.techniques import TECHNIQUES, Technique, flat, relief
from basrelief.shaders.techniques.own import technique_from_file

__all__ = [
    "SHAPES", "LookAt", "Object", "Orbit", "Scene", "directional", "placed", "point", "spot",
    "turned",
]  # fmt: skip

SHAPES = ("plane", "box", "sphere", "cylinder")
DEFAULT_SCALE = 0.05
"""The depth of a relief whose material does not say: 5 % of a tile's width."""

_TILING = {"plane": (1.0, 1.0), "box": (1.0, 1.0), "sphere": (4.0, 2.0), "cylinder": (3.0, 1.0)}
"""Tiles around and along each shape so that a square tile stays about square."""

_FILLED = 0.92
"""How much of the picture's width or height an object fills when it is framed."""

_NEAR, _FAR = 1e-6, 1e6
"""Sizes, places and tilings that float32 holds with room for squares, cubes and quotients."""

BACKGROUND = (0.05, 0.055, 0.065)
"""What is behind the objects unless a scene says otherwise: a dark grey, linear."""

Transform = NDArray[np.float64]
"""An affine map from object to world space, (4, 4), acting on columns."""


# --- cameras -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Orbit:
    """A camera on a sphere around its target; see `basrelief.cameras.orbit`.

    With `orthographic_height` it is orthographic, and `field_of_view` (vertical) does not matter.
    Without a `distance` it stands as far as shows the scene's first object whole.
    """

    azimuth: float = 30.0
    elevation: float = 35.0
    distance: float | None = None
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    field_of_view: float = 30.0
    orthographic_height: float | None = None

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        lens = _lens(self.field_of_view, self.orthographic_height)
        distance = 2.0 if self.distance is None else self.distance
        _in_reach(self.azimuth, self.elevation, distance, *self.target)
        return orbit(self.target, distance, self.azimuth, self.elevation, size=size, **lens)

    def framing(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera as near as shows all of the points, (n, 3)."""
        near = replace(self, distance=1.0).camera(size)
        right, down, forward = (
            np.array([*v], np.float64) for v in (near.right, near.down, near.forward)
        )
        offsets = points - np.array(self.target, np.float64)
        closer = -(offsets @ forward)
        if self.orthographic_height is not None:
            return replace(self, distance=float(closer.max()) + 1.0)
        # a point is in view where its way from the axis is within its depth times the half angle
        halves = np.array(size) * _FILLED / 2.0
        needed = [
            closer + np.abs(offsets @ axis) / (axis @ axis) / half
            for axis, half in zip((right, down), halves, strict=True)
        ]
        return replace(self, distance=float(np.max(needed)))

    def framing_all_round(self, points: NDArray[np.float64], size: tuple[int, int]) -> Orbit:
        """The same camera as near as shows all of the points, (n, 3), from every azimuth.

        The distance is the largest that `framing` finds on the way round, worked out, not searched.
        """
        offsets = points - np.array(self.target, np.float64)
        away, above = np.hypot(offsets[:, 0], offsets[:, 2]), offsets[:, 1]
        s, c = math.sin(math.radians(self.elevation)), math.cos(math.radians(self.elevation))
        # as the camera goes round, a point comes nearer by away · c · cos x, goes across the
        # picture by away · sin x and along it by above · c − away · s · cos x
        if self.orthographic_height is not None:
            return replace(self, distance=float((away * abs(c) + above * s).max()) + 1.0)
        tangent = math.tan(math.radians(self.field_of_view) / 2.0) * _FILLED
        across = np.hypot(c, size[1] / size[0] / tangent) * away + above * s
        # convex in cos x, so largest at one of its ends
        along = [
            turn * away * c + above * s + np.abs(above * c - turn * away * s) / tangent
            for turn in (-1.0, 1.0)
        ]
        return replace(self, distance=float(np.max([across, *along])))


@dataclass(frozen=True)
class LookAt:
    """A camera that stands somewhere and looks at something; see `basrelief.cameras.look`."""

    position: tuple[float, float, float]
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    field_of_view: float = 30.0
    orthographic_height: float | None = None

    def camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height)."""
        lens = _lens(self.field_of_view, self.orthographic_height)
        _in_reach(*self.position, *self.target)
        return look(self.position, self.target, self.upright, size=size, **lens)

    @property
    def upright(self) -> tuple[float, float, float]:
        """The direction of the world that points upwards in the picture: `up` where it can be."""
        along_y = self.position[0] == self.target[0] and self.position[2] == self.target[2]
        # straight up or down no other y would do: the picture's top is then where −z is
        return (0.0, 0.0, -1.0) if along_y and self.up == (0.0, 1.0, 0.0) else self.up


def _in_reach(*numbers: float) -> None:
    """Raise InputError where a camera stands, or is turned, further than 32 bits can follow."""
    for number in numbers:
        if not abs(number) <= _FAR:
            raise InputError(f"a camera at {number:g}: give angles and places up to {_FAR:g}")


def _lens(field_of_view: float, orthographic_height: float | None) -> dict[str, float]:
    if orthographic_height is not None:
        return {"orthographic_height": orthographic_height}
    return {"field_of_view": field_of_view}


# --- lights --------------------------------------------------------------------------------------

_Color = Sequence[float]
_WHITE = (1.0, 1.0, 1.0)


def directional(
    azimuth: float = -40.0, elevation: float = 40.0, color: _Color = _WHITE, intensity: float = 1.0
) -> Light:
    """A light from far away, from the direction of an orbit's azimuth and elevation."""
    around, above = np.radians([azimuth, elevation])
    with np.errstate(invalid="ignore"):
        level = np.array([np.sin(around), 0.0, np.cos(around)])
        towards = level * np.cos(above) + np.array([0.0, np.sin(above), 0.0])
    return _light(DIRECTIONAL, direction=-towards, color=color, intensity=intensity)


def point(
    position: Sequence[float], color: _Color = _WHITE, intensity: float = 1.0, falloff: float = 2.0
) -> Light:
    """A lamp at a position in world units; `intensity` is what arrives at distance 1.

    `falloff` is the power of the distance: 2 for the inverse square, 1 as in wikibooks.
    """
    return _light(POINT, position=position, color=color, intensity=intensity, falloff=falloff)


def spot(
    position: Sequence[float],
    target: Sequence[float] = (0.0, 0.0, 0.0),
    color: _Color = _WHITE,
    intensity: float = 1.0,
    falloff: float = 2.0,
    angle: float = 40.0,
    softness: float = 0.25,
) -> Light:
    """A lamp with a cone: `angle` is its whole width in degrees, `softness` the share of it (0 to
    1) over which it fades."""
    if not 0.0 < angle < 180.0 or not 0.0 <= softness <= 1.0:
        raise InputError(f"a spot of angle {angle}, softness {softness}: give 0–180 and 0–1")
    if len(target) != 3 or len(position) != 3:
        raise InputError(f"a spot at {position} towards {target}: give three numbers each")
    direction = np.subtract(target, position)
    half = math.radians(angle) / 2.0
    return _light(
        SPOT,
        position=position,
        direction=direction,
        color=color,
        intensity=intensity,
        falloff=falloff,
        cos_inner=math.cos(half * (1.0 - softness)),
        cos_outer=math.cos(half),
    )


def _light(
    kind: int,
    *,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    direction: Any = (0.0, -1.0, 0.0),
    color: _Color,
    intensity: float,
    falloff: float = 2.0,
    cos_inner: float = 1.0,
    cos_outer: float = 0.0,
) -> Light:
    way = np.asarray(direction, np.float64)
    length = float(np.linalg.norm(way))
    numbers = [*way, *position, *color, intensity]
    if len(position) != 3 or len(color) != 3:
        raise InputError(f"a light at {position} of colour {color}: give three numbers each")
    if not (np.abs(numbers) <= _FAR).all() or length == 0.0:
        raise InputError("a light needs finite numbers, and a direction of some length")
    within("falloff", falloff, 0.0, 8.0)
    return Light(
        kind,
        Vec3(*position),
        Vec3(*(way / length)),
        Vec3(*(c * intensity for c in color)),
        falloff,
        cos_inner,
        cos_outer,
    )


# --- transforms ----------------------------------------------------------------------------------


def turned(axis: Literal["x", "y", "z"], degrees: float) -> Transform:
    """A rotation about an axis of the world, counterclockwise seen against the axis."""
    a, b = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    made = np.eye(4)
    made[a, a] = made[b, b] = c
    made[a, b], made[b, a] = -s, s
    return made


def placed(
    position: Sequence[float] = (0.0, 0.0, 0.0), scale: float | Sequence[float] = 1.0
) -> Transform:
    """A scaling, one factor or one for each axis, and then a move."""
    made = np.diag([*np.broadcast_to(scale, 3), 1.0]).astype(np.float64)
    made[:3, 3] = position
    return made


def _sound(transform: Transform) -> bool:
    """Whether it is affine, and shaders in 32 bits can go there and back."""
    if transform.shape != (4, 4) or not (np.abs(transform) <= _FAR).all():
        return False
    sizes = np.linalg.svd(transform[:3, :3], compute_uv=False)
    return bool(sizes[-1] >= _NEAR and (transform[3] == (0.0, 0.0, 0.0, 1.0)).all())


def _round(heights: Sequence[float], radii: Sequence[float]) -> NDArray[np.float64]:
    """Points on circles around the y axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    return np.concatenate(
        [
            np.stack([r * np.sin(angle), np.full(24, y), r * np.cos(angle)], 1)
            for y, r in zip(heights, radii, strict=True)
        ]
    )


_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FROM_POLE = np.linspace(0.0, np.pi, 13)
_OUTLINES = {
    "plane": _CORNERS * (1.0, 1.0, 0.0),
    "box": _CORNERS,
    "sphere": _round([*np.cos(_FROM_POLE) / 2], [*np.sin(_FROM_POLE) / 2]),
    "cylinder": _round((-0.5, 0.5), (0.5, 0.5)),
}
"""Points of each shape that reach as far as it does."""

LYING = turned("x", -90.0)
"""Lays a plane flat: it faces up, the picture's top away from a camera at azimuth 0."""


# --- objects -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Object:
    """A shape with a material, and how its relief is drawn.

    `technique` is a name, "FILE.py:NAME" or a technique; without one it is `relief` where there are
    heights, and asking for one where there are none is an error. `settings` is its record, or a
    mapping of the fields to change. `scale` defaults to the material's, `level` and `projection`
    to the technique's. `edge` says what lies beyond the map: "wrap", "clamp", or "clip" (nothing).
    `tiling` counts the tiles along u and v. Raises InputError for values out of range.
    """

    material: Material
    shape: str = "plane"
    technique: str | Technique[..., Any] | None = None
    settings: Any = field(default_factory=dict)
    scale: float | None = None
    level: float | None = None
    projection: Literal["full", "biased", "limited"] | None = None
    bias: float = 0.42
    edge: Literal["wrap", "clamp", "clip"] = "wrap"
    tiling: tuple[float, float] | None = None
    shift: tuple[float, float] = (0.0, 0.0)
    finish: Finish = field(default_factory=Finish)
    transform: Transform | None = None

    def __post_init__(self) -> None:
        if self.technique is None:
            chosen = flat if self.material.height is None else relief
            object.__setattr__(self, "technique", chosen)
        elif isinstance(self.technique, str):
            object.__setattr__(self, "technique", technique_named(self.technique))
        if self.material.height is None and self.drawn_with is not flat:
            raise InputError(
                f"{self.material.name} has no height map, which {self.drawn_with.name} needs; "
                "add one, or draw it with the technique flat"
            )
        one_of("shape", self.shape, SHAPES)
        one_of("projection", self.projection, (None, "full", "biased", "limited"))
        one_of("edge", self.edge, ("wrap", "clamp", "clip"))
        within("scale", self.relief_scale, 0.0, 10.0)
        within("level", self.relief_level, 0.0, 1.0)
        within("bias", self.bias, 0.0, 100.0)
        checked_record(Finish, vars(self.finish), "the finish")
        if not all(_NEAR <= abs(n) <= _FAR for n in self.tiles):
            raise InputError(f"tiling {self.tiles}: give finite numbers other than 0")
        if not all(abs(n) <= _FAR for n in self.shift):
            raise InputError(f"shift {self.shift}: give finite numbers")
        object.__setattr__(self, "settings", self._settings())
        if not _sound(self.to_world):
            raise InputError(
                "an object's transform must be finite, affine (4 × 4, the last row 0 0 0 1), "
                "and not flatten it to nothing"
            )

    def _settings(self) -> Any:
        record = self.drawn_with.settings
        if isinstance(self.settings, Mapping):
            return checked_record(record, self.settings, self.drawn_with.name)
        if not isinstance(self.settings, record):
            raise InputError(f"{self.drawn_with.name} takes settings of type {record.__name__}")
        values = {f.name: getattr(self.settings, f.name) for f in fields(record)}
        return checked_record(record, values, self.drawn_with.name)

    @property
    def drawn_with(self) -> Technique[..., Any]:
        """The technique that is asked for."""
        assert isinstance(self.technique, Technique)
        return self.technique

    @property
    def has_relief(self) -> bool:
        """Whether anything is displaced: there are heights, and a technique that reads them."""
        return self.material.height is not None and self.drawn_with is not flat

    @property
    def relief_scale(self) -> float:
        """The depth of the relief as a fraction of a tile's width."""
        return _first(self.scale, self.material.scale, DEFAULT_SCALE)

    @property
    def relief_level(self) -> float:
        """The height that lies on the polygon."""
        return _first(self.level, self.drawn_with.level)

    @property
    def relief_projection(self) -> str:
        """The name of the projection in use."""
        return self.projection or self.drawn_with.projection

    @property
    def tiles(self) -> tuple[float, float]:
        """Tiles along u and v; more along v where a tile is wider than high."""
        if self.tiling is not None:
            return self.tiling
        u, v = _TILING[self.shape]
        return (u, v) if self.shape in ("plane", "box") else (u, v * self.material.proportion)

    @property
    def to_world(self) -> Transform:
        """The transform in use.

        Without one a plane lies flat, with the proportions of the maps; other shapes stand.
        """
        if self.transform is not None:
            return np.asarray(self.transform, np.float64)
        if self.shape != "plane":
            return np.eye(4)
        proportion = self.material.proportion
        return LYING @ placed(scale=(min(proportion, 1.0), min(1.0 / proportion, 1.0), 1.0))

    def outline(self) -> NDArray[np.float64]:
        """Points of world space, (n, 3), that the object lies between."""
        matrix = self.to_world
        return _OUTLINES[self.shape] @ matrix[:3, :3].T + matrix[:3, 3]

    def placement(self) -> Placement:
        """The shaders' record of where the object is."""
        matrix = self.to_world
        inverse = np.linalg.inv(matrix[:3, :3])
        return Placement(
            Vec3(*matrix[:3, 3]),
            _columns(inverse),
            _columns(matrix[:3, :3]),
            Vec2(*self.tiles),
            Vec2(*self.shift),
            self.material.proportion,
        )

    def depth(self) -> Depth:
        """The shaders' record of how deep the relief is."""
        return Depth(self.relief_scale, self.relief_level, self.bias)


def _columns(matrix: NDArray[Any]) -> Mat3:
    return Mat3(*(Vec3(*matrix[:, column]) for column in range(3)))


def _first(*values: float | None) -> float:
    return next(float(value) for value in values if value is not None)


def technique_named(name: str) -> Technique[..., Any]:
    """A technique of the library by its name, or one of a user's own as FILE.py:NAME.

    Raises InputError where there is none.
    """
    if ".py:" in name:
        return technique_from_file(*name.rsplit(":", 1))
    if name not in TECHNIQUES:
        raise InputError(
            f"no technique is called {name!r}; use one of {', '.join(TECHNIQUES)}, or FILE.py:NAME"
        )
    return TECHNIQUES[name]


# --- scenes --------------------------------------------------------------------------------------


def _default_lights() -> tuple[Light, ...]:
    return (
        directional(-50.0, 35.0, (1.0, 0.96, 0.9), 2.2),
        directional(80.0, 20.0, (0.8, 0.9, 1.0), 0.8),
    )


@dataclass(frozen=True, eq=False)
class Scene:
    """Objects, a camera, lights; `shading_model` is "ggx" (metallic-roughness) or "phong".

    `shadows` are those that a relief casts on itself: "none", "hard" or "soft".

    `background` is a linear colour, or None for transparent.
    """

    objects: tuple[Object, ...]
    camera: Orbit | LookAt = field(default_factory=Orbit)
    lights: tuple[Light, ...] = field(default_factory=_default_lights)
    shading: Shading = field(default_factory=Shading)
    shading_model: Literal["ggx", "phong"] = "ggx"
    shadows: Literal["none", "hard", "soft"] = "none"
    shadowing: Shadowing = field(default_factory=Shadowing)
    background: tuple[float, float, float] | None = BACKGROUND

    def __post_init__(self) -> None:
        one_of("shading_model", self.shading_model, ("ggx", "phong"))
        one_of("shadows", self.shadows, ("none", "hard", "soft"))
        checked_record(Shading, vars(self.shading), "the shading")
        ground = (0.0,) * 3 if self.background is None else self.background
        if len(ground) != 3 or not all(0.0 <= c <= _FAR for c in ground):
            raise InputError(f"background {ground}: give three finite numbers from 0, or None")
        object.__setattr__(self, "objects", tuple(self.objects))
        object.__setattr__(self, "lights", tuple(self.lights))

    def shader_camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height), framing the first object."""
        camera = self.camera
        if isinstance(camera, Orbit) and camera.distance is None and self.objects:
            camera = camera.framing(self.objects[0].outline(), size)
        return camera.camera(size)

    def from_far_to_near(self, size: tuple[int, int]) -> list[Object]:
        """The objects by the distance of their middles, so that what is nearer is laid over."""
        eye = np.array([*self.shader_camera(size).position], np.float64)
        away = [float(np.linalg.norm(thing.to_world[:3, 3] - eye)) for thing in self.objects]
        order = sorted(range(len(away)), key=lambda index: -away[index])
        return [self.objects[index] for index in order]

    def with_camera(self, camera: Orbit | LookAt) -> Scene:
        """The same scene from elsewhere."""
        return replace(self, camera=camera)

    def check_camera(self) -> None:
        """Raise InputError where the camera stands inside an object, or behind a lone plane."""
        eye = np.array([*self.shader_camera((1, 1)).position, 1.0], np.float64)
        for thing in self.objects:
            x, y, z, _ = np.linalg.inv(thing.to_world) @ eye
            advice = "move it away, for example --camera distance=3"
            if _inside(thing, x, y, z):
                raise InputError(f"the camera is inside the {thing.shape}; {advice}")
            if thing.shape == "plane" and z <= 0.0 and len(self.objects) == 1:
                raise InputError(
                    "the camera is behind the plane, which has no back; lift it to the other "
                    "side, for example --camera elevation=35"
                )


def _inside(thing: Object, x: float, y: float, z: float) -> bool:
    match thing.shape:
        case "plane":
            above = (1.0 - thing.relief_level) * thing.relief_scale / abs(thing.tiles[0])
            raised = above if thing.has_relief else 0.0
            return max(abs(x), abs(y)) <= 0.5 and 0.0 <= z <= raised
        case "box":
            return max(abs(x), abs(y), abs(z)) <= 0.5
        case "sphere":
            return math.hypot(x, y, z) <= 0.5
    return math.hypot(x, z) <= 0.5 and abs(y) <= 0.5


# --- checking values -----------------------------------------------------------------------------


_NUMBERS: tuple[Any, ...] = (int, float, np.integer, np.floating)
_MOST_IN_32_BITS: dict[Any, float] = {int: 2**31 - 1, float: float(np.finfo(np.float32).max)}


def one_of(what: str, value: Any, allowed: Sequence[Any]) -> None:
    """Raise InputError unless the value is one of those allowed."""
    if value not in allowed:
        names = ", ".join(str(a) for a in allowed if a is not None)
        raise InputError(f"{what} is one of {names}, not {value!r}")


def within(what: str, value: float, low: float | None, high: float | None) -> None:
    """Raise InputError unless the value is a finite number in the range, ends included."""
    below = low is not None and value < low
    above = high is not None and value > high
    if not math.isfinite(value) or below or above:
        ends = f"from {low:g}" if high is None else f"from {low or 0:g} to {high:g}"
        raise InputError(f"{what} is {value:g}: give a number {ends}")


def checked_record(record: Any, values: Mapping[str, Any], owner: str) -> Any:
    """A record of settings with some fields changed; raises InputError for what does not fit."""
    assert is_record(record)
    known = {f.name: f for f in fields(record)}
    for name in values:
        if name not in known:
            names = ", ".join(known) or "nothing"
            raise InputError(f"{owner} has no setting {name!r}; it has {names}")
    for name, each in known.items():
        if each.default is MISSING and name not in values:
            raise InputError(f"{owner} needs a value for {name}")
    types = fields_of(record)
    return record(**{n: _checked(n, v, types[n], known[n].metadata) for n, v in values.items()})


def _checked(name: str, value: Any, wanted: Any, meta: Mapping[str, Any]) -> Any:
    """A number, or a vector's numbers, each within the setting's range and 32 bits."""
    component: Any
    component, size = (wanted, 1) if wanted in (int, float) else VECTORS.get(wanted, (None, 0))
    if component is None:
        return value
    several = size > 1 and not isinstance(value, str | Mapping) and np.iterable(value)
    numbers = [*value] if several else [value]
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, _NUMBERS):
            raise InputError(f"{name} is a number, not {value!r}")
        if abs(float(number)) > _MOST_IN_32_BITS[component]:
            raise InputError(f"{name} is further from 0 than 32 bits reach")
        within(name, float(number), meta.get("low"), meta.get("high"))
        if component is int and int(number) != number:
            raise InputError(f"{name} is a whole number, not {number:g}")
    if len(numbers) not in (1, size):
        raise InputError(f"{name} is one number, or {size} of them, not {value!r}")
    return wanted(*numbers)
