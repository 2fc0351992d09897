"""Settings of a scene in one line, for the caption of its picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from basrelief.lang import Vec3
from basrelief.scene import Object, ResolvedObject, Scene
from basrelief.shading.brdf import Shading


def settings_of(scene: Scene) -> str:
    """Settings of the scene and its first object that differ from the defaults."""
    return " · ".join([*_of_object(scene.objects[0]), *_of_scene(scene)])


def _of_object(obj: Object) -> Iterator[str]:
    resolved = obj.resolved
    yield f"{resolved.technique.name}, {resolved.material.name} on a {resolved.shape}"
    if resolved.has_relief:
        yield f"scale {resolved.scale:.3g}"
        yield from _numbers(resolved.settings)
        yield from _of_ray(resolved)
    if obj.tiling is not None:
        yield "{:g} × {:g} tiles".format(*obj.tiling)
    if resolved.mapping != "planar" and resolved.has_relief:
        yield f"{resolved.mapping} mapping"
    if resolved.alpha != "blend":
        yield f"alpha {resolved.alpha}"
    yield from _changed(resolved.surface_parameters, type(resolved.surface_parameters)())


def _of_ray(obj: ResolvedObject) -> Iterator[str]:
    """Projection of the view ray, reference height, and filter of the heights."""
    if obj.projection != "full":
        with_bias = f" {obj.bias:g}" if obj.projection == "biased" else ""
        yield f"projection {obj.projection}{with_bias}"
    if obj.reference_height != obj.technique.reference_height:
        yield f"reference height {obj.reference_height:g}"
    if obj.heights != "sharp":
        yield f"{obj.heights} heights"
        yield from _numbers(obj.smoothing)
    if obj.filter == "hardware":
        yield "heights filtered by the graphics card"
    if obj.fade is not None:
        yield "fades from {:g} to {:g}".format(*obj.fade)


def _of_scene(scene: Scene) -> Iterator[str]:
    if scene.shading_model != "ggx":
        yield scene.shading_model
        yield from _changed(scene.shading, Shading())
    if scene.shadows != "none":
        yield f"{scene.shadows} shadows"
    if scene.casts and scene.shadows_on != "relief":
        yield f"shadows of other objects on the {scene.shadows_on}"
    if scene.occlusion_kind != "ambient":
        yield f"{scene.occlusion_kind} occlusion"
    if scene.fog_mode != "none":
        yield f"{scene.fog_mode.replace('_', ' ')} fog"


def _numbers(record: Any) -> Iterator[str]:
    for field in fields(record):
        value = getattr(record, field.name)
        # 0 switches steps by texels off
        if not (field.name == "steps_per_texel" and value == 0.0):
            yield _setting_text(field.name, value)


def _changed(record: Any, default: Any) -> Iterator[str]:
    for field in fields(record):
        value = getattr(record, field.name)
        if _setting_text("", value) != _setting_text("", getattr(default, field.name)):
            yield _setting_text(field.name, value)


def _setting_text(name: str, value: Any) -> str:
    numbers = [*value] if isinstance(value, Vec3) else [value]
    if len({float(number) for number in numbers}) == 1:
        numbers = numbers[:1]
    return f"{name.replace('_', ' ')} {'/'.join(f'{number:.3g}' for number in numbers)}"
