"""Landscapes: marches of fixed step length, ground blended by height, water, sky, scrolling."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from basrelief.lang import HeightField, Vec2
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import Layer, LookAt, Object, Orbit, Scene, Tiling, directional
from basrelief.shading.brdf import Shading
from basrelief.techniques import Hit, fixed_length, march
from basrelief.techniques.march import FixedLength
from basrelief.techniques.ray import Ray, at, height_at
from helpers.agreement import assert_engines_agree
from helpers.synthetic import (
    TRIPOD,
    bilinear,
    drawn,
    map_of,
    matte,
    noise,
    normal_under_tripod,
    uniform_material,
    unit,
)

EMPTY = HeightField([np.zeros((1, 1))])

# --- L1, L2: steps of one length ------------------------------------------------------------------


def view_ray(polar: float, around: float, scale: float) -> Ray:
    """The ray of a view direction: its travel is −scale · V.xy ÷ V.z."""
    view = np.array([math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around),
                     math.cos(polar)])  # fmt: skip
    travel = -scale * view[:2] / view[2] * (1.0, -1.0)
    return Ray(
        Vec2(0.3, 0.6), Vec2(*travel), height=1.0, drop=1.0, cosine=np.float32(view[2]),
        scale=np.float32(scale),
    )  # fmt: skip


def traced(form, ray: Ray, settings: FixedLength) -> tuple[Hit, np.ndarray]:
    """The hit on a closed-form surface, and the positions read, (n, 3), in tile widths."""
    places: list[tuple[float, ...]] = []

    def read(field: HeightField, ray: Ray, t: float) -> np.float32:
        uv = at(ray, t)
        height = float(height_at(ray, t))
        places.append((float(uv.x), float(uv.y), height * float(ray.scale)))
        return np.float32(form(float(uv.x), float(uv.y)))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(march, "height_under", read)
        hit = fixed_length(EMPTY, ray, settings)
    assert hit.reads == len(places)
    return hit, np.array(places)


RAYS = st.tuples(st.floats(0.0, 1.4), st.floats(-3.1, 3.1), st.sampled_from([0.1, 1.0, 5.0]))


@given(RAYS, st.sampled_from([0.01, 0.05]), st.integers(1, 60))
def test_steps_are_of_one_length_along_the_ray(ray, step: float, steps: int) -> None:
    """L1: positions one step apart along the ray, from the top; at most `steps`."""
    ray = view_ray(*ray)
    hit, places = traced(lambda u, v: -100.0, ray, FixedLength(steps, step))
    assert len(places) == hit.reads
    # the first position lies at the top, and the first below the base ends the march
    most = math.floor(float(ray.scale) / float(ray.cosine) / step)
    if steps <= most + 1:
        assert hit.reads == steps
    else:
        assert -step * float(ray.cosine) * 1.001 <= places[-1, 2] <= 1e-5 * float(ray.scale)
    np.testing.assert_allclose(places[0], [0.3, 0.6, ray.scale], atol=1e-6)
    moves = np.diff(places, axis=0)
    lengths = np.linalg.norm(moves, axis=1)
    # float32 rounds heights and coordinates to a few units in the last place
    np.testing.assert_allclose(lengths, step, atol=4e-6 * max(1.0, float(ray.scale)))
    # if the steps end above the surface there is no hit, and the last position remains
    assert not hit.found
    np.testing.assert_allclose([*hit.uv], places[-1, :2], atol=1e-6)
    assert float(hit.height) * float(ray.scale) == pytest.approx(places[-1, 2], abs=1e-5)


def test_the_default_is_300_steps_of_a_hundredth() -> None:
    """L1: the article's numbers."""
    assert (FixedLength().steps, FixedLength().step_length) == (300, pytest.approx(0.01))


