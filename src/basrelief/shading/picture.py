"""A picture from the pixels of its objects: composited from far to near, averaged over samples.

A scene of one object takes one run of `picture`. One of several takes a run of `layer` for each
sample of each object, over what the planes hold; the last run takes the mean.
"""

from __future__ import annotations

from basrelief.lang import (
    Buffer,
    HeightField,
    IVec2,
    Texture,
    Vec2,
    Vec4,
    pow,
    saturate,
    shader,
    struct,
)
from basrelief.shading.brdf import Shading
from basrelief.shading.fog import Fog
from basrelief.shading.geometry import Geometry
from basrelief.shading.intersection import CameraSample, Placement
from basrelief.shading.lights import Light
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.pixel import SOLID, Pixel, pixel
from basrelief.shading.relief import ReliefParameters
from basrelief.shading.self_shadow import Shadowing
from basrelief.shading.shadow_map import ShadowMapView
from basrelief.shading.surfaces.surface import MapTilings, SurfaceSettings
from basrelief.shading.variant import Variant
from basrelief.techniques.height import Smoothing
from basrelief.techniques.technique import Settings

NOWHERE = 3.0e38
"""Distance where nothing is hit, beyond every hit."""
MIN_COVERAGE = 1e-6
"""The lower limit of coverage where colours are divided by it."""


@struct
class SamplePosition:
    """Position of a sample within a pixel, 0 to 1."""

    x: float
    y: float


@struct
class Backdrop:
    """The background: a linear colour and coverage 1, or 0 in all for none."""

    color: Vec4


@struct
class Threshold:
    """The least linear light of an 8-bit sRGB code."""

    light: float


@struct
class Drawn:
    """A pixel of a picture.

    `color` is linear, with coverage; `codes` has it as four bytes, red the lowest, in sRGB. The
    others are those of the first sample: `distance` is along the ray in world units, `uv` are the
    displaced texture coordinates, `hit` says whether the pixel shows an object, and `reads` counts
    the heights read.
    """

    color: Vec4
    codes: int
    distance: float
    uv: Vec2
    hit: bool
    reads: int


@struct
class Layered:
    """A pixel whose objects are being composited: the picture so far, and the colour and the
    distance of the current sample."""

    drawn: Drawn
    color: Vec4
    distance: float


@struct
class Step:
    """Position of a run of `layer`: the index of its object, counted from the farthest, and of its
    sample, and how many there are of each."""

    layer: int
    layers: int
    sample: int
    samples: int


@shader
def empty(backdrop: Backdrop) -> Drawn:
    """A pixel without objects."""
    return Drawn(backdrop.color, 0, NOWHERE, Vec2(0.0), False, 0)


@shader
def composited(below: Drawn, above: Pixel) -> Drawn:
    """An object's pixel over those farther away, where it is nearer.

    The colour is premultiplied by coverage, so that samples can be added. Coverage below `SOLID`
    leaves the distance unchanged, and so hides nothing that follows.
    """
    reads = below.reads + above.reads
    if not above.hit or above.distance >= below.distance:
        return Drawn(below.color, 0, below.distance, below.uv, below.hit, reads)
    coverage = above.color.w
    color = below.color * (1.0 - coverage) + Vec4(above.color.xyz * coverage, coverage)
    if coverage < SOLID:
        return Drawn(color, 0, below.distance, below.uv, below.hit, reads)
    return Drawn(color, 0, above.distance, above.uv, True, reads)


@shader
def averaged(total: Vec4, count: int, backdrop: Backdrop) -> Vec4:
    """The mean of the samples' colours; over a transparent background with straight alpha."""
    mean = total * (1.0 / float(count))
    if backdrop.color.w > 0.0:
        return mean
    return Vec4(mean.xyz / max(mean.w, MIN_COVERAGE), mean.w)


@shader
def finished(first: Drawn, color: Vec4, thresholds: Buffer[Threshold]) -> Drawn:
    """The pixel with its mean colour, and that colour's codes."""
    codes = (
        srgb_code(color.x, thresholds)
        | (srgb_code(color.y, thresholds) << 8)
        | (srgb_code(color.z, thresholds) << 16)
        | (int(saturate(color.w) * 255.0 + 0.5) << 24)
    )
    return Drawn(color, codes, first.distance, first.uv, first.hit, first.reads)


