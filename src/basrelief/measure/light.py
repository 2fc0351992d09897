"""Light on a relief: the share of each light that reaches a pixel, in pictures and in truth.

A pixel is **in wrong light** where the share of a light differs by more than a half from the true
one: lit where the relief is in the way, or dark where nothing is.

The share in a picture is read off the picture itself, drawn with and without shadows. The true one
is that of the rays from the true hit to the light which meet nothing, by the oracle: one ray for
hard shadows, many over the disc of the light for soft ones. It is 0 where the surface faces away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine
from basrelief.measure.oracle import intersect_height_field
from basrelief.rendering.programs import map_edge
from basrelief.rendering.render import render
from basrelief.scene import ResolvedObject, Scene
from basrelief.shading.lights import DIRECTIONAL, Light
from basrelief.techniques.projection import MIN_COSINE

Floats = NDArray[np.float64]
RAYS = 16
"""Rays to the disc of a light."""
CENTRE = np.zeros(2)
DARK = 1e-5
"""Linear radiance below which a light adds nothing to a pixel."""
LIFT = 1e-7
"""Height above the true hit at which its ray to a light ends, so that it does not hit there."""


def shown_light(scene: Scene, size: tuple[int, int], engine: Engine) -> Floats:
    """Share of each light in a picture of a scene, 0 to 1, (lights, height, width).

    0 where a light adds nothing even without shadows, since the surface faces away from it.
    """
    without = _radiance(replace(scene, lights=()), size, engine)
    shares = np.zeros((len(scene.lights), *without.shape))
    for share, light in zip(shares, scene.lights, strict=True):
        lit = replace(scene, lights=(light,))
        whole = _radiance(replace(lit, shadows="none"), size, engine) - without
        part = _radiance(lit, size, engine) - without
        np.divide(part, whole, out=share, where=whole > DARK)
    return np.clip(shares, 0.0, 1.0)


def light_of(scene: Scene, size: tuple[int, int], engine: Engine) -> Floats | None:
    """`shown_light` of a scene with shadows; None without them."""
    return None if scene.shadows == "none" else shown_light(scene, size, engine)


def _radiance(scene: Scene, size: tuple[int, int], engine: Engine) -> Floats:
    """Linear radiance of each pixel, the sum of its channels."""
    color = render(scene, size=size, samples=1, device=engine).color
    radiance: Floats = color[:, :, :3].astype(np.float64).sum(-1)
    return radiance


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a plane's relief: texture coordinates (n, 2), heights (n,), and the height range at
    each in tile widths (n,)."""

    uv: Floats
    height: Floats
    scale: Floats


def visible_share(
    heights: NDArray[np.float32], obj: ResolvedObject, points: Points, light: Light, angle: float
) -> Floats:
    """Share of a light that the relief leaves visible from points, 0 to 1, (n,).

    `angle` is the one that the light's disc spans, in degrees; 0 for hard shadows.
    """
    if angle == 0.0:
        return unblocked(heights, obj, points, light).astype(np.float64)
    radius = np.tan(np.radians(0.5 * angle))
    free = [unblocked(heights, obj, points, light, radius * place) for place in _disc(RAYS)]
    share: Floats = np.mean(np.array(free, np.float64), axis=0)
    return share


def _disc(count: int) -> Floats:
    """Points spread evenly over the unit disc, (count, 2), on a spiral (H. Vogel, A Better Way to
    Construct the Sunflower Head, 1979)."""
    n = np.arange(count) + 0.5
    turn = n * (np.pi * (3.0 - np.sqrt(5.0)))
    places: Floats = np.sqrt(n / count)[:, None] * np.stack([np.cos(turn), np.sin(turn)], -1)
    return places


def unblocked(
    heights: NDArray[np.float32],
    obj: ResolvedObject,
    points: Points,
    light: Light,
    aside: Floats = CENTRE,
) -> NDArray[np.bool_]:
    """Whether rays from points to a light meet nothing, (n,).

    `aside` is the ray's offset from the centre of the light, (2,), at distance 1.
    """
    uv, height = points.uv, points.height
    tiles = np.array([*obj.tiling.tiles], np.float64)
    height_range = points.scale / abs(tiles[0])
    place = (uv - [*obj.tiling.shift]) / tiles
    above = (height - obj.reference_height) * height_range
    position = np.stack([place[:, 0] - 0.5, 0.5 - place[:, 1], above], -1)
    towards = _towards(light, obj, position, aside)
    rises = towards[:, 2] > MIN_COSINE
    slope = towards[:, :2] / np.where(rises, towards[:, 2], 1.0)[:, None]
    climb = (1.0 - height) * height_range
    travel = slope * climb[:, None] * tiles * [1.0, -1.0]
    # from the light down: a ray that starts on the surface would hit there
    end = height + LIFT
    top = np.maximum(end, 1.0)
    hits = intersect_height_field(
        heights, uv + travel, -travel, map_edge(obj), height=top, drop=top - end
    )
    free: NDArray[np.bool_] = rises & ~hits.found
    return free


def _towards(light: Light, obj: ResolvedObject, position: Floats, aside: Floats) -> Floats:
    """Unit directions to a place of a light in object space, (n, 3), from object positions."""
    matrix = np.asarray(obj.transform, np.float64)
    if light.kind == DIRECTIONAL:
        world = np.broadcast_to(-np.array([*light.direction], np.float64), position.shape)
    else:
        world = np.array([*light.position]) - (position @ matrix[:3, :3].T + matrix[:3, 3])
    world = world / np.linalg.norm(world, axis=-1, keepdims=True)
    # any two axes across the direction
    across = np.cross(world, np.where(abs(world[:, :1]) < 0.5, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    world = world + aside[0] * across + aside[1] * np.cross(world, across)
    inside = world @ np.linalg.inv(matrix[:3, :3]).T
    unit: Floats = inside / np.linalg.norm(inside, axis=-1, keepdims=True)
    return unit