@given(RAYS, st.floats(-0.4, 0.4), st.floats(0.2, 0.8))
def test_the_hit_on_a_ramp_is_exact(ray, slope: float, middle: float) -> None:
    """L2: the mean of the last two positions, weighted by their distances from the surface."""
    ray = view_ray(*ray)
    travel = float(ray.travel.x)

    def form(u: float, v: float) -> float:
        return middle + slope * (u - 0.3)

    # the ray has height h at u = 0.3 + travel · (1 − h)
    wanted = (middle + slope * travel) / (1.0 + slope * travel)
    assume(1.0 + slope * travel > 0.2)
    assume(0.05 < wanted < 0.95)
    hit, _ = traced(form, ray, FixedLength(4000, 0.01))
    assume(hit.found)  # not for rays so flat that the steps end above the ramp
    assert float(hit.height) == pytest.approx(wanted, abs=2e-4)


# --- L3, L4, L6: the ground -----------------------------------------------------------------------

FRONT = LookAt((0.0, 0.0, 3.0), orthographic_height=0.5)
UNLIT = {"lights": (), "shading": Shading(ambient=(1.0, 1.0, 1.0))}
GRASS, STONE = np.array([0.2, 0.6, 0.1]), np.array([0.5, 0.45, 0.4])


def land(height: float, water_level: float = 0.0, **options) -> Object:
    surface_parameters = {
        "water_level": water_level,
        "water_color": (0.1, 0.3, 0.8),
        "sky_color": (1, 0.5, 0),
    }
    options = {
        "technique": "fixed_length",
        "settings": {"steps": 300, "step_length": 0.01},
        "layer": Layer(uniform_material(STONE)),
        "scale": 0.5,
        **options,
    }
    return Object(uniform_material(GRASS, height), surface="landscape",
                  surface_parameters=surface_parameters, transform=np.eye(4),
                  **options)  # fmt: skip


def color(obj: Object, **scene) -> np.ndarray:
    frame = drawn(obj, camera=FRONT, size=(9, 9), **{**UNLIT, **scene})
    assert frame.hit.all()
    return frame.color[4, 4, :3]


