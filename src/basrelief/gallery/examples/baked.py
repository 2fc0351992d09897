"""Baked maps as pictures: normals, occlusion, two horizons and cones, seen from straight above."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief import Map, Material, Object, Orbit, Scene, baking
from basrelief.gallery.page import Page, Panel, sample

SCALE = 0.08
ABOVE = Orbit(azimuth=0.0, elevation=90.0, distance=2.0, orthographic_height=0.5)
AT_A_SKEW = Orbit(
    azimuth=24.0, elevation=38.0, distance=0.7, target=(0.0, -0.04, 0.0), field_of_view=36.0
)
EVEN: Any = {"ambient": 1.0}


def panels(texels: int) -> Iterator[Panel]:
    """The material, then what is baked from its heights."""
    stones = sample("cobbles", min(texels, 256))
    assert stones.height is not None
    heights = stones.height.linear()[:, :, 0]
    horizons = baking.horizon_map(heights, "wrap", SCALE) / 65535.0
    drawn = Object(stones, technique="exact", scale=SCALE)
    yield Panel("the material", Scene((drawn,), camera=AT_A_SKEW), "256 texels a side at most")
    normals = baking.normal_map(heights, "wrap", SCALE) * 0.5 + 0.5
    yield Panel("normals, green up", seen(normals))
    yield Panel("occlusion", seen(baking.ambient_occlusion(heights, "wrap", SCALE)))
    yield Panel("horizon to the right", seen(horizons[:, :, 0]))
    yield Panel("horizon to the top", seen(horizons[:, :, 2]))
    cones = baking.cone_map(heights, "wrap")[:, :, 0] / 65535.0
    yield Panel("cones: bright where wide", seen((cones - 0.6) / 0.4))


def seen(values: NDArray[Any]) -> Scene:
    """A map from straight above, its numbers as the codes of the picture."""
    codes = np.rint(np.clip(np.atleast_3d(values), 0.0, 1.0) * 65535.0).astype(np.uint16)
    colors = np.broadcast_to(codes, (*codes.shape[:2], 3))
    material = Material("a bake", base_color=Map(np.ascontiguousarray(colors), True, "baked"))
    return Scene((Object(material),), camera=ABOVE, lights=(), shading=EVEN)


PAGE = Page(
    name="baked",
    title="What is baked",
    source="beyond",
    rows={
        "B2": "normals, occlusion, horizons and cones of one height map, seamless beyond its edges",
    },
    look="One heap of stones six times: which way they face, how much sky they see, how high the "
    "next ones stand, and how wide a cone is free above.",
    article="N. Max, 1988, keeps for each texel how high the horizon stands all around, which "
    "gives shadows without a march. J. Dummer, 2006, keeps a cone that is free above each.",
    ours="As they are stored, but for the cones, whose codes from 0.6 to 1 are stretched from "
    "black to white. Horizons are bright in the joints and on the sides that rise in their "
    "direction; they are never lower than the true ones, and the cones never wider.",
    panels=panels,
)
