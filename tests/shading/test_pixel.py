"""Whole pixels against pictures computed in float64 from rays, planes and formulas."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang.llvm import print_llvm
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Map, Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import program_of
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Scene, directional, placed, point, rotated, spot
from basrelief.shading.brdf import Shading
from basrelief.techniques import TECHNIQUES
from helpers.synthetic import TRIPOD, map_of, matte, noise, normal_under_tripod, rays, unit

CPU = CpuEngine()
SIZE = (97, 61)
DARK = (0.0, 0.0, 0.0)


# --- reference in float64 -------------------------------------------------------------------------


def in_object(matrix: np.ndarray, origins, directions) -> tuple[np.ndarray, np.ndarray]:
    """Rays in object space; a distance along a ray is the same as in the world."""
    inverse = np.linalg.inv(matrix)
    return origins @ inverse[:3, :3].T + inverse[:3, 3], directions @ inverse[:3, :3].T


def heights(values) -> Material:
    return Material("made up", height=map_of(values))


def drawn(obj: Object, camera: LookAt, size=SIZE, **scene) -> Frame:
    scene = {"background": None, **scene}
    return render(Scene((obj,), camera=camera, **scene), size=size, samples=1, device=CPU)


SLANTED = LookAt((1.1, -1.4, 1.7), (0.05, -0.1, 0.0), (0.2, 0.3, 1.0), field_of_view=35.0)
PARALLEL = replace(SLANTED, orthographic_height=1.5)
CAMERAS = {"perspective": SLANTED, "orthographic": PARALLEL}

# The camera is moved with the object for these, so that the plane fills the picture.
TRANSFORMS = {
    "as it is": np.eye(4),
    "scaled": placed((0.3, -0.2, 0.5), 3.0),
    "stretched": placed((0.1, 0.2, -0.4), (1.6, 0.7, 0.35)),
    "turned and stretched": rotated("y", 40.0)
    @ rotated("x", -70.0)
    @ placed(scale=(0.5, 1.5, 2.5)),
    "mirrored": placed(scale=(-1.2, 0.8, 1.0)),
}


def camera_for(matrix: np.ndarray, camera: LookAt) -> LookAt:
    """A camera with about the same view of the transformed object as this one of the original."""
    stretch = matrix[:3, :3] / np.abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
    position = matrix[:3, :3] @ np.array(camera.position) * 1.05 + matrix[:3, 3]
    target = matrix[:3, :3] @ np.array(camera.target) + matrix[:3, 3]
    tall = camera.orthographic_height
    size = np.linalg.norm(matrix[:3, :3], 2)
    return replace(
        camera,
        position=tuple(position),
        target=tuple(target),
        up=tuple(stretch @ np.array(camera.up)),
        orthographic_height=None if tall is None else tall * size,
    )


# --- constant height: the polygon, shifted --------------------------------------------------------

KNOWN = {
    "offset": {},
    "steep": {"steps": 8},
    "parallax_occlusion": {"min_steps": 8, "max_steps": 8},
    "relief": {"min_steps": 8, "max_steps": 8, "search_steps": 12},
}
HEIGHT = 0.625


def assert_shifted(obj: Object, camera: LookAt, height: float = HEIGHT) -> None:
    """Assert distance and uv of a plane at a height, within the polygon's outline."""
    frame = drawn(obj, camera)
    origins, directions = in_object(obj.resolved.transform, *rays(camera))
    polygon = origins - directions * (origins[..., 2:] / directions[..., 2:])
    outline = np.abs(polygon[..., :2]).max(axis=-1)
    within = outline < 0.499
    assert within.sum() > 150
    assert frame.hit[within].all()
    assert not frame.hit[outline > 0.501].any()
    # in object space the whole range is `scale` of the width of a tile, along u
    tiles = np.array(obj.resolved.tiling.tiles, np.float64)
    shift = (height - obj.resolved.reference_height) * obj.resolved.scale / abs(tiles[0])
    distance = (shift - origins[..., 2]) / directions[..., 2]
    points = origins + directions * distance[..., None]
    uv = np.stack([0.5 + points[..., 0], 0.5 - points[..., 1]], -1) * tiles + obj.shift
    np.testing.assert_allclose(frame.distance[within], distance[within], rtol=1e-4)
    np.testing.assert_allclose(frame.uv[within], uv[within], atol=2e-4 * np.abs(tiles).max())


