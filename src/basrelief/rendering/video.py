"""The pictures of a video, converted from a frame's codes on the device that drew it."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine, PlaneBuffer, choose_device
from basrelief.images import encode_light
from basrelief.lang.program import Program
from basrelief.rendering.frame import Frame
from basrelief.scene import BACKGROUND
from basrelief.shading.video import CodeRows, FourCodes, video_block
from basrelief.timings import step


@functools.cache
def _program() -> Program:
    return Program(video_block)


@step("draw")
def video_picture(frame: Frame) -> NDArray[np.uint8]:
    """The picture of a frame in BT.709, 16 to 235, with chroma at half resolution.

    Transparent frames are composited over `BACKGROUND`.

    Parameters
    ----------
    frame
        A frame of even sides.

    Returns
    -------
    NDArray
        (height × 3 / 2, width): the rows of Y, and then those of Cb and of Cr, which are half as
        long, two in a row. FFmpeg calls it yuv420p.
    """
    on_device = frame.on_device("codes", FourCodes) if frame.is_opaque else None
    engine, codes = on_device or _codes_in_memory(frame)
    width, height = frame.size
    canvas = engine.canvas(_program(), (width // 2, height // 2))
    rows = CodeRows(codes.shape[1])
    engine.draw(_program(), {"codes": codes, "rows": rows}, canvas)
    luma, chroma = canvas.read("luma", 2)
    picture = np.empty((height * 3 // 2, width), np.uint8)
    # two lumas of a row at once
    pairs = np.ascontiguousarray(luma).view(np.uint16).reshape(height // 2, width // 2, 2)
    upper_and_lower = picture[:height].view(np.uint16).reshape(height // 2, 2, width // 2)
    upper_and_lower[:] = pairs.transpose(0, 2, 1)
    colors = np.ascontiguousarray(chroma).view(np.uint8).reshape(height // 2, width // 2, 4)
    picture[height:].reshape(2, height // 2, width // 2)[:] = colors[:, :, :2].transpose(2, 0, 1)
    return picture


def _codes_in_memory(frame: Frame) -> tuple[Engine, PlaneBuffer[FourCodes]]:
    """The CPU engine, and the codes of a frame over the default background as its buffer."""
    codes = frame.codes
    if (codes[:, :, 3] < 255).any():
        color, alpha = frame.color[:, :, :3], frame.color[:, :, 3:]
        behind = np.array(BACKGROUND, np.float32)
        covered = np.concatenate([color * alpha + behind * (1 - alpha), np.ones_like(alpha)], 2)
        codes = encode_light(covered)
    words = np.ascontiguousarray(codes).view("<i4")[:, :, 0]
    return choose_device("cpu"), PlaneBuffer(FourCodes, words.shape, words)
