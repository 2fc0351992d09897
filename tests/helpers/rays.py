"""Random rays over a tile, and height maps to trace them on."""

from __future__ import annotations

import functools

import numpy as np

from basrelief.lang import Vec2, shader, struct
from basrelief.material import sample
from basrelief.techniques import Ray

LATE = 0.05
"""Tolerance of hits behind the true one, in texels."""


def flat_ray(uv, travel, reference_height: float = 1.0, cosine: float = 0.5) -> Ray:
    """The whole ray over a flat surface; it intersects the polygon at `uv`."""
    travel = Vec2(*travel)
    return Ray(
        Vec2(*uv) + travel * (reference_height - 1.0),
        travel,
        1.0,
        1.0,
        cosine,
        reference_height=reference_height,
    )


@struct
class Fan:
    """Rays from random positions on a tile, each component of their travel up to `reach` tiles."""

    reach: float
    seed: int


@shader
def scattered(n: int) -> float:
    """A pseudo-random number from 0 to 1 for every int."""
    x = n * 747796405 + 891336453
    y = ((x >> 15) ^ x) * 277803737
    return float(((y >> 11) ^ y) & 16777215) / 16777216.0


@functools.cache
def maps() -> dict[str, np.ndarray]:
    random = np.random.default_rng(0)
    posts = np.zeros((96, 128))
    posts[random.integers(0, 96, 60), random.integers(0, 128, 60)] = 1.0
    seam = np.zeros((33, 31))
    seam[0], seam[:, -1] = 1.0, 0.9
    return {
        "noise": random.random((64, 64)),
        "odd noise": random.random((37, 53)),
        "posts": posts,
        "saddles": np.indices((32, 32)).sum(0) % 2 * 1.0,
        "seams": seam,
        "one texel": np.array([[0.3]]),
        "one row": random.random((1, 17)),
        "one column": random.random((13, 1)),
        "bricks": sample("bricks", 128).height.linear()[:, :, 0],
        "gravel": sample("gravel", (100, 128)).height.linear()[:, :, 0],
    }
