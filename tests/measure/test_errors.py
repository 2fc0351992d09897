"""Truth and errors against closed forms, computed here in float64."""

from __future__ import annotations

import math
import sys
import types
from dataclasses import replace

import numpy as np
import pytest

from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.measure import colors
from basrelief.measure.errors import (
    Spread,
    depth_error,
    errors,
    flip,
    has_flip,
    missed,
    overshoot,
    uv_error,
)
from basrelief.measure.oracle import intersect_height_field
from basrelief.measure.timing import Timing, seconds_of
from basrelief.measure.truth import Truth, truth
from basrelief.measure.views import at_angle
from basrelief.rendering.frame import Frame, Image
from basrelief.rendering.render import render
from basrelief.scene import LookAt, Object, Scene
from helpers.synthetic import (
    SIZE,
    bilinear,
    drawn,
    map_of,
    noise,
    on_plane,
    rays,
    uniform_material,
)

SMALL = (40, 24)
TEXELS = 32
SCALE = 0.2


def level_ground(height: float, texels: int = TEXELS) -> Material:
    """A relief of constant height."""
    return Material("ground", height=map_of(np.full((texels, texels), height)))


def measured(material: Material, technique: str, angle: float, **options):
    """A technique's frame, and the truth of the scene in which `exact` draws the same."""
    options = {"scale": SCALE, **options}
    scene = at_angle(material, angle, SMALL, {"technique": technique, **options})
    true = truth(at_angle(material, angle, SMALL, {"technique": "exact", "scale": SCALE}), SMALL)
    return render(scene, size=SMALL, samples=1, device="cpu"), true


def assert_spread(spread: Spread, expected: float, within: float = 1e-3) -> None:
    """All rays have one error: median, percentile and worst are equal."""
    values = (spread.median, spread.percentile_99, spread.worst)
    np.testing.assert_allclose(values, expected, atol=within)


# --- the truth -----------------------------------------------------------------------------------


@pytest.mark.parametrize("reference_height", [1.0, 0.3])
def test_the_rays_of_the_truth_are_those_of_the_camera(reference_height) -> None:
    """B4: rays computed here, without a shader, hit the same points at the same distance."""
    camera = LookAt((0.4, -0.9, 0.8), (0.05, 0.0, 0.0), field_of_view=38.0)
    heights = noise(2, (24, 36), 1)
    obj = Object(
        Material("waves", height=map_of(heights)), technique="exact", scale=0.3,
        reference_height=reference_height, transform=np.eye(4),
    )  # fmt: skip
    true = truth(Scene((obj,), camera=camera), SIZE, device="cpu")
    uv, distance = on_plane(camera)
    _, directions = rays(camera)
    inside = ((uv >= 0.0) & (uv <= 1.0)).all(-1) & (distance > 0.0)
    np.testing.assert_array_equal(true.there, inside)
    # the travel is −direction.xy ÷ direction.z times the scale; on a plane of one tile, lengths
    # are those of uv, with v downwards
    along = directions[..., :2] / -directions[..., 2:] * 0.3
    travel = np.stack([along[..., 0], -along[..., 1]], -1)
    start = uv - travel * (1.0 - reference_height)
    field = np.asarray(heights[:, :, 0], np.float32)
    hits = intersect_height_field(field, start[inside], travel[inside])
    distances = np.linalg.norm((true.uv[inside] - hits.uv) * field.shape[::-1], axis=1)
    assert np.quantile(distances, 0.99) < 1e-3
    expected = (distance + (reference_height - true.height) * 0.3 / -directions[..., 2])[inside]
    np.testing.assert_allclose(true.distance[inside], expected, atol=1e-5)
    assert true.texels == (36, 24)
    assert true.wraps


@pytest.mark.parametrize("alpha", ["mask", "blend", "opaque"])
def test_what_is_cut_out_does_not_count(alpha: str) -> None:
    """Stripes of opacity along u: the object is seen where the opacity at the true hit is ½ or
    more, and `exact` misses nothing. `offset` puts the stripes elsewhere."""
    heights = noise(4, (24, 36), 1)
    stripes = np.where(np.arange(36) % 12 < 5, 0.0, 1.0)[None, :].repeat(24, axis=0)
    material = Material("stripes", height=map_of(heights), opacity=map_of(stripes))
    camera = LookAt((0.3, -0.9, 0.6), field_of_view=40.0)
    frames, options = {}, {"scale": 0.15, "alpha": alpha, "transform": np.eye(4)}
    for technique in ("exact", "offset"):
        obj = Object(material, technique=technique, reference_height=0.6, **options)
        frames[technique] = drawn(obj, camera=camera)
        true = truth(Scene((obj,), camera=camera), SIZE, device="cpu")
    whole = truth(
        Scene((Object(material, reference_height=0.6, **{**options, "alpha": "opaque"}),), camera),
        SIZE,
        device="cpu",
    )
    opacity = bilinear(stripes, whole.uv)[..., 0]
    expected = whole.there if alpha == "opaque" else whole.there & (opacity >= 0.5)
    # at the borders of stripes the picture's filter decides
    clear = np.abs(opacity - 0.5) > 0.35
    np.testing.assert_array_equal(true.there[clear], expected[clear])
    assert errors(frames["exact"], true).missed == 0.0
    assert errors(frames["offset"], true).missed > 0.02


