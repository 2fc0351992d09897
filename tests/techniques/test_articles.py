"""The marches beside the code that their articles print, in float64 NumPy, against the oracle.

Nothing here is shared with the shaders: the articles' loops read their own bilinear surface.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
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
from basrelief.techniques import Ray, displace, relief
from basrelief.techniques.march import Relief
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


ARTICLES = {"catlike": catlike, "policarpo": policarpo}


# --- rays and maps --------------------------------------------------------------------------------


@struct
class Views:
    """Rays in all directions, from 20 to 80 degrees off the normal, on a relief of a tile of
    `columns` × `rows` texels."""

    scale: float
    columns: float
    rows: float


@struct
class TracedView:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    hit_uv: Vec2
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
    ray = Ray(uv, travel, 1.0, 1.0, cos(angle), scale=views.scale)
    hit = displace(field, baked, ray, settings)
    return TracedView(uv, travel, hit.uv, hit.t, hit.found)


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


def rays_of(name: str, settings: Any) -> tuple[Floats, Floats, dict[str, NDArray[Any]]]:
    """The rays of a map, traced by `relief` on the CPU: uv and travel, (n, 2), and the planes."""
    heights = heights_of(name)
    program = Program(traced, {displace: relief}, "wrap")
    rows, columns = heights.shape
    arguments = {
        "field": HeightField([heights], "wrap"),
        "views": Views(SCALE, float(columns), float(rows)),
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
        uv, travel, planes = rays_of(name, Relief(steps, steps, search_steps))
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
    uv, travel, planes = rays_of(name, Relief(steps, steps, search_steps))
    t = catlike(surface_of(heights_of(name), uv, travel), len(uv), steps, search_steps)
    texels = travel * heights_of(name).shape[::-1]
    off = np.abs(planes["t"] - t) * np.hypot(texels[:, 0], texels[:, 1])
    # rays that start on the surface stay there, where the article searches below it
    starts_above = surface_of(heights_of(name), uv, travel)(np.zeros(len(uv))) < 1.0
    assert starts_above.mean() > 0.9
    assert (t[starts_above] > 1.0 - 1.0 / steps).any()
    # a comparison that float32 decides otherwise moves a search by a halving
    assert (off[starts_above] > 0.002).mean() < 1e-3