@pytest.mark.parametrize("technique", KNOWN)
@pytest.mark.parametrize("reference_height", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("lens", CAMERAS)
def test_a_plane_of_one_height_is_the_polygon_shifted(technique, reference_height, lens) -> None:
    """C18, H6: depth and uv of the plane at (height − reference height) · scale."""
    obj = Object(
        heights(np.full((8, 12), HEIGHT)),
        technique=technique,
        settings=KNOWN[technique],
        scale=0.3,
        reference_height=reference_height,
        transform=np.eye(4),
    )
    assert_shifted(obj, CAMERAS[lens])


@pytest.mark.parametrize("name", TRANSFORMS)
@pytest.mark.parametrize("technique", ["offset", "relief"])
@pytest.mark.parametrize("lens", CAMERAS)
def test_the_relief_is_transformed_with_the_object(name, technique, lens) -> None:
    """C15: the relief is set in object space, so it is stretched with the object, without warp."""
    matrix = TRANSFORMS[name]
    obj = Object(
        heights(np.full((8, 12), HEIGHT)),
        technique=technique,
        settings=KNOWN[technique],
        scale=0.25,
        reference_height=0.75,
        transform=matrix,
    )
    assert_shifted(obj, camera_for(matrix, CAMERAS[lens]))


@pytest.mark.parametrize(
    ("tiling", "shift"),
    [((3, 1), (0, 0)), ((1, 3), (0.25, 0.5)), ((2, 5), (0, 0)), ((-2, 3), (0, 0.1)),
     ((2, -3), (-0.7, 0)), ((-1, -2), (0.2, 0.2))],
)  # fmt: skip
@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion"])
def test_the_offset_is_scaled_along_each_axis_of_the_tiling(tiling, shift, technique) -> None:
    """W4, C4: also mirrored; the depth is relative to the tile's width along u."""
    obj = Object(
        heights(np.full((5, 9), HEIGHT)),
        technique=technique,
        settings=KNOWN[technique],
        scale=0.4,
        tiling=tiling,
        shift=shift,
        transform=TRANSFORMS["turned and stretched"],
    )
    assert_shifted(obj, camera_for(obj.resolved.transform, SLANTED))


@pytest.mark.parametrize("technique", ["offset", "parallax_occlusion"])
@pytest.mark.parametrize("projection", ["biased", "limited"])
def test_a_biased_or_limited_ray_has_the_depth_of_its_height(technique, projection) -> None:
    """C18 with C6 and C8: uv along the projected ray, depth along the true one."""
    obj = Object(
        heights(np.full((8, 12), HEIGHT)),
        technique=technique,
        settings=KNOWN[technique],
        projection=projection,
        bias=0.42,
        scale=0.3,
        reference_height=1.0,
        transform=np.eye(4),
    )
    frame = drawn(obj, SLANTED)
    origins, directions = rays(SLANTED)
    polygon = origins - directions * (origins[..., 2:] / directions[..., 2:])
    within = np.abs(polygon[..., :2]).max(axis=-1) < 0.499
    cosine = -directions[..., 2]
    travel = -directions[..., :2]
    if projection == "biased":
        travel = travel / (cosine + 0.42)[..., None]
    shift = 0.3 * (HEIGHT - 1.0)
    uv = np.stack([0.5 + polygon[..., 0], 0.5 - polygon[..., 1]], -1)
    uv = uv + shift * travel * np.array([1.0, -1.0])
    distance = (shift - origins[..., 2]) / directions[..., 2]
    np.testing.assert_allclose(frame.uv[within], uv[within], atol=1e-4)
    np.testing.assert_allclose(frame.distance[within], distance[within], rtol=1e-4)


# --- a ramp from all sides ------------------------------------------------------------------------

SIDES = {
    "right": (1.8, 0.1, 1.5),
    "left": (-1.8, -0.1, 1.5),
    "top": (0.1, 1.8, 1.5),
    "bottom": (-0.1, -1.8, 1.5),
    "aslant": (-1.1, 1.3, 1.2),
}


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("slope", [(0.8, 0.0), (0.0, 0.8), (-0.5, 0.3)])
def test_a_ramp_is_a_tilted_plane_from_every_side(side, slope) -> None:
    """The exact intersection of ray and plane; a wrong sign in x or y shows as the whole offset."""
    columns, rows = 40, 24
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    a, b = slope
    scale = 0.12
    obj = Object(
        heights(0.5 + a * (u - 0.5) + b * (v - 0.5)),
        technique="parallax_occlusion",
        settings={"min_steps": 12, "max_steps": 24},
        scale=scale,
        reference_height=1.0,
        edge="clamp",
        transform=np.eye(4),
    )
    camera = LookAt(SIDES[side], up=(0.0, 0.0, 1.0), field_of_view=26.0)
    frame = drawn(obj, camera)
    origins, directions = rays(camera)
    # z = scale · (0.5 + a x − b y − 1) with u − ½ = x, v − ½ = −y
    normal = np.array([-scale * a, scale * b, 1.0])
    distance = (scale * (0.5 - 1.0) - origins @ normal) / (directions @ normal)
    points = origins + directions * distance[..., None]
    uv = np.stack([0.5 + points[..., 0], 0.5 - points[..., 1]], -1)
    polygon = origins - directions * (origins[..., 2:] / directions[..., 2:])
    entry = np.stack([0.5 + polygon[..., 0], 0.5 - polygon[..., 1]], -1)
    # the surface is level beyond the outer texel centres
    inner = [0.5 / columns, 0.5 / rows]
    ours = frame.hit.copy()
    # the march also reads one step beyond the hit
    for place in (entry, uv, uv + (uv - entry) / 2):
        ours &= (place > inner).all(axis=-1) & (place < 1 - np.array(inner)).all(axis=-1)
    assert ours.mean() > 0.1
    np.testing.assert_allclose(frame.uv[ours], uv[ours], atol=1e-4)
    np.testing.assert_allclose(frame.distance[ours], distance[ours], rtol=1e-4)
    assert np.abs(uv - entry)[ours].max() > 0.03


WALLS = {
    # the hill, the axis of uv that crosses its edge, the hill's side on it, where the viewer stands
    "right": (lambda u, v: u > 0.6, 0, +1, "right"),
    "left": (lambda u, v: u < 0.4, 0, -1, "left"),
    "bottom": (lambda u, v: v > 0.6, 1, +1, "bottom"),
    "top": (lambda u, v: v < 0.4, 1, -1, "top"),
}


@pytest.mark.parametrize("hill", WALLS)
def test_a_hill_hides_the_ground_behind(hill) -> None:
    """A hill on the right hides the ground to the left of it from a viewer on the right."""
    form, axis, sign, hiding = WALLS[hill]
    columns, rows = 90, 60
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    obj = Object(
        heights(form(u, v).astype(np.float32)),
        technique="relief",
        settings={"min_steps": 60, "max_steps": 60},
        scale=0.1,
        edge="clamp",
        transform=np.eye(4),
    )
    away = np.array(
        {"right": (1, 0, 0), "left": (-1, 0, 0), "top": (0, 1, 0), "bottom": (0, -1, 0)}[hiding]
    )

    def ground(direction) -> np.ndarray:
        """Distances in uv from the hill's foot to the ground seen at 45 degrees."""
        position = tuple(2.0 * direction + np.array([0.0, 0.0, 2.0]))
        frame = drawn(obj, LookAt(position, up=(0.0, 0.0, 1.0), orthographic_height=0.8))
        along = frame.uv[frame.hit][:, axis]
        foot = 0.6 if sign > 0 else 0.4
        return (foot - along) * sign

    hidden, seen = ground(away), ground(-away)
    # at 45 degrees a wall of 0.1 hides 0.1 of ground, less a texel of its own slope
    assert not ((hidden > 0.03) & (hidden < 0.08)).any()
    assert ((seen > 0.03) & (seen < 0.08)).mean() > 0.02
    assert (hidden > 0.12).mean() > 0.1


# --- light on a bump ------------------------------------------------------------------------------

FRONT = LookAt((0.0, 0.0, 3.0), orthographic_height=0.8)
LIGHTS_FROM = {
    "right": directional(60.0, 0.0),
    "left": directional(-60.0, 0.0),
    "above": directional(0.0, 60.0),
    "below": directional(0.0, -60.0),
}
MATTE = Shading(ambient=(0.0, 0.0, 0.0))


def bump(u, v) -> np.ndarray:
    """A hill in the middle of the map."""
    return np.exp(-((u - 0.5) ** 2 + (v - 0.5) ** 2) / 0.02)


def normals_of_bump(columns: int, rows: int, scale: float) -> np.ndarray:
    """The bump's unit normals, encoded with green up; from its derivatives, in float64."""
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    along_u = bump(u, v) * -2 * (u - 0.5) / 0.02 * scale
    along_v = bump(u, v) * -2 * (v - 0.5) / 0.02 * scale
    # a square tile: x is u, y is −v
    normal = unit(np.stack([-along_u, along_v, np.ones_like(u)], -1))
    return normal * 0.5 + 0.5


def bump_material(kind: str) -> Material:
    columns, rows = 36, 24
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    if kind == "heights":
        return heights(bump(u, v))
    return Material("made up", normal=map_of(normals_of_bump(columns, rows, 0.15)))


@pytest.mark.parametrize("kind", ["heights", "a normal map"])
@pytest.mark.parametrize("model", ["phong", "ggx"])
@pytest.mark.parametrize("light", LIGHTS_FROM)
@pytest.mark.parametrize("tiling", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_the_side_of_a_bump_that_faces_the_light_is_bright(kind, model, light, tiling) -> None:
    """In x and y of the picture, with normals from a map or from heights, mirrored or not."""
    obj = Object(
        bump_material(kind), technique="flat", scale=0.15, tiling=tiling, transform=np.eye(4)
    )
    frame = drawn(
        matte(obj),
        FRONT,
        (60, 60),
        lights=(LIGHTS_FROM[light],),
        shading=MATTE,
        shading_model=model,
    )
    shade = frame.color[:, :, 1]
    # the two halves of a band across the bump, on each axis
    left, right = shade[24:36, 18:28].mean(), shade[24:36, 32:42].mean()
    upper, lower = shade[18:28, 24:36].mean(), shade[32:42, 24:36].mean()
    along_x = {"right": 1, "left": -1}.get(light, 0)
    along_y = {"above": 1, "below": -1}.get(light, 0)
    if along_x:
        assert (right - left) * along_x > 0.1
        assert abs(upper - lower) < 0.02
    else:
        assert (upper - lower) * along_y > 0.1
        assert abs(right - left) < 0.02


@pytest.mark.parametrize(
    "matrix", [rotated("z", 90.0), rotated("z", 180.0), placed(scale=(-1, 1, 1))]
)
def test_a_rotated_bump_is_lit_from_the_same_side(matrix) -> None:
    obj = Object(bump_material("a normal map"), transform=matrix)
    frame = drawn(matte(obj), FRONT, (60, 60), lights=(LIGHTS_FROM["right"],), shading=MATTE)
    shade = frame.color[:, :, 1]
    assert shade[24:36, 32:42].mean() - shade[24:36, 18:28].mean() > 0.1
    assert abs(shade[18:28, 24:36].mean() - shade[32:42, 24:36].mean()) < 0.02


def test_lambert_on_a_normal_map_is_its_cosine() -> None:
    """One pixel a texel: base colour · intensity · n·l, for a light from the upper right."""
    columns, rows = 36, 24
    encoded = normals_of_bump(columns, rows, 0.1)
    material = Material(
        "made up",
        normal=map_of(encoded),
        base_color=map_of(np.full((1, 1, 3), 0.75)),
    )
    # one tile and a half down, so that texels are square on the object
    obj = Object(material, tiling=(1.0, 1.5), transform=np.eye(4))
    camera = LookAt((0.0, 0.0, 3.0), orthographic_height=1.0)
    light = directional(50.0, 25.0, intensity=2.0)
    frame = drawn(
        matte(obj),
        camera,
        (columns, columns),
        lights=(light,),
        shading=MATTE,
        shading_model="phong",
    )
    cosine = (encoded * 2 - 1) @ -np.array([*light.direction], np.float64)
    wanted = 0.75 * 2.0 * np.maximum(cosine, 0.0)
    wanted = np.concatenate([wanted, wanted[: columns - rows]])
    np.testing.assert_allclose(frame.color[:, :, 0], wanted, atol=2e-3)


@pytest.mark.parametrize("name", TRANSFORMS)
def test_normals_are_those_of_the_transformed_relief(name) -> None:
    """C15: a stretched ramp is lit as the tilted plane that it has become."""
    matrix = TRANSFORMS[name]
    u, v = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(32) + 0.5) / 32)
    scale, a, b = 0.5, 0.6, -0.3
    ramp = heights(0.5 + a * (u - 0.5) + b * (v - 0.5))
    obj = Object(ramp, technique="flat", scale=scale, edge="clamp", transform=matrix)
    light = directional(35.0, 50.0)
    camera = camera_for(matrix, SLANTED)
    frame = drawn(matte(obj), camera, lights=(light,), shading=MATTE, shading_model="phong")
    # two tangents of the ramp, transformed to the world; x is u and y is −v
    along = [matrix[:3, :3] @ side for side in ((1.0, 0.0, scale * a), (0.0, 1.0, -scale * b))]
    normal = unit(np.cross(*along)) * np.sign(np.linalg.det(matrix))
    wanted = 0.6 * max(float(normal @ -np.array([*light.direction], np.float64)), 0.0)
    inside = frame.hit & (np.abs(frame.uv - 0.5).max(axis=-1) < 0.4)
    assert inside.sum() > 100
    assert wanted > 0.05
    # coarse mip levels blend in the border, where the ramp ends
    assert np.median(frame.color[inside][:, 0]) == pytest.approx(wanted, abs=1e-3)