def test_exact_equals_the_truth() -> None:
    """B4, in uv and in depth, with tiles of other proportions, tilted, and cut at their edges."""
    camera = LookAt((0.3, -0.9, 0.6), field_of_view=40.0)
    for options in ({}, {"tiling": (2.0, 3.0), "shift": (0.2, 0.1)}, {"edge": "clip"}):
        obj = Object(
            Material("waves", height=map_of(noise(4, (24, 36), 1))), technique="exact", scale=0.15,
            reference_height=0.6, transform=np.eye(4), **options,
        )  # fmt: skip
        true = truth(Scene((obj,), camera=camera), SIZE, device="cpu")
        frame = drawn(obj, camera=camera)
        result = errors(frame, true)
        assert result.missed <= 3 / result.pixels, options
        assert result.uv.percentile_99 < 0.01
        assert result.depth.percentile_99 < 1e-5


def test_the_relief_fills_the_same_space_at_any_reference_height() -> None:
    """One truth serves techniques that push the relief in, centre it or raise it."""
    ground = Material("waves", height=map_of(noise(5, (32, 32), 1)))
    for reference_height in (1.0, 0.5, 0.0):
        frame, true = measured(ground, "exact", 60.0, reference_height=reference_height)
        result = errors(frame, true)
        assert result.pixels == SMALL[0] * SMALL[1]
        assert result.uv.worst < 0.05
        assert result.depth.worst < 1e-4


@pytest.mark.parametrize("angle", [0.0, 45.0, 85.0, 89.0])
def test_the_plane_fills_the_picture_at_every_angle(angle) -> None:
    """Every pixel is seen at that angle."""
    for size in ((64, 36), (30, 60)):
        scene = at_angle(level_ground(0.5), angle, size, {"scale": SCALE})
        true = truth(scene, size, device="cpu")
        assert true.there.all()
        length = np.linalg.norm(true.travel, axis=-1)
        np.testing.assert_allclose(length, SCALE * math.tan(math.radians(angle)), 2e-4, 1e-6)


def test_impossible_views_and_truths_are_refused() -> None:
    ground, bare = level_ground(0.5), uniform_material()
    with pytest.raises(InputError, match=r"angle of 89\.5"):
        at_angle(ground, 89.5, SMALL, {})
    with pytest.raises(InputError, match="one plane"):
        truth(Object(ground, shape="sphere"), SMALL)
    with pytest.raises(InputError, match="no height map"):
        truth(Object(bare), SMALL)


@pytest.mark.gpu
def test_the_truth_is_the_same_on_the_gpu() -> None:
    scene = at_angle(
        Material("waves", height=map_of(noise(5, (32, 32), 1))), 60.0, SMALL, {"scale": SCALE}
    )
    one, other = (truth(scene, SMALL, device=device) for device in ("cpu", "gpu"))
    np.testing.assert_array_equal(one.there, other.there)
    assert np.quantile(np.abs(one.uv - other.uv), 0.99) < 1e-4


# --- errors of techniques, by formula ------------------------------------------------------------


@pytest.mark.parametrize("angle", [45.0, 60.0])
def test_flat_stops_short_by_the_whole_relief(angle) -> None:
    """B4: on level ground of height h, by (1 − h) · scale · tan of the angle."""
    frame, true = measured(level_ground(0.25), "flat", angle)
    lean = math.radians(angle)
    result = errors(frame, true)
    assert_spread(result.uv, 0.75 * SCALE * math.tan(lean) * TEXELS)
    assert_spread(result.depth, 0.75 * SCALE / math.cos(lean), 1e-5)
    np.testing.assert_allclose(depth_error(frame, true), -0.75 * SCALE / math.cos(lean), atol=1e-5)
    behind = overshoot(frame, true)
    np.testing.assert_allclose(behind, -0.75 * SCALE * math.tan(lean) * TEXELS, atol=1e-3)
    assert (result.missed, result.passed, result.short) == (1.0, 0.0, 1.0)
    assert result.reads == 0.0


