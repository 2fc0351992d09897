"""The pictures in docs/viewer.md are of the page as it is."""

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
"""Encoded values that a dithered or blended pixel may differ by."""


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, Path]]:
    file = write_page(tmp_path_factory.mktemp("shots"))
    with chromium(SOFTWARE) as browser:
        yield browser, file


@pytest.mark.parametrize("name", SHOTS)
def test_a_picture_in_the_docs_is_of_the_page(
    opened: tuple[Any, Path], tmp_path: Path, name: str
) -> None:
    png, box = shot(*opened, name)
    (tmp_path / "now.png").write_bytes(png)
    now = _pixels(tmp_path / "now.png")
    kept = _pixels(PICTURES / f"{name}.png")
    hint = f"{name} shows another page; see scripts/goldens, and look at what it draws"
    assert now.shape == kept.shape, hint
    # the canvas: the panel's letters are those of the system
    rows = slice(round(box["y"]), round(box["y"] + box["height"]))
    columns = slice(round(box["x"]), round(box["x"] + box["width"]))
    apart = np.abs(now[rows, columns] - kept[rows, columns]).max(axis=2)
    assert (apart > COLOR_TOLERANCE).mean() < 0.02, hint
    assert np.ptp(now[rows, columns]) > 0.3


def _pixels(file: Path) -> np.ndarray:
    pixels = read_picture(file).pixels[:, :, :3]
    return pixels.astype(np.float32) / np.iinfo(pixels.dtype).max