@shader
def srgb_code(linear: float, thresholds: Buffer[Threshold]) -> int:
    """The 8-bit sRGB code of linear light."""
    light = displayed(linear)
    code = nearest_code(light, 255.0)
    return corrected_code(code, light, thresholds[code].light, thresholds[code + 1].light)


@shader
def displayed(linear: float) -> float:
    """Linear light from 0 to 1; a NaN is black."""
    # in this order
    return min(max(0.0, linear), 1.0)


@shader
def nearest_code(light: float, largest: float) -> int:
    """The sRGB code of light, 0 to 1, by the curve; off by one where an engine rounds otherwise.

    Source: IEC 61966-2-1:1999, Default RGB colour space, sRGB.
    """
    encoded = 12.92 * light
    if light > 0.0031308:
        encoded = 1.055 * pow(light, 1.0 / 2.4) - 0.055
    return int(encoded * largest + 0.5)


@shader
def corrected_code(code: int, light: float, least: float, next_least: float) -> int:
    """The exact code, by the least light of the nearest code and of the next, so that all engines
    agree."""
    if light < least:
        return code - 1
    if light >= next_least:
        return code + 1
    return code


@shader
def picture(
    at: IVec2,
    sample: CameraSample,
    positions: Buffer[SamplePosition],
    backdrop: Backdrop,
    thresholds: Buffer[Threshold],
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    surface_parameters: SurfaceSettings,
    tilings: MapTilings,
    shading: Shading,
    shadowing: Shadowing,
    fog: Fog,
    geometry: Geometry,
    field: HeightField,
    baked: Texture,
    maps: SurfaceMaps,
    lights: Buffer[Light],
    distances: HeightField,
    views: Buffer[ShadowMapView],
    variant: Variant,
) -> Drawn:
    """The picture of one object: all its samples."""
    total = Vec4(0.0)
    first = empty(backdrop)
    for k in range(len(positions)):
        offset = Vec2(positions[k].x, positions[k].y)
        drawn = composited(
            empty(backdrop),
            pixel(
                at,
                CameraSample(sample.camera, offset),
                placement,
                relief,
                smoothing,
                settings,
                surface_parameters,
                tilings,
                shading,
                shadowing,
                fog,
                geometry,
                field,
                baked,
                maps,
                lights,
                distances,
                views,
                variant,
            ),
        )
        if k == 0:
            first = drawn
            total = drawn.color
        else:
            total = total + drawn.color
    return finished(first, averaged(total, len(positions), backdrop), thresholds)


@shader
def layer(
    at: IVec2,
    stored: Layered,
    step: Step,
    sample: CameraSample,
    backdrop: Backdrop,
    thresholds: Buffer[Threshold],
    placement: Placement,
    relief: ReliefParameters,
    smoothing: Smoothing,
    settings: Settings,
    surface_parameters: SurfaceSettings,
    tilings: MapTilings,
    shading: Shading,
    shadowing: Shadowing,
    fog: Fog,
    geometry: Geometry,
    field: HeightField,
    baked: Texture,
    maps: SurfaceMaps,
    lights: Buffer[Light],
    distances: HeightField,
    views: Buffer[ShadowMapView],
    variant: Variant,
) -> Layered:
    """One sample of one object, over the objects behind it."""
    above = pixel(
        at,
        sample,
        placement,
        relief,
        smoothing,
        settings,
        surface_parameters,
        tilings,
        shading,
        shadowing,
        fog,
        geometry,
        field,
        baked,
        maps,
        lights,
        distances,
        views,
        variant,
    )
    drawn = stored.drawn
    below = Drawn(stored.color, 0, stored.distance, drawn.uv, drawn.hit, drawn.reads)
    if step.layer == 0:
        below = empty(backdrop)
    over = composited(below, above)
    if step.sample == 0:
        drawn = over
    if step.layer == step.layers - 1:
        drawn = with_sample(drawn, over.color, step, backdrop, thresholds)
    return Layered(drawn, over.color, over.distance)


@shader
def with_sample(
    drawn: Drawn, color: Vec4, step: Step, backdrop: Backdrop, thresholds: Buffer[Threshold]
) -> Drawn:
    """The pixel with one more sample; the last one is followed by the mean."""
    total = color if step.sample == 0 else drawn.color + color
    if step.sample == step.samples - 1:
        return finished(drawn, averaged(total, step.samples, backdrop), thresholds)
    return Drawn(total, 0, drawn.distance, drawn.uv, drawn.hit, drawn.reads)
