"""Pictures from pixels: compositing, averages of samples, and what hidden objects leave behind."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from basrelief.engine import PlaneBuffer, choose_device
from basrelief.images import encode_light, read_picture, srgb_encode, srgb_thresholds
from basrelief.lang import Buffer, Vec2, Vec4
from basrelief.material import Map, Material, sample
from basrelief.rendering.codes16 import read_codes16
from basrelief.rendering.render import render
from basrelief.scene import LYING, Object, Orbit, Scene, placed
from basrelief.shading.codes16 import FourLights
from basrelief.shading.picture import (
    Backdrop,
    Threshold,
    averaged,
    composited,
    empty,
    srgb_code,
)
from basrelief.shading.pixel import Pixel
from helpers.agreement import assert_engines_agree

BACKDROP = Backdrop(Vec4(0.2, 0.4, 0.6, 1.0))


def above(alpha: float = 1.0, distance: float = 2.0, hit: bool = True, red: float = 1.0) -> Pixel:
    return Pixel(Vec4(red, 0.0, 0.0, alpha), distance, Vec2(0.25, 0.5), hit, 3)


def values(color: Vec4) -> list[float]:
    return [float(c) for c in color]


def test_a_nearer_pixel_covers_what_is_behind() -> None:
    over = composited(empty(BACKDROP), above())
    assert (values(over.color), over.distance, over.hit, over.reads) == ([1, 0, 0, 1], 2.0, True, 3)
    behind = composited(over, above(distance=3.0, red=0.5))
    assert (values(behind.color), behind.distance) == ([1, 0, 0, 1], 2.0)
    # its reads count all the same
    assert behind.reads == 6


@pytest.mark.parametrize(("alpha", "solid"), [(0.4, False), (0.5, True)])
def test_coverage_mixes_and_hides_from_a_half_on(alpha: float, solid: bool) -> None:
    over = composited(empty(BACKDROP), above(alpha))
    wanted = [0.2 + alpha * 0.8, 0.4 * (1 - alpha), 0.6 * (1 - alpha), 1.0]
    np.testing.assert_allclose(values(over.color), wanted, atol=1e-6)
    assert over.hit is solid
    assert (float(over.distance) == 2.0) is solid


def test_an_infinite_colour_of_a_hidden_object_leaves_nothing() -> None:
    for hidden in (above(distance=5.0, red=np.inf), above(hit=False, red=np.inf)):
        near = composited(empty(BACKDROP), above(red=0.5))
        assert values(composited(near, hidden).color) == [0.5, 0.0, 0.0, 1.0]


def test_the_mean_over_a_transparent_background_has_straight_alpha() -> None:
    clear = Backdrop(Vec4(0.0))
    total = Vec4(0.0)
    for pixel in (above(), above(hit=False), above(red=0.5), above(hit=False)):
        total = total + composited(empty(clear), pixel).color
    np.testing.assert_allclose(values(averaged(total, 4, clear)), [0.75, 0.0, 0.0, 0.5])
    np.testing.assert_allclose(values(averaged(total, 4, BACKDROP)), [0.375, 0.0, 0.0, 0.5])
    assert values(averaged(Vec4(0.0), 4, clear)) == [0.0, 0.0, 0.0, 0.0]


def near_thresholds(bits: int) -> np.ndarray:
    """Every float32 within two steps of the least light of a code, and light all over the range."""
    least = srgb_thresholds(bits)[1:-1]
    around = [least]
    for end in (np.float32(-1.0), np.float32(2.0)):
        step = least
        for _ in range(2):
            step = np.nextafter(step, end)
            around.append(step)
    return np.concatenate([*around, np.linspace(-0.5, 1.5, 20_011, dtype=np.float32)])


def exact_code(light: np.ndarray, bits: int) -> np.ndarray:
    """The sRGB code in float64, rounded to the nearest."""
    encoded = srgb_encode(np.clip(light.astype(np.float64), 0, 1))
    return np.floor(encoded * (2**bits - 1) + 0.5).astype(int)


@pytest.mark.parametrize("bits", [8, 16])
def test_codes_of_arrays_are_those_of_the_exact_curve(bits: int) -> None:
    light = near_thresholds(bits)
    arrays = encode_light(np.repeat(light[:, None, None], 3, 2), bits)
    np.testing.assert_array_equal(arrays[:, 0, 0], exact_code(light, bits))


def test_codes_of_8_bits_are_those_of_the_exact_curve() -> None:
    light = near_thresholds(8)
    thresholds = Buffer([Threshold(float(each)) for each in srgb_thresholds()], Threshold)
    some = np.r_[: 5 * 255, 5 * 255 : len(light) : 40]
    found = [srgb_code(light[k], thresholds) for k in some]
    np.testing.assert_array_equal(found, exact_code(light, 8)[some])
    assert srgb_code(np.float32(np.nan), thresholds) == 0
    assert srgb_code(np.float32(np.inf), thresholds) == 255


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_codes_of_16_bits_are_those_of_the_exact_curve(device: str) -> None:
    """On a device, since there are hundreds of thousands."""
    light = near_thresholds(16)
    light = light[: len(light) // 64 * 64].reshape(-1, 64)
    planes = np.stack([light, light[::-1], light[:, ::-1], np.ones_like(light)])
    lights = PlaneBuffer(FourLights, (4 * len(light), 64), planes.reshape(-1, 64).view(np.int32))
    codes = read_codes16(choose_device(device), lights, (64, len(light)))
    for channel in range(3):
        np.testing.assert_array_equal(codes[:, :, channel], exact_code(planes[channel], 16))
    assert (codes[:, :, 3] == 65535).all()


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_a_frame_has_the_codes_of_its_colours(device: str) -> None:
    for scene in (crowd(), crowd(None), Scene(crowd().objects[:1]), Scene(())):
        frame = render(scene, size=(45, 31), samples=2, device=device)
        np.testing.assert_array_equal(frame.codes, encode_light(frame.color))


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)])
def test_a_frame_is_saved_in_16_bits(device: str, tmp_path: Path) -> None:
    for scene in (crowd(), crowd(None), Scene(crowd().objects[:1]), Scene(())):
        frame = render(scene, size=(45, 31), samples=2, device=device)
        stored = read_picture(frame.save(tmp_path / "a.png", bits=16)).pixels
        assert stored.dtype == np.uint16
        wanted = encode_light(frame.color, 16)
        assert (stored == wanted[:, :, : stored.shape[2]]).all()
        assert stored.shape[2] == 4 or (wanted[:, :, 3] == 65535).all()


def test_codes_of_16_bits_leave_the_colours_on_the_device(tmp_path: Path) -> None:
    frame = render(crowd(), size=(45, 31), samples=1, device="cpu")
    frame.save(tmp_path / "a.png", bits=16)
    assert not {"color", "_codes"} & vars(frame).keys()


def test_a_changed_colour_is_saved(tmp_path: Path) -> None:
    """Whether the codes were read before, or not."""
    for reads_codes in (False, True):
        frame = render(crowd(), size=(45, 31), samples=1, device="cpu")
        if reads_codes:
            assert frame.codes.any()
        frame.color[:, :, :3] *= 0.2
        assert frame.save(tmp_path / "a.png").is_file()
        stored = read_picture(tmp_path / "a.png").pixels[:, :, :3]
        np.testing.assert_array_equal(stored, encode_light(frame.color)[:, :, :3])


def test_a_frame_can_be_pickled() -> None:
    frame = render(crowd(), size=(45, 31), samples=1, device="cpu")
    again = pickle.loads(pickle.dumps(frame))
    for plane in ("color", "codes", "distance", "uv", "hit", "reads"):
        np.testing.assert_array_equal(getattr(again, plane), getattr(frame, plane))
    assert (again.size, again.device) == (frame.size, frame.device)


def test_a_saved_frame_equals_its_saved_image(tmp_path: Path) -> None:
    for background in ((0.1, 0.2, 0.3), None):
        frame = render(crowd(background), size=(45, 31), samples=1, device="cpu")
        for suffix in (".png", ".jpg", ".webp"):
            one, other = tmp_path / f"one{suffix}", tmp_path / f"other{suffix}"
            frame.save(one)
            frame.image.save(other)
            assert one.read_bytes() == other.read_bytes()


def crowd(background=(0.1, 0.2, 0.3)) -> Scene:
    """Objects before, behind and through one another, one of them half transparent."""
    glass = Material("glass", opacity=Map(np.full((1, 1, 1), 0.6, np.float32), False, "glass"))
    objects = (
        Object(sample("cobbles", 64), transform=LYING, scale=0.08),
        Object(glass, transform=placed((0.1, 0.3, 0.0), 0.6) @ LYING),
        Object(sample("tiles", 64), "sphere", transform=placed((0.2, 0.2, 0.1), 0.5)),
    )
    return Scene(objects, Orbit(30.0, 40.0, 1.9), shadows="hard", background=background)


def test_several_samples_are_the_mean_of_single_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one object and of several; the planes are those of the first sample."""
    from basrelief.rendering import render as render_module

    positions = render_module.sample_positions(3)
    for scene in (crowd(), Scene(crowd().objects[:1], Orbit(30.0, 40.0, 1.9))):
        whole = render(scene, size=(45, 31), samples=3, device="cpu")
        single = []
        for position in positions:
            with monkeypatch.context() as patched:
                patched.setattr(render_module, "sample_positions", lambda _, p=position: [p])
                single.append(render(scene, size=(45, 31), samples=1, device="cpu"))
        total = single[0].color + single[1].color + single[2].color
        np.testing.assert_array_equal(whole.color, total * np.float32(1 / 3))
        for plane in ("distance", "uv", "hit", "reads"):
            np.testing.assert_array_equal(getattr(whole, plane), getattr(single[0], plane))


def test_bands_make_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    from basrelief.rendering import render as render_module

    whole = render(crowd(None), size=(45, 31), samples=2, device="cpu")
    monkeypatch.setattr(render_module, "_BAND", 45 * 4)
    fractions: list[float] = []
    bands = render(crowd(None), size=(45, 31), samples=2, device="cpu", progress=fractions.append)
    np.testing.assert_array_equal(whole.color, bands.color)
    np.testing.assert_array_equal(whole.distance, bands.distance)
    assert fractions == sorted(fractions)
    assert (len(fractions), fractions[-1]) == (8 * 2 * 3, 1.0)


@pytest.mark.gpu
def test_cpu_and_gpu_agree_on_a_crowd() -> None:
    assert_engines_agree(crowd(), 64)
    assert_engines_agree(crowd(None), 64)
