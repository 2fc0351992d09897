"""How far a technique's frame is from the truth: what is missed, by how much, and how it looks.

A hit is **missed** where a pixel does not show the place at which its ray first meets the surface,
give or take a texel: where the displaced texture coordinates are more than one texel from the true
ones, or nothing is drawn. Missed hits are of two kinds. The ray **passed** through a feature where
it ended further along than the surface; it stopped **short** where it ended in the air before it,
as the techniques of one read do, which look for no hit at all, and marches that ran out of steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_encode
from basrelief.measure.truth import Truth
from basrelief.rendering.frame import Frame, Image

__all__ = ["Errors", "Spread", "depth_error", "errors", "flip", "missed", "overshoot", "uv_error"]

Floats = NDArray[np.float64]
WITHIN = 1.0
"""Texels by which a hit may be off before it counts as missed."""


@dataclass(frozen=True)
class Spread:
    """The median of some errors, the 99th percentile and the worst."""

    median: float
    percentile_99: float
    worst: float


@dataclass(frozen=True)
class Errors:
    """The errors of a frame over the pixels that show the object.

    `missed`, `passed` and `short` are shares of these pixels, 0 to 1; `missed` is the sum of the
    other two and of the pixels that are not drawn. `uv` is in texels, the shortest way round where
    the map repeats, `depth` in world units along the ray; both are magnitudes, over the pixels that
    are drawn. `reads` is the mean number of heights read for a pixel.
    """

    pixels: int
    missed: float
    passed: float
    short: float
    uv: Spread
    depth: Spread
    reads: float


def errors(frame: Frame, truth: Truth) -> Errors:
    """All of them; raises InputError where frame and truth are of different sizes."""
    lost = missed(frame, truth)
    count = max(int(truth.there.sum()), 1)
    behind = overshoot(frame, truth) > 0.0
    drawn = frame.hit & truth.there
    return Errors(
        pixels=int(truth.there.sum()),
        missed=float(lost.sum() / count),
        passed=float((lost & drawn & behind).sum() / count),
        short=float((lost & drawn & ~behind).sum() / count),
        uv=_spread(uv_error(frame, truth)[drawn]),
        depth=_spread(np.abs(depth_error(frame, truth)[drawn])),
        reads=frame.mean_reads,
    )


def missed(frame: Frame, truth: Truth) -> NDArray[np.bool_]:
    """Which pixels miss their hit, (height, width): off by more than a texel, or not drawn."""
    _check(frame, truth)
    off = np.nan_to_num(uv_error(frame, truth), nan=np.inf) > WITHIN
    lost: NDArray[np.bool_] = truth.there & off
    return lost


def uv_error(frame: Frame, truth: Truth) -> Floats:
    """How many texels lie between displaced and true coordinates, (height, width).

    Where the map repeats, the shortest way round. NaN where the object is not, or is not drawn.
    """
    off = _apart(frame, truth)
    if truth.wraps:
        off = off - np.rint(off)
    length: Floats = np.linalg.norm(off * truth.texels, axis=-1)
    return length


def overshoot(frame: Frame, truth: Truth) -> Floats:
    """How many texels further than the true hit a pixel's ray ends, along it, (height, width).

    Below 0 it stops short. A ray that falls straight has no way to be late on: 0. NaN as above.
    """
    way = truth.travel * truth.texels
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    unit = way / np.where(length > 0.0, length, 1.0)
    along: Floats = (_apart(frame, truth) * truth.texels * unit).sum(-1)
    return along


def depth_error(frame: Frame, truth: Truth) -> Floats:
    """How much further a frame's depth is than the truth's, in world units, (height, width)."""
    both = _drawn(frame, truth)
    # not infinite less something where nothing is
    seen = np.where(both, frame.distance, 0.0).astype(np.float64)
    return np.where(both, seen - truth.distance, np.nan)


def flip(reference: Image | Frame, picture: Image | Frame) -> float:
    """The mean FLIP error between two pictures as the eye sees them side by side, 0 to 1.

    P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020, by NVIDIA's own
    code at its usual 67 pixels a degree. Raises InputError where that is not installed.
    """
    evaluate = _evaluator()
    _, mean, _ = evaluate(_for_eyes(reference), _for_eyes(picture), "LDR", applyMagma=False)
    return float(mean)


def has_flip() -> bool:
    """Whether FLIP can be measured here."""
    try:
        _evaluator()
    except InputError:
        return False
    return True


def _evaluator() -> Any:
    try:
        from flip_evaluator import evaluate
    except ImportError:
        raise InputError(
            "FLIP needs NVIDIA's flip-evaluator; pip install 'basrelief[measure]'"
        ) from None
    return evaluate


def _for_eyes(picture: Image | Frame) -> NDArray[np.float32]:
    """sRGB codes, 0 to 1, over black where nothing is."""
    pixels = (picture.image if isinstance(picture, Frame) else picture).pixels
    light = np.clip(pixels[:, :, :3] * pixels[:, :, 3:], 0.0, 1.0)
    return np.ascontiguousarray(srgb_encode(light), np.float32)


def _apart(frame: Frame, truth: Truth) -> Floats:
    """Displaced less true coordinates, (height, width, 2), NaN where either is missing."""
    both = _drawn(frame, truth)
    off: Floats = np.where(both[:, :, None], frame.uv.astype(np.float64) - truth.uv, np.nan)
    return off


def _drawn(frame: Frame, truth: Truth) -> NDArray[np.bool_]:
    _check(frame, truth)
    both: NDArray[np.bool_] = frame.hit & truth.there
    return both


def _check(frame: Frame, truth: Truth) -> None:
    if frame.hit.shape != truth.there.shape:
        (h, w), (high, wide) = frame.hit.shape, truth.there.shape
        raise InputError(f"a frame of {w} × {h} and a truth of {wide} × {high}: make both alike")


def _spread(values: Floats) -> Spread:
    if values.size == 0:
        return Spread(0.0, 0.0, 0.0)
    median, late, worst = np.quantile(values, (0.5, 0.99, 1.0))
    return Spread(float(median), float(late), float(worst))
