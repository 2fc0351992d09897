"""A picture's colours as codes of 16 bits, of planes that are on a device."""

from __future__ import annotations

from basrelief.lang import Buffer, IVec2, saturate, shader, struct
from basrelief.shading.picture import corrected_code, displayed, nearest_code


@struct
class FourLights:
    """Four pixels in a row: the light of each in one channel, or its alpha."""

    first: float
    second: float
    third: float
    fourth: float


@struct
class LightRows:
    """The layout of a picture's channels, one after the other: how many lights there are from one
    row to the next, and from one channel to the next."""

    row: int
    channel: int


@struct
class Codes16:
    """A pixel's colour in sRGB, and alpha, in 16 bits: two channels a word, the first the lower."""

    red_green: int
    blue_alpha: int


@struct
class FourThresholds:
    """The least linear light of four codes of 16 bits."""

    first: float
    second: float
    third: float
    fourth: float


@shader
def codes16(
    at: IVec2, lights: Buffer[FourLights], rows: LightRows, thresholds: Buffer[FourThresholds]
) -> Codes16:
    """The codes of a pixel."""
    red = at.y * rows.row + at.x
    green = red + rows.channel
    blue = green + rows.channel
    alpha = int(saturate(light_at(lights, blue + rows.channel)) * 65535.0 + 0.5)
    return Codes16(
        code16(light_at(lights, red), thresholds)
        | (code16(light_at(lights, green), thresholds) << 16),
        code16(light_at(lights, blue), thresholds) | (alpha << 16),
    )


@shader
def code16(linear: float, thresholds: Buffer[FourThresholds]) -> int:
    """The 16-bit sRGB code of linear light."""
    light = displayed(linear)
    code = nearest_code(light, 65535.0)
    return corrected_code(
        code, light, threshold_of(thresholds, code), threshold_of(thresholds, code + 1)
    )


@shader
def light_at(lights: Buffer[FourLights], index: int) -> float:
    """The light at an index, counted over all channels."""
    four = lights[index >> 2]
    return one_of(four.first, four.second, four.third, four.fourth, index & 3)


@shader
def threshold_of(thresholds: Buffer[FourThresholds], code: int) -> float:
    four = thresholds[code >> 2]
    return one_of(four.first, four.second, four.third, four.fourth, code & 3)


@shader
def one_of(first: float, second: float, third: float, fourth: float, place: int) -> float:
    """The number at a place from 0 to 3."""
    if place == 0:
        return first
    if place == 1:
        return second
    if place == 2:
        return third
    return fourth
