"""What the slots of a program are bound to, by rules, where no static condition decides yet."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from basrelief.lang import Shader
from basrelief.lang.resources import Edge
from basrelief.shading import pixel, relief, shadow_map, shapes
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
    shape: str
    projection: str
    heights: Literal["sharp", "smooth", "mip"]
    edge: Edge
    clipped: bool
    fades: bool
    mapping: str
    apart: bool
    surface: str
    layer: bool
    base_color: bool
    normal: bool
    response: bool
    emission: bool
    layer_color: bool
    layer_normal: bool
    shadows_on: str
    casts: bool

    @property
    def triplanar(self) -> bool:
        """Whether colours are laid on from three sides, as the relief lies."""
        return self.mapping == "triplanar" and self.displaced and self.base_color


Rule = Callable[[Choices], AnyShader]


def bindings_of(choices: Choices) -> dict[AnyShader, AnyShader]:
    """What the slots of a program are bound to."""
    return {slot: rule(choices) for slot, rule in RULES.items()}


# --- the object ----------------------------------------------------------------------------------


def _inside(c: Choices) -> AnyShader:
    """What is cut off at the object's edge: around a sphere or a cylinder there is none along u."""
    if not c.clipped:
        return pixel.anywhere
    return pixel.within if c.shape in ("plane", "box") else pixel.within_rims


def _slope_of(c: Choices) -> AnyShader:
    """How the relief lies: boxes have sides, which nothing else in a program knows of."""
    if c.boxed:
        return relief.of_boxes
    return relief.of_heights if c.triplanar else relief.unasked


def _flat_height(c: Choices) -> AnyShader:
    """The height where nothing is displaced, for what asks for one."""
    if c.surface == "landscape" or c.occlusion_kind == "directional":
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


_LEVELS: Mapping[str, AnyShader] = {
    "sharp": relief.finest,
    "smooth": relief.as_the_pixel_sees,
    "mip": relief.nearest_level,
}


def _of_the_edge(slot: AnyShader) -> Rule:
    return lambda c: edge.edges_of(c.edge)[slot]


def _of_the_heights(slot: AnyShader) -> Rule:
    return lambda c: height.heights_of(c.heights)[slot]


RULES: dict[AnyShader, Rule] = {
    shapes.shape: lambda c: getattr(shapes, c.shape),
    projection.projection: lambda c: getattr(projection, c.projection),
    displace: lambda c: c.technique,
    **{each: _of_the_edge(each) for each in edge.edges_of("wrap")},
    **{each: _of_the_heights(each) for each in height.heights_of("sharp")},
    height.surface_height: _surface_height,
    pixel.inside: _inside,
    pixel.facing: lambda c: pixel.as_the_side if c.boxed else pixel.as_mapped,
    relief.displaced: lambda c: relief.with_relief if c.displaced else relief.without_relief,
    relief.depth_seen: lambda c: relief.fading if c.fades else relief.as_deep,
    relief.lod_seen: lambda c: _LEVELS[c.heights],
    relief.flat_height: _flat_height,
    relief.slope_of: _slope_of,
    # --- the surface
    surface.surface_at: lambda c: (
        landscape.landscape_surface if c.surface == "landscape" else standard.standard_surface
    ),
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
    pixel.receiver: lambda c: (
        pixel.on_the_polygon if c.shadows_on == "polygon" else pixel.on_the_relief
    ),
}
"""What each slot of `pixel` is bound to."""
