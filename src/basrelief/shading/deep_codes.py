"""A picture's colours as codes of 16 bits, of planes that are on a device."""

from __future__ import annotations

from basrelief.lang import Buffer, IVec2, saturate, shader, struct
from basrelief.shading.picture import Threshold, srgb_code


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
class DeepCodes:
    """A pixel's colour in sRGB, and alpha, in 16 bits: two channels a word, the first the lower."""

    red_green: int
    blue_alpha: int


@shader
def deep_codes(
    at: IVec2, lights: Buffer[FourLights], rows: LightRows, thresholds: Buffer[Threshold]
) -> DeepCodes:
    """The codes of a pixel."""
    red = at.y * rows.row + at.x
    green = red + rows.channel
    blue = green + rows.channel
    alpha = int(saturate(light_at(lights, blue + rows.channel)) * 65535.0 + 0.5)
    return DeepCodes(
        srgb_code(light_at(lights, red), thresholds)
        | (srgb_code(light_at(lights, green), thresholds) << 16),
        srgb_code(light_at(lights, blue), thresholds) | (alpha << 16),
    )


@shader
def light_at(lights: Buffer[FourLights], index: int) -> float:
    """The light at an index, counted over all channels."""
    four = lights[index >> 2]
    place = index & 3
    if place == 0:
        return four.first
    if place == 1:
        return four.second
    if place == 2:
        return four.third
    return four.fourth
