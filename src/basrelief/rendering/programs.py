"""Objects of a scene → programs, and the values that they read: only what is needed is in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from typing import Any, assert_never

from basrelief.engine import Engine
from basrelief.lang import Buffer, Shader, Vec2, Vec3
from basrelief.lang.frontend import Bindings
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge, Filter, members_of
from basrelief.material import Material
from basrelief.rendering import textures
from basrelief.rendering.textures import Source
from basrelief.scene import Object, Scene
from basrelief.scene.objects import DEFAULT_SCALE
from basrelief.shading.intersection import View
from basrelief.shading.lights import Light
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.landscape import landscape_surface
from basrelief.shading.surfaces.standard import standard_surface
from basrelief.shading.surfaces.surface import SurfaceMaps, surface_at
from basrelief.shading.variant import Variant
from basrelief.shading.view_ray import view_ray
from basrelief.techniques import Nothing, Technique, displace, flat

SURFACES: Mapping[str, Shader[..., Any]] = {
    "standard": standard_surface,
    "landscape": landscape_surface,
}


def surface_maps(thing: Object) -> Iterator[tuple[str, Source, Material, float]]:
    """The surface maps that an object may have: name, source, material and the relief's scale."""
    for name, source in textures.OF_MATERIAL.items():
        yield name, source, thing.material, thing.relief_scale
    if thing.layer is not None:
        over = thing.layer.material
        for name, source in textures.OF_LAYER.items():
            yield name, source, over, over.scale or DEFAULT_SCALE


def mapped(thing: Object) -> dict[str, bool]:
    """Which surface maps an object has; nothing is baked to know that."""
    has = dict.fromkeys(members_of(SurfaceMaps), False)
    has |= {
        name: source.has(made_of, scale) for name, source, made_of, scale in surface_maps(thing)
    }
    # the tops of boxes are level, whatever the heights beside them
    if displaced_by(thing).boxes and thing.material.normal is None:
        has["normal"] = False
    return has


def program_of(thing: Object, scene: Scene | None = None) -> Program:
    """The program that draws an object of a scene: only what it needs is in it."""
    return _program(thing, variant_of(thing, scene or Scene((thing,))))


def _program(thing: Object, variant: Variant) -> Program:
    bound: Bindings = {displace: displaced_by(thing), surface_at: SURFACES[thing.surface]}
    return Program(pixel, bound, map_edge(thing), height_filter(thing), variant)


def variant_of(thing: Object, scene: Scene) -> Variant:
    """What an object's program depends on, beside its technique and surface."""
    # what the object or the scene has by the same name
    shared = {
        each.name: getattr(owner, each.name)
        for owner in (thing, scene)
        for each in fields(Variant)
        if hasattr(owner, each.name)
    }
    derived: dict[str, Any] = {
        "displaced": thing.has_relief,
        "boxed": displaced_by(thing).boxes,
        "projection": thing.relief_projection,
        "fades": thing.fade is not None,
        "own_tilings": bool(thing.tilings),
        "layer": thing.layer is not None,
        "shadow_maps": scene.casts,
        **{f"{name}_map": there for name, there in mapped(thing).items()},
    }
    # what is not asked is as nobody chose it, so that equal programs have equal keys
    if not thing.has_relief:
        derived |= {"projection": "full", "fades": False, "shadows": "none"}
    if not scene.casts:
        derived |= {"shadows_on": "relief"}
    return Variant(**shared | derived)


def depth_program_of(thing: Object) -> Program:
    """The program that draws an object's part of a depth map."""
    opaque = thing.casts == "opaque"
    variant = variant_of(thing, Scene((thing,)))
    variant = replace(
        variant,
        depth_only=True,
        # a relief fades with the distance from the camera, not from a light
        fades=False,
        # of the surface only the opacity matters
        alpha="opaque" if opaque else variant.alpha,
        base_color_map=variant.base_color_map and not opaque,
        normal_map=False,
        response_map=False,
        emission_map=False,
        layer=False,
    )
    return _program(thing, variant)


def rays_of(thing: Object) -> Program:
    """The program that gives the true view ray of each pixel, whatever the technique."""
    variant = Variant(shape=thing.shape, fades=thing.fade is not None)
    return Program(view_ray, edge=map_edge(thing), variant=variant)


def displaced_by(thing: Object) -> Technique[..., Any]:
    """The technique that draws an object: `flat` where it has no relief."""
    return thing.drawn_with if thing.has_relief else flat


def height_filter(thing: Object) -> Filter:
    """How programs read an object's heights."""
    return "boxes" if displaced_by(thing).boxes else thing.heights


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
    material, beyond, has = thing.material, map_edge(thing), mapped(thing)
    found: dict[str, Any] = {
        "field": textures.height_field(material, beyond, height_filter(thing))
        if thing.has_relief
        else None,
        "baked": textures.baked(
            material, beyond, thing.drawn_with.bake, engine, all_levels=thing.heights == "mip"
        ),
    }
    for name, source, made_of, scale in surface_maps(thing):
        if has[name]:
            found[f"maps_{name}"] = source.texture(made_of, beyond, scale, engine)
    return {name: value for name, value in found.items() if value is not None}


def own_values(thing: Object, engine: Engine) -> dict[str, Any]:
    """The values of an object's programs that are its own: maps, place, relief and surface."""
    return {
        **maps_of(thing, engine),
        "placement": thing.placement(),
        "depth": thing.depth(),
        "smoothing": thing.smoothing,
        "settings": thing.settings if thing.has_relief else Nothing(),
        "finish": _finish(thing),
        "places": thing.map_places(),
    }


def values_of(thing: Object, scene: Scene, size: tuple[int, int], engine: Engine) -> dict[str, Any]:
    """The values of an object's program, all but the place of the sample and what others cast."""
    return {
        **own_values(thing, engine),
        "view": View(scene.shader_camera(size), Vec2(0.5, 0.5)),
        "shading": scene.shading,
        "shadowing": scene.shadowing,
        "fog": scene.air,
        "lights": Buffer(scene.lights, Light),
    }


def _finish(thing: Object) -> Any:
    """The finish, with an emission map's own brightness in it."""
    glow = textures.glow(thing.material)
    if glow == 1.0 or thing.surface != "standard":
        return thing.finish
    return replace(thing.finish, emission=Vec3(*thing.finish.emission) * glow)
