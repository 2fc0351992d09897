"""Rendering from Python: frames, errors, samples, edges, objects, user-defined techniques."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.errors import DeviceError, InputError
from basrelief.images import read_picture, srgb_decode, write_picture
from basrelief.lang import HeightField, setting, shader, struct
from basrelief.material import Map, Material, sample
from basrelief.rendering.programs import program_of, values_of
from basrelief.rendering.render import render, sample_positions
from basrelief.scene import LookAt, Object, Orbit, Scene, directional, placed, point, rotated
from basrelief.shading.brdf import Shading
from basrelief.techniques import (
    TECHNIQUES,
    Hit,
    Nothing,
    Ray,
    height_under,
    hit_at,
    t_at,
    technique,
)
from helpers.plain_python import pixel_in_python
from helpers.synthetic import matte

CPU = CpuEngine()
SIZE = (64, 36)
WHITE = Shading(ambient=(1.0, 1.0, 1.0))
ABOVE = LookAt((0.0, 2.0, 0.0), up=(0.0, 0.0, -1.0), orthographic_height=1.2)


def map_of(values, dtype=np.float32, srgb: bool = False) -> Map:
    values = np.asarray(values).astype(dtype)
    return Map(values if values.ndim == 3 else values[:, :, None], srgb, "made up")


def colored(color, **maps) -> Material:
    return Material("made up", base_color=map_of(np.full((1, 1, 3), color)), **maps)


def drawn(what, size=SIZE, samples=1, device=CPU, **options):
    return render(what, size=size, samples=samples, device=device, **options)


def refused(make, kind=InputError) -> str:
    with pytest.raises(kind) as caught:
        make()
    message = str(caught.value)
    assert message
    assert "\n" not in message
    return message


BRICKS = sample("bricks", 64)


# --- the frame ------------------------------------------------------------------------------------


def test_a_frame_is_rows_by_columns() -> None:
    frame = drawn(BRICKS, (5, 3))
    kinds = {
        "color": ((3, 5, 4), np.float32),
        "distance": ((3, 5), np.float32),
        "uv": ((3, 5, 2), np.float32),
        "hit": ((3, 5), np.bool_),
        "reads": ((3, 5), np.int32),
    }
    for name, (shape, dtype) in kinds.items():
        plane = getattr(frame, name)
        assert (plane.shape, plane.dtype) == (shape, dtype)
    assert frame.device.startswith("cpu: ")
    assert frame.image.pixels is frame.color


def test_distance_is_infinite_without_a_hit() -> None:
    frame = drawn(BRICKS)
    assert frame.hit.any()
    assert not frame.hit.all()
    assert np.isinf(frame.distance[~frame.hit]).all()
    assert np.isfinite(frame.distance[frame.hit]).all()
    assert (frame.distance[frame.hit] > 0).all()


def test_a_folder_a_material_an_object_and_a_scene_give_the_same_picture(tmp_path) -> None:
    folder = tmp_path / "rock"
    folder.mkdir()
    codes = np.random.default_rng(2).integers(0, 65536, (8, 12))
    # a picture is light, a height map codes: encoding gives the codes back
    light = srgb_decode(np.repeat(codes[:, :, None], 3, 2) / 65535)
    write_picture(folder / "rock_height.png", light, bits=16)
    material = Material("rock", height=map_of(codes, np.uint16))
    options = {"technique": "steep", "scale": 0.1}
    made = Object(material, **options)
    frames = [
        drawn(folder, **options),
        drawn(str(folder), **options),
        drawn(material, **options),
        drawn(made),
        drawn(Scene((made,))),
    ]
    for frame in frames[1:]:
        np.testing.assert_array_equal(frame.color, frames[0].color)
    assert frames[0].reads.max() == 10


def test_options_of_the_scene_are_taken_too() -> None:
    from_above = drawn(BRICKS, camera=ABOVE, background=(1.0, 0.0, 0.0), lights=())
    np.testing.assert_allclose(from_above.color[0, 0], [1, 0, 0, 1])
    same = drawn(Object(BRICKS), camera=ABOVE, background=(1.0, 0.0, 0.0), lights=())
    np.testing.assert_array_equal(from_above.color, same.color)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: drawn(BRICKS, (0, 5)), "a picture of 0 × 5: give 1 to 32768 pixels a side"),
        (lambda: drawn(BRICKS, (5, -1)), "a picture of 5 × -1"),
        (lambda: drawn(BRICKS, (32769, 1)), "a picture of 32769 × 1"),
        (lambda: drawn(BRICKS, samples=0), "0 samples a pixel: give 1 to 1024"),
        (lambda: drawn(BRICKS, samples=1025), "1025 samples a pixel"),
        (
            lambda: drawn(BRICKS, tecnique="relief"),  # codespell:ignore tecnique
            "no option 'tecnique'; there are alpha, background, bias",  # codespell:ignore tecnique
        ),
        (lambda: drawn(Object(BRICKS), scale=0.1), "scale: already set by the"),
        (lambda: drawn(Scene((Object(BRICKS),)), camera=Orbit()), "camera: already set by the"),
        (lambda: drawn(42), "cannot draw a int: give a folder, material or scene"),
        (lambda: drawn(None), "cannot draw a NoneType"),
        (lambda: drawn("nowhere/at all"), "nowhere/at all"),
        (lambda: drawn(BRICKS, technique="leap"), "no technique is called 'leap'"),
        (lambda: drawn(BRICKS, settings={"max_steps": 0}), "max_steps is 0"),
        (lambda: drawn(BRICKS, shape="sphere", camera=Orbit(distance=0.2)), "inside the sphere"),
        (lambda: drawn(BRICKS, shape="box", camera=Orbit(distance=0.2)), "inside the box"),
        (lambda: drawn(BRICKS, camera=Orbit(elevation=-20.0)), "behind the plane"),
        (lambda: drawn(replace(BRICKS, height=None), technique="steep"), "has no height map"),
    ],
)
def test_invalid_arguments_are_refused_in_a_line(make, message) -> None:
    assert message in refused(make)


def test_an_unknown_device_is_refused() -> None:
    message = refused(lambda: drawn(BRICKS, device="quantum"), DeviceError)
    assert "no device is called 'quantum'" in message
    assert "auto, cpu, gpu" in message


def test_devices_are_chosen_by_name() -> None:
    assert drawn(BRICKS, (3, 2), device="cpu").device.startswith("cpu: ")
    assert drawn(BRICKS, (3, 2), device="auto").device.split(":")[0] in ("cpu", "gpu")


@pytest.mark.gpu
def test_the_gpu_is_chosen_by_name() -> None:
    assert drawn(BRICKS, (3, 2), device="gpu").device.startswith("gpu: ")


def test_progress_grows_to_1() -> None:
    fractions: list[float] = []
    scene = Scene((Object(BRICKS), Object(BRICKS, shape="sphere")), camera=Orbit(distance=3.0))
    drawn(scene, samples=3, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)
    assert 0.0 < fractions[0] < 0.3


def test_a_picture_is_saved_as_it_was_drawn(tmp_path) -> None:
    frame = drawn(BRICKS)
    assert frame._repr_png_().startswith(b"\x89PNG")
    saved = read_picture(frame.save(tmp_path / "bricks.exr"))
    np.testing.assert_allclose(saved.pixels, frame.color[:, :, :3], atol=2e-3)
    clear = drawn(BRICKS, background=None)
    assert read_picture(clear.save(tmp_path / "clear.png")).pixels.shape == (36, 64, 4)


@pytest.mark.parametrize("rows", [1, 7, 36])
def test_the_rows_drawn_at_once_change_nothing(rows, monkeypatch) -> None:
    """Bands of one row, of seven with a remainder, and of the whole picture."""
    scene = Scene((Object(BRICKS), Object(BRICKS, shape="sphere")), camera=Orbit(distance=3.0))
    whole = drawn(scene, samples=3)
    monkeypatch.setattr("basrelief.rendering.render._BAND", rows * SIZE[0])
    banded = drawn(scene, samples=3)
    for name in ("color", "distance", "uv", "hit", "reads"):
        np.testing.assert_array_equal(getattr(banded, name), getattr(whole, name))


# --- samples and backgrounds ----------------------------------------------------------------------


def test_samples_are_spread_over_the_pixel_from_its_middle() -> None:
    assert sample_positions(1) == [(0.5, 0.5)]
    for count in (4, 16, 64):
        places = np.array(sample_positions(count))
        assert places[0].tolist() == [0.5, 0.5]
        assert places.min() >= 0.0
        assert places.max() < 1.0
        quarters = np.unique(places >= 0.5, axis=0, return_counts=True)[1]
        assert len(quarters) == 4
        assert quarters.max() - quarters.min() <= max(1, count // 8)


def test_samples_step_by_the_powers_of_the_plastic_number() -> None:
    """With g³ = g + 1, positions step by 1 ÷ g and 1 ÷ g², modulo 1."""
    plastic = max(np.roots([1.0, 0.0, -1.0, -1.0]).real)
    places = np.array(sample_positions(50))
    steps = np.array([1.0 / plastic, 1.0 / plastic**2])
    wanted = (0.5 + np.arange(50)[:, None] * steps) % 1.0
    np.testing.assert_allclose(places, wanted, atol=1e-12)


def test_samples_are_averaged() -> None:
    """The mean of single-sample pictures with cameras moved within the pixel is the same."""
    camera = ABOVE
    width, height = SIZE
    scene = Scene((Object(BRICKS),), camera=camera, background=(0.25, 0.5, 0.75))
    total = np.zeros((height, width, 4))
    for x, y in sample_positions(3):
        step = 1.2 / height
        right, back = (x - 0.5) * step, (y - 0.5) * step
        moved = replace(camera, position=(right, 2.0, back), target=(right, 0.0, back))
        total += drawn(scene.with_camera(moved)).color
    averaged = drawn(scene, samples=3)
    assert np.abs(averaged.color - total / 3).mean() < 2e-4
    # all planes but the colour are those of the first sample
    first = drawn(scene)
    np.testing.assert_array_equal(averaged.uv, first.uv)
    np.testing.assert_array_equal(averaged.distance, first.distance)


def test_more_samples_smooth_the_outline() -> None:
    scene = Scene((Object(colored(1.0)),), camera=Orbit(20.0, 30.0), background=(0.0, 0.0, 0.0))
    scene = replace(scene, lights=(), shading=WHITE)
    one, many = drawn(scene).color[:, :, 0], drawn(scene, samples=16).color[:, :, 0]
    assert set(np.unique(one)) == {0.0, 1.0}
    between = (many > 0.05) & (many < 0.95)
    assert 0.01 < between.mean() < 0.2


def test_a_transparent_background_leaves_colours_whole() -> None:
    """Alpha is coverage, and the colour is the object's up to its border."""
    scene = Scene(
        (Object(colored((0.2, 0.4, 0.8))),),
        camera=Orbit(20.0, 30.0),
        background=None,
        lights=(),
        shading=WHITE,
    )
    color = drawn(scene, samples=16).color
    alpha = color[:, :, 3]
    assert alpha.min() == 0.0
    assert alpha.max() == pytest.approx(1.0)
    assert ((alpha > 0.05) & (alpha < 0.95)).any()
    seen = alpha > 0.05
    np.testing.assert_allclose(
        color[seen][:, :3], np.tile([0.2, 0.4, 0.8], (seen.sum(), 1)), atol=1e-4
    )
    assert (color[alpha == 0.0] == 0.0).all()