@pytest.mark.parametrize("steps", [3, 7, 16])
def test_steep_overshoots_to_its_next_layer(steps) -> None:
    """B4: it stops at the first layer 1 − k/N that is not above the ground."""
    height, angle = 0.43, math.radians(60.0)
    frame, true = measured(level_ground(height), "steep", 60.0, settings={"steps": steps})
    layer = next(1 - k / steps for k in range(steps) if 1 - k / steps <= height)
    late = (height - layer) * SCALE * math.tan(angle) * TEXELS
    result = errors(frame, true)
    np.testing.assert_allclose(overshoot(frame, true), late, atol=1e-3)
    assert_spread(result.uv, late)
    assert_spread(result.depth, (height - layer) * SCALE / math.cos(angle), 1e-5)
    assert result.missed == result.passed == float(late > 1.0)
    assert result.reads == 1 + round((1 - layer) * steps)


def test_an_offset_is_exact_on_level_ground_and_a_limited_one_short() -> None:
    """B4: limiting moves by sin instead of tan of the angle; its depth is that of its height."""
    height, angle = 0.15, math.radians(60.0)
    frame, true = measured(level_ground(height), "offset", 60.0)
    assert_spread(errors(frame, true).uv, 0.0)
    frame, true = measured(level_ground(height), "offset_limited", 60.0)
    short = (0.5 - height) * SCALE * (math.tan(angle) - math.sin(angle)) * TEXELS
    result = errors(frame, true)
    assert_spread(result.uv, short)
    np.testing.assert_allclose(overshoot(frame, true), -short, atol=1e-3)
    assert result.short == float(short > 1.0) == 1.0
    assert_spread(result.depth, 0.0, 1e-5)


def test_a_chord_is_exact_on_a_slope_and_a_layer_is_not() -> None:
    """B4: a tent of two slopes; parallax occlusion is right away from its ridges."""
    ramp = np.abs(np.linspace(-1, 1, TEXELS, endpoint=False))[None, :].repeat(TEXELS, 0)
    tent = Material("tent", height=map_of(0.8 * ramp))
    chord, true = measured(tent, "parallax_occlusion", 45.0, settings={"min_steps": 64})
    layer, _ = measured(tent, "steep", 45.0, settings={"steps": 64})
    assert errors(chord, true).uv.median < 1e-3
    assert errors(layer, true).uv.median > 0.02


# --- errors of frames made by hand ---------------------------------------------------------------


def by_hand(offsets, *, wraps: bool = True, hit=True) -> tuple[Frame, Truth]:
    """A row of pixels with errors in texels along u and v; rays move towards +u."""
    offsets = np.asarray(offsets, float)[None]
    shape = offsets.shape[:2]
    texels = (16, 8)
    uv = np.full((*shape, 2), 0.5)
    travel = np.zeros((*shape, 2))
    travel[..., 0] = 1.0
    ones = np.ones(shape)
    frame = Frame(
        np.zeros((*shape, 4), np.float32),
        (2 * ones).astype(np.float32),
        (uv + offsets / texels).astype(np.float32),
        np.broadcast_to(np.asarray(hit), shape).copy(),
        np.full(shape, 3, np.int32),
        "by hand",
    )
    true = Truth(uv, 0.5 * ones, 1.5 * ones, ones > 0, travel, texels, wraps)
    return frame, true


def test_hits_that_count_as_missed() -> None:
    """B4: off by more than a texel in any direction, or not drawn; a late hit has passed."""
    frame, true = by_hand(
        [(0, 0), (0.9, 0), (1.1, 0), (-1.1, 0), (0.8, 0.8), (0, 0)], hit=[True] * 5 + [False]
    )
    np.testing.assert_array_equal(missed(frame, true)[0], [False, False, True, True, True, True])
    result = errors(frame, true)
    assert result.pixels == 6
    assert (result.missed, result.passed, result.short) == (4 / 6, 2 / 6, 1 / 6)
    assert result.uv.median == pytest.approx(1.1, abs=1e-5)
    assert result.uv.worst == pytest.approx(math.hypot(0.8, 0.8), abs=1e-5)
    assert_spread(result.depth, 0.5)
    assert result.reads == 3.0


def test_the_uv_error_on_a_repeated_map_is_the_shortest() -> None:
    """A whole tile further is the same point; the overshoot is not wrapped."""
    offsets = [(16, 0), (15, 0), (-13, 8)]
    frame, true = by_hand(offsets)
    np.testing.assert_allclose(uv_error(frame, true)[0], [0, 1, 3], atol=1e-5)
    np.testing.assert_allclose(overshoot(frame, true)[0], [16, 15, -13], atol=1e-5)
    frame, true = by_hand(offsets, wraps=False)
    np.testing.assert_allclose(uv_error(frame, true)[0], [16, 15, math.hypot(13, 8)], atol=1e-5)


