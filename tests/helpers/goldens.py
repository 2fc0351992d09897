"""Golden pictures of the gallery: one strip per page, its panels at a small size, six in a row.

Run as a program, it redraws them on the CPU and writes docs/gallery.md: `scripts/goldens`.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief.gallery import PAGES, Page
from basrelief.gallery.document import text
from basrelief.gallery.drawing import picture_of
from basrelief.images import read_picture, srgb_encode, write_data
from basrelief.rendering.render import render
from helpers.repository import REPOSITORY

GOLDEN = REPOSITORY / "tests" / "golden"
DOCUMENT = REPOSITORY / "docs" / "gallery.md"
SIZE = (192, 108)
TEXELS = 256
IN_A_ROW = 6
"""Panels in a row of a strip; of more panels, a page has a multiple of these."""
Strip = NDArray[np.uint8]


@functools.cache
def engine(name: str) -> Any:
    from basrelief.engine import choose_device

    return choose_device(name)


def strip(page: Page, device: str) -> Strip:
    """All panels of a page, row by row, as 8-bit codes (rows · height, columns · width, 3)."""
    pictures = []
    for panel in page.panels(TEXELS):
        frame = render(panel.scene, size=SIZE, samples=1, device=engine(device))
        pictures.append(picture_of(panel, frame, engine(device)).image.pixels[:, :, :3])
    rows = [pictures[n : n + IN_A_ROW] for n in range(0, len(pictures), IN_A_ROW)]
    colors = np.concatenate([np.concatenate(row, axis=1) for row in rows])
    return np.rint(srgb_encode(np.clip(colors, 0.0, 1.0)) * 255.0).astype(np.uint8)


def panels_of(strip: Strip) -> list[Strip]:
    """The panels of a strip, in their order."""
    width, height = SIZE
    rows = np.split(strip, strip.shape[0] // height)
    return [panel for row in rows for panel in np.split(row, row.shape[1] // width, axis=1)]


def golden(name: str) -> Strip:
    """The stored strip; fails with advice if it is missing."""
    file = GOLDEN / f"{name}.png"
    assert file.is_file(), (
        f"{name} has no golden picture; draw it with `scripts/goldens`, and look at it"
    )
    return np.asarray(read_picture(file).pixels[:, :, :3], np.uint8)


def fraction_different(one: Strip, other: Strip, steps: int = 2) -> float:
    """Fraction of pixels with a channel that differs by more than `steps` of 255."""
    difference = np.abs(one.astype(np.int16) - other.astype(np.int16)).max(axis=2)
    return float((difference > steps).mean())


def draw_all() -> None:
    """Draw every strip, delete those without a page, and write the document."""
    GOLDEN.mkdir(exist_ok=True)
    for file in GOLDEN.glob("*.png"):
        if file.stem not in PAGES:
            file.unlink()
    for page in PAGES.values():
        print(write_data(GOLDEN / f"{page.name}.png", strip(page, "cpu")))
    DOCUMENT.write_text(text(), encoding="utf-8")
    print(DOCUMENT)


if __name__ == "__main__":
    draw_all()
