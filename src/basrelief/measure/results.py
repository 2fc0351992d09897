"""Measurements of techniques at some angles: what a comparison holds, and its report is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.lang import Vec3
from basrelief.measure.errors import Errors
from basrelief.measure.timing import Timing
from basrelief.scene import Object
from basrelief.techniques import flat


@dataclass(frozen=True, eq=False)
class Result:
    """One technique at one angle, in degrees: errors against the truth, cost, and how it looks.

    `flip` is the mean FLIP error against the picture by `exact`, None where FLIP is not installed;
    `seconds` the median time of the drawing program; `picture` (H, W, 3) linear, `off` (H, W) the
    uv error of each pixel in texels, NaN where there is none; both float16.
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
    """Measurements of a comparison: `results` by angle, then by technique, fastest first."""

    material: str
    texels: tuple[int, int]
    scale: float
    device: str
    size: tuple[int, int]
    samples: int
    timing: Timing
    runs: int
    angles: tuple[float, ...]
    objects: Mapping[str, Object]
    results: tuple[Result, ...]

    def at(self, angle: float) -> list[Result]:
        """The results at one angle."""
        return [each for each in self.results if each.angle == angle]

    def of(self, technique: str) -> list[Result]:
        """The results of one technique, angle by angle."""
        return [each for each in self.results if each.technique == technique]


def settings_of(obj: Object) -> dict[str, Any]:
    """The settings of an object's technique, as plain numbers."""
    if obj.selected_technique is flat:
        return {}
    record = obj.settings
    return {name: _plain(getattr(record, name)) for name in type(record).__dataclass_fields__}


def _plain(value: Any) -> Any:
    if isinstance(value, Vec3):
        return [float(each) for each in value]
    # the shortest number that is the same in 32 bits
    return float(str(value)) if isinstance(value, np.float32) else int(value)
