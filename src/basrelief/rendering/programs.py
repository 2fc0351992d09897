"""Programs of objects in a scene, specialised to what they need, and the values they read."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, assert_never

from basrelief.engine import Engine
from basrelief.images import srgb_thresholds
from basrelief.lang import Buffer, HeightField, Shader, Texture, Vec2, Vec3, Vec4
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge, Filter, Sampling, members_of
from basrelief.lang.slots import Bindings
from basrelief.material import Material
from basrelief.rendering import textures
from basrelief.rendering.textures import TextureSource
from basrelief.scene import ResolvedObject, Scene
from basrelief.scene.resolve import default_scale
from basrelief.shading.intersection import CameraSample
from basrelief.shading.lights import Light
from basrelief.shading.maps import AvailableMaps, SurfaceMaps
from basrelief.shading.picture import Backdrop, SamplePosition, Threshold, layer, picture
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.landscape import landscape_surface
from basrelief.shading.surfaces.standard import standard_surface
from basrelief.shading.surfaces.surface import surface_at
from basrelief.shading.variant import Variant
from basrelief.shading.view_ray import view_ray
from basrelief.techniques import Nothing, Technique, displace, flat
from basrelief.timings import step

SURFACES: Mapping[str, Shader[..., Any]] = {
    "standard": standard_surface,
    "landscape": landscape_surface,
}

_DEFAULT_SCENE = Scene(())
"""The scene of an object that is drawn by itself."""


def surface_maps(obj: ResolvedObject) -> Iterator[tuple[str, TextureSource, Material, float]]:
    """The possible surface maps of an object: name, source, material, and scale of the relief."""
    for name, source in textures.MATERIAL_TEXTURES.items():
        yield name, source, obj.material, obj.scale
    if obj.layer is not None:
        layer = obj.layer.material
        for name, source in textures.LAYER_TEXTURES.items():
            yield name, source, layer, default_scale(layer)


def available_maps(obj: ResolvedObject) -> dict[str, bool]:
    """Whether an object has each surface map; found without baking."""
    has = dict.fromkeys(members_of(SurfaceMaps), False)
    has |= {
        name: source.has(material_of_map, scale)
        for name, source, material_of_map, scale in surface_maps(obj)
    }
    # the tops of columns are flat, whatever the heights around them
    if effective_technique(obj).columns and obj.material.normal is None:
        has["normal"] = False
    return has


def program_of(
    obj: ResolvedObject, scene: Scene | None = None, entry: Shader[..., Any] = pixel
) -> Program:
    """The program that draws an object of a scene, specialised to its variant."""
    return _program(obj, variant_of(obj, scene or _DEFAULT_SCENE), entry)


def frame_program_of(obj: ResolvedObject, scene: Scene) -> Program:
    """The program that draws an object into the frame of its scene: all samples at once, or one
    over other objects."""
    return program_of(obj, scene, picture if len(scene.objects) == 1 else layer)


def _program(obj: ResolvedObject, variant: Variant, entry: Shader[..., Any] = pixel) -> Program:
    bindings: Bindings = {displace: effective_technique(obj), surface_at: SURFACES[obj.surface]}
    return Program(
        entry, bindings, map_edge(obj), height_filter(obj), variant, height_sampling(obj)
    )


def variant_of(obj: ResolvedObject, scene: Scene) -> Variant:
    """The shader variant of an object's program."""
    # fields that the object or the scene has under the same name
    shared = {
        field.name: getattr(owner, field.name)
        for owner in (obj, scene)
        for field in fields(Variant)
        if hasattr(owner, field.name)
    }
    derived: dict[str, Any] = {
        "displaced": obj.has_relief,
        "columns": effective_technique(obj).columns,
        "exact_shadows": effective_technique(obj).exact and scene.shadows == "hard",
        "projection": obj.projection,
        "fades": obj.fade is not None,
        "own_tilings": bool(obj.tilings),
        "layer": obj.layer is not None,
        "shadow_maps": scene.casts,
        **{f"{name}_map": present for name, present in available_maps(obj).items()},
    }
    # irrelevant fields get their defaults, so that equal programs have equal keys
    if not obj.has_relief:
        derived |= {"projection": "full", "fades": False, "shadows": "none"}
    # nor does a layer on the polygon have an offset
    if not obj.has_relief or obj.layer is None:
        derived |= {"layer_offset": "scaled"}
    if not scene.casts:
        derived |= {"shadows_on": "relief"}
    return Variant(**shared | derived)


def depth_program_of(obj: ResolvedObject) -> Program:
    """The program that draws an object into a shadow map."""
    opaque = obj.casts == "opaque"
    variant = variant_of(obj, _DEFAULT_SCENE)
    maps: dict[str, Any] = {field.name: False for field in fields(AvailableMaps)}
    # of the surface only the opacity matters
    maps["base_color_map"] = variant.base_color_map and not opaque
    variant = replace(
        variant,
        depth_only=True,
        # a relief fades with the distance from the camera, not from a light
        fades=False,
        alpha="opaque" if opaque else variant.alpha,
        layer=False,
        **maps,
    )
    return _program(obj, variant)


