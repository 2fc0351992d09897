"""What the slots of a program are bound to, by rules, where no static condition decides yet."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, assert_never

from basrelief.lang import Shader
from basrelief.lang.resources import Edge
from basrelief.shading import pixel, relief, shadow_map, shapes
from basrelief.shading.kinds import (
    HeightsKind,
    MappingKind,
    OcclusionKind,
    Projection,
    ShadowsOnKind,
    ShapeKind,
    SurfaceKind,
)
from basrelief.shading.surfaces import landscape, standard, surface
from basrelief.shading.variant import Variant
from basrelief.techniques import Technique, columns, displace, edge, height, projection

AnyShader = Shader[..., Any]


@dataclass(frozen=True, kw_only=True)
class Choices(Variant):
    """A variant, and what else the program of an object in a scene depends on.

    `technique` is `flat` where nothing is displaced. The maps are named that are read; for others
    something plain stands.
    """

    technique: Technique[..., Any]
    shape: ShapeKind
    projection: Projection
    heights: HeightsKind
    edge: Edge
    clipped: bool
    fades: bool
    mapping: MappingKind
    apart: bool
    surface: SurfaceKind
    layer: bool
    base_color: bool
    normal: bool
    response: bool
    emission: bool
    layer_color: bool
    layer_normal: bool
    shadows_on: ShadowsOnKind
    casts: bool

    @property
    def triplanar(self) -> bool:
        """Whether colours are laid on from three sides, as the relief lies."""
        return _FROM_THREE_SIDES[self.mapping] and self.displaced and self.base_color


Rule = Callable[[Choices], AnyShader]


def bindings_of(choices: Choices) -> dict[AnyShader, AnyShader]:
    """What the slots of a program are bound to."""
    return {slot: rule(choices) for slot, rule in RULES.items()}


# --- the object ----------------------------------------------------------------------------------


def _inside(c: Choices) -> AnyShader:
    """What is cut off at the object's edge: around a sphere or a cylinder there is none along u."""
    if not c.clipped:
        return pixel.anywhere
    match c.shape:
        case "plane" | "box":
            return pixel.within
        case "sphere" | "cylinder":
            return pixel.within_rims
        case _:
            assert_never(c.shape)


def _slope_of(c: Choices) -> AnyShader:
    """How the relief lies: boxes have sides, which nothing else in a program knows of."""
    if c.boxed:
        return relief.of_boxes
    return relief.of_heights if c.triplanar else relief.unasked


def _flat_height(c: Choices) -> AnyShader:
    """The height where nothing is displaced, for what asks for one."""
    if _GOES_BY_HEIGHT[c.surface] or _HAS_DIRECTION[c.occlusion_kind]:
        return columns.top_at if c.boxed else relief.as_stored
    return relief.unread


def _surface_height(c: Choices) -> AnyShader:
    return columns.top_at if c.boxed else height.heights_of(c.heights)[height.surface_height]


def _base_color_of(c: Choices) -> AnyShader:
    if not c.base_color:
        return standard.plain_base_color
    if c.triplanar:
        return standard.triplanar_base_color
    return standard.pixelated_base_color if c.boxed else standard.mapped_base_color


# --- what each value of a choice stands for; no other value is known

SHAPES: Mapping[ShapeKind, AnyShader] = {
    "plane": shapes.plane,
    "box": shapes.box,
    "sphere": shapes.sphere,
    "cylinder": shapes.cylinder,
}
PROJECTIONS: Mapping[Projection, AnyShader] = {
    "full": projection.full,
    "biased": projection.biased,
    "limited": projection.limited,
}
LEVELS: Mapping[HeightsKind, AnyShader] = {
    "sharp": relief.finest,
    "smooth": relief.as_the_pixel_sees,
    "mip": relief.nearest_level,
}
SURFACES: Mapping[SurfaceKind, AnyShader] = {
    "standard": standard.standard_surface,
    "landscape": landscape.landscape_surface,
}
RECEIVERS: Mapping[ShadowsOnKind, AnyShader] = {
    "relief": pixel.on_the_relief,
    "polygon": pixel.on_the_polygon,
}
_FROM_THREE_SIDES: Mapping[MappingKind, bool] = {"planar": False, "triplanar": True}
_HAS_DIRECTION: Mapping[OcclusionKind, bool] = {"ambient": False, "directional": True}
_GOES_BY_HEIGHT: Mapping[SurfaceKind, bool] = {"standard": False, "landscape": True}


# --- the rules


def _of_the_edge(slot: AnyShader) -> Rule:
    return lambda c: edge.edges_of(c.edge)[slot]


def _of_the_heights(slot: AnyShader) -> Rule:
    return lambda c: height.heights_of(c.heights)[slot]


RULES: dict[AnyShader, Rule] = {
    shapes.shape: lambda c: SHAPES[c.shape],
    projection.projection: lambda c: PROJECTIONS[c.projection],
    displace: lambda c: c.technique,
    **{each: _of_the_edge(each) for each in edge.edges_of("wrap")},
    **{each: _of_the_heights(each) for each in height.heights_of("sharp")},
    height.surface_height: _surface_height,
    pixel.inside: _inside,
    pixel.facing: lambda c: pixel.as_the_side if c.boxed else pixel.as_mapped,
    relief.displaced: lambda c: relief.with_relief if c.displaced else relief.without_relief,
    relief.depth_seen: lambda c: relief.fading if c.fades else relief.as_deep,
    relief.lod_seen: lambda c: LEVELS[c.heights],
    relief.flat_height: _flat_height,
    relief.slope_of: _slope_of,
    # --- the surface
    surface.surface_at: lambda c: SURFACES[c.surface],
    surface.spot_of: lambda c: surface.apart if c.apart else surface.together,
    surface.turned: lambda c: surface.mirrored_with if c.apart else surface.as_it_is,
    standard.layered: lambda c: standard.with_details if c.layer else standard.bare,
    landscape.high_ground: lambda c: landscape.of_the_layer if c.layer else landscape.as_below,
    standard.base_color_of: _base_color_of,
    standard.normal_of: lambda c: standard.mapped_normal if c.normal else standard.plain_normal,
    standard.response_of: lambda c: (
        standard.mapped_response if c.response else standard.plain_response
    ),
    standard.emission_of: lambda c: (
        standard.mapped_emission if c.emission else standard.plain_emission
    ),
    standard.layer_color_of: lambda c: (
        standard.mapped_layer_color if c.layer_color else standard.plain_layer_color
    ),
    standard.layer_normal_of: lambda c: (
        standard.mapped_layer_normal if c.layer_normal else standard.plain_layer_normal
    ),
    # --- the light
    shadow_map.reaching_past_others: lambda c: (
        shadow_map.past_others if c.casts else shadow_map.nothing_else
    ),
    pixel.receiver: lambda c: RECEIVERS[c.shadows_on],
}
"""What each slot of `pixel` is bound to."""