# --- parameters of the standard surface -----------------------------------------------------------

OVERHEAD = (directional(0.0, 0.0),)
"""A light that shines along the view of the camera FRONT."""


def shaded(material: Material, lights=(), shading=MATTE, **options) -> np.ndarray:
    """The linear colour of a uniform material that faces the camera."""
    model = options.pop("shading_model", "ggx")
    obj = Object(material, transform=np.eye(4), **options)
    frame = drawn(matte(obj), FRONT, (3, 5), lights=lights, shading=shading, shading_model=model)
    assert frame.hit.all()
    assert np.ptp(frame.color, axis=(0, 1)).max() < 1e-5
    return frame.color[2, 1, :3]


def shading_normal(material: Material, **options) -> np.ndarray:
    """The unit normal that a white material is shaded with, by Lambert's cosines."""
    return normal_under_tripod(shaded(material, TRIPOD, shading_model="phong", **options))


def white(**maps) -> Material:
    return Material("made up", base_color=map_of(np.ones((1, 1, 3))), **maps)


def normal_map(*normal: float) -> dict[str, Map]:
    """A map of one normal, stored as 0 to 1."""
    return {"normal": map_of((np.array(normal) * 0.5 + 0.5).reshape(1, 1, 3))}


@pytest.mark.parametrize("strength", [None, 0.0, 0.25, 1.0, 1.5])
def test_normal_strength_scales_the_slope_of_the_map(strength) -> None:
    """x and y times the strength, z as stored, then normalised; 1 by default."""
    times = 1.0 if strength is None else strength
    surface_parameters = {} if strength is None else {"normal_strength": strength}
    wanted = unit([0.36 * times, -0.48 * times, 0.8])
    found = shading_normal(
        white(**normal_map(0.36, -0.48, 0.8)), surface_parameters=surface_parameters
    )
    np.testing.assert_allclose(found, wanted, atol=2e-4)


