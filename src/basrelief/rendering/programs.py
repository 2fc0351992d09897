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
from basrelief.shading.intersection import CameraSample
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


def surface_maps(obj: Object) -> Iterator[tuple[str, Source, Material, float]]:
    """The surface maps that an object may have: name, source, material and the relief's scale."""
    for name, source in textures.OF_MATERIAL.items():
        yield name, source, obj.material, obj.relief_scale
    if obj.layer is not None:
        over = obj.layer.material
        for name, source in textures.OF_LAYER.items():
            yield name, source, over, over.scale or DEFAULT_SCALE


def mapped(obj: Object) -> dict[str, bool]:
    """Which surface maps an object has; nothing is baked to know that."""
    has = dict.fromkeys(members_of(SurfaceMaps), False)
    has |= {name: source.has(made_of, scale) for name, source, made_of, scale in surface_maps(obj)}
    # the tops of boxes are level, whatever the heights beside them
    if displaced_by(obj).columns and obj.material.normal is None:
        has["normal"] = False
    return has


def program_of(obj: Object, scene: Scene | None = None) -> Program:
    """The program that draws an object of a scene: only what it needs is in it."""
    return _program(obj, variant_of(obj, scene or Scene((obj,))))


def _program(obj: Object, variant: Variant) -> Program:
    bound: Bindings = {displace: displaced_by(obj), surface_at: SURFACES[obj.surface]}
    return Program(pixel, bound, map_edge(obj), height_filter(obj), variant)


def variant_of(obj: Object, scene: Scene) -> Variant:
    """What an object's program depends on, beside its technique and surface."""
    # what the object or the scene has by the same name
    shared = {
        each.name: getattr(owner, each.name)
        for owner in (obj, scene)
        for each in fields(Variant)
        if hasattr(owner, each.name)
    }
    derived: dict[str, Any] = {
        "displaced": obj.has_relief,
        "columns": displaced_by(obj).columns,
        "projection": obj.relief_projection,
        "fades": obj.fade is not None,
        "own_tilings": bool(obj.tilings),
        "layer": obj.layer is not None,
        "shadow_maps": scene.casts,
        **{f"{name}_map": there for name, there in mapped(obj).items()},
    }
    # what is not asked is as nobody chose it, so that equal programs have equal keys
    if not obj.has_relief:
        derived |= {"projection": "full", "fades": False, "shadows": "none"}
    if not scene.casts:
        derived |= {"shadows_on": "relief"}
    return Variant(**shared | derived)


def depth_program_of(obj: Object) -> Program:
    """The program that draws an object's part of a depth map."""
    opaque = obj.casts == "opaque"
    variant = variant_of(obj, Scene((obj,)))
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
    return _program(obj, variant)


def rays_of(obj: Object) -> Program:
    """The program that gives the true view ray of each pixel, whatever the technique."""
    variant = Variant(shape=obj.shape, fades=obj.fade is not None)
    return Program(view_ray, edge=map_edge(obj), variant=variant)


def displaced_by(obj: Object) -> Technique[..., Any]:
    """The technique that draws an object: `flat` where it has no relief."""
    return obj.drawn_with if obj.has_relief else flat


def height_filter(obj: Object) -> Filter:
    """How programs read an object's heights."""
    return "columns" if displaced_by(obj).columns else obj.heights


def map_edge(obj: Object) -> Edge:
    """What programs read beyond a map: within a shape that is clipped it repeats, if it has to."""
    over = [] if obj.layer is None else [obj.layer.tiling]
    match obj.edge:
        case "wrap" | "clamp":
            return obj.edge
        case "clip":
            lain = (obj.main_tiling, *obj.tilings.values(), *over)
            return "wrap" if any(each.repeats for each in lain) else "clamp"
        case _:
            assert_never(obj.edge)


def maps_of(obj: Object, engine: Engine) -> dict[str, Any]:
    """The material's maps as programs read them, without those that are missing.

    What is made of heights, a technique's table and normals, the engine that draws bakes.
    """
    material, beyond, has = obj.material, map_edge(obj), mapped(obj)
    found: dict[str, Any] = {
        "field": textures.height_field(material, beyond, height_filter(obj))
        if obj.has_relief
        else None,
        "baked": textures.baked(
            material, beyond, obj.drawn_with.bake, engine, all_levels=obj.heights == "mip"
        ),
    }
    for name, source, made_of, scale in surface_maps(obj):
        if has[name]:
            found[f"maps_{name}"] = source.texture(made_of, beyond, scale, engine)
    return {name: value for name, value in found.items() if value is not None}


def own_values(obj: Object, engine: Engine) -> dict[str, Any]:
    """The values of an object's programs that are its own: maps, place, relief and surface."""
    return {
        **maps_of(obj, engine),
        "placement": obj.placement(),
        "relief": obj.relief_parameters(),
        "smoothing": obj.smoothing,
        "settings": obj.settings if obj.has_relief else Nothing(),
        "surface_parameters": _surface_parameters(obj),
        "tilings": obj.map_tilings(),
    }


def values_of(obj: Object, scene: Scene, size: tuple[int, int], engine: Engine) -> dict[str, Any]:
    """The values of an object's program, all but the place of the sample and what others cast."""
    return {
        **own_values(obj, engine),
        "sample": CameraSample(scene.shader_camera(size), Vec2(0.5, 0.5)),
        "shading": scene.shading,
        "shadowing": scene.shadowing,
        "fog": scene.fog,
        "lights": Buffer(scene.lights, Light),
    }


def _surface_parameters(obj: Object) -> Any:
    """The finish, with an emission map's own brightness in it."""
    glow = textures.glow(obj.material)
    if glow == 1.0 or obj.surface != "standard":
        return obj.surface_parameters
    return replace(obj.surface_parameters, emission=Vec3(*obj.surface_parameters.emission) * glow)
