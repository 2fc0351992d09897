"""Errors of a technique's frame against the truth: missed hits, distances, visible difference.

A hit is **missed** where the displaced texture coordinates are more than one texel from those of
the true first hit, or where nothing is drawn. Missed hits are of two kinds. The ray **passed**
through a feature where it ended behind the true hit. It stopped **short** where it ended before it,
as techniques of one read do, which search for no hit, and marches that ran out of steps.

A pixel is in **wrong light** where more than half a light is missing or too much; `measure.light`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_encode
from basrelief.measure.truth import Truth, length_of
from basrelief.rendering.frame import Frame, Image

__all__ = [
    "Errors", "Spread", "depth_error", "errors", "flip", "light_error", "missed", "overshoot",
    "uv_error", "wrong_light",
]  # fmt: skip

Floats = NDArray[np.float64]
MISS_TOLERANCE = 1.0
"""Largest uv error, in texels, of a hit that does not count as missed."""
WRONG_LIGHT = 0.5
"""Largest error of a light's share in a pixel that does not count as in wrong light."""


@dataclass(frozen=True)
class Spread:
    """Median, 99th percentile and maximum of some errors."""

    median: float
    percentile_99: float
    worst: float


@dataclass(frozen=True)
class Errors:
    """Errors of a frame over the pixels that show the object.

    Attributes
    ----------
    pixels : int
        Number of pixels that show the object.
    missed : float
        Share of these pixels whose hit is missed, 0 to 1: `passed`, `short` and pixels that are
        not drawn.
    passed : float
        Share of pixels whose ray ended behind the true hit, 0 to 1.
    short : float
        Share of pixels whose ray ended before the true hit, 0 to 1.
    uv : Spread
        Magnitudes of the uv errors of drawn pixels, in texels, by the shortest way where the map
        repeats.
    depth : Spread
        Magnitudes of the depth errors of drawn pixels, in world units along the ray.
    reads : float
        Mean number of heights read in a covered pixel.
    wrong_light : float or None
        Share of pixels in wrong light, 0 to 1; None without shadows.
    """

    pixels: int
    missed: float
    passed: float
    short: float
    uv: Spread
    depth: Spread
    reads: float
    wrong_light: float | None = None


def errors(frame: Frame, truth: Truth, light: Floats | None = None) -> Errors:
    """All errors of a frame; raises InputError where frame and truth have different sizes.

    `light` is the share of each light in the picture, as `measure.light.shown_light` gives it.
    """
    difference = _uv_difference(frame, truth)
    off = _length(difference, truth)
    is_missed, behind = _is_missed(off, truth), _along_ray(difference, truth) > 0.0
    count = max(int(truth.there.sum()), 1)
    drawn = frame.hit & truth.there
    return Errors(
        pixels=int(truth.there.sum()),
        missed=float(is_missed.sum() / count),
        passed=float((is_missed & drawn & behind).sum() / count),
        short=float((is_missed & drawn & ~behind).sum() / count),
        uv=_spread(off[drawn]),
        depth=_spread(np.abs(depth_error(frame, truth)[drawn])),
        reads=frame.mean_reads,
        wrong_light=None if light is None else float(wrong_light(light, truth).sum() / count),
    )


def missed(frame: Frame, truth: Truth) -> NDArray[np.bool_]:
    """Mask of missed hits, (height, width): off by more than a texel, or not drawn."""
    return _is_missed(uv_error(frame, truth), truth)


def wrong_light(light: Floats, truth: Truth) -> NDArray[np.bool_]:
    """Mask of pixels in wrong light, (height, width).

    `light` is the share of each light in the picture, as `measure.light.shown_light` gives it.
    Raises InputError for a truth without shadows, and for one of another size.
    """
    difference = np.abs(light_error(light, truth))
    is_wrong: NDArray[np.bool_] = truth.there & (difference > WRONG_LIGHT).any(0)
    return is_wrong


def light_error(light: Floats, truth: Truth) -> Floats:
    """The share of each light in a picture less the true one, (lights, height, width)."""
    if truth.light is None:
        raise InputError("the truth is of a scene without shadows; turn them on: shadows='hard'")
    if light.shape != truth.light.shape:
        raise InputError("the light is of other lights or another size than the truth's")
    return light - truth.light


