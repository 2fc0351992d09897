"""Baked maps as pictures: normals, occlusion, two horizons and cones, seen from above."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief import Map, Material, Object, Orbit, Scene, baking
from basrelief.gallery.page import Page, Panel, sample

SCALE = 0.08
ABOVE = Orbit(azimuth=0.0, elevation=90.0, distance=2.0, orthographic_height=0.5)
OBLIQUE = Orbit(
    azimuth=24.0, elevation=38.0, distance=0.7, target=(0.0, -0.04, 0.0), field_of_view=36.0
)
EVEN: Any = {"ambient": 1.0}


def panels(texels: int) -> Iterator[Panel]:
    """The material, then the bakes of its heights."""
    stones = sample("cobbles", min(texels, 256))
    assert stones.height is not None
    heights = stones.height.linear()[:, :, 0]
    horizons = baking.horizon_map(heights, "wrap", SCALE) / 65535.0
    drawn = Object(stones, technique="exact", scale=SCALE)
    yield Panel("the material", Scene((drawn,), camera=OBLIQUE), "256 texels a side at most")
    normals = baking.normal_map(heights, "wrap", SCALE) * 0.5 + 0.5
    yield Panel("normals, green up", map_scene(normals))
    yield Panel("occlusion", map_scene(baking.ambient_occlusion(heights, "wrap", SCALE)))
    yield Panel("horizon to the right", map_scene(horizons[:, :, 0]))
    yield Panel("horizon to the top", map_scene(horizons[:, :, 2]))
    cones = baking.cone_map(heights, "wrap")[:, :, 0] / 65535.0
    yield Panel("cones: bright where wide", map_scene((cones - 0.6) / 0.4))


def map_scene(values: NDArray[Any]) -> Scene:
    """A scene that shows a map from above, with its values as sRGB codes of the picture."""
    codes = np.rint(np.clip(np.atleast_3d(values), 0.0, 1.0) * 65535.0).astype(np.uint16)
    colors = np.broadcast_to(codes, (*codes.shape[:2], 3))
    material = Material("a bake", base_color=Map(np.ascontiguousarray(colors), True, "baked"))
    return Scene((Object(material),), camera=ABOVE, lights=(), shading=EVEN)


PAGE = Page(
    name="baked",
    title="Bakes",
    source="beyond",
    rows={
        "B2": "normals, occlusion, horizons and cones of one height map, seamless across its edges",
    },
    look="The same stones six times: the material, the direction that each stone faces, the sky "
    "that it sees, the height of the horizon, and the width of the empty cone above it.",
    article="N. Max, 1988, stores the height of the horizon around each texel, which gives shadows "
    "without a march. J. Dummer, 2006, stores the widest empty cone above each texel.",
    ours="The maps as stored, except the cones, whose codes from 0.6 to 1 are stretched from black "
    "to white. Horizons are bright in the joints and on sides that rise in their direction. "
    "They are never lower than the true horizons, and the cones are never wider than the true "
    "ones.",
    panels=panels,
)
