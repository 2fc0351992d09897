"""How far apart two pictures may be that two engines draw of one scene.

Stated: displaced texture coordinates within 0.05 texel for 99.9 % of the pixels, colours within
2 ÷ 255 of an encoded picture for 99.5 %. Outlines and the layers of a march are what the rest is
for: there a last digit decides between two places.
"""

from __future__ import annotations

import numpy as np

from basrelief.images import srgb_encode
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Scene

CLOSE = 0.05
"""Texels."""
ALIKE = 2.0
"""Steps of 255 in an encoded picture."""


def texels_apart(one: Frame, other: Frame, both: np.ndarray, texels: int) -> np.ndarray:
    """How far apart the displaced coordinates are, in texels; 0 where either hits nothing."""
    apart = np.abs(one.uv.astype(np.float64) - other.uv).max(axis=-1) * texels
    return np.where(both, apart, 0.0)


def steps_apart(one: Frame, other: Frame) -> np.ndarray:
    """How far apart the colours of an 8-bit picture are."""
    codes = [srgb_encode(np.clip(frame.color[:, :, :3], 0.0, 1.0)) * 255 for frame in (one, other)]
    return np.abs(codes[0] - codes[1]).max(axis=-1)


def worst(apart: np.ndarray, one: Frame, other: Frame, unit: str) -> str:
    """The five worst pixels, for the message of a failure."""
    lines = []
    for flat in np.argsort(apart, axis=None)[::-1][:5]:
        y, x = np.unravel_index(flat, apart.shape)
        lines.append(
            f"pixel ({x}, {y}): {apart[y, x]:.4g} {unit} apart; "
            f"{one.device}: uv {one.uv[y, x]}, reads {one.reads[y, x]}, color {one.color[y, x]}; "
            f"{other.device}: uv {other.uv[y, x]}, reads {other.reads[y, x]}, "
            f"color {other.color[y, x]}"
        )
    return "\n".join(lines)


def assert_agree(one: Frame, other: Frame, texels: int) -> None:
    """Two frames of maps of so many texels a side are alike."""
    both = one.hit & other.hit
    assert both.mean() > 0.15
    assert (one.hit != other.hit).mean() <= 0.001
    apart = texels_apart(one, other, both, texels)
    share = float((apart[both] <= CLOSE).mean())
    assert share >= 0.999, f"{share:.4%} within {CLOSE}\n{worst(apart, one, other, 'texels')}"
    colors = steps_apart(one, other)
    share = float((colors[both] <= ALIKE).mean())
    assert share >= 0.995, f"{share:.4%} within {ALIKE}\n{worst(colors, one, other, 'steps')}"
    depths = np.abs(one.distance[both] - other.distance[both])
    assert (depths <= 1e-3).mean() >= 0.999


def assert_engines_agree(scene: Scene, texels: int, size: tuple[int, int] = (128, 72)) -> None:
    """The CPU and the GPU draw the same picture of a scene."""
    one, other = (render(scene, size=size, samples=1, device=name) for name in ("cpu", "gpu"))
    assert_agree(one, other, texels)