@pytest.mark.parametrize("z", [0.0, -0.5])
def test_a_stored_normal_points_out_of_the_surface(z: float) -> None:
    """Its z is at least 0.001: a map of (½, ½, ½) gives the surface's own normal."""
    # ½ is stored as 32768 ÷ 65535, which stands for 1 ÷ 65535
    least = unit([1.0 / 65535.0, 1.0 / 65535.0, 1e-3])
    np.testing.assert_allclose(shading_normal(white(**normal_map(0.0, 0.0, z))), least, atol=2e-4)


@pytest.mark.parametrize(("mapped", "stored"), [(None, 0.8), (0.6, 0.6)])
@pytest.mark.parametrize("factor", [None, 1.0, 0.75, 0.4])
def test_roughness_is_the_maps_times_the_factor(mapped, stored: float, factor) -> None:
    """0.8 without a map. Black and lit along the view, π · D · V · F is 0.01 ÷ roughness⁴."""
    maps = {} if mapped is None else {"roughness": map_of([[mapped]])}
    material = Material("made up", base_color=map_of(np.zeros((1, 1, 3))), **maps)
    surface_parameters = {} if factor is None else {"roughness": factor}
    highlight = 0.01 / (stored * (1.0 if factor is None else factor)) ** 4
    found = shaded(material, OVERHEAD, surface_parameters=surface_parameters)
    np.testing.assert_allclose(found, highlight, rtol=3e-4)


