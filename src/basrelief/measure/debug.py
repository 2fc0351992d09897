"""Debug pictures: reads and errors of a frame as colours, with a scale.

    debug_picture("missed", frame, truth(scene, size)).image.save("missed.png")

Dark means few reads or no error; colour maps are perceptually even (`measure.colors`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeGuard, assert_never, get_args

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.measure import colors
from basrelief.measure.errors import (
    depth_error,
    errors,
    light_error,
    missed,
    overshoot,
    wrong_light,
)
from basrelief.measure.truth import Truth
from basrelief.rendering.frame import Frame, Image

__all__ = ["SHOWN", "DebugPicture", "Shown", "debug_picture"]

Shown = Literal["reads", "missed", "overshoot", "depth-error", "shadow-error"]
SHOWN: tuple[str, ...] = get_args(Shown)
_DIMMED = 0.25
"""Brightness of the picture behind missed hits."""
_BACKGROUND = 0.03
"""The grey, linear, of pixels that show no object."""


@dataclass(frozen=True, eq=False)
class DebugPicture:
    """A picture with its scale along the lower edge, and the meaning of its colours in words."""

    image: Image
    meaning: str


def debug_picture(
    what: Shown | str,
    frame: Frame,
    truth: Truth | None = None,
    light: NDArray[np.float64] | None = None,
) -> DebugPicture:
    """Draw reads or errors of a frame as colours.

    Parameters
    ----------
    what : {"reads", "missed", "overshoot", "depth-error", "shadow-error"}
        Quantity to draw: heights read in each pixel, missed hits, overshoot in texels, depth error
        in world units, or the error of the light with the largest one. Overshoot and depth error
        are signed and on a scale of square roots: orange is too far, blue too short. Of the light
        orange is too much, blue too little.
    frame : Frame
        The frame, as `render` returns it.
    truth : Truth, optional
        The truth of the same scene and size; "reads" does not need it.
    light : ndarray of float64, shape (lights, h, w), optional
        The share of each light in the frame, for "shadow-error": `measure.light.shown_light`.

    Returns
    -------
    DebugPicture
        Its scale starts at 0, or spans both signs, and ends at a round number that 99 of 100
        pixels do not exceed.

    Raises
    ------
    InputError
        For another quantity, a missing truth or light, and one of another size.
    """
    if not is_shown(what):
        raise InputError(_unknown_picture(what))
    if what == "reads":
        return _reads(frame)
    if truth is None:
        raise InputError(f"{what} is measured against the truth; give it: truth(scene, size)")
    match what:
        case "missed":
            return _missed(frame, truth)
        case "overshoot":
            return _signed(overshoot(frame, truth), "uv overshoot", "texels")
        case "depth-error":
            return _signed(depth_error(frame, truth), "depth error", "world units")
        case "shadow-error":
            if light is None:
                raise InputError("shadow-error needs the light of the picture; give it as light=…")
            return _light(light, truth)
        case _:
            assert_never(what)


def is_shown(what: str) -> TypeGuard[Shown]:
    """Whether a debug picture has this name."""
    return what in SHOWN


def check_shown(what: str) -> None:
    """Raise InputError for a name that no debug picture has."""
    if not is_shown(what):
        raise InputError(_unknown_picture(what))


def _unknown_picture(what: str) -> str:
    return f"there is no debug picture {what!r}; use color, {', '.join(SHOWN)}"


def _reads(frame: Frame) -> DebugPicture:
    reads = np.where(frame.hit, frame.reads, np.nan)
    most = _round_up(reads)
    image = _with_scale(_with_background(colors.heat(reads / most), ~frame.hit), colors.heat, 0.0)
    mean = f"{frame.mean_reads:.1f} on average"
    return DebugPicture(image, f"heights read in a pixel, from 0 (dark) to {most:g} (pale): {mean}")


def _missed(frame: Frame, truth: Truth) -> DebugPicture:
    is_missed, behind = missed(frame, truth), overshoot(frame, truth) > 0.0
    dim = frame.color[:, :, :3] * frame.color[:, :, 3:]
    pixels = np.repeat(dim.mean(-1, keepdims=True) * _DIMMED, 3, axis=-1)
    pixels[is_missed & behind] = colors.PASSED
    pixels[is_missed & ~behind] = colors.SHORT
    totals = errors(frame, truth)
    meaning = (
        f"missed hits: {totals.missed:.2%} of the pixels that show the object; orange: passed "
        f"through a feature ({totals.passed:.2%}), blue: stopped short or not drawn "
        f"({totals.missed - totals.passed:.2%})"
    )
    return DebugPicture(_opaque(pixels), meaning)


def _signed(values: NDArray[np.float64], what: str, unit: str) -> DebugPicture:
    most = _round_up(np.abs(values))
    # square roots, or a few large errors would hide the many small ones
    share = np.copysign(np.sqrt(np.abs(values) / most), values)
    pixels = _with_background(colors.signed(share), np.isnan(values))
    image = _with_scale(pixels, colors.signed, -1.0)
    meaning = (
        f"{what}, from {-most:g} {unit} (pale blue: too short) over 0 (dark) to {most:g} "
        f"(pale orange: too far); the middle of either half is {most / 4.0:g}"
    )
    return DebugPicture(image, meaning)


def _light(light: NDArray[np.float64], truth: Truth) -> DebugPicture:
    if not len(light):
        raise InputError("shadow-error compares lights, and the scene has none; add --light")
    error = light_error(light, truth)
    largest = np.abs(error).argmax(0)[None]
    values = np.where(truth.there, np.take_along_axis(error, largest, 0)[0], np.nan)
    pixels = _with_background(colors.signed(values), np.isnan(values))
    share = wrong_light(light, truth).sum() / max(int(truth.there.sum()), 1)
    meaning = (
        "error of a light's share, from -1 (pale blue: dark where it should be lit) over 0 (dark) "
        f"to 1 (pale orange: lit where it should be dark); {share:.2%} of the pixels that show the "
        "object are in wrong light, off by more than a half"
    )
    return DebugPicture(_with_scale(pixels, colors.signed, -1.0), meaning)


def _round_up(values: NDArray[np.float64]) -> float:
    """A round number that 99 of 100 values do not exceed."""
    finite = values[~np.isnan(values)]
    quantile = float(np.quantile(finite, 0.99)) if finite.size else 0.0
    if quantile <= 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(quantile))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= quantile))


def _with_background(
    pixels: NDArray[np.float32], background: NDArray[np.bool_]
) -> NDArray[np.float32]:
    pixels[background] = _BACKGROUND
    return pixels


def _with_scale(pixels: NDArray[np.float32], ramp: Any, first: float) -> Image:
    """The picture with a bar of the colours from `first` to 1 along its lower edge."""
    height, width = pixels.shape[:2]
    bar = max(height // 40, 1)
    pixels[height - bar :] = ramp(np.linspace(first, 1.0, width))
    if height > 3 * bar:
        pixels[height - bar - 1 - bar // 4 : height - bar] = 0.0
    return _opaque(pixels)


def _opaque(pixels: NDArray[np.float32]) -> Image:
    whole = np.ones((*pixels.shape[:2], 4), np.float32)
    whole[:, :, :3] = pixels
    return Image(whole)
