"""The pictures in docs/viewer.md equal screenshots of the page."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.images import read_picture
from helpers.browser import SOFTWARE, chromium
from helpers.shots import PICTURES, SHOTS, shot, write_page

COLOR_TOLERANCE = 8.0 / 255.0
"""Tolerance of encoded values, for dithered or blended pixels."""


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, Path]]:
    file = write_page(tmp_path_factory.mktemp("shots"))
    with chromium(SOFTWARE) as browser:
        yield browser, file


@pytest.mark.parametrize("name", SHOTS)
def test_a_picture_in_the_docs_equals_the_page(
    opened: tuple[Any, Path], tmp_path: Path, name: str
) -> None:
    png, box = shot(*opened, name)
    (tmp_path / "now.png").write_bytes(png)
    now = _pixels(tmp_path / "now.png")
    stored = _pixels(PICTURES / f"{name}.png")
    advice = f"{name} differs from the page; run scripts/goldens and look at the new picture"
    assert now.shape == stored.shape, advice
    # only the canvas, as the panel has fonts of the system
    rows = slice(round(box["y"]), round(box["y"] + box["height"]))
    columns = slice(round(box["x"]), round(box["x"] + box["width"]))
    difference = np.abs(now[rows, columns] - stored[rows, columns]).max(axis=2)
    assert (difference > COLOR_TOLERANCE).mean() < 0.02, advice
    assert np.ptp(now[rows, columns]) > 0.3


def _pixels(file: Path) -> np.ndarray:
    pixels = read_picture(file).pixels[:, :, :3]
    return pixels.astype(np.float32) / np.iinfo(pixels.dtype).max