@pytest.mark.parametrize(("mapped", "stored"), [(None, 0.0), (0.7, 0.7)])
@pytest.mark.parametrize("factor", [None, 0.5, 0.0])
def test_metallic_is_the_maps_times_the_factor(mapped, stored: float, factor) -> None:
    """0 without a map. Of roughness 0.8 and lit along the view, so that F is that of head-on."""
    base = np.array([0.9, 0.5, 0.1])
    maps = {} if mapped is None else {"metallic": map_of([[mapped]])}
    material = Material("made up", base_color=map_of(base.reshape(1, 1, 3)), **maps)
    surface_parameters = {} if factor is None else {"metallic": factor}
    metal = stored * (1.0 if factor is None else factor)
    fresnel = 0.04 * (1.0 - metal) + base * metal
    wanted = base * (1.0 - metal) * (1.0 - fresnel) + fresnel * 0.25 / 0.8**4
    np.testing.assert_allclose(
        shaded(material, OVERHEAD, surface_parameters=surface_parameters), wanted, atol=2e-4
    )


@pytest.mark.parametrize(("mapped", "stored"), [(None, 1.0), (0.3, 0.3)])
@pytest.mark.parametrize("strength", [None, 1.0, 0.5, 0.0])
def test_occlusion_of_ambient_light_is_scaled_by_its_strength(mapped, stored, strength) -> None:
    """1 without a map; with one, from 1 at strength 0 to its value at strength 1."""
    maps = {} if mapped is None else {"occlusion": map_of([[mapped]])}
    surface_parameters = {} if strength is None else {"occlusion": strength}
    ambient = Shading(ambient=(0.8, 0.4, 0.2))
    share = 1.0 - (1.0 - stored) * (1.0 if strength is None else strength)
    found = shaded(white(**maps), shading=ambient, surface_parameters=surface_parameters)
    np.testing.assert_allclose(found, np.array([0.8, 0.4, 0.2]) * share, atol=1e-4)


def test_colours_are_maps_times_factors() -> None:
    """Base colour in ambient light, and emission; each channel has its factor."""
    material = Material(
        "made up",
        base_color=map_of(np.array([[[0.25, 0.5, 0.75]]])),
        emission=map_of(np.array([[[0.5, 0.125, 2.0]]])),
    )
    surface_parameters = {"base_color": (1.0, 0.5, 2.0), "emission": (3.0, 1.0, 0.25)}
    found = shaded(
        material, shading=Shading(ambient=(1.0, 1.0, 0.5)), surface_parameters=surface_parameters
    )
    wanted = [0.25 + 1.5, 0.25 + 0.125, 0.75 + 0.5]
    np.testing.assert_allclose(found, wanted, atol=1e-4)
    # without maps: light grey, no emission
    plain = shaded(
        Material("nothing"),
        shading=Shading(ambient=(1.0, 0.5, 0.1)),
        surface_parameters=surface_parameters,
    )
    np.testing.assert_allclose(plain, [0.6, 0.15, 0.12], atol=1e-5)


# --- the offset applies to every map and light ----------------------------------------------------

LAMPS = {
    "directional": directional(-30.0, 40.0, (0.9, 0.8, 1.0), 1.3),
    "point": point((0.4, 0.5, 0.6), (1.0, 0.7, 0.5), 0.6),
    "spot": spot((-0.5, 0.2, 0.9), (0.1, 0.0, 0.0), intensity=1.5, angle=50.0),
}
VARIED = {
    "base_color": {"base_color": map_of(noise(1))},
    "normal": {"normal": map_of(noise(2) * [0.5, 0.5, 0.0] + [0.2, 0.2, 0.95])},
    "occlusion": {"occlusion": map_of(noise(3, channels=1))},
    "roughness": {"roughness": map_of(noise(4, channels=1))},
    "metallic": {"metallic": map_of(noise(5, channels=1))},
    "emission": {"emission": map_of(noise(6))},
    "opacity": {"base_color": map_of(noise(1)), "opacity": map_of(noise(7, channels=1))},
}


