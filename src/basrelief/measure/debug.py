"""Debug pictures: what a frame hides, as colours, each with its scale.

    debug_picture("missed", frame, truth(scene, size)).image.save("missed.png")

Dark is as it should be in all of them; maps of colour are even to the eye (`measure.colors`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeGuard, assert_never, get_args

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.measure import colors
from basrelief.measure.errors import depth_error, errors, missed, overshoot
from basrelief.measure.truth import Truth
from basrelief.rendering.frame import Frame, Image

__all__ = ["SHOWN", "DebugPicture", "Shown", "debug_picture"]

Shown = Literal["reads", "missed", "overshoot", "depth-error"]
SHOWN: tuple[str, ...] = get_args(Shown)
_DIMMED = 0.25
"""How bright the picture behind missed hits is."""
_NOTHING = 0.03
"""The grey, linear, of pixels that show no object."""


@dataclass(frozen=True, eq=False)
class DebugPicture:
    """A picture with its scale along the lower edge, and in words what its colours mean."""

    image: Image
    meaning: str


def debug_picture(what: Shown | str, frame: Frame, truth: Truth | None = None) -> DebugPicture:
    """How many heights each pixel `reads`, or against the truth its `missed` hit, `overshoot` or
    `depth-error`.

    Overshoot is in texels, depth error in world units, both signed and by square roots: orange is
    too far, blue not far enough. The scale reaches from 0, or to both sides of it, up to a round
    number that holds 99 of 100 pixels. Raises InputError for anything else, and where a truth is
    needed and not given.
    """
    if not is_shown(what):
        raise InputError(_not_shown(what))
    if what == "reads":
        return _reads(frame)
    if truth is None:
        raise InputError(f"{what} is measured against the truth; give it, as truth(scene, size)")
    match what:
        case "missed":
            return _missed(frame, truth)
        case "overshoot":
            return _signed(overshoot(frame, truth), "uv overshoot", "texels")
        case "depth-error":
            return _signed(depth_error(frame, truth), "depth error", "world units")
        case _:
            assert_never(what)


def is_shown(what: str) -> TypeGuard[Shown]:
    """Whether there is a debug picture of that name."""
    return what in SHOWN


def check_shown(what: str) -> None:
    """Raise InputError for what there is no debug picture of."""
    if not is_shown(what):
        raise InputError(_not_shown(what))


def _not_shown(what: str) -> str:
    return f"nothing is shown as {what!r}; use color, {', '.join(SHOWN)}"


def _reads(frame: Frame) -> DebugPicture:
    reads = np.where(frame.hit, frame.reads, np.nan)
    most = _round_up(reads)
    image = _with_scale(_over(colors.heat(reads / most), ~frame.hit), colors.heat, 0.0)
    mean = f"{frame.mean_reads:.1f} on average"
    return DebugPicture(image, f"heights read a pixel, from 0 (dark) to {most:g} (pale): {mean}")


def _missed(frame: Frame, truth: Truth) -> DebugPicture:
    lost, behind = missed(frame, truth), overshoot(frame, truth) > 0.0
    dim = frame.color[:, :, :3] * frame.color[:, :, 3:]
    pixels = np.repeat(dim.mean(-1, keepdims=True) * _DIMMED, 3, axis=-1)
    pixels[lost & behind] = colors.PASSED
    pixels[lost & ~behind] = colors.SHORT
    found = errors(frame, truth)
    told = (
        f"missed hits: {found.missed:.2%} of the pixels that show the object; orange passed "
        f"through a feature ({found.passed:.2%}), blue stopped short or is not drawn "
        f"({found.missed - found.passed:.2%})"
    )
    return DebugPicture(_opaque(pixels), told)


def _signed(values: NDArray[np.float64], what: str, unit: str) -> DebugPicture:
    most = _round_up(np.abs(values))
    # by square roots, or a few that are far off would hide the many that are a little
    share = np.copysign(np.sqrt(np.abs(values) / most), values)
    pixels = _over(colors.signed(share), np.isnan(values))
    image = _with_scale(pixels, colors.signed, -1.0)
    told = (
        f"{what}, from {-most:g} {unit} (pale blue: not far enough) over 0 (dark) to {most:g} "
        f"(pale orange: too far); half-way to either end is {most / 4.0:g}"
    )
    return DebugPicture(image, told)


def _round_up(values: NDArray[np.float64]) -> float:
    """A round number that 99 of 100 values do not exceed."""
    there = values[~np.isnan(values)]
    held = float(np.quantile(there, 0.99)) if there.size else 0.0
    if held <= 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(held))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= held))


def _over(pixels: NDArray[np.float32], nothing: NDArray[np.bool_]) -> NDArray[np.float32]:
    pixels[nothing] = _NOTHING
    return pixels


def _with_scale(pixels: NDArray[np.float32], ramp: Any, first: float) -> Image:
    """The picture with its colours from `first` to 1 in a bar along the lower edge."""
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
