"""Objects of a scene → programs, and the values that they read: only what is needed is in them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from basrelief.lang import Buffer, Vec2, Vec3
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.material import pyramids
from basrelief.scene import Object, Scene
from basrelief.scene.objects import DEFAULT_SCALE
from basrelief.shaders import (
    boxes,
    cast,
    fog,
    height,
    lighting,
    pixel,
    projection,
    relief,
    shadow,
    shapes,
    view_ray,
)
from basrelief.shaders.edge import edges_of
from basrelief.shaders.lighting import Light
from basrelief.shaders.meeting import View
from basrelief.shaders.surfaces import landscape, standard, surface
from basrelief.shaders.techniques import Nothing, displace, flat

_LEVELS = {
    "sharp": relief.finest,
    "smooth": relief.as_the_pixel_sees,
    "mip": relief.nearest_level,
}
_MAPPED = {
    "base_color": standard.base_color_of,
    "normal": standard.normal_of,
    "response": standard.response_of,
    "emission": standard.emission_of,
    "layer_color": standard.layer_color_of,
    "layer_normal": standard.layer_normal_of,
}
"""The slot of each map: bound to what reads it, or to what stands for it."""


def program_of(thing: Object, scene: Scene | None = None) -> Program:
    """The program that draws an object of a scene: only what it needs is in it."""
    scene = scene or Scene((thing,))
    shadowed = thing.has_relief and scene.shadows != "none"
    boxed = thing.has_relief and thing.drawn_with.boxes
    bindings = {
        **_bindings_of(thing),
        pixel.facing: pixel.as_the_side if boxed else pixel.as_mapped,
        relief.unhidden: relief.self_shadowed if shadowed else relief.everything,
        relief.depth_seen: relief.fading if thing.fade else relief.as_deep,
        relief.flat_height: (
            (boxes.top_at if boxed else relief.as_stored)
            if thing.surface == "landscape" or scene.occlusion_kind == "directional"
            else relief.unread
        ),
        relief.lit_from: relief.on_the_box if boxed else relief.on_the_surface,
        shadow.shadow: _shadow(scene.shadows == "soft", boxed),
        lighting.reflectance: getattr(lighting, scene.shading_model),
        cast.reaching_past_others: cast.past_others if scene.casts else cast.nothing_else,
        pixel.receiver: (
            pixel.on_the_polygon if scene.shadows_on == "polygon" else pixel.on_the_relief
        ),
        pixel.openness: (
            pixel.open_from_above if scene.occlusion_kind == "directional" else pixel.open_to_all
        ),
        fog.fogged: fog.clear if scene.fog == "none" else getattr(fog, scene.fog),
    }
    return Program(pixel.pixel, bindings, map_edge(thing))


def _shadow(soft: bool, boxed: bool) -> Any:
    """What the relief hides of a light."""
    if boxed:
        return shadow.soft_of_boxes if soft else shadow.hard_of_boxes
    return shadow.soft if soft else shadow.hard


def reach_of(thing: Object) -> Program:
    """The program that draws an object's part of a depth map."""
    # a relief that fades does so with the distance from the camera, not from a light
    bindings = {**_bindings_of(thing), relief.depth_seen: relief.as_deep}
    if thing.casts == "opaque":
        bindings[standard.opacity_of] = standard.opaque
    return Program(pixel.reach, bindings, map_edge(thing))


def rays_of(thing: Object) -> Program:
    """The program that gives the true view ray of each pixel, whatever the technique."""
    return Program(
        view_ray.view_ray,
        {
            shapes.shape: getattr(shapes, thing.shape),
            relief.depth_seen: relief.fading if thing.fade else relief.as_deep,
            projection.projection: projection.full,
        },
        map_edge(thing),
    )