def test_the_99th_percentile_and_the_worst() -> None:
    frame, true = by_hand([(k / 100, 0) for k in range(101)])
    spread = errors(frame, true).uv
    np.testing.assert_allclose((spread.median, spread.percentile_99), (0.5, 0.99), atol=1e-5)
    assert spread.worst == pytest.approx(1.0, abs=1e-5)


def test_frames_and_truths_of_unequal_size_are_refused() -> None:
    frame, _ = by_hand([(0, 0), (1, 0)])
    _, true = by_hand([(0, 0)])
    with pytest.raises(InputError, match="the frame is 2 × 1, the truth 1 × 1"):
        errors(frame, true)


# --- FLIP ----------------------------------------------------------------------------------------


def plain_picture(color, size=(32, 24)) -> Image:
    pixels = np.ones((size[1], size[0], 4), np.float32)
    pixels[:, :, :3] = color
    return Image(pixels)


def test_flip_from_none_to_the_largest() -> None:
    """B4: 0 between equals, nearly 1 between black and white, monotonic in the difference."""
    black, grey, white = (plain_picture(value) for value in (0.0, 0.2, 1.0))
    assert flip(grey, grey) == 0.0
    assert flip(black, white) > 0.9
    assert 0.0 < flip(black, grey) < flip(black, white)
    bare = plain_picture(1.0)
    bare.pixels[:, :, 3] = 0.0
    assert flip(black, bare) == 0.0


def test_without_flip_the_error_names_what_to_install(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    assert not has_flip()
    with pytest.raises(InputError, match=r"pip install 'basrelief\[measure\]'"):
        flip(plain_picture(0.1), plain_picture(0.2))


# --- times ---------------------------------------------------------------------------------------


def test_times_are_taken_in_turn(monkeypatch) -> None:
    """The median of runs after a row to warm up, by a fake clock."""
    order: list[str] = []
    drawn: list[tuple[int, int] | None] = []
    now = [0.0]
    takes = {"slow": iter([90.0, 3.0, 5.0, 40.0]), "fast": iter([80.0, 1.0, 9.0, 2.0])}

    class Engine:
        def canvas(self, program, size):
            return types.SimpleNamespace(read=lambda name: None)

        def draw(self, program, values, canvas, rows=None):
            name = "slow" if values["relief"].scale == np.float32(0.3) else "fast"
            order.append(name)
            drawn.append(rows)
            now[0] += next(takes[name])

    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    # with a normal map, or the engine would bake one
    ground = replace(level_ground(0.5), normal=map_of(np.full((1, 1, 3), (0.5, 0.5, 1.0))))
    scenes = {
        name: Scene((Object(ground, scale=scale),))
        for name, scale in (("slow", 0.3), ("fast", 0.1))
    }
    seconds = seconds_of(scenes, Timing(SMALL, "clock"), Engine(), runs=3)  # type: ignore[arg-type]
    assert seconds == {"slow": 5.0, "fast": 2.0}
    assert order == ["slow", "fast"] * 4
    assert drawn == [(0, 1)] * 2 + [None] * 6


@pytest.mark.gpu
def test_a_gpu_times_itself() -> None:
    """By timestamps: more work takes longer."""
    engine = choose_device("gpu")
    assert engine.has_timestamps  # type: ignore[attr-defined]
    ground = level_ground(0.002)
    scenes = {
        name: Scene((Object(ground, technique=name, settings=settings),))
        for name, settings in (("flat", {}), ("steep", {"steps": 500}))
    }
    seconds = seconds_of(scenes, Timing((96, 64), "timestamps"), engine, runs=3)
    assert 0.0 < seconds["flat"] < seconds["steep"] < 5.0


# --- colours -------------------------------------------------------------------------------------


def test_colour_maps_are_perceptually_uniform() -> None:
    """Equal steps in OKLab within the sRGB gamut, from dark to light."""
    np.testing.assert_allclose(colors.lab_to_linear([1.0, 0.0, 0.0]), 1.0, atol=1e-4)
    for path in (colors._HEAT, colors._POSITIVE, colors._NEGATIVE):
        lab = colors.path_in_lab(path)
        steps = np.linalg.norm(np.diff(lab, axis=0), axis=1)
        assert steps.max() / steps.min() < 1.1
        assert (np.diff(lab[:, 0]) > 0.0).all()
        light = colors.lab_to_linear(lab)
        assert light.min() > -2e-3
        assert light.max() < 1.0 + 2e-3


def test_signed_colours_are_dark_in_the_middle_and_differ_at_the_ends() -> None:
    low, middle, high = colors.signed([-1.0, 0.0, 1.0])
    assert middle.max() < 0.02 < 0.5 < min(low.max(), high.max())
    assert low[2] > low[0]
    assert high[0] > high[2]
