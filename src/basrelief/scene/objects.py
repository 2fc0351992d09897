"""Objects: a shape with a material, and how its relief is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.lang import Mat3, Vec2, Vec3
from basrelief.material import Material
from basrelief.scene.checks import FAR, NEAR, checked_record, one_of, within
from basrelief.scene.transforms import LYING, OUTLINES, Transform, placed, sound
from basrelief.shaders.pixel import Depth, Placement
from basrelief.shaders.surfaces.standard import Finish
from basrelief.shaders.techniques import TECHNIQUES, Technique, flat, relief
from basrelief.shaders.techniques.own import technique_from_file

SHAPES = ("plane", "box", "sphere", "cylinder")
DEFAULT_SCALE = 0.05
"""The depth of a relief whose material does not say: 5 % of a tile's width."""

_TILING = {"plane": (1.0, 1.0), "box": (1.0, 1.0), "sphere": (4.0, 2.0), "cylinder": (3.0, 1.0)}
"""Tiles around and along each shape so that a square tile stays about square."""


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
        if not all(NEAR <= abs(n) <= FAR for n in self.tiles):
            raise InputError(f"tiling {self.tiles}: give finite numbers other than 0")
        if not all(abs(n) <= FAR for n in self.shift):
            raise InputError(f"shift {self.shift}: give finite numbers")
        object.__setattr__(self, "settings", self._settings())
        if not sound(self.to_world):
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
        return OUTLINES[self.shape] @ matrix[:3, :3].T + matrix[:3, 3]

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
