"""The preset `gamedev` beside its article's shader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from articles import gamedev, maps, view
from articles.agreement import EYES, PICTURE, SIZES, agrees, draw, lamps, material, write


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("size", SIZES)
def test_gamedev_draws_its_article(size: tuple[int, int], eye: str, tmp_path: Path) -> None:
    """Heights in the alpha of the normal map, from its mip levels, by the preset's lamp."""
    columns, rows = size
    packed = np.concatenate(
        [maps.normals(columns, rows, 5), maps.noise(columns, rows, 1)[:, :, None]], -1
    )
    color = maps.colors(columns, rows, 7)
    files = material(
        "gamedev", normal=write(tmp_path, "n", packed), base_color=write(tmp_path, "c", color)
    )
    quad = view.fragments(EYES[eye], PICTURE, columns / rows)
    expected = gamedev.pixel(
        quad,
        maps.sampler(packed / maps.CODE),
        maps.sampler(maps.decoded(color)),
        lamps("gamedev"),
        ends_at_base=True,
        lit_at_hit=True,
        unit_normals=True,
    )
    agrees(draw("gamedev", files, EYES[eye], quad), quad, expected, size)
