"""Catlike Coding, Rendering 20: Parallax, in float64.

The shader's names and order are kept. The article takes its lighting from earlier parts, whose
formulas it does not print; here it is the metallic-roughness BRDF of glTF 2.0, appendix B, times π,
with correlated masking (E. Heitz, 2014).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from articles.maps import Floats, Sampler
from articles.view import Fragments, Lamp, Pixels, dot, to_uv, to_world, unit

STRENGTH = 0.03
"""_ParallaxStrength."""
BIAS = 0.42
"""PARALLAX_BIAS, unless defined otherwise."""
STEPS = 10
"""PARALLAX_RAYMARCHING_STEPS."""
SEARCH_STEPS = 3
"""PARALLAX_RAYMARCHING_SEARCH_STEPS."""
MIDDLE_GREY = 0.214041
"""Half of sRGB's range as a linear value: a detail map of this grey changes nothing."""

Height = Callable[[Floats], Floats]
"""GetParallaxHeight: heights at n coordinates, (n,)."""


@dataclass(frozen=True)
class Shift:
    """uvOffset, (n, 2), the height that the ray has there, 0 to 1, and the closest decision."""

    uv: Floats
    height: Floats
    margin: Floats


# --- offsets --------------------------------------------------------------------------------------


def view_dir(quad: Fragments, *, limited: bool, bias: float) -> Floats:
    """tangentViewDir.xy as ApplyParallax projects it, in the picture's coordinates, (n, 2)."""
    tangent_view_dir = unit(quad.to_eye)
    across = tangent_view_dir[:, :2]
    if not limited:
        across = across / (tangent_view_dir[:, 2:] + bias)
    return to_uv(across)


def parallax_offset(get_height: Height, uv: Floats, view: Floats) -> Shift:
    """ParallaxOffset."""
    height = get_height(uv)
    offset = view * (STRENGTH * (height - 0.5))[:, None]
    return Shift(offset, height, np.full(len(uv), np.inf))


def parallax_raymarching(get_height: Height, uv: Floats, view: Floats) -> Shift:
    """ParallaxRaymarching with its search."""
    step_size = 1.0 / STEPS
    uv_delta = view * (step_size * STRENGTH)
    uv_offset = np.zeros_like(uv)
    step_height = np.ones(len(uv))
    surface_height = get_height(uv)
    margin = np.abs(step_height - surface_height)
    for _ in range(1, STEPS):
        above = step_height > surface_height
        uv_offset = np.where(above[:, None], uv_offset - uv_delta, uv_offset)
        step_height = np.where(above, step_height - step_size, step_height)
        surface_height = get_height(uv + uv_offset)
        margin = np.minimum(margin, np.abs(step_height - surface_height))
    for _ in range(SEARCH_STEPS):
        uv_delta = uv_delta * 0.5
        step_size *= 0.5
        below = step_height < surface_height
        margin = np.minimum(margin, np.abs(step_height - surface_height))
        uv_offset = np.where(below[:, None], uv_offset + uv_delta, uv_offset - uv_delta)
        step_height = np.where(below, step_height + step_size, step_height - step_size)
        surface_height = get_height(uv + uv_offset)
    return Shift(uv_offset, step_height, margin)


# --- lighting -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Surface:
    """Albedo, (n, 3), unit normal in tangent space, and roughness, metallic and occlusion, (n,)."""

    albedo: Floats
    normal: Floats
    roughness: Floats
    metallic: Floats
    occlusion: Floats


