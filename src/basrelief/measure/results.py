"""Measurements of techniques at several angles, which comparisons and reports are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine
from basrelief.lang import Vec3
from basrelief.lang.types import fields_of
from basrelief.measure.errors import Errors
from basrelief.measure.timing import Timing
from basrelief.scene import ResolvedObject, Scene
from basrelief.scene.recipe import Recipe
from basrelief.settings.kinds import FilterKind
from basrelief.techniques import flat


@dataclass(frozen=True, eq=False)
class Result:
    """Measurements of one technique at one angle: errors, time and pictures.

    Attributes
    ----------
    angle : float
        Angle between view and normal, in degrees.
    technique : str
        Name of the technique within the comparison.
    errors : Errors
        Errors against the truth.
    flip : float or None
        Mean FLIP error against the picture by `exact`, 0 to 1; None where FLIP is not installed.
    seconds : float
        Median time of the drawing program.
    picture : ndarray of float16, shape (h, w, 3)
        The picture, linear.
    off : ndarray of float16, shape (h, w)
        uv error of each pixel in texels, NaN where there is none.
    """

    angle: float
    technique: str
    errors: Errors
    flip: float | None
    seconds: float
    picture: NDArray[np.float16]
    off: NDArray[np.float16]


@dataclass(frozen=True, eq=False)
class Results:
    """Measurements of a comparison; `Comparison` describes the fields."""

    material: str
    texels: tuple[int, int]
    scale: float
    device: str
    filter: FilterKind
    filtered_format: str | None
    size: tuple[int, int]
    samples: int
    timing: Timing
    runs: int
    angles: tuple[float, ...]
    objects: Mapping[str, ResolvedObject]
    recipes: Mapping[str, Recipe]
    results: tuple[Result, ...]

    @property
    def filter_text(self) -> str:
        """The filter of the heights, in a sentence."""
        return filter_sentence(self.filter, self.filtered_format)

    def at(self, angle: float) -> list[Result]:
        """Results at one angle."""
        return [result for result in self.results if result.angle == angle]

    def of(self, technique: str) -> list[Result]:
        """Results of one technique, by angle."""
        return [result for result in self.results if result.technique == technique]


def filter_of(scene: Scene, engine: Engine) -> dict[str, Any]:
    """The filter of the heights of a scene of one object, and the format in which the device
    filters them, by the names of fields of `Results`."""
    filter = scene.objects[0].filter
    is_hardware = filter == "hardware"
    return {"filter": filter, "filtered_format": engine.filtered_format if is_hardware else None}


def filter_sentence(filter: FilterKind, filtered_format: str | None) -> str:
    """The filter of the heights, in a sentence."""
    match filter:
        case "texel":
            return "Heights are read as texels and interpolated by the shaders."
        case "hardware":
            return (
                f"Heights are filtered by the graphics card ({filtered_format}), except by exact, "
                "which reads texels."
            )
        case _:
            assert_never(filter)


def settings_of(obj: ResolvedObject) -> dict[str, Any]:
    """Settings of an object's technique, as JSON has them."""
    if obj.technique is flat:
        return {}
    record = obj.settings
    return {name: _json_value(getattr(record, name)) for name in fields_of(type(record))}


def _json_value(value: Any) -> Any:
    if isinstance(value, Vec3):
        return [float(component) for component in value]
    # the shortest decimal that gives the same 32-bit number
    return float(str(value)) if isinstance(value, np.float32) else int(value)
