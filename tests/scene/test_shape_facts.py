"""Properties of shapes against their shaders."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from basrelief.lang import Vec2, Vec3
from basrelief.material import sample
from basrelief.scene import SHAPES, Object, Scene
from basrelief.shading.intersection import is_clipped
from basrelief.shading.shapes import ShapeRay, chart, intersect_shape
from basrelief.shading.variant import Variant
from basrelief.viewer.state import manifest, sources_of

PLACES = np.random.default_rng(3).uniform(-0.6, 0.6, (60, 3))


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_contains_the_points_that_its_shader_intersects(name) -> None:
    facts = SHAPES[name]
    inside = []
    for place in PLACES:
        # a flat shape is hit by a ray from straight above
        direction = np.array([0.0, 0.0, -1.0]) if facts.flat else np.array([0.3, -0.9, 0.2])
        intersection = intersect_shape(
            ShapeRay(Vec3(*(place - 3.0 * direction)), Vec3(*direction)), Variant(shape=name)
        )
        inside.append(
            intersection.found
            and (facts.flat or intersection.distance <= 3.0 <= intersection.t_exit)
        )
        assert facts.contains(*place) == inside[-1]
    assert 10 < sum(inside) < 50


@pytest.mark.parametrize("name", SHAPES)
def test_bounding_points_lie_on_the_shape(name) -> None:
    facts = SHAPES[name]
    assert all(facts.contains(*place) for place in facts.bounding_points * 0.999)
    assert not any(facts.contains(*place) for place in facts.bounding_points * 1.001)


@pytest.mark.parametrize("name", SHAPES)
def test_a_round_shape_has_no_rims_along_u(name) -> None:
    placement = Object(
        sample("bricks", 8), name, tiling=(2.0, -3.0), shift=(0.25, 0.5)
    ).resolved.placement()

    def clipped_at(u: float, v: float, edge: Any = "clip") -> bool:
        uv = Vec2(u, v) * placement.tiling + placement.shift
        return is_clipped(uv, placement, Variant(shape=name, edge=edge))

    assert not clipped_at(0.5, 0.5)
    assert clipped_at(1.1, 0.5) == clipped_at(-0.1, 0.5) == (not SHAPES[name].round)
    assert clipped_at(0.5, 1.1)
    assert clipped_at(0.5, -0.1)
    assert not clipped_at(1.1, 1.1, "wrap")


@pytest.mark.parametrize("name", SHAPES)
def test_the_width_along_u_is_that_of_the_facts(name) -> None:
    variant = Variant(shape=name)
    intersection = intersect_shape(ShapeRay(Vec3(0.1, 0.1, 3.0), Vec3(0.0, -0.01, -1.0)), variant)
    around = (
        np.hypot(intersection.position.x, intersection.position.z) * 2.0
        if SHAPES[name].round
        else 1.0
    )
    along_u = np.linalg.norm([*chart(intersection.position, intersection.normal, variant).along_u])
    assert along_u == pytest.approx(SHAPES[name].width * around, rel=1e-5)


def test_a_page_contains_flat_shapes_and_bounding_spheres() -> None:
    scene = Scene((Object(sample("bricks", 8)),))
    shapes = manifest(scene, sources_of(scene), None)["shapes"]
    assert {name for name, each in shapes.items() if each["flat"]} == {"plane"}
    radii = {name: each["radius"] for name, each in shapes.items()}
    assert radii == {"plane": 0.71, "box": 0.87, "sphere": 0.5, "cylinder": 0.71}
