"""`texel`, heights as columns, against closed forms and all walls along each ray in float64."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.engine.cpu import CpuEngine
from basrelief.errors import InputError
from basrelief.lang import HeightField, IVec2, Vec2, Vec3, shader, struct
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.lang.types import leaf_values
from basrelief.material import Material
from basrelief.measure.columns import intersect_columns
from basrelief.rendering.programs import program_of, values_of
from basrelief.scene import LookAt, Object, Scene, directional
from basrelief.shading.brdf import Shading
from basrelief.techniques import TECHNIQUES, Nothing, texel
from basrelief.techniques.columns import INSET, side_normal
from basrelief.techniques.ray import Ray
from helpers.rays import Fan, flat_ray, scattered
from helpers.synthetic import drawn, map_of, matte, on_plane, rays, unit

RANDOM = np.random.default_rng(5)
MAPS = {
    "steps": RANDOM.integers(0, 9, (16, 16)) / 8,
    "portrait": RANDOM.random((23, 7)),
    "one row": RANDOM.random((1, 9)),
    "one texel": np.array([[0.4]]),
    "flat": np.zeros((4, 6)),
    "top": np.ones((3, 5)),
}
CORNERS = 0.004
"""The share of rays that pass an edge within the rounding of float32."""


@struct
class TracedRay:
    """A ray, its hit, and the normal of the side that is hit."""

    uv: Vec2
    travel: Vec2
    hit_uv: Vec2
    height: float
    found: bool
    reads: int
    side: Vec2


@shader
def trace_columns(at: IVec2, fan: Fan, field: HeightField) -> TracedRay:
    """A random ray, traced by `texel`."""
    n = (at.y * 8192 + at.x) * 4 + fan.seed * 7919
    uv = Vec2(scattered(n), scattered(n + 1)) * 3.0 - 1.0
    travel = (Vec2(scattered(n + 2), scattered(n + 3)) * 2.0 - 1.0) * fan.reach
    hit = texel(field, Ray(uv, travel, 1.0, 1.0, 0.5), Nothing())
    side = side_normal(field, hit.uv, hit.height, travel)
    return TracedRay(uv, travel, hit.uv, hit.height, hit.found, hit.reads, side)


def traced_rays(engine: Any, heights: np.ndarray, edge: str, reach: float) -> dict[str, np.ndarray]:
    program = Program(trace_columns, edge=edge)
    values = {"fan": Fan(reach, 3), "field": HeightField([heights], edge)}
    planes = {k: v.ravel() for k, v in engine.run(program, values, (64, 64)).items()}
    pairs = {
        name: np.stack([planes[f"{name}.x"], planes[f"{name}.y"]], -1).astype(float)
        for name in ("uv", "travel", "hit_uv", "side")
    }
    return {**pairs, **{k: planes[k] for k in ("height", "found", "reads")}}


def assert_first_column(engine: Any, heights: np.ndarray, edge: str, reach: float) -> None:
    heights = np.asarray(heights, np.float32)
    got = traced_rays(engine, heights, edge, reach)
    wanted = intersect_columns(heights, got["uv"], got["travel"], edge)
    texels = np.array(heights.shape[::-1])
    late = np.abs((1.0 - got["height"]) - wanted.t)
    shifted = np.abs((got["hit_uv"] - wanted.uv) * texels).max(axis=1)
    rotated = (got["side"] != wanted.side).any(axis=1)
    wrong = (late > 1e-5) | (shifted > INSET + 1e-3) | rotated
    assert got["found"].all()
    assert wrong.mean() <= CORNERS, (
        f"{wrong.mean():.3%} wrong, {rotated.mean():.3%} of them rotated"
    )


# --- against all walls ----------------------------------------------------------------------------


@pytest.mark.parametrize("reach", [0.05, 0.8, 4.0])
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", MAPS)
def test_every_ray_hits_its_first_column(name: str, edge: str, reach: float) -> None:
    assert_first_column(CpuEngine(), MAPS[name], edge, reach)


@pytest.mark.gpu
@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("name", ["steps", "portrait"])
def test_every_ray_hits_its_first_column_on_the_gpu(name: str, edge: str) -> None:
    from basrelief.engine import choose_device

    assert_first_column(choose_device("gpu"), MAPS[name], edge, 0.8)


def test_the_reference_distinguishes_edges() -> None:
    """Clamped and repeated columns differ, so a wrong edge would fail the tests above."""
    heights = MAPS["steps"].astype(np.float32)
    got = traced_rays(CpuEngine(), heights, "wrap", 0.8)
    other = intersect_columns(heights, got["uv"], got["travel"], "clamp")
    assert (np.abs((1.0 - got["height"]) - other.t) > 1e-5).mean() > 0.1


# --- closed forms ---------------------------------------------------------------------------------

WALL = np.array([[0.0, 0.0, 0.75, 0.75], [0.0, 0.0, 0.75, 0.75]], np.float32)
"""Low on the left, high on the right, with a wall at u = ½; 4 × 2 texels."""


def hit_and_side(
    heights: np.ndarray, uv, travel, edge: str = "clamp", reference_height: float = 1.0
):
    field = HeightField([heights], edge)
    ray = flat_ray(uv, travel, reference_height)
    hit = texel(field, ray, Nothing())
    side = side_normal(field, hit.uv, hit.height, ray.travel)
    return hit, tuple(float(n) for n in side)


@given(st.floats(0.02, 0.24), st.floats(0.05, 0.95))
def test_the_hit_on_a_wall_has_the_height_of_the_ray(height: float, v: float) -> None:
    """A ray from u = ¼ that has `height` at u = ½; the wall faces −u."""
    hit, side = hit_and_side(WALL, (0.25, v), (0.25 / (1 - height), 0.0))
    assert float(hit.height) == pytest.approx(height, abs=1e-6)
    assert float(hit.uv.x) == pytest.approx(0.5 + INSET / 4, abs=1e-6)
    assert side == (-1.0, 0.0)
    assert hit.reads == 2


def test_the_hit_on_a_top_is_level() -> None:
    """At u = ½ the ray has height 0.8; a little further it reaches the top at 0.75."""
    hit, side = hit_and_side(WALL, (0.25, 0.5), (1.25, 0.1))
    assert float(hit.height) == 0.75
    assert float(hit.uv.x) == pytest.approx(0.25 + 1.25 * 0.25, abs=1e-6)
    assert side == (0.0, 0.0)


@pytest.mark.parametrize(
    ("travel", "side"),
    [((0.5, 0.0), (-1, 0)), ((-0.5, 0.0), (1, 0)), ((0.0, 0.5), (0, -1)), ((0.0, -0.5), (0, 1))],
)
def test_each_side_of_a_post_faces_the_ray(travel, side) -> None:
    post = np.zeros((5, 5), np.float32)
    post[2, 2] = 1.0
    start = np.array([0.5, 0.5]) - np.array(travel) * 0.6
    hit, faces = hit_and_side(post, start, travel)
    # the side is half a texel before the middle: 0.4 after the start, in t
    assert float(hit.height) == pytest.approx(1.0 - (0.6 - 0.2), abs=1e-6)
    assert faces == side


@pytest.mark.parametrize("reference_height", [0.0, 0.5])
def test_the_reference_height_is_where_the_ray_intersects_the_polygon(
    reference_height: float,
) -> None:
    """The same ray, given by its intersection at another height."""
    one, _ = hit_and_side(WALL, (0.25, 0.5), (0.4, 0.1))
    uv = (0.25 + 0.4 * (1 - reference_height), 0.5 + 0.1 * (1 - reference_height))
    other, _ = hit_and_side(WALL, uv, (0.4, 0.1), reference_height=reference_height)
    np.testing.assert_allclose([*other.uv, other.height], [*one.uv, one.height], atol=1e-6)


@pytest.mark.parametrize("travel", [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (1e-30, -1e-30)])
def test_straight_down_the_hit_is_the_column_below(travel) -> None:
    hit, side = hit_and_side(MAPS["steps"], (5 / 16, 9 / 16), travel)
    assert float(hit.height) == np.float32(MAPS["steps"][9, 5])
    assert side == (0.0, 0.0)
    assert hit.reads == 1


def test_the_cpu_computes_the_same_bits_as_python() -> None:
    field = HeightField([MAPS["portrait"]], "wrap")
    program = Program(trace_columns, edge="wrap")
    values = {"fan": Fan(0.8, 3), "field": field}
    planes = CpuEngine().run(program, values, (9, 7))
    for x, y in [(0, 0), (8, 6), (3, 2), (5, 5)]:
        one = trace_columns(IVec2(x, y), Fan(0.8, 3), field)
        assert [planes[name][y, x] for name, _ in program.planes] == [*leaf_values(one, TracedRay)]


# --- in a picture ---------------------------------------------------------------------------------

SCALE = 0.3
TOWN = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [0, 6, 6, 6, 0, 2, 0],
        [0, 6, 0, 0, 0, 4, 0],
        [0, 0, 0, 0, 0, 8, 0],
        [0, 3, 3, 0, 0, 0, 0],
    ]
) / 8  # fmt: skip
"""5 × 7 texels, different from every side."""
FROM = {
    "below": LookAt((0.3, -1.2, 1.3), (0.0, -0.05, -0.1), (0, 0, 1), orthographic_height=0.9),
    "the left, above": LookAt((-1.3, 0.8, 0.9), (0.1, 0.0, -0.1), (0, 0, 1), field_of_view=30.0),
}
LIGHTS = {"right": (0.8, 0.3, 0.6), "left": (-0.5, -0.6, 0.5)}
MATTE = Shading(ambient=Vec3(0.0))


def town(**options: Any) -> Object:
    material = Material("town", base_color=map_of(np.ones((1, 1, 3))), height=map_of(TOWN))
    options = {"technique": "texel", "scale": SCALE, "edge": "clip", **options}
    return Object(material, transform=np.eye(4), **options)


def lamp(towards) -> Any:
    x, y, z = towards
    return directional(np.degrees(np.arctan2(x, z)), np.degrees(np.arctan2(y, np.hypot(x, z))))


def travel_of(direction: np.ndarray) -> np.ndarray:
    """Travel of rays over the unit plane while they fall through the height range."""
    return direction[..., :2] * [1, -1] * SCALE / -direction[..., 2:]


def lit(camera: LookAt, towards, shadows: bool) -> tuple[np.ndarray, np.ndarray]:
    """Cosines on the sides that are hit, in float64, and the mask of pixels with a hit."""
    uv, _ = on_plane(camera)
    _, directions = rays(camera)
    shape = uv.shape[:2]
    start, travel = uv.reshape(-1, 2), travel_of(directions).reshape(-1, 2)
    hits = intersect_columns(TOWN, start, travel, "clamp")
    normals = np.column_stack([hits.side * [1, -1], 1 - np.abs(hits.side).sum(1)])
    light = unit(towards)
    shade = np.maximum(normals @ light, 0.0)
    if shadows:
        # the ray of the light, from where it enters at the top
        back = np.broadcast_to(travel_of(-light), travel.shape)
        before = hits.uv + hits.side * 1e-6
        lit_columns = intersect_columns(TOWN, before - back * hits.t[:, None], back, "clamp")
        shade = shade * (lit_columns.t >= hits.t - 1e-5)
    # both the polygon and the hit are within the outline
    places = np.concatenate([start, hits.uv], axis=1)
    visible = (places >= 0).all(1) & (places <= 1).all(1)
    return shade.reshape(shape), visible.reshape(shape)


@pytest.mark.parametrize("shadows", [False, True])
@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("camera", FROM)
def test_sides_are_lit_as_walls_and_cast_shadows(camera: str, light: str, shadows: bool) -> None:
    """For every pixel not at an edge: the cosine on the side that is hit, 0 in shadow."""
    frame = drawn(
        matte(town()),
        camera=FROM[camera],
        lights=(lamp(LIGHTS[light]),),
        shading=MATTE,
        shading_model="phong",
        shadows="hard" if shadows else "none",
        shadowing={"shadow_offset": 0.0},
        background=(0.0, 0.0, 0.0),
    )
    shade, visible = lit(FROM[camera], LIGHTS[light], shadows)
    assert (frame.hit != visible).mean() < 0.005
    both = frame.hit & visible
    error = np.abs(frame.color[:, :, 0] - shade)[both]
    assert both.sum() > 1000
    assert (error > 2e-3).mean() < 0.01, f"{(error > 2e-3).mean():.2%} of the pixels"


def test_tops_do_not_use_the_normals_of_the_heights() -> None:
    """Baked normals belong to the bilinear surface; a normal map of the material is still used."""
    assert "maps_normal" not in values_of(town().resolved, Scene((town(),)), (8, 8), CpuEngine())
    own = replace(town().material, normal=map_of(np.full((2, 2, 3), (0.6, 0.5, 0.9))))
    obj = replace(town(), material=own)
    assert "maps_normal" in values_of(obj.resolved, Scene((obj,)), (8, 8), CpuEngine())


def test_colours_are_whole_texels_nearby() -> None:
    """No pixel blends two adjacent colours, as the bilinear map of other techniques does."""
    colors = np.zeros((1, 4, 3))
    colors[0, ::2] = 0.8
    material = Material("pair", base_color=map_of(colors), height=map_of([[0.5, 0.5, 0.5, 0.5]]))
    camera = LookAt((0.0, 0.0, 3.0), orthographic_height=1.0)
    shades = {}
    for technique in ("texel", "steep"):
        obj = Object(material, technique=technique, edge="clamp", transform=np.eye(4))
        frame = drawn(
            obj, camera=camera, lights=(), shading=Shading(ambient=Vec3(1.0)), size=(60, 60)
        )
        shades[technique] = np.unique(np.round(frame.color[:, :, 0][frame.hit], 3))
    assert len(shades["texel"]) == 2
    assert len(shades["steep"]) > 10


def test_other_techniques_have_no_code_of_columns() -> None:
    """Functions of columns are only in programs of `texel`."""
    names = (
        "side_normal(", "column_top_at(", "column_top(", "grid_line(", "pixelated(",
        "shading_normal(normal: vec3f, relief_normal: vec3f",
    )  # fmt: skip
    for technique in TECHNIQUES.values():
        obj = town(technique=technique)
        program = program_of(obj.resolved, Scene((obj,), shadows="hard"))
        text = print_wgsl(program.module, program.edge)
        found = [name for name in names if f"fn {name}" in text]
        assert bool(found) == technique.columns, f"{technique.name}: {found}"


def test_heights_are_read_sharp() -> None:
    with pytest.raises(InputError, match="texel reads its heights sharp"):
        town(heights="smooth")