def pictures_of_the_shift(maps, lights, shading) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours of a relief of height ½, of a flat plane at its depth, and of one at the polygon.

    In parallel projection, so that a pixel covers as much of each.
    """
    matrix = TRANSFORMS["turned and stretched"]
    camera = camera_for(matrix, PARALLEL)
    material = Material("made up", height=map_of(np.full((24, 36), 0.5)), **maps)
    common = {"scale": 0.25, "tiling": (2.0, 3.0), "shift": (0.1, 0.3)}
    steps = {"min_steps": 8, "max_steps": 8}
    relief = Object(
        material, technique="parallax_occlusion", settings=steps, transform=matrix, **common
    )
    lowered = matrix @ placed((0.0, 0.0, -0.5 * 0.25 / 2.0))
    still = [Object(material, technique="flat", transform=m, **common) for m in (lowered, matrix)]
    frames = [
        drawn(each, camera, lights=lights, shading=shading, background=DARK)
        for each in (relief, *still)
    ]
    both = frames[0].hit & frames[1].hit & frames[2].hit
    assert both.sum() > 100
    return tuple(frame.color[both] for frame in frames)  # type: ignore[return-value]


@pytest.mark.parametrize("what", VARIED)
def test_the_offset_acts_in_every_map(what) -> None:
    """C5: each map, varied alone, is read at the displaced uv."""
    relief, there, polygon = pictures_of_the_shift(
        VARIED[what], tuple(LAMPS.values()), Shading(ambient=(0.3, 0.3, 0.3))
    )
    np.testing.assert_allclose(relief, there, atol=5e-3)
    assert np.abs(relief - polygon).max() > 0.05


@pytest.mark.parametrize("lamp", LAMPS)
def test_the_offset_acts_in_every_light(lamp) -> None:
    """C17: lights illuminate the displaced point, not the polygon."""
    maps = {**VARIED["base_color"], **VARIED["roughness"]}
    relief, there, polygon = pictures_of_the_shift(maps, (LAMPS[lamp],), MATTE)
    np.testing.assert_allclose(relief, there, atol=5e-3)
    assert np.abs(relief - polygon).max() > 0.05


@pytest.mark.parametrize("model", ["phong", "ggx"])
def test_lights_add_up_and_ambient_counts_once(model) -> None:
    """C17, W10: the sum of the lights alone, plus ambient light and emission once."""
    material = replace(sample("bricks", 64), emission=map_of(noise(6, (64, 64))))
    obj = Object(material, technique="relief")
    camera = LookAt((0.6, 1.2, 1.3), field_of_view=35.0)
    more = (*LAMPS.values(), point((-0.6, 0.3, 0.2), intensity=0.4, falloff=1.0))

    def color(lights, shading=None) -> np.ndarray:
        chosen = {} if shading is None else {"shading": shading}
        return drawn(obj, camera, lights=lights, shading_model=model, **chosen).color[:, :, :3]

    unlit_color = color(())
    assert unlit_color.max() > 0.1
    alone = sum(color((light,)) - unlit_color for light in more)
    np.testing.assert_allclose(color(more), unlit_color + alone, atol=2e-5)
    unlit = Shading(ambient=(0.0, 0.0, 0.0))
    assert color((), unlit).max() < unlit_color.max()


# --- curved shapes --------------------------------------------------------------------------------


def on_round(
    shape: str, point: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Normal, ∂P/∂u, ∂P/∂v and uv of a point of the unit-wide sphere or cylinder's side."""
    x, y, z = np.moveaxis(point, -1, 0)
    u = 0.5 + np.arctan2(x, z) / (2 * np.pi)
    along_u = 2 * np.pi * np.stack([z, 0 * x, -x], -1)
    if shape == "cylinder":
        normal = unit(np.stack([x, 0 * y, z], -1))
        return (
            normal,
            along_u,
            np.broadcast_to([0.0, -1.0, 0.0], point.shape),
            np.stack([u, 0.5 - y], -1),
        )
    ring = np.hypot(x, z)
    v = np.arctan2(ring, y) / np.pi
    along_v = np.pi * np.stack([x / ring * y, -ring, z / ring * y], -1)
    return unit(point), along_u, along_v, np.stack([u, v], -1)


