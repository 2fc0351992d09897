"""Each surface honours every parameter, map and choice that it accepts; none is ignored."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest

from basrelief.errors import InputError
from basrelief.material import MAPS, Material
from basrelief.scene import OWN_TILINGS, SURFACES, Layer, LookAt, Object, Tiling, directional
from basrelief.settings import settings_of
from basrelief.settings.kinds import AlphaKind, LayerOffsetKind, MappingKind, ShadingModel
from helpers.frame_cases import SURFACE_PARAMETERS
from helpers.synthetic import drawn, map_of, noise

CAMERA = LookAt((0.2, -0.9, 1.0), up=(0.0, 0.0, 1.0), field_of_view=40.0)
NAMES = tuple(SURFACES)
WITHOUT_MAP = {
    "opacity": map_of(np.ones((1, 1))),
    "layer_mask": map_of(np.ones((1, 1))),
    "height": map_of(np.full((1, 1), 0.9)),
}
"""Maps in place of those without which other code is in effect."""


def material(seed: int) -> Material:
    """A material with every map, all of them noise."""
    maps = {
        name: map_of(noise(seed + k, (24, 24), kind.channels))
        for k, (name, kind) in enumerate(MAPS.items())
    }
    maps["normal"] = map_of(noise(seed + 20, (24, 24)) * [0.5, 0.5, 0.0] + [0.2, 0.2, 0.9])
    return Material("all maps", **maps)


def acting(surface: str, **options: Any) -> Object:
    """An object on which everything of a surface acts: high and low ground, and rays that run out
    of steps."""
    return Object(
        options.pop("material", material(1)),
        surface=surface,
        technique="fixed_length",
        settings={"steps": 9, "step_length": 0.02},
        scale=0.15,
        transform=np.eye(4),
        **{"alpha": "mask", "layer": Layer(material(40), Tiling((2.0, 3.0))), **options},
    )


def picture(obj: Object, shading_model: ShadingModel = "ggx") -> np.ndarray:
    lights = (directional(-40.0, 40.0), directional(60.0, 10.0))
    frame = drawn(
        obj,
        camera=CAMERA,
        size=(48, 36),
        lights=lights,
        background=(1.0, 0.0, 1.0),
        shading_model=shading_model,
    )
    return frame.color


@functools.cache
def usual(surface: str, shading_model: ShadingModel = "ggx") -> np.ndarray:
    return picture(acting(surface), shading_model)


def difference(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max())


# --- the class: whatever is declared acts ---------------------------------------------------------


@pytest.mark.parametrize(
    ("surface", "parameter"),
    [(surface, name) for surface in NAMES for name in settings_of(SURFACES[surface])],
)
def test_each_parameter_acts(surface: str, parameter: str) -> None:
    other = {parameter: SURFACE_PARAMETERS[surface][parameter]}
    # roughness and metal act with one model, the highlight's parameters with the other
    obj = acting(surface, surface_parameters=other)
    differences = [
        difference(picture(obj, model), usual(surface, model)) for model in get_args(ShadingModel)
    ]
    assert max(differences) > 5e-3


@pytest.mark.parametrize("surface", NAMES)
@pytest.mark.parametrize("name", MAPS)
def test_each_map_acts(surface: str, name: str) -> None:
    without = replace(material(1), **{name: WITHOUT_MAP.get(name)})
    if name == "dust":
        # it acts by the hole that it opens, in which there are no normals
        holes = [picture(acting(surface, material=m, opening=0.8)) for m in (without, material(1))]
        assert difference(*holes) > 5e-3
        return
    assert difference(picture(acting(surface, material=without)), usual(surface)) > 5e-3


@pytest.mark.parametrize("surface", NAMES)
@pytest.mark.parametrize("name", ["base_color", "normal"])
def test_each_map_of_the_layer_acts(surface: str, name: str) -> None:
    # without a normal map a layer has the normals of its heights
    layer = replace(material(40), **{"height": None, name: None})
    changed = picture(acting(surface, layer=Layer(layer, Tiling((2.0, 3.0)))))
    assert difference(changed, usual(surface)) > 5e-3


CHOICES: dict[str, tuple[Any, ...]] = {
    "alpha": get_args(AlphaKind),
    "mapping": get_args(MappingKind),
    "layer": (None, Layer(material(40), Tiling((2.0, 3.0))), Layer(material(40))),
    "layer_offset": get_args(LayerOffsetKind),
    "tilings": ({}, *({name: Tiling((3.0, 2.0))} for name in OWN_TILINGS)),
}
"""Options of the section "Surface", with values that draw different pictures."""


def test_the_choices_are_all_options_of_surfaces() -> None:
    of_surfaces = {n for n, s in settings_of(Object).items() if s.group == "Surface"}
    assert {*CHOICES} == of_surfaces - {"surface", "surface_parameters"}


@pytest.mark.parametrize("surface", NAMES)
@pytest.mark.parametrize("name", CHOICES)
def test_each_choice_acts(surface: str, name: str) -> None:
    pictures = [picture(acting(surface, **{name: value})) for value in CHOICES[name]]
    for k, first in enumerate(pictures):
        for second in pictures[k + 1 :]:
            assert difference(first, second) > 5e-3


@pytest.mark.parametrize("surface", NAMES)
def test_triplanar_mapping_projects_the_layer_too(surface: str) -> None:
    plain = replace(material(1), base_color=None, opacity=None)
    planar, triplanar = (
        picture(acting(surface, material=plain, mapping=mapping))
        for mapping in ("planar", "triplanar")
    )
    assert difference(planar, triplanar) > 5e-3


def test_parameters_of_another_surface_are_refused() -> None:
    for surface, name in (("standard", "water_level"), ("landscape", "waves")):
        with pytest.raises(InputError, match=f"the {surface} surface has no setting '{name}'"):
            acting(surface, surface_parameters={name: 0.5})


# --- a landscape's ground is the standard surface's -----------------------------------------------


@pytest.mark.parametrize("alpha", get_args(AlphaKind))
@pytest.mark.parametrize("mapping", get_args(MappingKind))
def test_ground_without_a_layer_is_the_standard_surface(alpha: str, mapping: str) -> None:
    """Bit for bit, with every map and parameter."""
    numbers = SURFACE_PARAMETERS["standard"]
    standard, landscape = (
        picture(replace(acting(surface, alpha=alpha, mapping=mapping, layer=None),
                        technique="relief", settings={}, surface_parameters=parameters))
        for surface, parameters in (
            ("standard", numbers), ("landscape", {**numbers, "water_level": 0.0})
        )
    )  # fmt: skip
    assert (standard == landscape).all()