def uv_error(frame: Frame, truth: Truth) -> Floats:
    """Distance from true to displaced texture coordinates in texels, (height, width).

    The shortest distance where the map repeats. NaN where there is no object, or it is not drawn.
    """
    return _length(_uv_difference(frame, truth), truth)


def overshoot(frame: Frame, truth: Truth) -> Floats:
    """Signed distance from the true hit to the end of the ray in texels, (height, width).

    Measured along the ray over the map; below 0 the ray stopped short. 0 for a ray along the
    normal, which does not move over the map. NaN where there is no object, or it is not drawn.
    """
    return _along_ray(_uv_difference(frame, truth), truth)


def depth_error(frame: Frame, truth: Truth) -> Floats:
    """A frame's distance less the truth's, in world units along the ray, (height, width).

    NaN where there is no object, or it is not drawn.
    """
    both = _is_drawn(frame, truth)
    # the distance is infinite where nothing is drawn
    distance = np.where(both, frame.distance, 0.0).astype(np.float64)
    return np.where(both, distance - truth.distance, np.nan)


def flip(reference: Image | Frame, picture: Image | Frame) -> float:
    """Mean FLIP error between two pictures that alternate on a screen, 0 to 1.

    P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020, by NVIDIA's own
    code at its default of 67 pixels a degree; 0 for equal pictures, without evaluating them.
    Raises InputError where that is not installed.
    """
    evaluate = _evaluator()
    colors = _display_colors(reference), _display_colors(picture)
    if np.array_equal(*colors):
        return 0.0
    _, mean, _ = evaluate(*colors, "LDR", applyMagma=False)
    return float(mean)


def has_flip() -> bool:
    """Whether NVIDIA's flip-evaluator is installed."""
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


def _display_colors(picture: Image | Frame) -> NDArray[np.float32]:
    """The picture over black, in sRGB, 0 to 1."""
    pixels = (picture.image if isinstance(picture, Frame) else picture).pixels
    light = np.clip(pixels[:, :, :3] * pixels[:, :, 3:], 0.0, 1.0)
    return np.ascontiguousarray(srgb_encode(light), np.float32)


def _uv_difference(frame: Frame, truth: Truth) -> Floats:
    """Displaced less true texture coordinates, (height, width, 2), NaN where either is missing."""
    both = _is_drawn(frame, truth)
    difference: Floats = np.where(both[:, :, None], frame.uv.astype(np.float64) - truth.uv, np.nan)
    return difference


def _length(difference: Floats, truth: Truth) -> Floats:
    """Lengths of differences of texture coordinates in texels, the shortest where a map repeats."""
    if truth.wraps:
        difference = difference - np.rint(difference)
    return length_of(difference * truth.texels)


def _along_ray(difference: Floats, truth: Truth) -> Floats:
    """Parts of differences of texture coordinates along the rays over the map, in texels."""
    products = difference * truth.texels * truth.direction
    along: Floats = products[:, :, 0] + products[:, :, 1]
    return along


def _is_missed(off: Floats, truth: Truth) -> NDArray[np.bool_]:
    """Mask of missed hits from uv errors."""
    is_missed: NDArray[np.bool_] = truth.there & (np.nan_to_num(off, nan=np.inf) > MISS_TOLERANCE)
    return is_missed


def _is_drawn(frame: Frame, truth: Truth) -> NDArray[np.bool_]:
    _check(frame, truth)
    both: NDArray[np.bool_] = frame.hit & truth.there
    return both


def _check(frame: Frame, truth: Truth) -> None:
    if frame.hit.shape != truth.there.shape:
        (h, w), (high, wide) = frame.hit.shape, truth.there.shape
        raise InputError(
            f"the frame is {w} × {h}, the truth {wide} × {high}: use one size for both"
        )


def _spread(values: Floats) -> Spread:
    if values.size == 0:
        return Spread(0.0, 0.0, 0.0)
    median, percentile_99, worst = np.quantile(values, (0.5, 0.99, 1.0))
    return Spread(float(median), float(percentile_99), float(worst))