def round_hits(shape: str, camera: LookAt) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Intersections of rays with the sphere or infinite cylinder: distance, point, direction."""
    origins, directions = rays(camera)
    keep = np.array([1.0, 0.0, 1.0]) if shape == "cylinder" else np.ones(3)
    o, d = origins * keep, directions * keep
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - 0.25
    with np.errstate(invalid="ignore"):
        distance = (-b - np.sqrt(b * b - a * c)) / a
    return distance, origins + directions * distance[..., None], directions


def round_exits(shape: str, camera: LookAt) -> np.ndarray:
    """Distances at which rays leave the sphere or the closed cylinder."""
    origins, directions = rays(camera)
    keep = np.array([1.0, 0.0, 1.0]) if shape == "cylinder" else np.ones(3)
    o, d = origins * keep, directions * keep
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - 0.25
    with np.errstate(invalid="ignore"):
        t_exit = (-b + np.sqrt(b * b - a * c)) / a
    if shape == "sphere":
        return t_exit
    caps = (np.copysign(0.5, directions[..., 1]) - origins[..., 1]) / directions[..., 1]
    return np.minimum(t_exit, caps)


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
@pytest.mark.parametrize("reference_height", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("tiling", [(4.0, 2.0), (3.0, -1.0), (-2.0, 5.0)])
def test_on_round_shapes_the_ray_is_traced_in_the_tangent_plane(
    shape, reference_height, tiling
) -> None:
    """C19: with the tangent frame of each point, and everywhere the depth of the widest tile."""
    scale = 0.15
    obj = Object(
        heights(np.full((6, 10), HEIGHT)),
        shape=shape,
        technique="parallax_occlusion",
        settings=KNOWN["parallax_occlusion"],
        scale=scale,
        reference_height=reference_height,
        tiling=tiling,
    )
    camera = LookAt((0.9, 0.7, 1.6), field_of_view=36.0)
    frame = drawn(obj, camera)
    distance, points, directions = round_hits(shape, camera)
    normal, along_u, along_v, uv = on_round(shape, points)
    cosine = -(directions * normal).sum(-1)
    # not at the outline, where rounding of the point changes the ray strongly
    ours = np.isfinite(distance) & (cosine > 0.2) & (np.abs(points[..., 1]) < 0.49)
    assert ours.mean() > 0.1
    assert frame.hit[ours].all()
    tiles = np.array(tiling)
    along_u, along_v = along_u / tiles[0], along_v / tiles[1]
    width, height = (np.linalg.norm(w, axis=-1) for w in (along_u, along_v))
    view_x = -(directions * along_u).sum(-1) / width
    view_y = (directions * along_v).sum(-1) / height
    deep = scale * np.pi / abs(tiles[0])
    travel = -deep * np.stack([view_x / width, -view_y / height], -1) / cosine[..., None]
    wanted = uv * tiles + travel * (reference_height - HEIGHT)
    away = np.abs(frame.uv - wanted)
    # the seam, where u jumps by its whole range, is at the back
    assert away[ours].max() < 1e-3
    deeper = distance + (reference_height - HEIGHT) * deep / cosine
    # clamped to the shape and to the shell of a raised relief around it
    shell = (1 - reference_height) * deep
    t_exit = round_exits(shape, camera)
    deeper = np.clip(deeper, distance - np.sqrt(shell * (1 + shell)), t_exit)
    np.testing.assert_allclose(frame.distance[ours], deeper[ours], rtol=2e-4)


def test_errors_on_a_cylinder_grow_with_the_scale() -> None:
    """C19: the tangent plane departs from the curve faster than linearly in the depth."""
    camera = LookAt((0.0, 0.2, 2.5), field_of_view=26.0)
    origins, directions = rays(camera)
    errors = []
    for scale in (0.02, 0.04, 0.08, 0.16):
        obj = Object(
            heights(np.full((6, 10), HEIGHT)),
            shape="cylinder",
            technique="parallax_occlusion",
            settings=KNOWN["parallax_occlusion"],
            scale=scale,
            tiling=(3.0, 1.0),
        )
        frame = drawn(obj, camera)
        deep = (1 - HEIGHT) * scale * np.pi / 3
        with np.errstate(invalid="ignore"):
            points = origins + directions * frame.distance[..., None]
            radius = np.hypot(points[..., 0], points[..., 2])
        side = frame.hit & (np.abs(points[..., 0]) < 0.4) & (np.abs(points[..., 1]) < 0.45)
        assert side.mean() > 0.1
        errors.append(np.abs(radius - (0.5 - deep))[side].max())
    assert errors[0] < 1e-3
    assert all(more > 2.5 * less for less, more in pairwise(errors))


# --- the box --------------------------------------------------------------------------------------

FACES = {
    "front": ((0, 0, 3), (0, 1, 0)),
    "back": ((0, 0, -3), (0, 1, 0)),
    "right": ((3, 0, 0), (0, 1, 0)),
    "left": ((-3, 0, 0), (0, 1, 0)),
    "top": ((0, 3, 0), (0, 0, -1)),
    "bottom": ((0, -3, 0), (0, 0, 1)),
}


@pytest.mark.parametrize("face", FACES)
def test_each_face_of_the_box_shows_the_whole_texture(face) -> None:
    """G11: upright, not mirrored, over the whole face."""
    position, up = FACES[face]
    color = noise(8, (20, 30))
    material = Material("made up", base_color=map_of(color))
    obj = Object(material, shape="box", transform=placed(scale=(1, 1, 1)))
    camera = LookAt(position, up=up, orthographic_height=1.0)
    frame = drawn(obj, camera, (30, 30), lights=(), shading=Shading(ambient=(1.0, 1.0, 1.0)))
    assert frame.hit.all()
    u, v = np.meshgrid((np.arange(30) + 0.5) / 30, (np.arange(30) + 0.5) / 30)
    np.testing.assert_allclose(frame.uv, np.stack([u, v], -1), atol=1e-6)
    # columns match the texels; the 20 rows of the map lie between the 30 of the picture
    rows = np.array([1 + 3 * k for k in range(10)])
    wanted = (color[2 * np.arange(10)] + color[2 * np.arange(10) + 1]) / 2
    np.testing.assert_allclose(frame.color[rows][:, :, :3], wanted, atol=1e-3)


# --- what is in a program -------------------------------------------------------------------------

PARALLAX = {
    "corners", "faded_relief", "object_height_range", "height_lod", "relief_ray",
    "relief_interval", "trace", "max_shell_distance", "offset_per_height", "sharp", "height_under",
    "surface_height", "march", "march_to_end", "chord", "at", "height_at", "hit_at", "t_at",
    "steps_by_angle", "step_count_by_angle", "step_count", "shifted", "full", "biased", "limited",
    "grid_line", "cone_reach",
    # `texel` is also the name of an intrinsic
    *(name for name in TECHNIQUES if name != "texel"),
}  # fmt: skip


def functions(obj: Object, model: str = "ggx") -> set[str]:
    """The names of all functions in the WGSL and LLVM texts of an object's program."""
    program = program_of(obj.resolved, Scene((obj,), shading_model=model))
    wgsl = print_wgsl(program.module, program.edge)
    llvm = print_llvm(program.module, 8)
    names = set(re.findall(r"\bfn (\w+)\(", wgsl))
    names |= set(re.findall(r"define [^@]*@\"?([\w.]+)", llvm))
    # LLVM's read of four texels has a name for each kind of map
    return {"corners" if name.startswith("corners") else name for name in names}


