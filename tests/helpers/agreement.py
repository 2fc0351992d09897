"""Tolerances between pictures of one scene that two engines draw.

Texture coordinates agree within 0.05 texel for 99.9 % of the pixels, and encoded colours within
2 ÷ 255 for 99.5 %. The remaining pixels are for outlines and the layers of a march, where a last
digit decides between two positions.
"""

from __future__ import annotations

import numpy as np

from basrelief.images import srgb_encode
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Scene

UV_TOLERANCE = 0.05
"""Tolerance of texture coordinates, in texels."""
COLOR_TOLERANCE = 2.0
"""Tolerance of encoded colours, in steps of 255."""


def uv_difference(one: Frame, other: Frame, hit_in_both: np.ndarray, texels: int) -> np.ndarray:
    """Distance of the displaced coordinates in texels; 0 where either frame hits nothing."""
    difference = np.abs(one.uv.astype(np.float64) - other.uv).max(axis=-1) * texels
    return np.where(hit_in_both, difference, 0.0)


def color_difference(one: Frame, other: Frame) -> np.ndarray:
    """Difference of encoded colours in steps of 255."""
    codes = [srgb_encode(np.clip(frame.color[:, :, :3], 0.0, 1.0)) * 255 for frame in (one, other)]
    return np.abs(codes[0] - codes[1]).max(axis=-1)


def worst(difference: np.ndarray, one: Frame, other: Frame, unit: str) -> str:
    """The five worst pixels, for an assertion message."""
    lines = []
    for flat in np.argsort(difference, axis=None)[::-1][:5]:
        y, x = np.unravel_index(flat, difference.shape)
        lines.append(
            f"pixel ({x}, {y}): {difference[y, x]:.4g} {unit} apart; "
            f"{one.device}: uv {one.uv[y, x]}, reads {one.reads[y, x]}, color {one.color[y, x]}; "
            f"{other.device}: uv {other.uv[y, x]}, reads {other.reads[y, x]}, "
            f"color {other.color[y, x]}"
        )
    return "\n".join(lines)


def assert_agree(one: Frame, other: Frame, texels: int) -> None:
    """Assert that two frames agree; `texels` is the side of the maps."""
    hit_in_both = one.hit & other.hit
    assert hit_in_both.mean() > 0.15
    assert (one.hit != other.hit).mean() <= 0.001
    difference = uv_difference(one, other, hit_in_both, texels)
    fraction = float((difference[hit_in_both] <= UV_TOLERANCE).mean())
    assert fraction >= 0.999, (
        f"{fraction:.4%} within {UV_TOLERANCE}\n{worst(difference, one, other, 'texels')}"
    )
    colors = color_difference(one, other)
    fraction = float((colors[hit_in_both] <= COLOR_TOLERANCE).mean())
    assert fraction >= 0.995, (
        f"{fraction:.4%} within {COLOR_TOLERANCE}\n{worst(colors, one, other, 'steps')}"
    )
    depths = np.abs(one.distance[hit_in_both] - other.distance[hit_in_both])
    assert (depths <= 1e-3).mean() >= 0.999


def assert_engines_agree(scene: Scene, texels: int, size: tuple[int, int] = (128, 72)) -> None:
    """Assert that the CPU and the GPU draw the same picture of a scene."""
    one, other = (render(scene, size=size, samples=1, device=name) for name in ("cpu", "gpu"))
    assert_agree(one, other, texels)
