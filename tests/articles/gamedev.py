"""J. Zink, A Closer Look at Parallax Occlusion Mapping, 2006, in float64.

The shader's names and order are kept. Three places are parameters, since the preset differs there
on purpose: the end of a ray that meets nothing, the point that is lit, and the length of a filtered
normal. All maps are filtered by the gradients of the undisplaced coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from articles.maps import Floats, Sampler
from articles.view import Fragments, Lamp, Pixels, dot, to_uv, to_world, unit

HEIGHT_MAP_SCALE = 0.1
"""fHeightMapScale."""
MIN_SAMPLES = 4
MAX_SAMPLES = 20
AMBIENT = 0.1
DIFFUSE = 0.5
FLAT_CHORD = 2e-3
"""A ray and a chord that part by less than this over a step meet at a place that the last digits
of the heights, 1e-6, move by 1/2000 of the step."""


def march(
    quad: Fragments, normal_height_map: Sampler, *, ends_at_base: bool
) -> tuple[Floats, Floats, Floats]:
    """vCurrOffset, (n, 2), the share of the whole offset that it is, and the closest decision.

    A ray without a sample above it ends at the whole offset, or with `ends_at_base` at the chord of
    the step from the last sample to the base.
    """
    eye = -unit(quad.to_eye)
    limit = -np.linalg.norm(eye[:, :2], axis=-1) / eye[:, 2] * HEIGHT_MAP_SCALE
    max_offset = to_uv(unit(eye[:, :2])) * limit[:, None]
    wanted = MAX_SAMPLES + (MIN_SAMPLES - MAX_SAMPLES) * -eye[:, 2]
    samples = np.trunc(wanted)
    margin = np.abs(wanted - np.rint(wanted))
    lod = normal_height_map.lod(quad.gradients)
    step = 1.0 / samples
    ray, last = np.ones(len(eye)), np.ones(len(eye))
    now, before = np.zeros(len(eye)), np.zeros(len(eye))
    going_on = np.ones(len(eye), bool)
    for k in range(MAX_SAMPLES + ends_at_base):
        going_on &= k < samples + ends_at_base
        sampled = normal_height_map.at_lod(quad.uv + max_offset * now[:, None], lod)[:, 3]
        over, under = sampled - ray, (ray + step) - last
        is_base = k == samples
        hit = going_on & ((over > 0.0) | is_base)
        width = np.where(hit, over + under, 1.0)
        ratio = np.where(hit, over / width, 0.0)
        now = np.where(hit, ratio * before + (1.0 - ratio) * now, now)
        decided = np.where(is_base, np.inf, np.abs(over))
        flat = np.where(width < FLAT_CHORD, 0.0, np.inf)
        margin = np.where(going_on, np.minimum(margin, np.minimum(decided, flat)), margin)
        going_on &= ~hit
        ray = np.where(going_on, ray - step, ray)
        before = np.where(going_on, now, before)
        now = np.where(going_on, now + step, now)
        last = np.where(going_on, sampled, last)
    return max_offset * now[:, None], now, margin


def pixel(
    quad: Fragments,
    normal_height_map: Sampler,
    color_map: Sampler,
    lamps: Sequence[Lamp],
    *,
    ends_at_base: bool,
    lit_at_hit: bool,
    unit_normals: bool,
) -> Pixels:
    """The pixel shader. `normal_height_map` has normals and, in the fourth channel, heights."""
    offset, share, margin = march(quad, normal_height_map, ends_at_base=ends_at_base)
    final = quad.uv + offset
    normal = normal_height_map.grad(final, quad.gradients)[:, :3] * 2.0 - 1.0
    color = color_map.grad(final, quad.gradients)
    height = -share * HEIGHT_MAP_SCALE
    position = quad.raised(height) if lit_at_hit else quad.position
    length = 1.0 if unit_normals else np.linalg.norm(normal, axis=-1)
    total = color * AMBIENT
    for lamp in lamps:
        light, _ = lamp.at(position)
        cosine = np.maximum(0.0, dot(light, to_world(unit(normal)))) * length
        total = total + color * cosine[:, None] * DIFFUSE
    return Pixels(final, total, height, margin)
