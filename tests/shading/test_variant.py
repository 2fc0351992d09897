"""Variants have the choices of their object and scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest

from basrelief.lang import static_fields
from basrelief.lang.resources import members_of
from basrelief.material import sample
from basrelief.rendering.programs import program_of, variant_of
from basrelief.scene import Layer, Object, Scene
from basrelief.shading.maps import AvailableMaps, SurfaceMaps
from basrelief.shading.variant import Variant
from basrelief.viewer.printed import program_library

MENUS = {name: menu for name, (_, _, menu) in static_fields(Variant).items() if menu}
"""The values of each choice."""
CASES = [(name, value) for name, menu in MENUS.items() for value in menu]


@pytest.mark.parametrize(("name", "value"), CASES)
def test_every_value_of_every_menu_comes_from_a_scene(name: str, value: str) -> None:
    # with shadows, as some choices are about them
    options: dict[str, Any] = {"shadows": "hard", name: value}
    of_object = {k: options.pop(k) for k in list(options) if k in Object.__dataclass_fields__}
    layer = Layer(sample("grid", 16))
    obj = Object(sample("tiles", 16), layer=layer, **of_object)
    other = Object(sample("tiles", 16), "sphere")
    assert getattr(variant_of(obj.resolved, Scene((obj, other), **options)), name) == value


def test_an_option_without_effect_makes_no_program_of_its_own() -> None:
    def key(scene: dict[str, Any], **options: Any) -> str:
        obj = Object(sample("tiles", 16), **options)
        return program_of(obj.resolved, Scene((obj,), **scene)).key

    flat = key({}, technique="flat")
    assert key({"shadows": "soft"}, technique="flat", projection="limited", fade=(1, 2)) == flat
    assert key({"shadows_on": "polygon"}) == key({})
    assert key({"shadows": "soft"}) != key({"shadows": "hard"}) != key({})


def compared_values(condition: Any) -> Iterator[tuple[str, Any]]:
    """The pairs of field and value that a condition compares."""
    word, *rest = condition
    if word in ("and", "or", "not"):
        for each in rest:
            yield from compared_values(each)
    else:
        yield from ((word, value) for value in rest[0])


@pytest.mark.parametrize("name", MENUS)
def test_shaders_compare_with_every_value_but_one(name: str) -> None:
    """The last value is the else branch; a second unknown value would be drawn as it, unnoticed."""
    known = {
        pair for each in program_library().library.conditions for pair in compared_values(each)
    }
    left = [value for value in MENUS[name] if (name, value) not in known]
    # `wrap` and `clamp` are conditions on a map's edge
    assert left == (["wrap", "clamp"] if name == "edge" else left[:1])


@pytest.mark.parametrize("name", MENUS)
def test_a_value_in_no_menu_is_refused(name: str) -> None:
    obj = Object(sample("tiles", 16))
    of_object = name in Object.__dataclass_fields__
    with pytest.raises(Exception, match=f"{name}.*sideways"):
        Object(sample("tiles", 16), **{name: "sideways"}) if of_object else Scene(
            (obj,), **{name: "sideways"}
        )


def test_every_map_of_a_surface_has_a_condition() -> None:
    conditions = [field.name for field in fields(AvailableMaps)]
    assert conditions == [f"{name}_map" for name in members_of(SurfaceMaps)]
