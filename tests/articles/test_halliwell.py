"""The presets `halliwell-stock` and `halliwell` beside their article's code and text."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import basrelief
from articles import halliwell, maps, view, wikibooks
from articles.agreement import (
    COLOR_TOLERANCE,
    DOUBT,
    EYES,
    PICTURE,
    SIZES,
    agrees,
    draw,
    material,
    write,
)

LAMPS = [view.sun(-50.0, 8.0, (0.9, 0.8, 0.6)), view.sun(100.0, 6.0, (0.3, 0.4, 0.5))]
AMBIENT = np.full(3, 0.1)
"""The library's, as the presets have none."""
SHADOW_STEPS = 160
"""Of the reference: far more than one to a texel."""
SAME_SHADOW = 0.97
"""Least share of the pixels at which both march to the same answer."""


@dataclass(frozen=True)
class MapSet:
    """Maps of one size: heights, colour, normals and occlusion."""

    height: maps.Sampler
    color: maps.Sampler
    normal: maps.Sampler
    occlusion: maps.Sampler


def map_set(
    folder: Path, preset: str, columns: int, rows: int
) -> tuple[basrelief.Material, MapSet]:
    heights, occlusion = maps.noise(columns, rows, 1), maps.noise(columns, rows, 3)
    color, normals = maps.colors(columns, rows, 7), maps.normals(columns, rows, 5)
    files = material(
        preset,
        height=write(folder, "h", heights),
        base_color=write(folder, "c", color),
        normal=write(folder, "n", normals),
        occlusion=write(folder, "o", occlusion),
    )
    return files, MapSet(
        maps.sampler(heights / maps.CODE),
        maps.sampler(maps.decoded(color)),
        maps.sampler(normals / maps.CODE),
        maps.sampler(occlusion / maps.CODE),
    )


@dataclass(frozen=True)
class Shaded:
    """The shading after the offset, the same for both presets: maps at `uv`, and Phong's model,
    which they chose."""

    quad: view.Fragments
    samplers: MapSet
    uv: np.ndarray
    height: np.ndarray

    @property
    def normal(self) -> np.ndarray:
        return view.unit(self.samplers.normal.grad(self.uv, self.quad.gradients) * 2.0 - 1.0)

    @property
    def occlusion(self) -> np.ndarray:
        return self.samplers.occlusion.grad(self.uv, self.quad.gradients)

    def pixels(
        self, preset: str, margin: np.ndarray, visible: list[np.ndarray] | None = None
    ) -> view.Pixels:
        surface = basrelief.preset(preset).values["object"]["surface_parameters"]
        colors, closest = wikibooks.phong(
            view.to_world(self.normal),
            self.quad.view,
            self.quad.raised(self.height),
            LAMPS,
            color=self.samplers.color.grad(self.uv, self.quad.gradients),
            spec_color=np.array(surface["specular"]),
            shininess=surface["shininess"],
            ambient=AMBIENT * self.occlusion,
            visible=visible,
        )
        return view.Pixels(self.uv, colors, self.height, np.minimum(margin, closest))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
def test_halliwell_stock_draws_the_printed_offset(
    size: tuple[int, int], eye: str, tmp_path: Path
) -> None:
    quad = view.fragments(EYES[eye], PICTURE, size[0] / size[1])
    files, samplers = map_set(tmp_path, "halliwell-stock", *size)
    scale = basrelief.preset("halliwell-stock").values["object"]["scale"]
    offset, height = halliwell.stock_offset(samplers.height, quad, scale)
    shaded = Shaded(quad, samplers, quad.uv + offset, height)
    expected = shaded.pixels("halliwell-stock", np.full(len(height), np.inf))
    agrees(draw("halliwell-stock", files, EYES[eye], quad, LAMPS), quad, expected, size)


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
def test_halliwell_draws_its_article(size: tuple[int, int], eye: str, tmp_path: Path) -> None:
    """Without shadows each pixel agrees; with them it agrees with one answer to each light, which
    mostly is that of a much finer march."""
    quad = view.fragments(EYES[eye], PICTURE, size[0] / size[1])
    files, samplers = map_set(tmp_path, "halliwell", *size)
    tables = basrelief.preset("halliwell").values
    obj, scale = tables["object"], tables["object"]["scale"]
    steps = obj["settings"]
    smoothing = obj["smoothing"]
    height = halliwell.smooth_heights(
        samplers.height, quad, smoothing["mip_bias"], smoothing["mip_fade"]
    )
    offset = halliwell.march(
        quad, height, scale, steps["min_steps"], steps["max_steps"], steps["search_steps"]
    )
    shaded = Shaded(quad, samplers, quad.uv + offset.uv, (offset.height - 1.0) * scale)
    open_shares = [
        halliwell.directional_occlusion(
            shaded.occlusion[:, 0], offset.height, shaded.normal, lamp, quad.position
        )
        for lamp in LAMPS
    ]
    expected = shaded.pixels("halliwell", offset.margin, open_shares)
    bare = draw("halliwell", files, EYES[eye], quad, LAMPS, shadows="none")
    agrees(bare, quad, expected, size)

    slack = tables["scene"]["shadowing"]["shadow_offset"]
    free = [
        halliwell.reaches(
            shaded.uv, height, tangent_light(lamp, quad, size), scale, slack, SHADOW_STEPS
        )
        for lamp in LAMPS
    ]
    assert all(0.02 < light.mean() < 0.98 for light in free)
    answers = [np.array([a, b]) for a in (0.0, 1.0) for b in (0.0, 1.0)]
    drawn = draw("halliwell", files, EYES[eye], quad, LAMPS).color
    differences = []
    for answer in answers:
        shares = [share * open_share for share, open_share in zip(answer, open_shares, strict=True)]
        colors = shaded.pixels("halliwell", offset.margin, shares).colors
        differences.append(np.abs(drawn - colors).max(-1))
    certain = expected.margin >= DOUBT
    assert np.min(differences, 0)[certain].max() <= COLOR_TOLERANCE
    finer = (2 * free[0] + free[1]).astype(int)
    same = np.take_along_axis(np.array(differences), finer[None], 0)[0] <= COLOR_TOLERANCE
    assert same[certain].mean() >= SAME_SHADOW


def tangent_light(lamp: view.Lamp, quad: view.Fragments, size: tuple[int, int]) -> np.ndarray:
    """The direction to a directional light in the quad's tangent space, (n, 3)."""
    x, y, z = lamp.at(quad.position)[0].T
    return np.stack([x, -z * size[0] / size[1], y], -1)
