"""Controls of a page, from the declarations of what they set."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from basrelief.lang.types import fields_of
from basrelief.scene import Object, Orbit, Scene, Tiling
from basrelief.scene.checks import FAR, NEAR
from basrelief.scene.lights import parameters_of_all_lights
from basrelief.scene.motion import Scrolling
from basrelief.settings import Setting, settings_of
from basrelief.viewer.layouts import json_value

_NUMBERS = ("number", "pair", "triple")
"""Kinds of settings that have sliders."""


def controls() -> dict[str, Any]:
    """Controls of the settings that are not in records of numbers, by name.

    `scene` are those of `Object` and `Scene`, `tiling` those of a map's tiling; `camera`, `lights`
    and `scroll` those of an orbit, of all kinds of lights, and of scrolling.
    """
    return {
        "scene": _controls({**settings_of(Object), **settings_of(Scene)}),
        "tiling": _controls(settings_of(Tiling)),
        "camera": _controls(settings_of(Orbit)),
        "lights": _controls(parameters_of_all_lights()),
        "scroll": _controls(settings_of(Scrolling)),
    }


def limits() -> dict[str, Any]:
    """Ranges of numbers outside the records of settings, as `Object` and `Scene` check them.

    `least` and `most` are the smallest and largest absolute value of a tiling.
    """
    return {
        "numbers": {
            **_ranges({**settings_of(Object), **settings_of(Scene)}),
            "divider": (0.0, 1.0),
            "scroll": _ranges(settings_of(Scrolling))["u"],
        },
        "lights": _ranges(parameters_of_all_lights()),
        "camera": _ranges(settings_of(Orbit)),
        "least": NEAR,
        "most": FAR,
    }


def numbers_of(record: type) -> list[dict[str, Any]]:
    """Settings of a record of numbers: name, meaning, range, default, and whether it is whole."""
    return [
        {
            "name": name,
            "doc": declared.doc,
            "low": declared.low,
            "high": declared.high,
            "default": json_value(declared.default),
            "whole": fields_of(record)[name] is int,
        }
        for name, declared in settings_of(record).items()
        if not declared.required
    ]


def _controls(declared: Mapping[str, Setting]) -> dict[str, dict[str, Any]]:
    return {
        name: _control(setting)
        for name, setting in declared.items()
        if setting.kind in (*_NUMBERS, "choice")
    }


def _control(setting: Setting) -> dict[str, Any]:
    """Meaning and slider of a setting; it is soft where numbers beyond the slider are allowed."""
    whole_range = {"low": setting.low, "high": setting.high}
    slider = {**whole_range, **setting.control}
    return {
        "kind": setting.kind,
        "group": setting.group,
        "doc": setting.doc.replace("`", ""),
        **slider,
        "soft": any(slider[end] != whole_range[end] for end in whole_range),
    }


def _ranges(declared: Mapping[str, Setting]) -> dict[str, tuple[float | None, float | None]]:
    return {
        name: (setting.low, setting.high)
        for name, setting in declared.items()
        if setting.kind in _NUMBERS and (setting.low, setting.high) != (None, None)
    }
