"""S. Halliwell, Parallax Offset, 2014, in float64.

The article prints the stock offset alone. Its march, its smoothing, its shadows and its directional
occlusion are written here after its text. The numbers that it leaves open are parameters, and the
occlusion's formula is the one of the documentation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from articles.maps import Floats, Sampler
from articles.view import Fragments, Lamp, dot, to_uv, to_world, unit

Height = Callable[[Floats], Floats]
"""Heights at n coordinates, (n,)."""


# --- the stock offset -----------------------------------------------------------------------------


def stock_offset(parallax_map: Sampler, quad: Fragments, height: float) -> tuple[Floats, Floats]:
    """ParallaxOffset: on the picture, (n, 2), and the point's height over the quad, (n,)."""
    h = parallax_map.at(quad.uv)[:, 0]
    h = h * height - height / 2.0
    v = unit(quad.to_eye)
    return h[:, None] * to_uv(v[:, :2]) / (v[:, 2:] + 0.42), h


# --- the article's own shader ---------------------------------------------------------------------


def smooth_heights(parallax_map: Sampler, quad: Fragments, bias: float, fade: float) -> Height:
    """Heights of a lower mip level, faded to a still lower one by the difference of the two."""
    lod = parallax_map.lod(quad.gradients) + bias

    def height(uv: Floats) -> Floats:
        sample = parallax_map.at_lod(uv, lod)[:, 0]
        lower = parallax_map.at_lod(uv, lod + 2.0)[:, 0]
        weight = np.minimum(np.abs(sample - lower) * fade, 1.0)
        return sample + (lower - sample) * weight

    return height


@dataclass(frozen=True)
class Offset:
    """uv offset, (n, 2), height of the ray there from 0 to 1, and the closest decision, (n,)."""

    uv: Floats
    height: Floats
    margin: Floats


def march(
    quad: Fragments, height: Height, depth: float, min_steps: int, max_steps: int, halvings: int
) -> Offset:
    """The march in the view direction by steps of the view angle, then the binary search between
    the previous and the current sample."""
    view = unit(quad.to_eye)
    travel = -to_uv(view[:, :2]) / view[:, 2:] * depth
    wanted = max_steps + (min_steps - max_steps) * view[:, 2]
    steps = np.trunc(wanted)
    margin = np.abs(wanted - np.rint(wanted))
    current = np.full(len(steps), np.nan)
    for k in range(max_steps):
        t = k / steps
        over = height(quad.uv + travel * t[:, None]) - (1.0 - t)
        going_on = np.isnan(current) & (k < steps)
        margin = np.where(going_on, np.minimum(margin, np.abs(over)), margin)
        current = np.where(going_on & (over >= 0.0), t, current)
    # no surface lies below the floor
    current = np.where(np.isnan(current), 1.0, current)
    previous = np.maximum(current - 1.0 / steps, 0.0)
    middle = current
    for k in range(halvings):
        middle = (previous + current) / 2.0
        over = height(quad.uv + travel * middle[:, None]) - (1.0 - middle)
        if k < halvings - 1:
            margin = np.minimum(margin, np.where(current > 0.0, np.abs(over), np.inf))
        current = np.where(over >= 0.0, middle, current)
        previous = np.where(over >= 0.0, previous, middle)
    return Offset(travel * middle[:, None], 1.0 - middle, margin)


def reaches(
    uv: Floats, height: Height, light: Floats, depth: float, slack: float, steps: int
) -> Floats:
    """1 where a march from the surface towards the light, (n, 3) in tangent space, makes it to the
    top without dipping below the height, else 0."""
    start = height(uv)
    travel = to_uv(light[:, :2]) / light[:, 2:] * (depth * (1.0 - start))[:, None]
    free = light[:, 2] > 0.0
    for k in range(1, steps + 1):
        ray = start + (1.0 - start) * (k / steps)
        free &= height(uv + travel * (k / steps)) <= ray + slack
    return free.astype(np.float64)


def directional_occlusion(
    occlusion: Floats, height: Floats, normal: Floats, lamp: Lamp, position: Floats
) -> Floats:
    """The ambient occlusion mixed with depth and N · L: the share of a light, (n,)."""
    light, _ = lamp.at(position)
    n_dot_l = np.clip(dot(to_world(normal), light), 0.0, 1.0)
    exposure = occlusion * height
    return exposure + (1.0 - exposure) * n_dot_l
