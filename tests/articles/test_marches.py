"""The marches beside the code that their articles print, in float64 NumPy, against the oracle.

Nothing here is shared with the shaders: the articles' loops read their own bilinear surface.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from basrelief import preset
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import HeightField, IVec2, Texture, Vec2, cos, shader, sin, struct, tan
from basrelief.lang.program import Program
from basrelief.material import SAMPLES, sample
from basrelief.measure.oracle import intersect_height_field
from basrelief.techniques import Ray, displace, parallax_occlusion, relief
from basrelief.techniques.march import March, Relief
from basrelief.techniques.technique import Settings
from helpers.rays import maps, scattered

Floats = NDArray[np.float64]
Surface = Callable[[Floats], Floats]
"""Heights for every t of n rays, (n,)."""

SIZES = ((61, 37), (96, 96), (251, 173))
"""Columns and rows of the maps of noise."""
SCALE = 0.1
PICTURE = (72, 48)


# --- the articles' searches -----------------------------------------------------------------------


def catlike(surface: Surface, count: int, steps: int, search_steps: int) -> Floats:
    """Catlike Coding, Rendering 20: march at most N − 1 times, then halve forwards or back from
    there, whether or not the surface was hit."""
    t = np.zeros(count)
    below = surface(t) >= 1.0
    for _ in range(steps - 1):
        t = np.where(below, t, t + 1.0 / steps)
        below = surface(t) >= 1.0 - t
    step = 1.0 / steps
    for _ in range(search_steps):
        step /= 2.0
        t = np.where(surface(t) > 1.0 - t, t - step, t + step)
    return t


def policarpo(surface: Surface, count: int, steps: int, search_steps: int) -> Floats:
    """Policarpo, Oliveira and Comba 2005: the first of the depths 1/N … (N − 1)/N under the
    surface, else depth 1; then halve the step, and keep the least depth that is under it."""
    depth = np.zeros(count)
    best = np.ones(count)
    for _ in range(steps - 1):
        depth = depth + 1.0 / steps
        best = np.where((best == 1.0) & (depth >= 1.0 - surface(depth)), depth, best)
    depth = best.copy()
    size = 1.0 / steps
    for _ in range(search_steps):
        size /= 2.0
        under = depth >= 1.0 - surface(depth)
        best = np.where(under, depth, best)
        depth = np.where(under, depth - size, depth + size)
    return best


def gamedev(surface: Surface, cosine: Floats, min_steps: int, max_steps: int) -> Floats:
    """Zink 2006: the number of samples truncated; the first sample above the ray gives the chord of
    its step; a ray without one ends at the full limit, t = 1."""
    samples = np.trunc(max_steps + (min_steps - max_steps) * cosine)
    step = 1.0 / samples
    ray, last = np.ones_like(cosine), np.ones_like(cosine)
    t, result = np.zeros_like(cosine), np.full_like(cosine, np.nan)
    for k in range(max_steps):
        sampled = surface(t)
        active = np.isnan(result) & (k < samples)
        over, under = sampled - ray, ray + step - last
        hit = active & (over > 0.0)
        ratio = over / np.where(hit, over + under, 1.0)
        result = np.where(hit, t - ratio * step, result)
        going_on = active & ~hit
        ray, t = np.where(going_on, ray - step, ray), np.where(going_on, t + step, t)
        last = np.where(going_on, sampled, last)
    return np.where(np.isnan(result), 1.0, result)


ARTICLES = {"catlike": catlike, "policarpo": policarpo}


# --- rays and maps --------------------------------------------------------------------------------


@struct
class Views:
    """Rays in all directions, from 20 to 80 degrees off the normal, on a relief of a tile of
    `columns` × `rows` texels."""

    scale: float
    columns: float
    rows: float
    lod: float


@struct
class TracedView:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    hit_uv: Vec2
    cosine: float
    t: float
    found: bool


@shader
def traced(
    at: IVec2, views: Views, field: HeightField, baked: Texture, settings: Settings
) -> TracedView:
    """A random ray, traced by the bound technique."""
    n = (at.y * 8192 + at.x) * 4
    uv = Vec2(scattered(n), scattered(n + 1))
    angle = 0.35 + scattered(n + 2) * 1.05
    azimuth = scattered(n + 3) * 6.2831853
    reach = tan(angle) * views.scale
    travel = Vec2(cos(azimuth), sin(azimuth) * views.columns / views.rows) * reach
    ray = Ray(uv, travel, 1.0, 1.0, cos(angle), scale=views.scale, lod=views.lod)
    hit = displace(field, baked, ray, settings)
    return TracedView(uv, travel, hit.uv, ray.cosine, hit.t, hit.found)


@functools.cache
def heights_of(name: str) -> NDArray[np.float32]:
    """A sample, a map of the other tests, or noise of a size, with some ground below 1/N."""
    if name in SAMPLES:
        height = sample(name, (90, 128)).height
        assert height is not None
        return np.asarray(height.linear()[:, :, 0], np.float32)
    if name in maps():
        return np.asarray(maps()[name], np.float32)
    columns, rows = (int(number) for number in name.split(" x "))
    random = np.random.default_rng(columns)
    y, x = np.mgrid[0:rows, 0:columns]
    waves = np.sin(x * (6 * np.pi / columns)) * np.cos(y * (4 * np.pi / rows) + 1.0)
    heights = 0.45 + 0.5 * waves + 0.1 * random.random((rows, columns))
    return np.clip(heights, 0.0, 1.0).astype(np.float32)


NOISE = tuple(f"{columns} x {rows}" for columns, rows in SIZES)
RELIEFS = tuple(name for name in SAMPLES if sample(name, (6, 8)).height is not None)
NAMES = (*NOISE, *RELIEFS, *(name for name in maps() if name not in SAMPLES))


def surface_of(heights: NDArray[np.float32], uv: Floats, travel: Floats) -> Surface:
    """The bilinear surface under rays, repeated."""
    values = heights.astype(np.float64)
    rows, columns = values.shape

    def surface(t: Floats) -> Floats:
        x, y = ((uv + travel * t[:, None]) * (columns, rows) - 0.5).T
        left, top = np.floor(x).astype(int), np.floor(y).astype(int)
        a, b = x - left, y - top
        above = (
            values[top % rows, left % columns] * (1 - a)
            + a * (values[top % rows, (left + 1) % columns])
        )
        below = (
            values[(top + 1) % rows, left % columns] * (1 - a)
            + a * (values[(top + 1) % rows, (left + 1) % columns])
        )
        return above * (1 - b) + below * b

    return surface


def rays_of(
    name: str, technique: Any, settings: Any, levels: Sequence[NDArray[np.float32]], lod: float
) -> tuple[Floats, Floats, dict[str, NDArray[Any]]]:
    """The rays of a map, traced on the CPU: uv and travel, (n, 2), and the planes."""
    kind = "smooth" if len(levels) > 1 else "sharp"
    program = Program(traced, {displace: technique}, "wrap", kind)
    rows, columns = levels[0].shape
    arguments = {
        "field": HeightField(levels, "wrap", kind),
        "views": Views(SCALE, float(columns), float(rows), lod),
        "settings": settings,
    }
    planes = CpuEngine().run(program, arguments, PICTURE)
    flat = {key: plane.ravel() for key, plane in planes.items()}
    uv, travel = (
        np.stack([flat[f"{key}.x"], flat[f"{key}.y"]], -1).astype(np.float64)
        for key in ("uv", "travel")
    )
    return uv, travel, flat


def texels_off(name: str, t: Floats, uv: Floats, travel: Floats) -> Floats:
    """Distance of a hit from the true one, in texels."""
    heights = heights_of(name)
    true = intersect_height_field(heights, uv, travel, "wrap")
    texels = travel * heights.shape[::-1]
    return np.abs(t - true.t) * np.hypot(texels[:, 0], texels[:, 1])


# --- comparisons ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_relief_misses_no_more_than_the_code_of_its_articles(name: str) -> None:
    """The share of rays that end more than one texel off, with the same steps: at most that of
    either article. All rays are found, since the base is under every surface."""
    for steps, search_steps in ((10, 3), (16, 5), (32, 6)):
        uv, travel, planes = rays_of(
            name, relief, Relief(steps, steps, search_steps), [heights_of(name)], 0.0
        )
        assert planes["found"].all()
        surface = surface_of(heights_of(name), uv, travel)
        share = (texels_off(name, planes["t"].astype(np.float64), uv, travel) > 1.0).mean()
        for article in ARTICLES.values():
            t = article(surface, len(uv), steps, search_steps)
            assert share <= (texels_off(name, t, uv, travel) > 1.0).mean()


@pytest.mark.parametrize("name", NOISE)
def test_catlike_march_ends_where_its_article_does(name: str) -> None:
    """Within 0.002 texel, on noise: also where the surface lies below the last layer."""
    settings = preset("catlike-march").values["object"]["settings"]
    steps, search_steps = settings["min_steps"], settings["search_steps"]
    uv, travel, planes = rays_of(
        name, relief, Relief(steps, steps, search_steps), [heights_of(name)], 0.0
    )
    t = catlike(surface_of(heights_of(name), uv, travel), len(uv), steps, search_steps)
    texels = travel * heights_of(name).shape[::-1]
    off = np.abs(planes["t"] - t) * np.hypot(texels[:, 0], texels[:, 1])
    # rays that start on the surface stay there, where the article searches below it
    starts_above = surface_of(heights_of(name), uv, travel)(np.zeros(len(uv))) < 1.0
    assert starts_above.mean() > 0.9
    assert (t[starts_above] > 1.0 - 1.0 / steps).any()
    # a comparison that float32 decides otherwise moves a search by a halving
    assert (off[starts_above] > 0.002).mean() < 1e-3


@pytest.mark.parametrize("lod", [0.0, 0.6, 2.3])
@pytest.mark.parametrize("name", NOISE)
def test_gamedev_ends_where_its_article_does(name: str, lod: float) -> None:
    """Within 0.002 texel, with trilinear heights at the level of the undisplaced coordinates.

    On purpose another: where no sample is above the ray the article ends at the full limit. Here
    the chord of the last step ends between there and the last sample.
    """
    made = preset("gamedev").values["object"]
    settings = made["settings"]
    assert (made["heights"], made["smoothing"]["mip_bias"], made["smoothing"]["mip_fade"]) == (
        "smooth", 0.0, 0.0,
    )  # fmt: skip
    least, most = settings["min_steps"], settings["max_steps"]
    levels = levels_of(heights_of(name))
    uv, travel, planes = rays_of(name, parallax_occlusion, March(least, most), levels, lod)
    finer = math.floor(lod)
    surfaces = [surface_of(levels[finer + k], uv, travel) for k in (0, 1)]

    def trilinear(t: Floats) -> Floats:
        return surfaces[0](t) * (finer + 1 - lod) + surfaces[1](t) * (lod - finer)

    cosine = planes["cosine"].astype(np.float64)
    samples = np.trunc(most + (least - most) * cosine)
    t = gamedev(trilinear, cosine, least, most)
    texels = travel * levels[0].shape[::-1]
    off = np.abs(planes["t"] - t) * np.hypot(texels[:, 0], texels[:, 1])
    unhit = t == 1.0
    assert planes["found"].all()
    assert unhit.mean() < 0.4
    assert unhit.any() or lod > 1.0
    assert (planes["t"][unhit] >= 1.0 - 1.0 / samples[unhit] - 1e-6).all()
    assert (off[~unhit] > 0.002).mean() < 1e-3


def levels_of(heights: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    """The map at level 0, then smaller maps; here any will do."""
    levels = [heights]
    while min(levels[-1].shape) > 1:
        rows, columns = (n // 2 * 2 for n in levels[-1].shape)
        even = levels[-1][:rows, :columns].astype(np.float64)
        mean = (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]) / 4
        levels.append(mean.astype(np.float32))
    return levels
