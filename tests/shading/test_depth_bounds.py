"""Bounds of displaced depth, transparent objects, and normals on stretched tiles."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.lang import Vec3
from basrelief.material import Map, Material
from basrelief.rendering.render import render
from basrelief.scene import LYING, Object, Orbit, Scene, directional, placed, rotated
from basrelief.shading.brdf import Shading
from helpers.synthetic import matte

RNG = np.random.default_rng(8)
DARK = Shading(ambient=Vec3(0.0))
BUMPS = Map(RNG.random((24, 40, 1)).astype(np.float32), False, "bumps")


def plain(color, opacity: float = 1.0) -> Material:
    whole = np.array(color, np.float32).reshape(1, 1, 3)
    clear = Map(np.full((1, 1, 1), opacity, np.float32), False, "opacity")
    return Material("plain", base_color=Map(whole, False, "colour"), opacity=clear)


@pytest.mark.parametrize("shape", ["sphere", "box", "cylinder"])
@pytest.mark.parametrize(
    ("technique", "reference_height"), [("offset", 0.5), ("relief", 1.0), ("relief", 0.0)]
)
def test_depth_is_clamped_to_the_shape_and_its_shell(shape, technique, reference_height):
    """Between a shell as thick as the raised relief and the ray's exit from the shape."""
    obj = Object(
        Material("bumps", height=BUMPS),
        shape=shape,
        technique=technique,
        reference_height=reference_height,
        scale=0.2,
    )
    scene = Scene((obj,), Orbit(20.0, 25.0, 2.1))
    frame = render(scene, size=(96, 80), samples=1, device="cpu")
    depth = frame.distance[frame.hit]
    assert frame.hit.mean() > 0.1
    # each shape lies in a ball of radius √3/2; a tile is at most 3.2 wide
    reach = np.sqrt(3) / 2
    shell = (1.0 - reference_height) * 0.2 * 3.2
    raised = np.sqrt(shell * (2.0 + shell))
    assert depth.max() <= 2.1 + reach + 1e-3
    assert depth.min() >= 2.1 - reach - raised - 1e-3
    assert depth.min() > 0.0


@pytest.mark.parametrize("first", ["near", "far"])
def test_a_fully_transparent_object_hides_nothing(first):
    """C16: the object behind shows, in either order of the list."""
    near = Object(
        plain((1.0, 0.0, 0.0), 0.0), transform=placed((0.0, 0.3, 0.0)) @ LYING, technique="flat"
    )
    far = Object(plain((0.0, 0.0, 1.0)), transform=LYING, technique="flat")
    objects = (near, far) if first == "near" else (far, near)
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=0.5)
    frame = render(Scene(objects, camera), size=(8, 8), samples=1, device="cpu")
    assert (frame.color[:, :, 2] > 0.2).all()
    assert (frame.color[:, :, 0] < frame.color[:, :, 2]).all()
    np.testing.assert_allclose(frame.distance, 2.0, atol=1e-5)


@pytest.mark.parametrize("first", ["near", "far"])
def test_half_opacity_mixes_with_the_object_behind(first):
    near = Object(
        plain((1.0, 0.0, 0.0), 0.4), transform=placed((0.0, 0.3, 0.0)) @ LYING, technique="flat"
    )
    far = Object(plain((0.0, 0.0, 1.0)), transform=LYING, technique="flat")
    near, far = matte(near), matte(far)
    objects = (near, far) if first == "near" else (far, near)
    camera = Orbit(0.0, 90.0, 2.0, orthographic_height=0.5)
    light = (directional(0.0, 90.0),)
    scene = Scene(objects, camera, light, shading=DARK, shading_model="phong")
    color = render(scene, size=(8, 8), samples=1, device="cpu").color[4, 4]
    other = Scene((far,), camera, light, shading=DARK, shading_model="phong")
    alone = render(other, size=(8, 8), samples=1, device="cpu").color[4, 4]
    assert color[3] == 1.0
    np.testing.assert_allclose(color[:3], [0.4, 0.0, 0.6 * alone[2]], atol=1e-4)


@pytest.mark.parametrize(("columns", "rows"), [(64, 32), (32, 64), (48, 48)])
@pytest.mark.parametrize("shape", ["plane", "box"])
def test_normals_from_heights_are_those_of_the_relief(shape, columns, rows):
    """A ramp along v is lit as a tilted plane in the world, for maps of any proportions."""
    rise, scale = 0.5, 0.3
    ramp = np.linspace(0.25, 0.25 + rise, rows, dtype=np.float32)[:, None]
    heights = Map(np.repeat(ramp, columns, 1)[:, :, None], False, "ramp")
    obj = Object(Material("ramp", height=heights), shape, "flat", scale=scale, edge="clamp")
    light, eye = directional(0.0, 45.0), Orbit(0.0, 90.0, 3.0, orthographic_height=0.2)
    shading = DARK
    scene = Scene((matte(obj),), eye, (light,), shading=shading, shading_model="phong")
    seen = render(scene, size=(9, 9), samples=1, device="cpu").color[4, 4, 0]
    # over the tile the ramp rises by rise · scale tile widths, towards the lower edge (+z)
    length = min(1.0, rows / columns) if shape == "plane" else 1.0
    width = min(1.0, columns / rows) if shape == "plane" else 1.0
    slope = rise * rows / (rows - 1) * scale * width / length
    normal = np.array([0.0, 1.0, -slope]) / np.hypot(1.0, slope)
    towards = np.array([0.0, np.sqrt(0.5), np.sqrt(0.5)])
    assert seen == pytest.approx(0.6 * normal @ towards, rel=0.01)


def test_the_depth_of_a_rotated_object_is_bounded_too():
    obj = Object(
        Material("bumps", height=BUMPS),
        shape="box",
        technique="offset",
        scale=0.2,
        transform=rotated("y", 30.0) @ placed(scale=(2.0, 1.0, 0.5)),
    )
    frame = render(Scene((obj,), Orbit(10.0, 30.0, 4.0)), size=(64, 64), samples=1, device="cpu")
    assert (frame.distance[frame.hit] > 1.5).all()
    assert (frame.distance[frame.hit] < 6.0).all()
