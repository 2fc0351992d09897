"""The settings of a scene in one line, for the caption of its picture."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from basrelief.lang import Vec3
from basrelief.scene import Object, Scene
from basrelief.shading.brdf import Shading


def settings_of(scene: Scene) -> str:
    """What the first object and the scene say that is not taken for granted."""
    return " · ".join([*_of_object(scene.objects[0]), *_of_scene(scene)])


def _of_object(thing: Object) -> Iterator[str]:
    yield f"{thing.drawn_with.name}, {thing.material.name} on a {thing.shape}"
    if thing.has_relief:
        yield f"scale {thing.relief_scale:.3g}"
        yield from _numbers(thing.settings)
        yield from _of_ray(thing)
    if thing.tiling is not None:
        yield "{:g} × {:g} tiles".format(*thing.tiling)
    if thing.mapping != "planar" and thing.has_relief:
        yield f"{thing.mapping} colour"
    if thing.alpha != "blend":
        yield f"alpha {thing.alpha}"
    yield from _changed(thing.finish, type(thing.finish)())


def _of_ray(thing: Object) -> Iterator[str]:
    """How the view ray is projected, where it enters, and what it reads."""
    if thing.relief_projection != "full":
        with_bias = f" {thing.bias:g}" if thing.relief_projection == "biased" else ""
        yield f"projection {thing.relief_projection}{with_bias}"
    if thing.relief_level != thing.drawn_with.level:
        yield f"level {thing.relief_level:g}"
    if thing.heights != "sharp":
        yield f"{thing.heights} heights"
        yield from _numbers(thing.smoothing)
    if thing.fade is not None:
        yield "fades from {:g} to {:g}".format(*thing.fade)


def _of_scene(scene: Scene) -> Iterator[str]:
    if scene.shading_model != "ggx":
        yield scene.shading_model
        yield from _changed(scene.shading, Shading())
    if scene.shadows != "none":
        yield f"{scene.shadows} shadows"
    if scene.casts and scene.shadows_on != "relief":
        yield f"shadows of others on the {scene.shadows_on}"
    if scene.occlusion_kind != "ambient":
        yield f"{scene.occlusion_kind} occlusion"
    if scene.fog != "none":
        yield f"{scene.fog.replace('_', ' ')} fog"


def _numbers(record: Any) -> Iterator[str]:
    for each in fields(record):
        value = getattr(record, each.name)
        # what is switched off is not worth a word
        if not (each.name == "steps_per_texel" and value == 0.0):
            yield _told(each.name, value)


def _changed(record: Any, plain: Any) -> Iterator[str]:
    for each in fields(record):
        value = getattr(record, each.name)
        if _told("", value) != _told("", getattr(plain, each.name)):
            yield _told(each.name, value)


def _told(name: str, value: Any) -> str:
    numbers = [*value] if isinstance(value, Vec3) else [value]
    if len({float(each) for each in numbers}) == 1:
        numbers = numbers[:1]
    return f"{name.replace('_', ' ')} {'/'.join(f'{each:.3g}' for each in numbers)}"
