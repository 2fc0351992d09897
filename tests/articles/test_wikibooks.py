"""The preset `wikibooks` beside its article's shader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import basrelief
from articles import maps, view, wikibooks
from articles.agreement import EYES, PICTURE, SIZES, agrees, draw, lamps, material, write

SUNS = [view.sun(-50.0, 35.0, (0.9, 0.8, 0.6)), view.sun(100.0, 25.0, (0.1, 0.3, 0.4))]


@pytest.mark.parametrize("tiling", [(1.0, 1.0), (3.0, 2.0)])
@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
def test_wikibooks_draws_its_article(
    size: tuple[int, int], eye: str, tiling: tuple[float, float], tmp_path: Path
) -> None:
    """Heights in A, normals in A and G, each map tiled and shifted, by the sun and by a lamp."""
    columns, rows = size
    heights = maps.noise(columns, rows, 1)
    slopes = maps.slopes(columns, rows, 5)
    color = maps.colors(columns, rows, 7)
    blank = np.full_like(heights, maps.CODE // 3)
    files = material(
        "wikibooks",
        height=write(tmp_path, "h", np.stack([blank, blank, blank, heights], -1)),
        normal=write(tmp_path, "n", np.stack([blank, slopes[:, :, 1], blank, slopes[:, :, 0]], -1)),
        base_color=write(tmp_path, "c", color),
    )
    quad = view.fragments(EYES[eye], PICTURE, columns / rows)
    z = maps.as_codes(wikibooks.local_coords(slopes / maps.CODE)[:, :, 2:] * 0.5 + 0.5)
    ambient = np.array(basrelief.preset("wikibooks").values["scene"]["shading"]["ambient"])
    shift = np.array([0.3, -0.2])
    for lights in (SUNS, lamps("wikibooks")):
        expected = wikibooks.pixel(
            quad,
            maps.sampler(heights / maps.CODE),
            maps.sampler(np.concatenate([slopes, z], -1) / maps.CODE),
            maps.sampler(maps.decoded(color)),
            lights,
            ambient,
            np.array(tiling),
            shift,
            lit_at_hit=True,
            normals_have_z=True,
            stretch=tiling[1] / tiling[0],
        )
        picture = draw(
            "wikibooks", files, EYES[eye], quad, lights, tiling=tiling, shift=tuple(shift)
        )
        agrees(picture, quad, expected, size)