def without(material: Material, *kinds: str) -> Material:
    return replace(material, **dict.fromkeys(kinds))


@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_a_material_without_heights_has_no_parallax_code(shape) -> None:
    """C3."""
    material = replace(without(sample("tiles", 16), "height"), depth=None)
    obj = Object(material, shape=shape)
    assert not functions(obj) & PARALLAX
    text = print_wgsl(program_of(obj.resolved).module, "wrap")
    assert "texture_2d<f32>" not in text
    assert "ReliefParameters" not in text


def test_an_object_drawn_flat_has_no_parallax_code() -> None:
    """C3; the programs of the other techniques have all of it, so the names in PARALLAX exist."""
    material = sample("tiles", 16)
    assert not functions(Object(material, technique="flat")) & PARALLAX
    found: set[str] = set()
    for technique in TECHNIQUES:
        for projection in ("full", "biased", "limited"):
            found |= functions(Object(material, technique=technique, projection=projection))
    assert found >= PARALLAX - {"flat"}


READS = {
    "base_color": "base_color_of",
    "normal": "normal_of",
    "emission": "emission_of",
    "response": "response_of",
}


@pytest.mark.parametrize("what", READS)
def test_a_missing_map_costs_nothing(what) -> None:
    """A program without the map has neither its texture nor a read of it."""
    whole = replace(sample("tiles", 16), emission=map_of(noise(6, (16, 16))))
    kinds = {"response": ("occlusion", "roughness", "metallic"), "normal": ("normal", "height")}
    lacking = without(replace(whole, depth=None), *kinds.get(what, (what,)))
    for material, there in ((whole, True), (lacking, False)):
        module = program_of(Object(material).resolved).module
        # both engines print from this: the reader has all of its parameters or none
        (reading,) = (each for each in module.functions if each.name == READS[what])
        assert ("map" in reading.parameters) == bool(reading.parameters) == there
        text = print_wgsl(module, "wrap")
        assert f"fn {READS[what]}({'map: texture_2d' if there else ')'}" in text
        assert (f"{what}_map" in text) == there


def test_a_program_contains_only_its_shading_model_and_shape() -> None:
    material = sample("tiles", 16)
    names = functions(Object(material, shape="sphere"), "phong")
    assert {"intersect_sphere", "phong"} <= names
    assert (
        not {
            "intersect_plane",
            "intersect_box",
            "intersect_cylinder",
            "ggx",
            "smith",
            "trowbridge_reitz",
        }
        & names
    )


def test_changing_a_number_compiles_nothing() -> None:
    material = sample("tiles", 16)
    one = program_of(
        Object(material, technique="steep", settings={"steps": 5}, scale=0.01).resolved
    )
    other = program_of(
        Object(material, technique="steep", settings={"steps": 50}, scale=0.3, reference_height=0.2,
               tiling=(2, -3), transform=rotated("y", 3.0)).resolved
    )  # fmt: skip
    assert one.key == other.key
    assert program_of(Object(material, technique="relief").resolved).key != one.key


def test_scale_0_draws_flat_without_reads() -> None:
    """C2."""
    material = sample("bricks", 64)
    camera = LookAt((0.6, 1.2, 1.3), field_of_view=35.0)
    for technique in TECHNIQUES:
        frame = drawn(Object(material, technique=technique, scale=0.0), camera)
        still = drawn(Object(material, technique="flat", scale=0.0), camera)
        assert frame.reads.max() == 0
        np.testing.assert_array_equal(frame.uv, still.uv)
        np.testing.assert_array_equal(frame.color, still.color)


def test_reads_are_counted_where_the_object_is() -> None:
    """C11: 1 for an offset, at most N for a march, 0 in the background."""
    material = sample("bricks", 64)
    camera = LookAt((0.6, 1.2, 1.3), field_of_view=35.0)
    frame = drawn(Object(material, technique="steep", settings={"steps": 10}, scale=0.1), camera)
    assert not frame.hit.all()
    assert frame.reads[~frame.hit].max() == 0
    assert frame.reads[frame.hit].min() >= 1
    assert frame.reads.max() == 10
    frame = drawn(Object(material, technique="offset", scale=0.1), camera)
    assert set(np.unique(frame.reads[frame.hit])) == {1}