def lit(
    surface: Surface, view: Floats, position: Floats, lamps: Sequence[Lamp], ambient: Floats
) -> Floats:
    """The colour of n points, (n, 3)."""
    normal = to_world(surface.normal)
    albedo, metallic = surface.albedo, surface.metallic[:, None]
    total = ambient * albedo * surface.occlusion[:, None]
    alpha = surface.roughness**2
    n_dot_v = np.maximum(dot(normal, view), 1e-4)
    f0 = 0.04 * (1.0 - metallic) + albedo * metallic
    for lamp in lamps:
        light, color = lamp.at(position)
        n_dot_l = np.maximum(dot(normal, light), 0.0)
        half = unit(light + view)
        n_dot_h, v_dot_h = dot(normal, half), dot(view, half)
        distribution = alpha**2 / (np.pi * (n_dot_h**2 * (alpha**2 - 1.0) + 1.0) ** 2)
        towards = n_dot_v * np.sqrt(n_dot_l**2 * (1.0 - alpha**2) + alpha**2)
        away = n_dot_l * np.sqrt(n_dot_v**2 * (1.0 - alpha**2) + alpha**2)
        visibility = 0.5 / (towards + away)
        fresnel = f0 + (1.0 - f0) * ((1.0 - v_dot_h) ** 5)[:, None]
        diffuse = albedo * (1.0 - metallic) * (1.0 - fresnel)
        specular = fresnel * (np.pi * distribution * visibility)[:, None]
        total = total + color * (diffuse + specular) * n_dot_l[:, None]
    return total


def fogged(color: Floats, distance: Floats, fog_color: Floats, density: float) -> Floats:
    """Exponential squared fog by the distance to the camera (FOG_DISTANCE)."""
    factor = np.exp(-((density * distance) ** 2))[:, None]
    return fog_color * (1.0 - factor) + color * factor


# --- the fragment shader --------------------------------------------------------------------------


@dataclass(frozen=True)
class MapSet:
    """The material's maps; `response` has occlusion, roughness and metallic. `detail` and
    `detail_normal` are the secondary maps."""

    parallax: Sampler
    albedo: Sampler
    normal: Sampler
    response: Sampler
    detail: Sampler | None = None
    detail_normal: Sampler | None = None


def pixel(
    quad: Fragments,
    maps: MapSet,
    lamps: Sequence[Lamp],
    ambient: Floats,
    *,
    tiling: Floats,
    detail_tiling: Floats,
    limited: bool = False,
    bias: float = BIAS,
    marched: bool = False,
    fog: tuple[Floats, float] | None = None,
) -> Pixels:
    """MyFragmentProgram on a quad whose main maps are tiled. The hit is lit, and fogged, where it
    is displaced to."""

    def get_height(uv: Floats) -> Floats:
        return maps.parallax.at(uv)[:, 0]

    main, second = quad.uv * tiling, quad.uv * detail_tiling
    view = view_dir(quad, limited=limited, bias=bias)
    shift = (parallax_raymarching if marched else parallax_offset)(get_height, main, view)
    main = main + shift.uv
    second = second + shift.uv * (detail_tiling / tiling)

    gradients, second_gradients = quad.gradients * tiling, quad.gradients * detail_tiling
    albedo = maps.albedo.grad(main, gradients)
    normal = unit(maps.normal.grad(main, gradients) * 2.0 - 1.0)
    occlusion, roughness, metallic = maps.response.grad(main, gradients).T
    if maps.detail is not None:
        albedo = albedo * maps.detail.grad(second, second_gradients) / MIDDLE_GREY
    if maps.detail_normal is not None:
        detail = unit(maps.detail_normal.grad(second, second_gradients) * 2.0 - 1.0)
        normal = blend_normals(normal, detail)

    height = STRENGTH / tiling[0] * (shift.height - (1.0 if marched else 0.5))
    position = quad.raised(height)
    surface = Surface(albedo, normal, roughness, metallic, occlusion)
    colors = lit(surface, quad.view, position, lamps, ambient)
    if fog is not None:
        distance = np.linalg.norm(quad.camera - position, axis=-1)
        colors = fogged(colors, distance, *fog)
    return Pixels(main, colors, height, shift.margin)


def blend_normals(a: Floats, b: Floats) -> Floats:
    """BlendNormals: slopes add up."""
    return unit(np.concatenate([a[:, :2] + b[:, :2], a[:, 2:] * b[:, 2:]], -1))
