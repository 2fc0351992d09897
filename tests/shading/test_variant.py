"""A variant has the choices of the object and the scene that it is made for."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from basrelief.lang import static_fields
from basrelief.material import sample
from basrelief.rendering.programs import program_of, variant_of
from basrelief.scene import Object, Scene
from basrelief.shading.variant import Variant
from basrelief.viewer.printed import program_library

MENUS = {name: menu for name, (_, _, menu) in static_fields(Variant).items() if menu}
"""The values of each choice."""
CASES = [(name, value) for name, menu in MENUS.items() for value in menu]


@pytest.mark.parametrize(("name", "value"), CASES)
def test_every_value_of_every_menu_comes_from_a_scene(name: str, value: str) -> None:
    # with shadows, which some are about
    options: dict[str, Any] = {"shadows": "hard", name: value}
    of_object = {k: options.pop(k) for k in list(options) if k in Object.__dataclass_fields__}
    obj, other = Object(sample("tiles", 16), **of_object), Object(sample("tiles", 16), "sphere")
    assert getattr(variant_of(obj.resolved, Scene((obj, other), **options)), name) == value


def test_what_is_not_asked_makes_no_program_of_its_own() -> None:
    def key(scene: dict[str, Any], **options: Any) -> str:
        obj = Object(sample("tiles", 16), **options)
        return program_of(obj.resolved, Scene((obj,), **scene)).key

    flat = key({}, technique="flat")
    assert key({"shadows": "soft"}, technique="flat", projection="limited", fade=(1, 2)) == flat
    assert key({"shadows_on": "polygon"}) == key({})
    assert key({"shadows": "soft"}) != key({"shadows": "hard"}) != key({})


def asked(condition: Any) -> Iterator[tuple[str, Any]]:
    """The fields that a condition is on, with each value that it names."""
    word, *rest = condition
    if word in ("and", "or", "not"):
        for each in rest:
            yield from asked(each)
    else:
        yield from ((word, value) for value in rest[0])


@pytest.mark.parametrize("name", MENUS)
def test_shaders_know_every_value_but_one(name: str) -> None:
    """That one is what is left; a value that no shader knows would be drawn as that, unnoticed."""
    known = {pair for each in program_library().library.conditions for pair in asked(each)}
    left = [value for value in MENUS[name] if (name, value) not in known]
    # that maps wrap or clamp is their own edge
    assert left == (["wrap", "clamp"] if name == "edge" else left[:1])


@pytest.mark.parametrize("name", MENUS)
def test_what_is_in_no_menu_is_refused(name: str) -> None:
    obj = Object(sample("tiles", 16))
    of_object = name in Object.__dataclass_fields__
    with pytest.raises(Exception, match=f"{name}.*sideways"):
        Object(sample("tiles", 16), **{name: "sideways"}) if of_object else Scene(
            (obj,), **{name: "sideways"}
        )
