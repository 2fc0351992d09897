"""Objects of a scene → programs, and the values that they read: only what is needed is in them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, assert_never

from basrelief.engine import Engine
from basrelief.lang import Buffer, Vec2, Vec3
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.material import Material
from basrelief.rendering import textures
from basrelief.scene import Object, Scene
from basrelief.scene.objects import DEFAULT_SCALE
from basrelief.shading import pixel, relief, shapes, view_ray
from basrelief.shading.choices import SHAPES, Choices, bindings_of
from basrelief.shading.intersection import View
from basrelief.shading.lights import Light
from basrelief.techniques import Nothing, flat, projection

MAPPED = ("base_color", "normal", "response", "emission", "layer_color", "layer_normal")
"""The maps for which something plain stands where they are missing."""


def mapped(thing: Object) -> dict[str, bool]:
    """Which of `MAPPED` an object has; nothing is baked to know that."""
    material = thing.material
    # the tops of boxes are level, whatever the heights beside them
    level = thing.has_relief and thing.drawn_with.boxes and material.normal is None
    over = None if thing.layer is None else thing.layer.material
    return {
        "base_color": textures.has_base_color(material),
        "normal": not level and textures.has_normal(material, thing.relief_scale),
        "response": textures.has_response(material),
        "emission": material.emission is not None,
        "layer_color": over is not None and textures.has_base_color(over),
        "layer_normal": over is not None and textures.has_normal(over, _layer_scale(over)),
    }


def _layer_scale(over: Material) -> float:
    """The scale at which a layer's heights give normals."""
    return over.scale or DEFAULT_SCALE


def program_of(thing: Object, scene: Scene | None = None) -> Program:
    """The program that draws an object of a scene: only what it needs is in it."""
    choices = choices_of(thing, scene or Scene((thing,)))
    return Program(pixel.pixel, bindings_of(choices), choices.edge, choices)


def choices_of(thing: Object, scene: Scene) -> Choices:
    """What an object's program depends on."""
    technique = thing.drawn_with if thing.has_relief else flat
    return Choices(
        technique=technique,
        displaced=thing.has_relief,
        boxed=technique.boxes,
        shape=thing.shape,
        projection=thing.relief_projection,
        heights=thing.heights,
        edge=map_edge(thing),
        clipped=thing.edge == "clip",
        fades=thing.fade is not None,
        mapping=thing.mapping,
        apart=bool(thing.tilings),
        alpha=thing.alpha,
        surface=thing.surface,
        layer=thing.layer is not None,
        shadows=scene.shadows,
        shadows_on=scene.shadows_on,
        casts=scene.casts,
        shading_model=scene.shading_model,
        occlusion_kind=scene.occlusion_kind,
        fog=scene.fog,
        **mapped(thing),
    )


def reach_of(thing: Object) -> Program:
    """The program that draws an object's part of a depth map."""
    # a relief that fades does so with the distance from the camera, not from a light
    choices = replace(choices_of(thing, Scene((thing,))), fades=False)
    if thing.casts == "opaque":
        choices = replace(choices, alpha="opaque")
    bindings = bindings_of(choices)
    # heights say nothing of how far a ray goes where nothing is displaced
    bindings[relief.flat_height] = relief.unread
    return Program(pixel.reach, bindings, choices.edge, choices)


def rays_of(thing: Object) -> Program:
    """The program that gives the true view ray of each pixel, whatever the technique."""
    return Program(
        view_ray.view_ray,
        {
            shapes.shape: SHAPES[thing.shape],
            relief.depth_seen: relief.fading if thing.fade else relief.as_deep,
            projection.projection: projection.full,
        },
        map_edge(thing),
    )


def map_edge(thing: Object) -> Edge:
    """What programs read beyond a map: within a shape that is clipped it repeats, if it has to."""
    over = [] if thing.layer is None else [thing.layer.tiling]
    match thing.edge:
        case "wrap" | "clamp":
            return thing.edge
        case "clip":
            lain = (thing.main_tiling, *thing.tilings.values(), *over)
            return "wrap" if any(each.repeats for each in lain) else "clamp"
        case _:
            assert_never(thing.edge)


def maps_of(thing: Object, engine: Engine) -> dict[str, Any]:
    """The material's maps as programs read them, without those that are missing.

    What is made of heights, a technique's table and normals, the engine that draws bakes.
    """
    material, beyond = thing.material, map_edge(thing)
    has, glow = mapped(thing), textures.emission(material, beyond)
    over = thing.layer and thing.layer.material
    scale = thing.relief_scale
    found = {
        "field": textures.height_field(material, beyond) if thing.has_relief else None,
        "baked": textures.baked(
            material, beyond, thing.drawn_with.bake, engine, all_levels=thing.heights == "mip"
        ),
        "base_color": textures.base_color(material, beyond),
        "normal": textures.normal(material, beyond, scale, engine) if has["normal"] else None,
        "response": textures.response(material, beyond),
        "emission": glow and glow[0],
        "layer_color": over and textures.base_color(over, beyond),
        "layer_normal": over and textures.normal(over, beyond, _layer_scale(over), engine),
    }
    return {name: value for name, value in found.items() if value is not None}


def values_of(thing: Object, scene: Scene, size: tuple[int, int], engine: Engine) -> dict[str, Any]:
    """The values of an object's program, all but the place of the sample and what others cast."""
    return {
        **maps_of(thing, engine),
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
    glow = textures.emission(thing.material, map_edge(thing))
    if glow is None or glow[1] == 1.0 or thing.surface != "standard":
        return thing.finish
    return replace(thing.finish, emission=Vec3(*thing.finish.emission) * glow[1])
