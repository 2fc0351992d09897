"""Cut-outs: opacity read at the hit, the background through the holes, and light through them.

The relief is a plane of constant height, so that hits are known in float64.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.programs import depth_program_of, program_of
from basrelief.rendering.shadow_maps import shadow_map_values
from basrelief.scene import LYING, LookAt, Object, Orbit, Scene, directional, placed
from basrelief.shading.brdf import Shading
from basrelief.shading.lights import FAR_AWAY
from helpers.agreement import assert_engines_agree
from helpers.synthetic import (
    bilinear,
    drawn,
    map_of,
    matte,
    noise,
    on_plane,
    rays,
    uniform_material,
)

SLANTED = LookAt((0.8, -1.1, 1.6), up=(0.1, 0.3, 1.0), orthographic_height=0.35)
UNLIT = {"lights": (), "shading": Shading(ambient=(1.0, 1.0, 1.0))}
OPACITY = np.random.default_rng(5).random((5, 7, 1))
FRONT, BACK = np.array([0.9, 0.2, 0.1]), np.array([0.1, 0.3, 0.8])
SUNKEN = {
    "technique": "parallax_occlusion",
    "settings": {"min_steps": 8, "max_steps": 8},
    "scale": 0.3,
    "reference_height": 1.0,
}


def holed(**options) -> Object:
    """A plane whose relief lies 0.225 below the polygon, with holes in it."""
    material = uniform_material(FRONT, opacity=map_of(OPACITY), height=0.25)
    return Object(material, transform=np.eye(4), **{**SUNKEN, **options})


def behind() -> Object:
    """A larger plane below the first."""
    return Object(uniform_material(BACK), transform=placed((0.0, 0.0, -0.5), (4.0, 4.0, 1.0)))


def opacity_seen() -> np.ndarray:
    """The opacity at each pixel, where the ray meets the sunken plane."""
    return bilinear(OPACITY, on_plane(SLANTED, -0.225)[0])[..., 0]


@pytest.mark.parametrize("cutoff", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("other", ["an object", "the background"])
def test_a_hole_shows_the_object_or_background_behind(cutoff: float, other: str) -> None:
    """C16: solid or empty by the opacity at the hit; a hole shows exactly the colour behind."""
    objects = [holed(alpha="mask", surface_parameters={"cutoff": cutoff})]
    if other == "an object":
        objects.append(behind())
    frame = drawn(*objects, camera=SLANTED, background=(0.3, 0.6, 0.2), **UNLIT)
    opacity = opacity_seen()
    hole, solid = opacity < cutoff - 2e-3, opacity > cutoff + 2e-3
    assert min(hole.mean(), solid.mean()) > 0.1
    np.testing.assert_allclose(
        frame.color[solid][:, :3], np.tile(FRONT, (solid.sum(), 1)), atol=1e-4
    )
    if other == "an object":
        wanted = drawn(behind(), camera=SLANTED, **UNLIT)
        np.testing.assert_array_equal(frame.color[hole], wanted.color[hole])
        np.testing.assert_array_equal(frame.distance[hole], wanted.distance[hole])
    else:
        np.testing.assert_array_equal(
            frame.color[hole], np.float32([[0.3, 0.6, 0.2, 1.0]] * hole.sum())
        )
        assert not frame.hit[hole].any()
    # the opacity read on the polygon would put the holes elsewhere
    polygon = bilinear(OPACITY, on_plane(SLANTED)[0])[..., 0]
    assert ((polygon < cutoff) != (opacity < cutoff)).mean() > 0.1


def test_opaque_ignores_opacity_and_blend_mixes() -> None:
    whole = drawn(holed(alpha="opaque"), behind(), camera=SLANTED, **UNLIT)
    np.testing.assert_allclose(
        whole.color[:, :, :3], np.broadcast_to(FRONT, (61, 97, 3)), atol=1e-4
    )
    mixed = drawn(holed(alpha="blend"), behind(), camera=SLANTED, **UNLIT)
    share = opacity_seen()[..., None]
    np.testing.assert_allclose(mixed.color[:, :, :3], FRONT * share + BACK * (1 - share), atol=1e-3)


@pytest.mark.parametrize(
    ("opacity", "cutoff", "solid"),
    [(32767, None, False), (32768, None, True), (65534, 1.0, False), (65535, 1.0, True),
     (0, 0.0, True), (13106, 0.2, False), (13107, 0.2, True)],
)  # fmt: skip
def test_opacity_equal_to_the_cutoff_is_solid(opacity: int, cutoff, solid: bool) -> None:
    """Stored opacities, of 65535, just below and at a cutoff; the default is a half."""
    stored = Map(np.full((1, 1, 1), opacity, np.uint16), False, "made up")
    surface_parameters = {} if cutoff is None else {"cutoff": cutoff}
    obj = Object(
        uniform_material(FRONT, opacity=stored),
        alpha="mask",
        surface_parameters=surface_parameters,
        transform=np.eye(4),
    )
    frame = drawn(obj, camera=SLANTED, background=(0.3, 0.6, 0.2), **UNLIT)
    assert (frame.hit == solid).all()
    wanted = FRONT if solid else (0.3, 0.6, 0.2)
    np.testing.assert_allclose(frame.color[30, 48, :3], wanted, atol=1e-4)


# --- light through the holes ----------------------------------------------------------------------

LIGHT = directional(90.0, 45.0)
ABOVE = LookAt((0.0, 3.0, 0.0), up=(0.0, 0.0, -1.0), orthographic_height=1.8)
MATTE = {"shading": Shading(ambient=(0.0, 0.0, 0.0))}
RAISED = 0.6
FLOOR = Object(uniform_material(), transform=LYING @ placed(scale=(4.0, 4.0, 1.0)))


def shadow_on_floor(**options) -> tuple[np.ndarray, np.ndarray]:
    """The dark pixels of a floor below a plane with holes, and the points of its pixels."""
    smooth = Material("smooth", base_color=map_of(np.full((16, 16, 3), 0.6)),
                      opacity=map_of(noise(11, (16, 16), 1, 0.0, 1.0)))  # fmt: skip
    roof = Object(smooth, transform=placed((0.0, RAISED, 0.0)) @ LYING, **options)
    scene = {"camera": ABOVE, "lights": (LIGHT,), "shading_model": "phong", **MATTE}
    frame = drawn(matte(FLOOR), matte(roof), **scene, shadows="hard", shadow_map_size=512)
    origins, directions = rays(ABOVE)
    points = origins + directions * np.where(frame.hit, frame.distance, 0.0)[..., None]
    floor = frame.hit & (np.abs(points[..., 1]) < 1e-3)
    return np.where(floor, frame.color[:, :, 0] < 0.2, False), np.where(
        floor[..., None], points, np.nan
    )


def roof_crossing(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where rays to the light cross the roof: the larger |uv − ½|, and the opacity."""
    with np.errstate(invalid="ignore"):
        uv = np.stack([0.5 + points[..., 0] + RAISED, 0.5 + points[..., 2]], -1)
        inside = np.abs(uv - 0.5).max(-1)
    opacity = bilinear(noise(11, (16, 16), 1, 0.0, 1.0), np.nan_to_num(uv))[..., 0]
    return np.nan_to_num(inside, nan=0.5), opacity


