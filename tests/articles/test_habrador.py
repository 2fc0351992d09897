"""The presets `habrador`, `habrador-hole` and `habrador-bricks` beside their article's shader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import basrelief
from articles import habrador, maps, view
from articles.agreement import EYES, PICTURE, SIZES, agrees, draw, material, write

LAMPS = [view.sun(-40.0, 50.0, (0.9, 0.8, 0.7))]
SCROLLED = np.array([0.375, 0.0])
"""animateUV after a second and a half: _Time[0] is a twentieth of it, and counts five times."""


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
def test_habrador_draws_its_article(size: tuple[int, int], eye: str, tmp_path: Path) -> None:
    """Valleys, mountains, water, and white where nothing is hit, while the landscape moves."""
    heights, grass, stone = (
        maps.noise(*size, 1), maps.colors(*size, 7), maps.colors(*size, 11),
    )  # fmt: skip
    files = material(
        "habrador", height=write(tmp_path, "h", heights), base_color=write(tmp_path, "g", grass)
    )
    layer = basrelief.load(base_color=write(tmp_path, "s", stone))
    tables = basrelief.preset("habrador")
    obj, scene = tables.values["object"], tables.values["scene"]
    assert tables.scroll == tuple(SCROLLED / 1.5)
    quad = view.fragments(EYES[eye], PICTURE, size[0] / size[1])
    relief = habrador.Relief(
        maps.sampler(heights / maps.CODE),
        habrador.NOISE_SIZE,
        np.array(obj["shift"]) + SCROLLED * habrador.NOISE_SIZE,
        1.0,
    )
    expected = habrador.landscape(
        quad,
        relief,
        maps.sampler(maps.decoded(grass)),
        maps.sampler(maps.decoded(stone)),
        LAMPS,
        scrolled=SCROLLED,
        water_color=np.array(obj["surface_parameters"]["water_color"]),
        ambient=np.array(scene["shading"]["ambient"]),
    )
    picture = draw(
        "habrador",
        files,
        EYES[eye],
        quad,
        LAMPS,
        layer=basrelief.Layer(layer, basrelief.Tiling(tuple(obj["layer"]["tiles"]))),
        scrolled=tuple(SCROLLED),
    )
    agrees(picture, quad, expected, size)


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("preset", ["habrador-hole", "habrador-bricks"])
def test_hole_and_bricks_take_the_march_of_their_article(
    preset: str, size: tuple[int, int], eye: str, tmp_path: Path
) -> None:
    heights, color, normals = (
        maps.noise(*size, 1), maps.colors(*size, 7), maps.normals(*size, 5),
    )  # fmt: skip
    files = material(
        preset,
        height=write(tmp_path, "h", heights),
        base_color=write(tmp_path, "c", color),
        normal=write(tmp_path, "n", normals),
    )
    tables = basrelief.preset(preset).values
    quad = view.fragments(EYES[eye], PICTURE, size[0] / size[1])
    expected = habrador.relief_with_normals(
        quad,
        habrador.Relief(
            maps.sampler(heights / maps.CODE), 1.0, np.zeros(2), tables["object"]["scale"]
        ),
        tables["object"]["settings"]["step_length"],
        maps.sampler(maps.decoded(color)),
        maps.sampler(normals / maps.CODE),
        LAMPS,
        ambient=np.array(tables["scene"]["shading"]["ambient"]),
    )
    agrees(draw(preset, files, EYES[eye], quad, LAMPS), quad, expected, size)
