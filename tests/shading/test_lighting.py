"""Lights, Phong and GGX against values worked out by hand and against physical laws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.lang import Vec3
from basrelief.lang.frontend import analyse
from basrelief.shading.brdf import Shading, ShadingPoint, ambient_light, ggx, phong, reflectance
from basrelief.shading.lights import (
    DIRECTIONAL,
    POINT,
    SPOT,
    IncidentLight,
    Light,
    incident_light,
    spot_attenuation,
)
from basrelief.shading.surfaces.landscape import Landscape
from basrelief.shading.surfaces.standard import SurfaceParameters
from basrelief.shading.variant import Variant

UP = (0, 0, 1)
MODELS = ["phong", "ggx"]


def a(vector):
    return np.array([*vector], np.float64)


def unit(*vector):
    return np.array(vector, np.float64) / np.linalg.norm(vector)


def tilted(degrees, turn=0.0):
    """The unit vector at an angle from +z, rotated about z."""
    angle, turn = math.radians(degrees), math.radians(turn)
    return (
        math.sin(angle) * math.cos(turn),
        math.sin(angle) * math.sin(turn),
        math.cos(angle),
    )


def point_seen(view=UP, **changed):
    fields = {
        "position": (0, 0, 0),
        "normal": UP,
        "view": view,
        "base_color": (1, 1, 1),
        "roughness": 1.0,
        "metallic": 0.0,
        "occlusion": 1.0,
        "emission": (0, 0, 0),
        "specular": (1, 1, 1),
        "shininess": 10.0,
        **changed,
    }
    vectors = ("position", "normal", "view", "base_color", "emission", "specular")
    return ShadingPoint(**{k: Vec3(*v) if k in vectors else v for k, v in fields.items()})


def arriving(direction, radiance=(1, 1, 1)):
    return IncidentLight(Vec3(*direction), Vec3(*radiance), 1.0)


def light(kind, **changed):
    fields = {
        "position": (0, 0, 0),
        "direction": (0, 0, -1),
        "color": (1, 2, 4),
        "falloff": 2.0,
        "cos_inner": 0.9,
        "cos_outer": 0.8,
        **changed,
    }
    vectors = ("position", "direction", "color")
    return Light(kind=kind, **{k: Vec3(*v) if k in vectors else v for k, v in fields.items()})


def reflected(model, point, incident):
    return reflectance(point, Shading(), incident, Variant(shading_model=model))


@pytest.mark.parametrize("model", MODELS)
def test_the_shaders_are_in_the_subset_and_a_variant_has_its_own(model):
    variant = Variant(shading_model=model)
    module = analyse(reflectance, static_value=lambda name: getattr(variant, name))
    (other,) = {*MODELS} - {model}
    names = {function.name for function in module.functions}
    assert model in names
    assert other not in names
    analyse(incident_light)
    analyse(ambient_light)
    by_name = {
        "phong": phong(point_seen(), Shading(), arriving(UP)),
        "ggx": ggx(point_seen(), arriving(UP)),
    }
    assert reflected(model, point_seen(), arriving(UP)) == by_name[model]


# --- light arriving --------------------------------------------------------------------------


def test_a_directional_light_is_the_same_everywhere():
    sun = light(DIRECTIONAL, direction=(0.6, 0, -0.8))
    for place in ((0, 0, 0), (30, -20, 1000)):
        found = incident_light(sun, Vec3(*place))
        np.testing.assert_allclose(a(found.direction), (-0.6, 0, 0.8), atol=1e-7)
        assert a(found.radiance).tolist() == [1, 2, 4]
        assert found.distance > 1e15


@pytest.mark.parametrize(("falloff", "divisor"), [(1.0, 5.0), (2.0, 25.0)])
def test_a_point_light_falls_off_with_a_power_of_distance(falloff, divisor):
    lamp = light(POINT, position=(1, 2, 3), falloff=falloff)
    found = incident_light(lamp, Vec3(1, -2, 6))
    assert found.distance == pytest.approx(5)
    np.testing.assert_allclose(a(found.direction), (0, 0.8, -0.6), atol=1e-7)
    np.testing.assert_allclose(a(found.radiance), np.array((1, 2, 4)) / divisor, rtol=2e-6)


@pytest.mark.parametrize("kind", [POINT, SPOT])
def test_within_a_lamp_the_light_is_finite(kind):
    for offset in (0.0, 1e-20, 1e-7):
        found = incident_light(light(kind, position=(1, 1, 1)), Vec3(1 + offset, 1, 1))
        assert np.isfinite(a(found.radiance)).all()
        assert np.linalg.norm(a(found.direction)) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("kind", [POINT, SPOT])
@pytest.mark.parametrize(
    ("distance", "clamped"),
    [(2e-4, 1e-3), (9e-4, 1e-3), (1.5e-3, 1.5e-3), (9e3, 9e3), (1.1e4, 1e4), (3e6, 1e4)],
)
def test_the_distance_of_a_lamp_is_clamped_to_a_millimetre_and_ten_kilometres(
    kind, distance, clamped
):
    lamp = light(kind, falloff=1.0)
    found = incident_light(lamp, Vec3(0, 0, -distance))
    assert found.distance == pytest.approx(distance, rel=1e-6)
    np.testing.assert_allclose(a(found.radiance), np.array((1, 2, 4)) / clamped, rtol=1e-5)


def test_within_a_millionth_of_a_lamp_the_light_direction_is_up():
    lamp = light(POINT)
    for distance, direction in ((0.0, (0, 1, 0)), (9e-7, (0, 1, 0)), (1.1e-6, (-1, 0, 0))):
        found = incident_light(lamp, Vec3(distance, 0, 0))
        np.testing.assert_allclose(a(found.direction), direction, atol=1e-6)


def spot_radiance(degrees, **changed):
    """Radiance of a spot at distance 1 and an angle from its axis."""
    down = light(SPOT, color=(1, 1, 1), **changed)
    return float(incident_light(down, Vec3(*tilted(180 - degrees))).radiance.x)


def test_a_spot_is_1_inside_its_cones_half_between_and_0_outside():
    cones = {"cos_inner": math.cos(math.radians(20)), "cos_outer": math.cos(math.radians(40))}
    middle = math.degrees(math.acos((cones["cos_inner"] + cones["cos_outer"]) / 2))
    assert spot_radiance(0, **cones) == 1
    assert spot_radiance(19.9, **cones) == pytest.approx(1, abs=1e-6)
    assert spot_radiance(middle, **cones) == pytest.approx(0.5, abs=1e-5)
    assert 0 < spot_radiance(39.9, **cones) < 1e-3
    assert spot_radiance(40.01, **cones) == 0
    assert spot_radiance(90, **cones) == 0
    assert spot_radiance(180, **cones) == 0


def test_a_spot_with_equal_cones_has_a_hard_edge():
    cones = {"cos_inner": 0.5, "cos_outer": 0.5}
    assert spot_radiance(59.9, **cones) == 1
    assert spot_radiance(60.1, **cones) == 0
    assert 0 <= spot_radiance(60, **cones) <= 1


def test_the_edge_of_equal_cones_is_a_millionth_wide():
    """Measured in cosines, with half of the light in the middle."""
    lamp = light(SPOT, cos_inner=0.5, cos_outer=0.5)
    for more, share in ((-1e-7, 0.0), (5e-7, 0.5), (1.1e-6, 1.0)):
        assert float(spot_attenuation(lamp, np.float32(0.5 + more))) == pytest.approx(
            share, abs=0.1
        )


def test_a_spot_falls_off_as_a_point_light_does():
    lamp = light(SPOT, position=(0, 0, 4), falloff=1.0)
    np.testing.assert_allclose(a(incident_light(lamp, Vec3(0)).radiance), (0.25, 0.5, 1), rtol=2e-6)


def test_ambient_light_is_tinted_and_occluded():
    point = point_seen(base_color=(1, 0.5, 0.25), occlusion=0.5)
    lit = ambient_light(point, Shading(ambient=Vec3(0.4, 0.2, 0.8)))
    np.testing.assert_allclose(a(lit), (0.2, 0.05, 0.1), rtol=1e-6)


# --- Phong -----------------------------------------------------------------------------------


def test_phong_in_the_mirror_direction_shows_the_whole_highlight():
    point = point_seen(view=(-0.6, 0, 0.8), base_color=(0.5, 0.25, 1), specular=(0.1, 0.2, 0.3))
    lit = phong(point, Shading(diffuse=0.5), arriving((0.6, 0, 0.8), (2, 1, 1)))
    # 0.8 · 0.5 · base + specular, the first channel lit twice as much
    np.testing.assert_allclose(a(lit), (2 * (0.2 + 0.1), 0.1 + 0.2, 0.4 + 0.3), rtol=1e-6)


@pytest.mark.parametrize(("shininess", "highlight"), [(10.0, 0.8**10), (1.0, 0.8), (40.0, 0.8**40)])
def test_phong_seen_from_above_raises_the_cosine_to_the_shininess(shininess, highlight):
    lit = phong(point_seen(shininess=shininess), Shading(diffuse=0.0), arriving((0, 0.6, 0.8)))
    np.testing.assert_allclose(a(lit), highlight, rtol=1e-5)


def test_phong_has_no_highlight_on_the_side_of_the_light():
    grazing = tilted(80)
    lit = phong(point_seen(view=grazing), Shading(diffuse=0.0), arriving(grazing))
    assert a(lit).tolist() == [0, 0, 0]


def test_the_shininess_is_that_of_the_article_by_default():
    for surface in (SurfaceParameters(), Landscape()):
        assert surface.shininess == 10
        assert a(surface.specular).tolist() == [1, 1, 1]


@pytest.mark.parametrize("model", MODELS)
def test_a_light_behind_the_surface_gives_nothing(model):
    # the view is the light's mirror image, where a highlight would be
    point = point_seen(view=(-0.6, 0, -0.8), roughness=0.2)
    assert a(reflected(model, point, arriving((0.6, 0, -0.8)))).tolist() == [0, 0, 0]
    assert a(reflected(model, point_seen(), arriving((1, 0, 0)))).tolist() == [0, 0, 0]


# --- GGX -------------------------------------------------------------------------------------


def test_ggx_head_on_by_hand():
    # α = 1: D = 1/π, V = 1/4, F = 0.04: 0.96 of the diffuse, π · D · V · F = 0.01
    white = ggx(point_seen(), arriving(UP))
    np.testing.assert_allclose(a(white), 0.97, rtol=1e-6)
    # α = 1/4: D = 16/π, V = 1/4, F = base
    metal = point_seen(base_color=(1, 0.5, 0.25), roughness=0.5, metallic=1.0)
    lit = ggx(metal, arriving(UP, (1, 1, 3)))
    np.testing.assert_allclose(a(lit), (4, 2, 3), rtol=1e-6)


def test_ggx_in_the_mirror_direction_by_hand():
    # n·l = n·v = h·v = 4/5, n·h = 1, α² = 1/16; (1 − 4/5)⁵ = 0.00032
    metal = point_seen(view=(-0.6, 0, 0.8), base_color=(0.5, 0.5, 0.5), roughness=0.5, metallic=1.0)
    visible = 0.5 / (2 * 0.8 * math.sqrt(0.64 * 15 / 16 + 1 / 16))
    expected = 16 * visible * (0.5 + 0.5 * 0.00032) * 0.8
    assert expected == pytest.approx(2.458, abs=1e-3)
    lit = ggx(metal, arriving((0.6, 0, 0.8)))
    np.testing.assert_allclose(a(lit), expected, rtol=1e-5)


def reference_ggx(point, to_light):
    """glTF 2.0, appendix B, in float64: a dielectric and a metal, mixed."""
    normal, view, base = a(point.normal), a(point.view), a(point.base_color)
    half = to_light + view
    half /= np.linalg.norm(half)
    alpha2 = float(point.roughness) ** 4
    nl, nv, nh, vh = normal @ to_light, normal @ view, normal @ half, view @ half
    distribution = alpha2 / (math.pi * (nh**2 * (alpha2 - 1) + 1) ** 2)
    # Smith's Λ, correlated by height: G = 1 / (1 + Λ(l) + Λ(v))
    lambdas = [(math.sqrt(1 + alpha2 * (1 / c**2 - 1)) - 1) / 2 for c in (nl, nv)]
    specular = distribution / (1 + sum(lambdas)) / (4 * nl * nv)
    grazing = (1 - vh) ** 5
    metal = specular * (base + (1 - base) * grazing)
    share = 0.04 + 0.96 * grazing
    dielectric = (1 - share) * base / math.pi + share * specular
    mixed = dielectric + (metal - dielectric) * float(point.metallic)
    return math.pi * mixed * nl


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@given(
    from_light=st.floats(0, 85),
    from_view=st.floats(0, 85),
    turn=st.floats(0, 360),
    roughness=st.floats(0.05, 1),
)
def test_ggx_equals_the_formulas_of_gltf(metallic, from_light, from_view, turn, roughness):
    point = point_seen(
        view=tilted(from_view, turn),
        base_color=(0.9, 0.5, 0.1),
        roughness=roughness,
        metallic=metallic,
    )
    lit = ggx(point, arriving(tilted(from_light)))
    expected = reference_ggx(point, np.array(tilted(from_light)))
    # float32 direction vectors move a sharp highlight by their rounding
    np.testing.assert_allclose(a(lit), expected, rtol=2e-6 / roughness**2 + 2e-5)


@given(
    one=st.floats(0, 85),
    other=st.floats(0, 85),
    turn=st.floats(0, 360),
    roughness=st.floats(0.1, 1),
)
def test_ggx_is_reciprocal(one, other, turn, roughness):
    light_way, view = tilted(one), tilted(other, turn)
    kind = {"base_color": (0.8, 0.4, 0.2), "roughness": roughness, "metallic": 0.5}
    there = ggx(point_seen(view=view, **kind), arriving(light_way))
    back = ggx(point_seen(view=light_way, **kind), arriving(view))
    np.testing.assert_allclose(a(there) / light_way[2], a(back) / view[2], rtol=1e-4)


def reflected_share(point, count=16):
    """The reflected share of uniform light, by a stratified sum over directions."""
    total = np.zeros(3)
    for i in range(count):
        for k in range(count):
            # equal solid angles; odd rows are offset by half a sample
            cosine, turn = (i + 0.5) / count, (k + (i % 2) * 0.5 + 0.25) / count * 360
            direction = tilted(math.degrees(math.acos(cosine)), turn)
            total += a(ggx(point, arriving(direction)))
    # ∫ f · n·l dω, with π · f · n·l summed over 2π
    return 2 * total / count**2


@pytest.mark.parametrize("cosine", [1.0, 0.5])
def test_a_rough_white_metal_reflects_the_share_of_the_closed_form(cosine):
    # α = 1: f = 1 ÷ (2π (n·l + n·v)), whose integral is 1 − n·v · ln(1 + 1 ÷ n·v)
    view = tilted(math.degrees(math.acos(cosine)))
    share = reflected_share(point_seen(view=view, metallic=1.0))
    np.testing.assert_allclose(share, 1 - cosine * math.log(1 + 1 / cosine), rtol=2e-3)


@pytest.mark.parametrize(("roughness", "metallic"), [(0.5, 1.0), (0.5, 0.0), (1.0, 0.0)])
@pytest.mark.parametrize("degrees", [10, 60])
def test_no_more_light_leaves_than_arrives(roughness, metallic, degrees):
    point = point_seen(view=tilted(degrees), roughness=roughness, metallic=metallic)
    share = reflected_share(point)
    assert (share < 1.02).all()
    assert (share > 0.7).all()


@pytest.mark.parametrize("view", [(1, 0, 0), (0.99, 0, -0.1)])
def test_ggx_of_a_view_from_behind_the_normal_is_that_of_a_grazing_view(view):
    """n·v is at least 1e-4. α = 1: V = ½ ÷ (n·v + n·l), D = 1 ÷ π; the light along the normal."""
    view = unit(*view)
    half = unit(*(view + np.array(UP)))
    metal = point_seen(view=view, base_color=(0.9, 0.5, 0.1), metallic=1.0)
    base = np.array((0.9, 0.5, 0.1))
    wanted = (base + (1 - base) * (1 - half @ view) ** 5) * 0.5 / (1.0 + 1e-4)
    np.testing.assert_allclose(a(ggx(metal, arriving(UP))), wanted, rtol=2e-5)


# --- finite for every input ------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_no_direction_makes_a_nan_or_an_infinity(model, roughness):
    rng = np.random.default_rng(11)
    directions = [unit(*rng.normal(size=3)) for _ in range(8)]
    directions += [np.array(d, np.float64) for d in ((0, 0, 1), (0, 0, -1), (1, 0, 0))]
    directions += [unit(1, 0, 1e-20), unit(-1, 0, 1e-7)]
    for view in [*directions, *(-d for d in directions)]:
        point = point_seen(view=view, roughness=roughness, metallic=0.5)
        for direction in directions:
            lit = a(reflected(model, point, arriving(direction)))
            assert np.isfinite(lit).all()
            assert (lit >= 0).all()


def test_roughness_is_at_least_0_045():
    mirror = ggx(point_seen(roughness=0.0, metallic=1.0), arriving(UP))
    least = ggx(point_seen(roughness=0.045, metallic=1.0), arriving(UP))
    assert mirror == least
    # π · D · V = 1 ÷ (4 α²)
    np.testing.assert_allclose(a(mirror), 0.25 / 0.045**4, rtol=1e-5)