def view_ray_program_of(obj: ResolvedObject) -> Program:
    """The program that computes the view ray of each pixel, with any technique."""
    variant = Variant(shape=obj.shape, fades=obj.fade is not None)
    return Program(view_ray, edge=map_edge(obj), variant=variant)


def effective_technique(obj: ResolvedObject) -> Technique[..., Any]:
    """The technique in effect: `flat` for an object without relief."""
    return obj.technique if obj.has_relief else flat


def height_filter(obj: ResolvedObject) -> Filter:
    """The filter of an object's height field."""
    return "columns" if effective_technique(obj).columns else obj.heights


def height_sampling(obj: ResolvedObject) -> Sampling:
    """Whether an object's heights are interpolated in shaders or by the filter of the GPU.

    A technique that solves whole cells reads texels, and so do its self-shadows, which are those of
    the same surface.
    """
    reads_texels = not obj.has_relief or obj.technique.solves_cells
    return "texel" if reads_texels else obj.filter


def map_edge(obj: ResolvedObject) -> Edge:
    """The edge policy of an object's maps; with `clip` they repeat if they have several tiles."""
    layer = [] if obj.layer is None else [obj.layer.tiling]
    match obj.edge:
        case "wrap" | "clamp":
            return obj.edge
        case "clip":
            tilings = (obj.tiling, *obj.tilings.values(), *layer)
            return "wrap" if any(tiling.repeats for tiling in tilings) else "clamp"
        case _:
            assert_never(obj.edge)


@step("load")
def resources_of(obj: ResolvedObject, engine: Engine) -> dict[str, Any]:
    """Height field, baked table and surface textures of an object, without missing ones.

    The given engine bakes tables and normals from the heights.
    """
    material, edge, has = obj.material, map_edge(obj), available_maps(obj)
    makers: dict[str, Callable[[], Texture | HeightField | None]] = {}
    from_heights: dict[str, Texture | HeightField | None] = {}
    for name, source, material_of_map, scale in surface_maps(obj):
        make = functools.partial(source.texture, material_of_map, edge, scale, engine)
        if has[name] and source.of_heights and material_of_map.normal is None:
            from_heights[f"maps_{name}"] = make()
        elif has[name]:
            makers[f"maps_{name}"] = make
    if obj.has_relief:
        makers["field"] = lambda: textures.height_field(material, edge, height_filter(obj))
    resources = {**textures.make_textures(material, makers), **from_heights}
    baked = textures.bake_texture(
        material, edge, obj.technique.bake, engine, all_levels=obj.heights == "mip"
    )
    return resources if baked is None else {**resources, "baked": baked}


def object_values(obj: ResolvedObject, engine: Engine) -> dict[str, Any]:
    """The values of an object's programs that do not depend on the scene."""
    return {
        **resources_of(obj, engine),
        "placement": obj.placement(),
        "relief": obj.relief_parameters(),
        "smoothing": obj.smoothing,
        "settings": obj.settings if obj.has_relief else Nothing(),
        "surface_parameters": _surface_parameters(obj),
        "tilings": obj.map_tilings(),
    }


def values_of(
    obj: ResolvedObject, scene: Scene, size: tuple[int, int], engine: Engine
) -> dict[str, Any]:
    """The values of an object's program, except sample position and shadow maps."""
    return {
        **object_values(obj, engine),
        "sample": CameraSample(scene.shader_camera(size), Vec2(0.5, 0.5)),
        "shading": scene.shading,
        "shadowing": scene.shadowing,
        "fog": scene.fog,
        "lights": Buffer(scene.lights, Light),
    }


def frame_values(scene: Scene, positions: Sequence[tuple[float, float]]) -> dict[str, Any]:
    """The values that the programs of a frame share: positions of the samples, background, and
    thresholds of codes."""
    return {
        "backdrop": Backdrop(backdrop_of(scene)),
        "positions": _position_buffer(tuple(positions)),
        "thresholds": _threshold_buffer(),
    }


def backdrop_of(scene: Scene) -> Vec4:
    """The background's colour and coverage."""
    return Vec4(0.0) if scene.background is None else Vec4(*scene.background, 1.0)


@functools.lru_cache(maxsize=8)
def _position_buffer(positions: tuple[tuple[float, float], ...]) -> Buffer[SamplePosition]:
    return Buffer([SamplePosition(*position) for position in positions], SamplePosition)


@functools.cache
def _threshold_buffer() -> Buffer[Threshold]:
    return Buffer([Threshold(float(light)) for light in srgb_thresholds()], Threshold)


def _surface_parameters(obj: ResolvedObject) -> Any:
    """The surface parameters, with emission multiplied by the scale of the emission map."""
    glow = textures.emission_scale(obj.material)
    if glow == 1.0:
        return obj.surface_parameters
    return replace(obj.surface_parameters, emission=Vec3(*obj.surface_parameters.emission) * glow)