def _bindings_of(thing: Object) -> dict[Any, Any]:
    """What an object's own choices bind: where rays end, and what is read there."""
    three = thing.mapping == "triplanar"
    three = three and thing.has_relief and thing.material.base_color is not None
    boxed = thing.has_relief and thing.drawn_with.boxes
    alpha = {"blend": standard.blended, "mask": standard.masked, "opaque": standard.opaque}
    bindings: dict[Any, Any] = {
        shapes.shape: getattr(shapes, thing.shape),
        **edges_of(map_edge(thing)),
        pixel.inside: _inside(thing),
        relief.displaced: relief.with_relief if thing.has_relief else relief.without_relief,
        # whole, as for a light; what is seen may fade
        relief.depth_seen: relief.as_deep,
        relief.lod_seen: _LEVELS[thing.heights],
        relief.flat_height: relief.unread,
        relief.slope_of: _slope(three, boxed),
        **height.heights_of(thing.heights),
        displace: thing.drawn_with if thing.has_relief else flat,
        projection.projection: getattr(projection, thing.relief_projection),
        surface.surface_at: (
            landscape.landscape_surface
            if thing.surface == "landscape"
            else standard.standard_surface
        ),
        surface.spot_of: surface.apart if thing.tilings else surface.together,
        surface.turned: surface.mirrored_with if thing.tilings else surface.as_it_is,
        standard.opacity_of: alpha[thing.alpha],
        landscape.high_ground: landscape.of_the_layer if thing.layer else landscape.as_below,
        standard.layered: standard.with_details if thing.layer else standard.bare,
    }
    maps = maps_of(thing)
    for name, slot in _MAPPED.items():
        kind = "plain" if maps[name] is None else "mapped"
        bindings[slot] = getattr(standard, f"{kind}_{name}")
    if boxed:
        bindings[height.surface_height] = boxes.top_at
    if boxed and maps["base_color"] is not None:
        bindings[standard.base_color_of] = standard.pixelated_base_color
    if three:
        bindings[standard.base_color_of] = standard.triplanar_base_color
    return bindings


def _slope(asked: bool, boxed: bool) -> Any:
    """How the relief lies: boxes have sides, which nothing else in a program knows of."""
    if boxed:
        return relief.of_boxes
    return relief.of_heights if asked else relief.unasked


def _inside(thing: Object) -> Any:
    """What is cut off at the object's edge: around a sphere or a cylinder there is none along u."""
    if thing.edge != "clip":
        return pixel.anywhere
    return pixel.within if thing.shape in ("plane", "box") else pixel.within_rims


def map_edge(thing: Object) -> Edge:
    """What programs read beyond a map: within a shape that is clipped it repeats, if it has to."""
    over = [] if thing.layer is None else [thing.layer.tiling]
    repeats = thing.edge == "clip" and any(
        each.repeats for each in (thing.main_tiling, *thing.tilings.values(), *over)
    )
    return "wrap" if thing.edge == "wrap" or repeats else "clamp"


def maps_of(thing: Object) -> dict[str, Any]:
    """The material's maps as programs read them, None for those that are missing."""
    material, beyond = thing.material, map_edge(thing)
    glow = pyramids.emission(material, beyond)
    over = thing.layer and thing.layer.material
    # the tops of boxes are level, whatever the heights beside them
    level = thing.has_relief and thing.drawn_with.boxes and material.normal is None
    return {
        "field": pyramids.height_field(material, beyond) if thing.has_relief else None,
        "baked": pyramids.baked(
            material, beyond, thing.drawn_with.bake, all_levels=thing.heights == "mip"
        ),
        "base_color": pyramids.base_color(material, beyond),
        "normal": None if level else pyramids.normal(material, beyond, thing.relief_scale),
        "response": pyramids.response(material, beyond),
        "emission": glow and glow[0],
        "layer_color": over and pyramids.base_color(over, beyond),
        "layer_normal": over and pyramids.normal(over, beyond, over.scale or DEFAULT_SCALE),
    }


def values_of(thing: Object, scene: Scene, size: tuple[int, int]) -> dict[str, Any]:
    """The values of an object's program, all but the place of the sample and what others cast."""
    found = {name: value for name, value in maps_of(thing).items() if value is not None}
    return {
        **found,
        "view": View(scene.shader_camera(size), Vec2(0.5, 0.5)),
        "placement": thing.placement(),
        "depth": thing.depth(),
        "smoothing": thing.smoothing,
        "settings": thing.settings if thing.has_relief else Nothing(),
        "finish": _finish(thing),
        "places": thing.map_places(),
        "shading": scene.shading,
        "shadowing": scene.shadowing,
        "fog": scene.air,
        "lights": Buffer(scene.lights, Light),
    }


def _finish(thing: Object) -> Any:
    """The finish, with an emission map's own brightness in it."""
    glow = pyramids.emission(thing.material, map_edge(thing))
    if glow is None or glow[1] == 1.0 or thing.surface != "standard":
        return thing.finish
    return replace(thing.finish, emission=Vec3(*thing.finish.emission) * glow[1])
