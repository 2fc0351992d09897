"""Video pictures: luma and chroma by the matrix of BT.709, the same on every device."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.engine import choose_device
from basrelief.engine import gpu as gpu_module
from basrelief.engine.cpu import CpuEngine
from basrelief.engine.engine import Engine
from basrelief.images import encode_light
from basrelief.material import sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.rendering.video import video_picture
from basrelief.scene import BACKGROUND, Object, Scene, directional

SIZE = (90, 46)
DEVICES = ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)]


def engine_named(name: str) -> Engine:
    return CpuEngine(8, 2) if name == "cpu" else choose_device("gpu")


def scene(**options) -> Scene:
    stones = sample("gravel")
    red, blue = (
        directional(30, 40, color=(3.0, 0.2, 0.1)),
        directional(200, 30, color=(0.1, 0.3, 3)),
    )
    return Scene((Object(stones, technique="relief", shape="box"),), lights=(red, blue), **options)


def bt709(codes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Y, Cb and Cr of sRGB codes (h, w, 3), before they are rounded; chroma at half resolution,
    with the weights 1, 2, 1 along a row, and the first column repeated before the picture."""
    r, g, b = (codes[:, :, :3].astype(float) / 255.0).transpose(2, 0, 1)
    y = 0.2126 * r + 0.7152 * g + 0.0722 * b
    cb, cr = (b - y) / 1.8556, (r - y) / 1.5748

    def halved(plane: np.ndarray) -> np.ndarray:
        before = np.concatenate([plane[:, :1], plane], 1)
        columns = (before[:, :-1:2] + 2.0 * plane[:, ::2] + plane[:, 1::2]) / 4.0
        return (columns[::2] + columns[1::2]) / 2.0

    return 16.0 + 219.0 * y, 128.0 + 224.0 * halved(cb), 128.0 + 224.0 * halved(cr)


def planes(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    height, width = picture.shape[0] * 2 // 3, picture.shape[1]
    chroma = picture[height:].reshape(2, height // 2, width // 2)
    return picture[:height], chroma[0], chroma[1]


def check(picture: np.ndarray, codes: np.ndarray) -> None:
    assert picture.shape == (codes.shape[0] * 3 // 2, codes.shape[1])
    for plane, exact in zip(planes(picture), bt709(codes), strict=True):
        assert np.abs(plane - exact).max() <= 0.51


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("size", [SIZE, (2, 2), (2, 64), (130, 4)])
def test_a_drawn_frame(device: str, size: tuple[int, int]) -> None:
    frame = render(scene(), size=size, samples=2, device=engine_named(device))
    picture = video_picture(frame)
    assert "_codes" not in vars(frame)
    check(picture, frame.codes)


@pytest.mark.gpu
def test_a_canvas_in_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = video_picture(render(scene(), size=SIZE, device="gpu"))
    monkeypatch.setattr(gpu_module, "_MAX_CANVAS_BYTES", 11 * 10 * 4 * SIZE[0])
    frame = render(scene(), size=SIZE, device="gpu")
    assert len(frame._canvas.bands) == 5
    assert (video_picture(frame) == drawn).all()


@pytest.mark.parametrize("device", DEVICES)
def test_several_objects(device: str) -> None:
    both = Scene((*scene().objects, Object(sample("bricks"))))
    frame = render(both, size=SIZE, device=engine_named(device))
    check(video_picture(frame), frame.codes)


def test_a_colour_that_was_changed() -> None:
    frame = render(scene(), size=SIZE, device="cpu")
    frame.color[10:, 20:, :3] = (0.9, 0.1, 0.05)
    check(video_picture(frame), encode_light(frame.color))


def test_a_transparent_frame_lies_over_the_background() -> None:
    frame = render(scene(background=None), size=SIZE, device="cpu")
    color, alpha = frame.color[:, :, :3], frame.color[:, :, 3:]
    assert 0.0 == alpha.min() < alpha.max() == 1.0
    over = encode_light(color * alpha + np.float32(BACKGROUND) * (1 - alpha))
    check(video_picture(frame), over)


def test_a_frame_of_arrays() -> None:
    color = np.random.default_rng(3).random((6, 8, 4), np.float32)
    color[:, :, 3] = 1.0
    flat = np.zeros((6, 8), np.float32)
    frame = Frame(color, flat, np.zeros((6, 8, 2), np.float32), flat > 0, flat.astype(np.int32), "")
    check(video_picture(frame), encode_light(color))
