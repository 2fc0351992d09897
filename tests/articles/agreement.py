"""A preset's picture beside the pixels that an article's code gives.

The only file here, apart from the tests, that uses the library: it draws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import basrelief
from articles.maps import Codes, Floats
from articles.view import Eye, Fragments, Lamp, Pixels
from basrelief.images import write_data

SIZES = ((61, 37), (96, 96), (251, 173))
"""Columns and rows of the maps."""
PICTURE = (84, 60)
EYES = {
    "near": Eye((0.16, 0.42, 0.23), (0.05, 0.0, -0.04), 20.0),
    "flat": Eye((-0.75, 0.3, 0.62), (-0.02, 0.0, 0.05), 36.0),
}
"""Cameras: one that magnifies the maps, and one that looks along the quad and minifies them."""
UV_TOLERANCE = 0.002
"""Texels of the height map."""
COLOR_TOLERANCE = 1e-4
"""Of linear colour."""
DISTANCE_TOLERANCE = 1e-4
"""Of the distance along the ray."""
DOUBT = 5e-6
"""A comparison of heights, or of n · l with 0, that is decided by less than this may be decided
otherwise in float32: it rounds a coordinate of the largest map by up to 1e-5 texel, and heights
change by less than a half per texel."""
MAX_DOUBTFUL = 0.02
"""Share of the pixels that may hang on such a comparison."""


@dataclass(frozen=True)
class Picture:
    """The planes of a frame at the fragments: (n, 2) coordinates, (n, 3) colours, (n,)
    distances."""

    uv: Floats
    color: Floats
    distance: Floats


def write(folder: Path, name: str, codes: Codes) -> Path:
    """A map as a file of 16 bits."""
    return write_data(folder / f"{name}.png", codes if codes.ndim == 3 else codes[:, :, None])


def material(preset: str, **files: Path) -> basrelief.Material:
    """The material of files, read as the preset reads it."""
    return basrelief.load(**{**basrelief.preset(preset).maps, **files})


def light(lamp: Lamp) -> Any:
    """The library's light."""
    if lamp.falloff is not None:
        return basrelief.point(lamp.place, lamp.color, falloff=lamp.falloff)
    x, y, z = lamp.place
    azimuth, elevation = np.degrees([np.arctan2(x, z), np.arctan2(y, np.hypot(x, z))])
    return basrelief.directional(float(azimuth), float(elevation), lamp.color)


def lamps(preset: str) -> list[Lamp]:
    """The lights in the file of a preset, as its articles have them: point lights."""
    tables = basrelief.preset(preset).values["scene"]["lights"]
    return [
        Lamp(
            tuple(table["position"]),
            tuple(table["intensity"] * c for c in table["color"]),
            table["falloff"],
        )
        for table in tables
    ]


def draw(
    preset: str,
    what: basrelief.Material,
    eye: Eye,
    quad: Fragments,
    lamps: Sequence[Lamp] | None = None,
    *,
    scrolled: tuple[float, float] | None = None,
    **options: Any,
) -> Picture:
    """The preset drawn on the CPU, at the fragments. `lamps` replace the preset's lights;
    all maps are `scrolled` on the quad."""
    if lamps is not None:
        options["lights"] = tuple(light(lamp) for lamp in lamps)
    camera = basrelief.LookAt(eye.position, eye.target, field_of_view=eye.angle)
    scene = basrelief.preset(preset).scene(what, camera=camera, **options)
    if scrolled is not None:
        scene = replace(scene, objects=(scene.objects[0].scrolled(*scrolled),))
    frame = basrelief.render(scene, size=PICTURE, samples=1, device="cpu")
    assert (frame.hit == quad.shown).all()
    assert quad.shown.mean() > 0.3
    chosen = quad.shown
    return Picture(
        frame.uv[chosen].astype(np.float64),
        frame.color[chosen][:, :3].astype(np.float64),
        frame.distance[chosen].astype(np.float64),
    )


def agrees(picture: Picture, quad: Fragments, expected: Pixels, size: Sequence[int]) -> None:
    """Assert that coordinates, colours and the hit's place agree, except where the article's code
    decides by less than `DOUBT`."""
    doubtful = expected.margin < DOUBT
    assert doubtful.mean() <= MAX_DOUBTFUL
    texels = np.linalg.norm((picture.uv - expected.uv) * size, axis=-1)
    colors = np.abs(picture.color - expected.colors).max(-1)
    hit = np.linalg.norm(quad.raised(expected.height) - quad.camera, axis=-1)
    assert worst(texels, doubtful) <= UV_TOLERANCE
    assert worst(colors, doubtful) <= COLOR_TOLERANCE
    assert worst(np.abs(picture.distance / hit - 1.0), doubtful) <= DISTANCE_TOLERANCE


def worst(difference: Floats, doubtful: NDArray[np.bool_]) -> float:
    """The largest difference at the pixels that are not doubtful."""
    return float(difference[~doubtful].max())
