"""A picture as video: luma for each pixel, and chroma at half resolution.

The matrix is that of ITU-R BT.709-6, Parameter values for the HDTV standards, 2015, items 3.2 to
3.5: luma from 16 to 235, chroma from 16 to 240 around 128. The arithmetic is in integers, so that
all engines agree.
"""

from __future__ import annotations

from basrelief.lang import Buffer, IVec2, shader, struct


@struct
class FourCodes:
    """Four pixels in a row: the colour of each as four bytes in sRGB, red the lowest."""

    first: int
    second: int
    third: int
    fourth: int


@struct
class CodeRows:
    """The layout of a picture's codes: how many there are from one row to the next."""

    stride: int


@struct
class VideoBlock:
    """Two by two pixels of a video: four lumas as bytes, the upper left the lowest, then the upper
    right; and the bytes of Cb and Cr."""

    luma: int
    chroma: int


@shader
def video_block(at: IVec2, codes: Buffer[FourCodes], rows: CodeRows) -> VideoBlock:
    """The block whose upper left pixel is at twice the coordinates.

    The chroma is at the centre of the block's left side, where H.264 has it by default: columns
    have the weights 1, 2, 1.
    """
    x = at.x * 2
    y = at.y * 2
    left = max(x - 1, 0)
    row = y * rows.stride
    next_row = row + rows.stride
    upper = code_at(codes, row + x)
    upper_right = code_at(codes, row + x + 1)
    upper_left = code_at(codes, row + left)
    lower = code_at(codes, next_row + x)
    lower_right = code_at(codes, next_row + x + 1)
    lower_left = code_at(codes, next_row + left)
    luma = (
        luma_of(upper)
        | (luma_of(upper_right) << 8)
        | (luma_of(lower) << 16)
        | (luma_of(lower_right) << 24)
    )
    # eight times the mean of each channel
    sides = red(upper_left) + red(upper_right) + red(lower_left) + red(lower_right)
    r = sides + 2 * (red(upper) + red(lower))
    sides = green(upper_left) + green(upper_right) + green(lower_left) + green(lower_right)
    g = sides + 2 * (green(upper) + green(lower))
    sides = blue(upper_left) + blue(upper_right) + blue(lower_left) + blue(lower_right)
    b = sides + 2 * (blue(upper) + blue(lower))
    # of 65536: 224 ÷ 255, times −0.1146, −0.3854 and 0.5
    cb = (b * 28784 - r * 6596 - g * 22188 + MIDDLE) >> 19
    cr = (r * 28784 - g * 26145 - b * 2639 + MIDDLE) >> 19
    return VideoBlock(luma, cb | (cr << 8))


MIDDLE = (128 << 19) + (1 << 18)
"""Chroma without colour, and one half for rounding."""


@shader
def code_at(codes: Buffer[FourCodes], index: int) -> int:
    """The code of a pixel, counted row by row."""
    four = codes[index >> 2]
    place = index & 3
    if place == 0:
        return four.first
    if place == 1:
        return four.second
    if place == 2:
        return four.third
    return four.fourth


@shader
def luma_of(code: int) -> int:
    """The luma of a pixel, 16 to 235."""
    # of 65536: 219 ÷ 255, times 0.2126, 0.7152 and 0.0722
    return (red(code) * 11966 + green(code) * 40254 + blue(code) * 4064 + LUMA_OFFSET) >> 16


LUMA_OFFSET = (16 << 16) + (1 << 15)
"""The luma of black, and one half for rounding."""


@shader
def red(code: int) -> int:
    return code & 255


@shader
def green(code: int) -> int:
    return (code >> 8) & 255


@shader
def blue(code: int) -> int:
    return (code >> 16) & 255
