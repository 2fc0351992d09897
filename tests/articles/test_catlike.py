"""The presets `catlike`, `catlike-limited` and `catlike-march` beside their article's shader."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import basrelief
from articles import catlike, maps, view
from articles.agreement import EYES, PICTURE, SIZES, agrees, draw, material, write

PRESETS: dict[str, dict[str, Any]] = {
    "catlike": {},
    "catlike-limited": {"limited": True},
    "catlike-march": {"marched": True, "bias": 0.0},
}
"""Presets, and what their article's shader defines."""
LAMPS = [view.sun(-50.0, 35.0, (1.0, 0.9, 0.8)), view.Lamp((0.4, 0.5, -0.3), (0.1, 0.15, 0.2), 2.0)]
AMBIENT = np.full(3, 0.1)
"""The library's, as the presets have none."""


def map_set(
    folder: Path, preset: str, columns: int, rows: int
) -> tuple[basrelief.Material, catlike.MapSet]:
    """A material and its maps: heights in the green channel of a colour picture."""
    heights = maps.colors(columns, rows, 1)
    albedo = maps.colors(columns, rows, 7)
    normals = maps.normals(columns, rows, 5)
    response = maps.colors(columns, rows, 11)
    # a mirror's highlight is finer than float32's normals
    response[:, :, 1] = maps.CODE // 3 + response[:, :, 1] // 2
    names = ("occlusion", "roughness", "metallic")
    files = material(
        preset,
        height=write(folder, "h", heights),
        base_color=write(folder, "c", albedo),
        normal=write(folder, "n", normals),
        **{name: write(folder, name, response[:, :, k]) for k, name in enumerate(names)},
    )
    return files, catlike.MapSet(
        maps.sampler(heights[:, :, 1] / maps.CODE),
        maps.sampler(maps.decoded(albedo)),
        maps.sampler(normals / maps.CODE),
        maps.sampler(response / maps.CODE),
    )


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("preset", PRESETS)
def test_catlike_draws_its_article(
    preset: str, size: tuple[int, int], eye: str, tmp_path: Path
) -> None:
    columns, rows = size
    quad = view.fragments(EYES[eye], PICTURE, columns / rows)
    files, samplers = map_set(tmp_path, preset, columns, rows)
    one = np.ones(2)
    expected = catlike.pixel(
        quad, samplers, LAMPS, AMBIENT, tiling=one, detail_tiling=one, **PRESETS[preset]
    )
    picture = draw(preset, files, EYES[eye], quad, LAMPS)
    agrees(picture, quad, expected, size)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("preset", PRESETS)
def test_catlike_draws_details_and_fog_as_its_article(
    preset: str, size: tuple[int, int], tmp_path: Path
) -> None:
    """Main maps tiled 2 × 2, details 7 × 7, whose offset is scaled with them; dense fog."""
    columns, rows = size
    quad = view.fragments(EYES["near"], PICTURE, columns / rows)
    files, main = map_set(tmp_path, preset, columns, rows)
    color, normals = maps.colors(columns, rows, 17), maps.normals(columns, rows, 19)
    layer = basrelief.load(
        base_color=write(tmp_path, "dc", color), normal=write(tmp_path, "dn", normals)
    )
    fog = (np.array([0.3, 0.5, 0.7]), 1.6)
    samplers = catlike.MapSet(
        main.parallax, main.albedo, main.normal, main.response,
        maps.sampler(maps.decoded(color)), maps.sampler(normals / maps.CODE),
    )  # fmt: skip
    expected = catlike.pixel(
        quad, samplers, LAMPS, AMBIENT, tiling=np.full(2, 2.0), detail_tiling=np.full(2, 7.0),
        fog=fog, **PRESETS[preset],
    )  # fmt: skip
    picture = draw(
        preset,
        files,
        EYES["near"],
        quad,
        LAMPS,
        tiling=(2.0, 2.0),
        layer=basrelief.Layer(layer, basrelief.Tiling((7.0, 7.0))),
        fog_mode="exponential_squared",
        fog={"fog_color": fog[0].tolist(), "fog_density": fog[1]},
    )
    agrees(picture, quad, expected, size)