@pytest.mark.parametrize("height", [0.0, 0.1, 0.35, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("water", [0.0, 0.4])
def test_ground_is_blended_by_height_and_water_lies_below(height: float, water: float) -> None:
    """L3, L4: grass at height 0, stone at height 1; below the water level height × water colour."""
    ground = GRASS * (1.0 - height) + STONE * height
    wanted = np.array([0.1, 0.3, 0.8]) * height if height < water else ground
    np.testing.assert_allclose(color(land(height, water)), wanted, atol=1e-4)


@pytest.mark.parametrize("technique", ["fixed_length", "offset", "steep", "relief"])
def test_the_ground_has_the_height_of_the_map_at_the_hit(technique: str) -> None:
    """L3: also where the technique ends its ray above or below the surface."""
    heights = noise(4, (23, 17), 1)
    ground = Material("ground", height=map_of(heights), base_color=map_of(np.zeros((1, 1, 3))))
    obj = Object(
        ground,
        technique=technique,
        scale=0.3,
        reference_height=1.0,
        surface="landscape",
        surface_parameters={"water_level": 0.0, "sky_color": (0, 0, 0)},
        layer=Layer(uniform_material(np.ones(3))),
    )
    frame = drawn(obj, camera=Orbit(20.0, 40.0), size=(48, 36), **UNLIT)
    wanted = bilinear(heights, frame.uv[frame.hit])
    shown = frame.color[frame.hit][:, :1]
    found = shown[:, 0] > 0.0
    assert found.mean() > 0.5
    np.testing.assert_allclose(shown[found], wanted[found], atol=2e-4)


def test_a_ray_without_a_hit_shows_the_sky() -> None:
    """L6: 25 steps end above the ground, 27 reach it."""
    for steps, wanted in ((25, [1.0, 0.5, 0.0]), (27, GRASS * 0.5 + STONE * 0.5)):
        settings = {"steps": steps, "step_length": 0.01}
        np.testing.assert_allclose(color(land(0.5, settings=settings)), wanted, atol=1e-4)


def test_a_ray_that_runs_out_of_steps_below_the_water_level_shows_the_sky() -> None:
    """L6: only a hit is water. At a scale of 0.5, 31 reads end at height 0.4, above the ground at
    0.1; 47 reach it."""
    for steps, wanted in ((32, [1.0, 0.5, 0.0]), (48, [0.01, 0.03, 0.08])):
        settings = {"steps": steps, "step_length": 0.01}
        obj = land(0.1, water_level=0.45, settings=settings)
        np.testing.assert_allclose(color(obj), wanted, atol=1e-4)


@pytest.mark.parametrize("elevation", [0.0, 40.0, 75.0])
def test_the_ground_is_lit_by_lamberts_law(elevation: float) -> None:
    """L1."""
    unlit = Shading(ambient=(0.0, 0.0, 0.0))
    scene = {"lights": (directional(0.0, elevation),), "shading": unlit, "shading_model": "phong"}
    wanted = (GRASS * 0.5 + STONE * 0.5) * math.cos(math.radians(elevation))
    np.testing.assert_allclose(color(matte(land(0.5)), **scene), wanted, atol=1e-4)


# --- surface parameters

MATTE = Shading(ambient=(0.0, 0.0, 0.0))


def ground(own_color: float, maps=None, **numbers) -> Object:
    """A landscape that is 0.5 high everywhere, its normal map leaning to (0.36, −0.48, 0.8)."""
    leaning = np.array([[[0.36, -0.48, 0.8]]]) * 0.5 + 0.5
    return Object(
        uniform_material(own_color, 0.5, normal=map_of(leaning), **(maps or {})),
        surface="landscape",
        surface_parameters={"water_level": 0.0, **numbers},
        technique="parallax_occlusion",
        transform=np.eye(4),
    )


def shading_normal(obj: Object) -> np.ndarray:
    """The unit normal of a white landscape."""
    return normal_under_tripod(
        color(matte(obj), lights=TRIPOD, shading=MATTE, shading_model="phong")
    )


@pytest.mark.parametrize("strength", [None, 0.0, 0.25, 1.0, 1.5])
def test_normal_strength_scales_the_slope_of_the_map(strength) -> None:
    """x and y times the strength, then normalised; 1 by default."""
    times = 1.0 if strength is None else strength
    numbers = {} if strength is None else {"normal_strength": strength}
    wanted = unit([0.36 * times, -0.48 * times, 0.8])
    np.testing.assert_allclose(shading_normal(ground(1.0, **numbers)), wanted, atol=2e-4)


def test_water_and_sky_ignore_the_normal_map() -> None:
    # white at half the height
    lake = ground(1.0, water_level=0.6, water_color=2.0)
    np.testing.assert_allclose(shading_normal(lake), [0.0, 0.0, 1.0], atol=2e-4)
    above = {"technique": "fixed_length", "settings": {"steps": 5, "step_length": 0.001}}
    sky = replace(ground(0.0, sky_color=1.0), **above)
    np.testing.assert_allclose(shading_normal(sky), [0.0, 0.0, 1.0], atol=2e-4)


def test_by_default_water_lies_below_a_height_of_two_fifths() -> None:
    for height, wanted in ((0.395, np.array([0.1, 0.3, 0.8]) * 0.395), (0.405, GRASS)):
        obj = Object(
            uniform_material(GRASS, height), surface="landscape", technique="parallax_occlusion",
            transform=np.eye(4),
        )  # fmt: skip
        np.testing.assert_allclose(color(obj), wanted, atol=1e-4)


@pytest.mark.parametrize(("roughness", "factor"), [(None, 1.0), (0.5, 1.0), (0.6, 0.75)])
def test_the_ground_has_its_own_roughness(roughness, factor: float) -> None:
    """That of the map times the parameter; 0.8 without a map."""
    maps = {} if roughness is None else {"roughness": map_of([[roughness]])}
    black = ground(0.0, maps, normal_strength=0.0, roughness=factor)
    scene = {"lights": (directional(0.0, 0.0),), "shading": MATTE}
    # black and lit along the view: π · D · V · F is 0.01 ÷ roughness⁴
    own = (0.8 if roughness is None else roughness) * factor
    np.testing.assert_allclose(color(black, **scene), 0.01 / own**4, rtol=3e-4)


AMBIENT = {"lights": (), "shading": Shading(ambient=(0.2, 0.4, 0.8))}


@pytest.mark.parametrize("strength", [0.0, 0.5, 1.0])
def test_occlusion_and_emission_are_those_of_the_ground(strength: float) -> None:
    """ambient · mix(1, 0.3, strength) + emission."""
    maps = {"occlusion": map_of([[0.3]]), "emission": map_of(np.full((1, 1, 3), 0.5))}
    numbers = {"normal_strength": 0.0, "occlusion": strength, "emission": (0.2, 0.4, 0.0)}
    wanted = np.array([0.2, 0.4, 0.8]) * (1.0 - 0.7 * strength) + [0.1, 0.2, 0.0]
    np.testing.assert_allclose(color(ground(1.0, maps, **numbers), **AMBIENT), wanted, atol=1e-5)
    # water and sky have a colour alone
    for other in (
        ground(1.0, maps, **numbers, water_level=0.6, water_color=2.0),
        replace(ground(1.0, maps, **numbers, sky_color=1.0), technique="fixed_length",
                settings={"steps": 5, "step_length": 0.001}),
    ):  # fmt: skip
        np.testing.assert_allclose(color(other, **AMBIENT), [0.2, 0.4, 0.8], atol=1e-5)


@pytest.mark.parametrize("water_level", [0.0, 0.6])
@pytest.mark.parametrize("alpha", ["blend", "mask", "opaque"])
@pytest.mark.parametrize("opacity", [0.3, 0.7])
def test_ground_and_water_are_cut_out_by_opacity(water_level, alpha, opacity: float) -> None:
    """Over a background of black: the colour times its coverage; below the cutoff nothing."""
    maps = {"opacity": map_of([[opacity]])}
    numbers = {"normal_strength": 0.0, "water_level": water_level, "water_color": 2.0}
    obj = replace(ground(1.0, maps, **numbers), alpha=alpha)
    frame = drawn(obj, camera=FRONT, size=(9, 9), background=(0.0, 0.0, 0.0), **AMBIENT)
    coverage = {"blend": opacity, "mask": float(opacity >= 0.5), "opaque": 1.0}[alpha]
    assert frame.hit[4, 4] == (coverage >= 0.5)
    wanted = np.array([0.2, 0.4, 0.8]) * coverage
    np.testing.assert_allclose(frame.color[4, 4, :3], wanted, atol=1e-4)


def test_the_cutoff_is_a_parameter() -> None:
    obj = replace(ground(1.0, {"opacity": map_of([[0.3]])}, cutoff=0.25), alpha="mask")
    assert drawn(obj, camera=FRONT, size=(9, 9), **AMBIENT).hit.all()


def test_the_sky_is_opaque() -> None:
    """It is no point of the ground, whose opacity is read where the ray ends."""
    above = {"technique": "fixed_length", "settings": {"steps": 5, "step_length": 0.001}}
    sky = replace(ground(1.0, {"opacity": map_of([[0.0]])}), alpha="mask", **above)
    np.testing.assert_allclose(color(sky, **AMBIENT), [0.2, 0.4, 0.8], atol=1e-5)


@pytest.mark.parametrize(("mask", "strength"), [(1.0, 1.0), (0.25, 1.0), (0.5, 0.5), (0.0, 1.0)])
def test_mountains_follow_the_mask_and_the_strength_of_the_layer(mask, strength: float) -> None:
    """mix(grass, stone, height · mask · strength)."""
    grass = uniform_material(GRASS, 0.8, layer_mask=map_of([[mask]]))
    obj = Object(
        grass, surface="landscape", technique="parallax_occlusion", transform=np.eye(4),
        layer=Layer(uniform_material(STONE)), surface_parameters={"layer_color": strength},
    )  # fmt: skip
    share = 0.8 * mask * strength
    np.testing.assert_allclose(color(obj), GRASS * (1 - share) + STONE * share, atol=1e-4)


@pytest.mark.parametrize(("mask", "strength"), [(1.0, 1.0), (0.5, 1.0), (1.0, 2.0), (1.0, 0.0)])
def test_mountains_have_the_normals_of_the_layer(mask, strength: float) -> None:
    """Its slopes times height · mask · strength, added to those of the ground."""
    leaning = np.array([0.48, 0.36, 0.8])
    stone = uniform_material(1.0, normal=map_of((leaning * 0.5 + 0.5)[None, None]))
    obj = replace(
        ground(1.0, {"layer_mask": map_of([[mask]])}, layer_normal=strength),
        layer=Layer(stone, Tiling((1.0, 1.0))),
    )
    slope = 0.5 * mask * strength
    tilt = unit([*(leaning[:2] * slope), leaning[2]])
    wanted = unit([0.36 + tilt[0], -0.48 + tilt[1], 0.8 * tilt[2]])
    np.testing.assert_allclose(shading_normal(obj), wanted, atol=3e-4)


def test_ground_and_mountains_have_their_own_tilings() -> None:
    """L3: the article reads its noise at uv × 0.2 and its colours at uv × 0.4."""
    low, high = noise(1, (32, 32)), noise(2, (32, 32))
    material = Material("m", base_color=map_of(low), height=map_of(np.full((1, 1), 0.25)))
    obj = Object(
        material, surface="landscape", surface_parameters={"water_level": 0.0}, scale=0.05,
        technique="parallax_occlusion", tiling=(0.2, 0.2), transform=np.eye(4),
        tilings={"base_color": Tiling((0.4, 0.4))},
        layer=Layer(Material("high", base_color=map_of(high)), Tiling((0.8, 0.8))),
    )  # fmt: skip
    frame = drawn(obj, camera=FRONT, **UNLIT)
    place = frame.uv.astype(np.float64) / 0.2
    wanted = 0.75 * bilinear(low, place * 0.4) + 0.25 * bilinear(high, place * 0.8)
    np.testing.assert_allclose(frame.color[:, :, :3], wanted, atol=2e-3)


# --- L5: scrolling --------------------------------------------------------------------------------


@pytest.mark.parametrize("surface", ["landscape", "standard"])
def test_scrolling_moves_all_maps_together(surface: str) -> None:
    """L5: every map is shifted by an eighth of the shape along u."""
    material = Material(
        "m",
        height=map_of(noise(3, (32, 32), 1)),
        base_color=map_of(noise(4, (32, 32))),
        normal=map_of(noise(5, (32, 32)) * [0.4, 0.4, 0.0] + [0.3, 0.3, 0.95]),
        occlusion=map_of(noise(6, (32, 32), 1)),
        emission=map_of(noise(7, (32, 32))),
    )
    obj = Object(
        material,
        surface=surface,
        technique="parallax_occlusion",
        tiling=(2.0, 3.0),
        shift=(0.1, 0.2),
        tilings={
            "base_color": Tiling((1.0, 2.0), (0.3, 0.0)),
            "normal": Tiling((-3.0, 2.0)),
            "emission": Tiling((1.5, 1.0)),
        },
        layer=Layer(Material("over", base_color=map_of(noise(8, (32, 32)))), Tiling((2.5, 2.5))),
        transform=np.eye(4),
    )
    camera = LookAt((0.0, -1.2, 2.0), up=(0.0, 0.0, 1.0), orthographic_height=0.5)
    still, moved = (
        drawn(each, camera=camera, size=(96, 64)) for each in (obj, obj.scrolled(0.125))
    )
    # 128 pixels to a unit
    first, then = still.color[:, 24:88], moved.color[:, 8:72]
    assert still.hit.all()
    np.testing.assert_allclose(then, first, atol=2e-3)
    assert np.abs(still.color[:, 8:72] - then).max() > 0.1
    np.testing.assert_allclose(moved.uv[:, 8:72], still.uv[:, 24:88], atol=1e-4)


def test_scrolling_there_and_back_or_a_whole_tile_changes_nothing() -> None:
    obj = Object(sample("bricks", 16), tiling=(2.0, 3.0), shift=(0.5, 0.0),
                   layer=Layer(sample("grid", 16)))  # fmt: skip
    back = obj.scrolled(0.25, 0.5).scrolled(-0.25, -0.5)
    assert back.shift == obj.shift
    assert back.layer.tiling == obj.layer.tiling
    assert obj.scrolled(0.25, 0.5).shift == (1.0, 1.5)
    assert obj.scrolled(0.25, 0.5).layer.tiling.shift == (2.5, 5.0)


# --- what is in a program, and both engines ------------------------------------------------------


def test_only_the_chosen_surface_is_in_a_program() -> None:
    material = sample("terrain", 16)
    texts = [
        print_wgsl(program_of(Object(material, surface=surface).resolved).module, "wrap")
        for surface in ("standard", "landscape")
    ]
    for word, wanted in (
        ("landscape_surface", [False, True]),
        ("water_level", [False, True]),
        ("standard_surface", [True, False]),
    ):
        assert [word in text for text in texts] == wanted


@pytest.mark.gpu
def test_cpu_and_gpu_agree() -> None:
    obj = Object(
        sample("terrain", 64), surface="landscape", technique="fixed_length", scale=0.3,
        layer=Layer(sample("stone", 64), Tiling((3.0, 3.0))),
    ).scrolled(0.3)  # fmt: skip
    assert_engines_agree(Scene((obj,), Orbit(20.0, 30.0, 1.8)), 64)


def test_water_does_not_depend_on_the_fading_of_the_relief() -> None:
    """A landscape reads the height where the relief is flat; the standard surface reads none."""
    levels = np.full((4, 4, 1), 0.2, np.float32)
    ground = Material("lake", height=Map(levels, False, "lake"))
    options = {"technique": "fixed_length", "scale": 0.1, "transform": np.eye(4)}
    camera = LookAt((0.0, 0.0, 3.0), up=(0.0, 1.0, 0.0))
    colors = []
    for fade in (None, (0.5, 1.0)):
        obj = Object(ground, surface="landscape", fade=fade, **options)
        frame = render(Scene((obj,), camera), size=(9, 9), samples=1, device="cpu")
        colors.append(frame.color[4, 4])
    np.testing.assert_allclose(colors[0], colors[1], atol=1e-3)
    flat = Object(ground, fade=(0.5, 1.0), **options)
    assert render(Scene((flat,), camera), size=(9, 9), samples=1, device="cpu").reads.max() == 0


def test_without_a_layer_the_ground_is_the_same_everywhere() -> None:
    colors = np.full((1, 1, 3), 0.4, np.float32)
    height = Map(np.full((4, 4, 1), 0.8, np.float32), False, "high")
    ground = Material("ground", height=height, base_color=Map(colors, False, "colour"))
    obj = Object(ground, surface="landscape", transform=np.eye(4))
    camera = LookAt((0.0, 0.0, 3.0), up=(0.0, 1.0, 0.0))
    scene = Scene((obj,), camera, lights=(), shading={"ambient": 1.0})
    color = render(scene, size=(9, 9), samples=1, device="cpu").color[4, 4, :3]
    np.testing.assert_allclose(color, 0.4, atol=1e-3)


@pytest.mark.parametrize("technique", ["parallax_occlusion", "relief", "fixed_length"])
def test_ground_of_height_0_is_water_and_not_sky(technique) -> None:
    """A march to the base at height 0 has hit the ground of the lake."""
    ground = Material("pit", height=Map(np.zeros((4, 4, 1), np.float32), False, "pit"))
    obj = Object(ground, technique=technique, surface="landscape", transform=np.eye(4))
    camera = LookAt((0.0, 0.0, 3.0), up=(0.0, 1.0, 0.0))
    scene = Scene((obj,), camera, lights=(), shading={"ambient": 1.0})
    color = render(scene, size=(9, 9), samples=1, device="cpu").color[4, 4, :3]
    assert color.max() < 0.2