def test_opacity_lets_the_background_through() -> None:
    half = colored((0.8, 0.4, 0.2), opacity=map_of([[0.5]]))
    scene = Scene(
        (Object(half),), camera=ABOVE, background=(0.0, 0.2, 1.0), lights=(), shading=WHITE
    )
    middle = drawn(scene).color[18, 32]
    np.testing.assert_allclose(middle, [0.4, 0.3, 0.6, 1.0], atol=1e-4)
    clear = drawn(replace(scene, background=None)).color[18, 32]
    np.testing.assert_allclose(clear, [0.8, 0.4, 0.2, 0.5], atol=1e-4)


BARELY_NOT, BARELY = 32767, 32768
"""Codes of opacity on either side of a half, of 65535."""


def pane(code: int, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Object:
    """A green pane of an opacity, four times as wide as high, facing +z."""
    opacity = map_of([[code]], np.uint16)
    shape = placed((x, y, z), (2.0, 0.5, 1.0))
    return Object(colored((0.1, 0.8, 0.2), opacity=opacity), transform=shape)


@pytest.mark.parametrize(("code", "solid"), [(BARELY_NOT, False), (BARELY, True), (65535, True)])
def test_coverage_of_a_half_has_a_distance(code: int, solid: bool) -> None:
    """Coverage below a half only tints: distance, uv and hit are those of the object behind."""
    camera = LookAt((0.3, -0.1, 4.0), (0.3, -0.1, 0.0), orthographic_height=0.2)
    scene = {"camera": camera, "lights": (), "shading": WHITE, "background": (0.0, 0.0, 1.0)}
    share = code / 65535
    # one pane alone; the middle of the picture is at (0.3, −0.1), its pixels are 0.05 wide
    lone = drawn(Scene((pane(code, 0.1),), **scene), (8, 4))
    wanted = np.array([0.1, 0.8, 0.2]) * share + np.array([0.0, 0.0, 1.0]) * (1.0 - share)
    np.testing.assert_allclose(lone.color[..., :3], np.broadcast_to(wanted, (4, 8, 3)), atol=1e-4)
    assert (lone.hit == solid).all()
    x = 0.3 + (np.arange(8) + 0.5 - 4.0) * 0.05
    y = -0.1 - (np.arange(4) + 0.5 - 2.0) * 0.05
    u, v = np.meshgrid(0.5 + (x - 0.1) / 2.0, 0.5 - y / 0.5)
    if solid:
        np.testing.assert_allclose(lone.distance, 4.0, rtol=1e-6)
        np.testing.assert_allclose(lone.uv, np.stack([u, v], -1), atol=1e-5)
    else:
        assert np.isinf(lone.distance).all()
        assert (lone.uv == 0.0).all()
    # in front of an opaque one, in either order
    wall = Object(colored((0.9, 0.3, 0.6)), transform=placed((0.0, 0.1, -1.5), 3.0))
    for objects in ((wall, pane(code, 0.1)), (pane(code, 0.1), wall)):
        frame = drawn(Scene(objects, **scene), (8, 4))
        wanted = np.array([0.1, 0.8, 0.2]) * share + np.array([0.9, 0.3, 0.6]) * (1.0 - share)
        np.testing.assert_allclose(frame.color[2, 5, :3], wanted, atol=1e-4)
        assert frame.hit.all()
        np.testing.assert_allclose(frame.distance, 4.0 if solid else 5.5, rtol=1e-6)
        behind = np.stack(np.meshgrid(0.5 + x / 3.0, 0.5 - (y - 0.1) / 3.0), -1)
        there = np.stack([u, v], -1) if solid else behind
        np.testing.assert_allclose(frame.uv, there, atol=1e-5)


@pytest.mark.parametrize(("code", "solid"), [(BARELY_NOT, False), (BARELY, True)])
def test_coverage_of_a_half_casts_a_full_shadow(code: int, solid: bool) -> None:
    """Smaller coverage casts no shadow."""
    wall = Object(colored(1.0), transform=placed((0.0, 0.0, -1.0), 8.0))
    light = (directional(-60.0, 0.0),)
    unlit = Shading(ambient=(0.0, 0.0, 0.0))
    camera = LookAt((0.0, 0.0, 4.0), orthographic_height=3.0)
    scene = {"camera": camera, "lights": light, "shading": unlit, "shading_model": "phong"}
    objects = (matte(wall), matte(pane(code)))
    frames = [drawn(Scene(objects, **scene, shadows=kind), (80, 48)) for kind in ("none", "hard")]
    lit, shadowed = (frame.color[24, :, 0] for frame in frames)
    # light from the left: tan 60° to the right of the pane, which is one to either side
    x = (np.arange(80) + 0.5 - 40.0) * 3.0 / 48.0
    shadow = (x > 1.1) & (x < 1.0 + math.tan(math.radians(60.0)) - 0.1)
    assert shadow.sum() > 15
    np.testing.assert_allclose(lit[shadow], 0.5, atol=1e-3)
    np.testing.assert_allclose(shadowed[shadow], 0.0 if solid else 0.5, atol=1e-3)


# --- special materials and edges ------------------------------------------------------------------


@pytest.mark.parametrize("name", TECHNIQUES)
def test_a_height_map_of_one_texel_is_flat(name) -> None:
    """A constant height at the reference height shifts nothing."""
    material = replace(colored(0.5), height=map_of([[0.5]]))
    frame = drawn(Object(material, technique=name, reference_height=0.5, scale=0.1))
    still = drawn(Object(material, technique="flat", scale=0.1))
    np.testing.assert_array_equal(frame.hit, still.hit)
    np.testing.assert_allclose(frame.uv, still.uv, atol=0.02)
    # a plane has one normal, so one colour under directional lights
    within = frame.hit
    assert frame.color[within][:, 0].std() < 0.2


def test_maps_of_different_sizes_cover_the_same_tile() -> None:
    """Maps of any size are stretched over the whole tile."""
    u, v = np.meshgrid((np.arange(48) + 0.5) / 48, (np.arange(32) + 0.5) / 32)
    height = 0.5 + 0.4 * np.sin(2 * np.pi * u) * np.cos(2 * np.pi * v)

    def shrunk(values, times):
        rows, columns = values.shape
        blocks = values.reshape(rows // times, times, columns // times, times)
        return blocks.mean(axis=(1, 3))

    color = np.stack([0.5 + 0.3 * np.cos(2 * np.pi * u), v * 0 + 0.5, u * 0 + 0.2], -1)
    small = np.stack([shrunk(color[:, :, k], 4) for k in range(3)], -1)
    rough = 0.5 + 0.3 * np.sin(2 * np.pi * v)
    alike = Material("a", base_color=map_of(color), height=map_of(height), roughness=map_of(rough))
    mixed = Material(
        "b", base_color=map_of(small), height=map_of(height), roughness=map_of(shrunk(rough, 8))
    )
    one, other = (drawn(Object(m, scale=0.1, technique="relief")) for m in (alike, mixed))
    np.testing.assert_array_equal(one.uv, other.uv)
    assert np.abs(one.color - other.color)[one.hit].mean() < 0.02


def test_a_material_without_heights_is_drawn_flat() -> None:
    material = replace(BRICKS, height=None)
    frame = drawn(material)
    np.testing.assert_array_equal(frame.uv, drawn(BRICKS, technique="flat").uv)
    assert frame.reads.max() == 0
    assert frame.hit.any()


def test_a_material_without_maps_is_grey() -> None:
    scene = Scene((Object(Material("nothing")),), camera=ABOVE, lights=(), shading=WHITE)
    np.testing.assert_allclose(drawn(scene).color[18, 32], [0.6, 0.6, 0.6, 1.0], atol=1e-6)


def test_clip_draws_nothing_beyond_the_tile() -> None:
    """B8: with `clip` the relief ends at the border of the map; with `wrap` it continues."""
    camera = Orbit(0.0, 25.0, 1.8)
    whole = drawn(Object(BRICKS, scale=0.2), camera=camera)
    cut = drawn(Object(BRICKS, scale=0.2, edge="clip"), camera=camera)
    outside = (whole.uv < 0).any(axis=-1) | (whole.uv > 1).any(axis=-1)
    assert (outside & whole.hit).sum() > 30
    assert not (cut.hit & ((cut.uv < 0) | (cut.uv > 1)).any(axis=-1)).any()
    assert cut.hit.sum() < whole.hit.sum()
    assert np.isinf(cut.distance[~cut.hit]).all()


def test_clamp_stretches_the_border() -> None:
    """Beyond the tile `clamp` continues the last texel, where `wrap` repeats the map."""
    color = np.zeros((2, 4, 3))
    color[:, :, 0] = [0.2, 0.4, 0.6, 0.8]
    options = {"tiling": (2.0, 1.0), "camera": ABOVE, "lights": (), "shading": WHITE}
    material = Material("x", base_color=map_of(color))
    clamped = drawn(material, edge="clamp", **options).color[18, :, 0]
    wrapped = drawn(material, edge="wrap", **options).color[18, :, 0]
    uv = drawn(material, **options).uv[18, :, 0]
    outside = (uv > 1.2) & (uv < 1.3)
    assert outside.any()
    np.testing.assert_allclose(clamped[outside], 0.8, atol=0.01)
    assert (wrapped[outside] < 0.5).all()


# --- several objects ------------------------------------------------------------------------------


def test_objects_hide_each_other_by_their_displaced_depth() -> None:
    """C18: a flat sheet through the middle of the heights cuts a relief where it is lower."""
    u = (np.arange(64) + 0.5) / 64
    ramp = np.tile(0.25 + 0.5 * np.abs(2 * u - 1), (32, 1))  # 0.75 at the sides, 0.25 in the middle
    wavy = Object(
        replace(colored((1.0, 0.0, 0.0)), height=map_of(ramp)),
        technique="parallax_occlusion",
        settings={"min_steps": 32, "max_steps": 32},
        scale=0.2,
        reference_height=1.0,
        transform=np.eye(4),
    )
    # at the height ½, so at (½ − 1) · 0.2 below the polygon
    sheet = Object(colored((0.0, 0.0, 1.0)), transform=placed((0.0, 0.0, -0.1)))
    camera = LookAt((0.0, 0.0, 3.0), orthographic_height=1.0)
    for objects in ((wavy, sheet), (sheet, wavy)):
        scene = Scene(objects, camera=camera, lights=(), shading=WHITE, background=(0, 0, 0))
        frame = drawn(scene, (96, 48))
        row = frame.color[24]
        inside = frame.hit[24]
        place = frame.uv[24, :, 0]
        high = inside & (np.abs(2 * place - 1) > 0.55)
        low = inside & (np.abs(2 * place - 1) < 0.45)
        assert high.sum() > 10
        assert low.sum() > 10
        np.testing.assert_allclose(row[high][:, :3], np.tile([1.0, 0.0, 0.0], (high.sum(), 1)))
        np.testing.assert_allclose(row[low][:, :3], np.tile([0.0, 0.0, 1.0], (low.sum(), 1)))
        assert frame.distance[24][high].max() < 3.1
        np.testing.assert_allclose(frame.distance[24][low], 3.1, atol=1e-4)


def test_a_ball_in_the_relief_is_sunk_by_its_depth() -> None:
    """A pushed-in relief shows more of a ball in it than a raised one."""
    flat_height = replace(colored((1.0, 1.0, 1.0)), height=map_of(np.full((4, 4), 0.5)))
    ball = Object(colored((0.0, 1.0, 0.0)), shape="sphere", transform=placed(scale=0.5))
    shares = []
    for level in (0.0, 0.5, 1.0):
        ground = Object(flat_height, technique="offset", scale=0.2, reference_height=level)
        scene = Scene((ground, ball), camera=Orbit(0.0, 20.0, 2.0), lights=(), shading=WHITE)
        color = drawn(scene, (96, 54)).color
        shares.append(((color[:, :, 1] == 1.0) & (color[:, :, 0] == 0.0)).mean())
    assert shares[0] < shares[1] < shares[2]


def test_reads_of_all_objects_are_counted() -> None:
    """Reads of hidden objects count too: each object is drawn at every pixel."""
    flat = replace(colored((1.0, 1.0, 1.0)), height=map_of(np.full((4, 4), 0.5)))
    near = Object(flat, technique="steep", settings={"steps": 8}, transform=np.eye(4))
    far = Object(
        flat, technique="steep", settings={"steps": 20},
        transform=placed((0.25, 0.0, -1.0), (1.0, 2.0, 1.0)),
    )  # fmt: skip
    scene = {"camera": LookAt((0.0, 0.0, 3.0), orthographic_height=1.0), "lights": ()}
    both = drawn(Scene((near, far), **scene))
    alone = [drawn(Scene((each,), **scene)).reads for each in (near, far)]
    np.testing.assert_array_equal(both.reads, alone[0] + alone[1])
    # at half the height a march of N steps has read N ÷ 2 + 1 heights
    assert np.unique(both.reads).tolist() == [0, 5, 11, 16]
    assert both.mean_reads == pytest.approx(both.reads[both.hit].mean())


def test_an_empty_scene_is_its_background() -> None:
    frame = drawn(Scene((), background=(0.1, 0.2, 0.3)))
    np.testing.assert_allclose(
        frame.color, np.broadcast_to([0.1, 0.2, 0.3, 1.0], frame.color.shape)
    )
    assert not frame.hit.any()


def test_emission_of_any_brightness_arrives() -> None:
    light = np.full((2, 2, 3), [6.0, 1.5, 0.0])
    material = colored(0.0, emission=map_of(light))
    scene = Scene((Object(material),), camera=ABOVE, lights=())
    np.testing.assert_allclose(drawn(scene).color[18, 32], [6.0, 1.5, 0.0, 1.0], atol=1e-3)


# --- a user-defined technique ---------------------------------------------------------------------


@struct
class Lift:
    """Settings of the technique below."""

    times: int = setting(default=1, doc="how often the height is added", low=0, high=9)
    strength: float = setting(default=1.0, doc="how far it moves", low=0.0, high=10.0)


@shader
def lifted(ray: Ray, height: float, strength: float) -> float:
    """A helper of the technique."""
    return ray.reference_height - height * strength


@technique(reference_height=0.5)
def lift_technique(field: HeightField, ray: Ray, settings: Lift) -> Hit:
    """Go down by the height at the entry of the ray, `times` times."""
    height = ray.reference_height
    for _ in range(settings.times):
        start = t_at(ray, ray.reference_height)
        height = lifted(ray, height_under(field, ray, start), settings.strength)
    return hit_at(ray, t_at(ray, height), True, settings.times)


@technique()
def without_a_hit(field: HeightField, ray: Ray, settings: Nothing) -> Hit:
    """Stay at the entry of the ray, and report seven reads."""
    return hit_at(ray, t_at(ray, ray.reference_height), False, 7)


def own_scene(**settings) -> Scene:
    material = replace(BRICKS, height=map_of(np.full((4, 4), 0.25)))
    made = Object(
        material, technique=lift_technique, settings=settings, scale=0.2, transform=np.eye(4)
    )
    camera = LookAt((0.9, -1.1, 1.4), up=(0.0, 0.0, 1.0), field_of_view=35.0)
    return Scene((made,), camera=camera, lights=(directional(20.0, 60.0),))


def assert_shifted(frame, scene, strength: float) -> None:
    """On a plane of height ¼, the shift is scale · strength · ¼ down along the ray."""
    still = drawn(
        replace(scene, objects=(replace(scene.objects[0], technique="flat", settings={}),))
    )
    within = frame.hit
    assert within.mean() > 0.1
    deeper = frame.distance[within] - still.distance[within]
    # the ray's cosine from the undisplaced depth: the camera stands 1.4 above the plane
    cosine = 1.4 / still.distance[within]
    np.testing.assert_allclose(deeper * cosine, 0.2 * 0.25 * strength, atol=1e-4)
    moved = np.linalg.norm((frame.uv - still.uv)[within], axis=-1)
    across = np.sqrt(1 - cosine**2) / cosine
    np.testing.assert_allclose(moved, 0.2 * 0.25 * strength * across, atol=2e-4)


def test_a_user_defined_technique_runs_on_the_cpu() -> None:
    """C14: its settings change the picture without a new compilation."""
    once, twice = own_scene(times=1, strength=1.0), own_scene(times=3, strength=2.0)
    assert_shifted(drawn(once), once, 1.0)
    assert_shifted(drawn(twice), twice, 2.0)
    assert drawn(twice).reads.max() == 3
    keys = {program_of(scene.resolved[0]).key for scene in (once, twice)}
    assert len(keys) == 1
    assert drawn(own_scene(times=0)).reads.max() == 0
    frame = drawn(Scene((Object(BRICKS, technique=without_a_hit),)))
    assert set(np.unique(frame.reads[frame.hit])) == {7}


@pytest.mark.gpu
def test_a_user_defined_technique_runs_on_the_gpu() -> None:
    """C14."""
    from basrelief.engine.gpu import GpuEngine

    scene = own_scene(times=2, strength=1.5)
    frame = drawn(scene, device=GpuEngine())
    assert_shifted(frame, scene, 1.5)
    np.testing.assert_allclose(frame.color, drawn(scene).color, atol=2e-3)


def test_a_user_defined_technique_runs_as_plain_python() -> None:
    """C14: the pixel in plain Python equals the CPU's bit for bit."""
    scene = own_scene(times=2, strength=1.5)
    made = scene.objects[0]
    program, values = program_of(made.resolved), values_of(made.resolved, scene, SIZE, CpuEngine())
    frame = drawn(scene)
    for x, y in ((32, 18), (28, 20), (36, 16)):
        one = pixel_in_python(program, values, x, y)
        assert one.hit == frame.hit[y, x]
        assert [*one.uv] == [*frame.uv[y, x]]
        assert one.distance == frame.distance[y, x]
        assert one.reads == frame.reads[y, x] == 2


def test_a_technique_from_a_file_draws_the_same(tmp_path) -> None:
    """C14: FILE.py:NAME."""
    file = tmp_path / "mine.py"
    file.write_text(
        "from basrelief.lang import Buffer, HeightField, setting, struct\n"
        "from basrelief.techniques.height import height_under\n"
        "from basrelief.techniques import Hit, Ray, hit_at, t_at, technique\n\n\n"
        "@struct\n"
        "class Mine:\n"
        "    '''Settings.'''\n\n"
        "    strength: float = setting(default=1.0, doc='how far', low=0.0, high=10.0)\n\n\n"
        "@technique(reference_height=0.5)\n"
        "def mine(field: HeightField, ray: Ray, settings: Mine) -> Hit:\n"
        "    '''One read.'''\n"
        "    start = t_at(ray, ray.reference_height)\n"
        "    below = height_under(field, ray, start) * settings.strength\n"
        "    height = ray.reference_height - below\n"
        "    return hit_at(ray, t_at(ray, height), True, 1)\n"
    )
    scene = own_scene(times=1, strength=1.5)
    made = replace(
        scene.objects[0],
        technique=f"{file}:mine",
        settings={"strength": 1.5},
        reference_height=None,
    )
    frame = drawn(replace(scene, objects=(made,)))
    np.testing.assert_array_equal(frame.uv, drawn(scene).uv)
    assert frame.reads.max() == 1
    with pytest.raises(InputError, match=r"it has no other"):
        Object(BRICKS, technique=f"{file}:other")


def test_rotating_object_and_camera_together_changes_nothing() -> None:
    """Rendering does not depend on the direction in the world, lights included."""

    def at_angle(angle: float):
        turn = rotated("y", angle)
        made = Object(BRICKS, technique="relief", scale=0.1)
        made = replace(made, transform=turn @ made.resolved.transform)
        camera = Orbit(30.0 + angle, 35.0)
        return drawn(Scene((made,), camera=camera, lights=(directional(-40.0 + angle, 40.0),)))

    one, other = at_angle(0.0), at_angle(77.0)
    both = one.hit & other.hit
    assert (one.hit != other.hit).mean() < 0.01
    assert np.quantile(np.abs(one.uv - other.uv)[both], 0.99) < 1e-3
    assert np.quantile(np.abs(one.color - other.color)[both], 0.99) < 0.02
    assert math.isfinite(one.color.max())


def test_a_clipped_cylinder_has_no_slit_at_its_seam() -> None:
    """Round shapes have no border along u: coordinates beyond 1 continue at 0."""
    ground = Material("hills", height=map_of(np.random.default_rng(4).random((32, 32))))
    for shape in ("cylinder", "sphere"):
        seen = {}
        for edge in ("wrap", "clip"):
            obj = Object(ground, shape=shape, edge=edge, scale=0.1)
            scene = Scene((obj,), Orbit(160.0, 0.0, 3.0))
            frame = render(scene, size=(96, 54), samples=1, device="cpu")
            seen[edge] = frame.hit[15:39]
        np.testing.assert_array_equal(seen["wrap"], seen["clip"])


def test_lights_without_contribution_read_no_heights() -> None:
    obj = Object(BRICKS, technique="steep", scale=0.1, transform=np.eye(4))
    camera = LookAt((0.4, -0.6, 1.4), up=(0.0, 0.0, 1.0))
    reads = []
    behind = LookAt((0.0, 0.0, -3.0))
    for lights in ((), (point(behind.position),), (directional(0.0, 0.0, intensity=0.0),)):
        scene = Scene((obj,), camera, lights=lights, shadows="hard")
        reads.append(render(scene, size=(32, 18), samples=1, device="cpu").reads)
    np.testing.assert_array_equal(reads[0], reads[1])
    np.testing.assert_array_equal(reads[0], reads[2])
