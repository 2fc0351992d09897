"""A variant has the choices of the object and the scene that it is made for."""

from __future__ import annotations

from typing import Any

import pytest

from basrelief.lang import static_fields
from basrelief.material import sample
from basrelief.rendering.programs import variant_of
from basrelief.scene import Object, Scene
from basrelief.shading.variant import Variant

MENUS = {name: menu for name, (_, _, menu) in static_fields(Variant).items() if menu}
"""The values of each choice."""
CASES = [(name, value) for name, menu in MENUS.items() for value in menu]


@pytest.mark.parametrize(("name", "value"), CASES)
def test_every_value_of_every_menu_comes_from_a_scene(name: str, value: str) -> None:
    options: dict[str, Any] = {name: value}
    of_object = {k: options.pop(k) for k in list(options) if k in Object.__dataclass_fields__}
    thing = Object(sample("tiles", 16), **of_object)
    assert getattr(variant_of(thing, Scene((thing,), **options)), name) == value


@pytest.mark.parametrize("name", MENUS)
def test_what_is_in_no_menu_is_refused(name: str) -> None:
    thing = Object(sample("tiles", 16))
    of_object = name in Object.__dataclass_fields__
    with pytest.raises(Exception, match=f"{name}.*sideways"):
        Object(sample("tiles", 16), **{name: "sideways"}) if of_object else Scene(
            (thing,), **{name: "sideways"}
        )