@pytest.mark.parametrize("casts", ["shape", "polygon", "opaque", "none"])
def test_the_shadow_has_the_holes_of_the_mask_if_it_casts_its_shape(casts: str) -> None:
    """C16: the shadow has the holes of the mask, or no holes, or there is no shadow."""
    dark, points = shadow_on_floor(alpha="mask", casts=casts)
    inside, opacity = roof_crossing(points)
    seen = np.isfinite(points[..., 0])
    below, beside = seen & (inside < 0.48), seen & (inside > 0.52)
    holes, solid = below & (opacity < 0.42), below & (opacity > 0.58)
    assert min(holes.sum(), solid.sum(), beside.sum()) > 100
    assert not dark[beside].any()
    assert dark[solid].all() == (casts != "none")
    assert dark[holes].all() == (casts == "opaque")
    assert dark[holes].any() == (casts == "opaque")


def test_a_polygon_casts_its_undisplaced_holes() -> None:
    """A relief of one height below the polygon moves the holes that the light sees; the shadow of
    the polygon has them where the opacity map has them, at the polygon's depth."""
    sunk = Material("sunk", height=map_of(np.zeros((16, 16))),
                    base_color=map_of(np.full((16, 16, 3), 0.6)),
                    opacity=map_of(noise(11, (16, 16), 1, 0.0, 1.0)))  # fmt: skip
    flat = replace(sunk, height=None)

    def shadow(material: Material, **options: Any) -> np.ndarray:
        roof = Object(
            material, alpha="mask", transform=placed((0.0, RAISED, 0.0)) @ LYING, **options
        )
        scene = Scene((FLOOR, roof), ABOVE, (LIGHT,), shadows="hard", shadow_map_size=256)
        return shadow_map_values(scene, CpuEngine())[0]["distances"].levels[0]

    relief = {"technique": "relief", "scale": 0.2}
    of_polygon = shadow(sunk, **relief, casts="polygon")
    np.testing.assert_array_equal(of_polygon, shadow(flat))
    hit = of_polygon < FAR_AWAY
    assert hit.sum() > 100
    assert (of_polygon != shadow(sunk, **relief, casts="shape"))[hit].mean() > 0.9


def test_an_opaque_object_casts_a_shadow_without_holes() -> None:
    dark, points = shadow_on_floor(alpha="opaque")
    inside, _ = roof_crossing(points)
    assert dark[np.isfinite(points[..., 0]) & (inside < 0.48)].all()


# --- what is in a program, and both engines ------------------------------------------------------


def test_a_program_contains_only_its_kind_of_alpha() -> None:
    material = replace(sample("tiles", 16), opacity=map_of(np.ones((16, 16))))
    readings = {
        "blend": "opacity_of(opacity: f32) -> f32 {\n  return opacity;\n}",
        "mask": "opacity_of(opacity: f32, surface_parameters: SurfaceParameters) -> f32 {\n"
        "  return alpha_mask(opacity, surface_parameters);\n}",
        "opaque": "opacity_of() -> f32 {\n  return 1.0;\n}",
    }
    for alpha in readings:
        obj = Object(material, alpha=alpha)
        text = print_wgsl(program_of(obj.resolved).module, "wrap")
        assert [each in text for each in readings.values()] == [each == alpha for each in readings]
        assert ("alpha_mask" in text) == (alpha == "mask")
        for casts, cut in (("shape", alpha == "mask"), ("opaque", False)):
            program = depth_program_of(replace(obj, casts=casts).resolved)
            assert ("alpha_mask" in print_wgsl(program.module, "wrap")) == cut


@pytest.mark.gpu
def test_cpu_and_gpu_agree() -> None:
    hole = map_of(noise(11, (64, 64), 1, 0.0, 1.0))
    lattice = replace(sample("bricks", 64), opacity=hole)
    roof = Object(lattice, alpha="mask", technique="relief", transform=placed((0, 0.3, 0)) @ LYING)
    floor = Object(uniform_material(), transform=LYING @ placed(scale=(2.0, 2.0, 1.0)))
    scene = Scene((floor, roof), Orbit(25.0, 40.0, 2.0), shadows="hard", shadow_map_size=128)
    assert_engines_agree(scene, 64)
