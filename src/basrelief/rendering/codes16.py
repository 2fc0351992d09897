"""Codes of 16 bits, encoded on the device that drew the colours."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine, PlaneBuffer
from basrelief.images import srgb_thresholds
from basrelief.lang.program import Program
from basrelief.shading.codes16 import FourLights, FourThresholds, LightRows, codes16
from basrelief.timings import step


@functools.cache
def _program() -> Program:
    return Program(codes16)


@functools.cache
def _thresholds() -> PlaneBuffer[FourThresholds]:
    least = srgb_thresholds(16)
    rows = np.pad(least, (0, -len(least) % 4)).reshape(1, -1)
    return PlaneBuffer(FourThresholds, rows.shape, rows.view(np.int32))


@step("draw")
def read_codes16(
    engine: Engine, lights: PlaneBuffer[FourLights], size: tuple[int, int]
) -> NDArray[np.uint16]:
    """The sRGB codes and alpha, (height, width, 4), of the four channels of a picture."""
    rows = LightRows(lights.shape[1], lights.shape[1] * size[1])
    canvas = engine.canvas(_program(), size)
    values = {"lights": lights, "rows": rows, "thresholds": _thresholds()}
    engine.draw(_program(), values, canvas)
    words = np.asarray(canvas.read("red_green", 2, interleaved=True), "<i4")
    return words.view(np.uint16)
