"""The standard surface: the maps of a metallic-roughness material, each read or left out.

Each map has a slot with two answers: from the map, or the plain value that stands for a map which
the material does not have. A program contains only the reads that it needs.
"""

from __future__ import annotations

from basrelief.lang import (
    Texture,
    Vec2,
    Vec3,
    Vec4,
    mix,
    normalize,
    setting,
    shader,
    slot,
    struct,
)
from basrelief.shaders.gradients import Footprint
from basrelief.shaders.texture import trilinear

FLATTEST = 1e-3
"""The least z of a stored normal: a map of (½, ½, ½) gives the surface's own normal."""


@struct
class Finish:
    """Numbers that multiply the maps, or stand for those that are missing."""

    base_color: Vec3 = setting(default=Vec3(1.0), doc="colour, times the map's, linear", low=0.0)
    normal_strength: float = setting(
        default=1.0, doc="how far normals lean, 1 as stored", low=0.0, high=4.0
    )
    roughness: float = setting(default=1.0, doc="times the map's", low=0.0, high=1.0)
    metallic: float = setting(default=1.0, doc="times the map's", low=0.0, high=1.0)
    occlusion: float = setting(
        default=1.0, doc="how much of the map's occlusion acts", low=0.0, high=1.0
    )
    emission: Vec3 = setting(default=Vec3(1.0), doc="times the map's, linear", low=0.0)


@struct
class Spot:
    """A place on the texture: displaced coordinates and how far a pixel reaches."""

    uv: Vec2
    footprint: Footprint


# --- base colour and opacity ------------------------------------------------------------------


@slot
def base_color_of(map: Texture, spot: Spot) -> Vec4:
    """Linear colour, and opacity."""


@shader
def mapped_base_color(map: Texture, spot: Spot) -> Vec4:
    """From the map."""
    return trilinear(map, spot.uv, spot.footprint)


@shader
def plain_base_color(map: Texture, spot: Spot) -> Vec4:
    """Light grey, so that a material of heights alone shows its relief."""
    return Vec4(0.6, 0.6, 0.6, 1.0)


# --- normal -----------------------------------------------------------------------------------


@slot
def normal_of(map: Texture, spot: Spot, finish: Finish) -> Vec3:
    """The unit normal in tangent space, green up."""


@shader
def mapped_normal(map: Texture, spot: Spot, finish: Finish) -> Vec3:
    """From the map, leaning as strongly as the finish says."""
    stored = trilinear(map, spot.uv, spot.footprint).xyz * 2.0 - 1.0
    leaning = stored.xy * finish.normal_strength
    return normalize(Vec3(leaning, max(stored.z, FLATTEST)))


@shader
def plain_normal(map: Texture, spot: Spot, finish: Finish) -> Vec3:
    """The surface's own."""
    return Vec3(0.0, 0.0, 1.0)


# --- occlusion, roughness, metallic --------------------------------------------------------------


@slot
def response_of(map: Texture, spot: Spot) -> Vec3:
    """Occlusion, roughness, metallic."""


@shader
def mapped_response(map: Texture, spot: Spot) -> Vec3:
    """From the map in which the three are packed, as in glTF 2.0."""
    return trilinear(map, spot.uv, spot.footprint).xyz


@shader
def plain_response(map: Texture, spot: Spot) -> Vec3:
    """Not occluded, fairly rough, no metal."""
    return Vec3(1.0, 0.8, 0.0)


# --- emission ------------------------------------------------------------------------------------


@slot
def emission_of(map: Texture, spot: Spot) -> Vec3:
    """The light that the surface sends out by itself, linear."""


@shader
def mapped_emission(map: Texture, spot: Spot) -> Vec3:
    """From the map."""
    return trilinear(map, spot.uv, spot.footprint).xyz


@shader
def plain_emission(map: Texture, spot: Spot) -> Vec3:
    """None."""
    return Vec3(0.0)


# --- all of it -----------------------------------------------------------------------------------


@struct
class Surface:
    """What the surface is made of at one place; `normal` in tangent space."""

    base_color: Vec3
    opacity: float
    normal: Vec3
    occlusion: float
    roughness: float
    metallic: float
    emission: Vec3


@shader
def standard_surface(
    spot: Spot,
    finish: Finish,
    base_color: Texture,
    normal: Texture,
    response: Texture,
    emission: Texture,
) -> Surface:
    """Read the maps at a place and apply the finish."""
    color = base_color_of(base_color, spot)
    packed = response_of(response, spot)
    return Surface(
        base_color=color.xyz * finish.base_color,
        opacity=color.w,
        normal=normal_of(normal, spot, finish),
        occlusion=mix(1.0, packed.x, finish.occlusion),
        roughness=packed.y * finish.roughness,
        metallic=packed.z * finish.metallic,
        emission=emission_of(emission, spot) * finish.emission,
    )
