"""Wikibooks, Cg Programming/Unity: Projection of Bumpy Surfaces, in float64.

The shader's names and order are kept. Three places are parameters, since the preset differs there
on purpose: the point that is lit, the normals, whose z is reconstructed before or after filtering,
and their slope along v, which a tile of other proportions than its maps stretches.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from articles.maps import Floats, Sampler
from articles.view import Fragments, Lamp, Pixels, dot, to_uv, to_world, unit

PARALLAX = 0.01
"""_Parallax, the maximum height."""
MAX_TEX_COORD_OFFSET = 0.01
"""_MaxTexCoordOffset."""
COLOR = np.ones(3)
SPEC_COLOR = np.ones(3)
SHININESS = 10.0


def height_of(quad: Fragments, parallax_map: Sampler, tiling: Floats, shift: Floats) -> Floats:
    """`height`: that of the point, in units of the quad, (n,)."""
    return PARALLAX * (-0.5 + parallax_map.at(tiling * quad.uv + shift)[:, 0])


def tex_coord_offsets(quad: Fragments, height: Floats) -> Floats:
    """`texCoordOffsets`, on the quad, (n, 2)."""
    view = quad.to_eye
    offsets = height[:, None] * to_uv(view[:, :2]) / view[:, 2:]
    return np.clip(offsets, -MAX_TEX_COORD_OFFSET, MAX_TEX_COORD_OFFSET)


def local_coords(encoded: Floats) -> Floats:
    """`localCoords`: x and y as read, z from the unit length, (…, 3)."""
    xy = 2.0 * encoded - 1.0
    z = np.sqrt(1.0 - dot(xy, xy))
    return np.concatenate([xy, z[..., None]], -1)


def phong(
    normal: Floats,
    view: Floats,
    position: Floats,
    lamps: Sequence[Lamp],
    *,
    color: Floats = COLOR,
    spec_color: Floats = SPEC_COLOR,
    shininess: float = SHININESS,
    ambient: Floats,
    diffuse: float = 1.0,
    visible: Sequence[Floats] | None = None,
) -> tuple[Floats, Floats]:
    """The fragment's colour by Phong's lighting, (n, 3), and the least |n · l|, at which the
    highlight begins, (n,). `visible` is the share of each light that arrives."""
    total = ambient * color
    closest = np.full(len(normal), np.inf)
    for k, lamp in enumerate(lamps):
        light, light_color = lamp.at(position)
        n_dot_l = dot(normal, light)
        mirrored = 2.0 * n_dot_l[:, None] * normal - light
        highlight = np.maximum(0.0, dot(mirrored, view)) ** shininess
        specular = np.where(n_dot_l < 0.0, 0.0, highlight)[:, None] * spec_color
        diffuse_part = color * (diffuse * np.maximum(0.0, n_dot_l))[:, None]
        share = 1.0 if visible is None else visible[k][:, None]
        total = total + light_color * (diffuse_part + specular) * share
        closest = np.minimum(closest, np.abs(n_dot_l))
    return total, closest


def pixel(
    quad: Fragments,
    parallax_map: Sampler,
    bump_map: Sampler,
    color_map: Sampler | None,
    lamps: Sequence[Lamp],
    ambient: Floats,
    tiling: Floats,
    shift: Floats,
    *,
    lit_at_hit: bool,
    normals_have_z: bool,
    stretch: float,
) -> Pixels:
    """The fragment shader.

    `bump_map` has the channels A and G, or x, y and z where `normals_have_z`. Slopes along v are
    multiplied by `stretch`.
    """
    height = height_of(quad, parallax_map, tiling, shift)
    uv = tiling * (quad.uv + tex_coord_offsets(quad, height)) + shift
    gradients = quad.gradients * tiling
    encoded = bump_map.grad(uv, gradients)
    local = 2.0 * encoded - 1.0 if normals_have_z else local_coords(encoded)
    local = unit(local) * (1.0, stretch, 1.0)
    position = quad.raised(height) if lit_at_hit else quad.position
    colors, closest = phong(
        to_world(unit(local)),
        quad.view,
        position,
        lamps,
        color=COLOR if color_map is None else color_map.grad(uv, gradients),
        ambient=ambient,
    )
    return Pixels(uv, colors, height, closest)
