"""Random programs of a pixel, as a page chooses them and as the library has them."""

from __future__ import annotations

import random
from typing import Any, get_args

from basrelief.lang import static_fields
from basrelief.lang.program import Program
from basrelief.lang.resources import Edge
from basrelief.rendering.programs import SURFACES
from basrelief.shading.pixel import pixel
from basrelief.shading.surfaces.surface import surface_at
from basrelief.shading.variant import Variant
from basrelief.techniques import TECHNIQUES, displace, flat


def random_programs(count: int, seed: int) -> list[tuple[dict[str, Any], Program]]:
    """So many programs twice over: with the names of a page, and as the library has them."""
    rng = random.Random(seed)
    return [_program(rng) for _ in range(count)]


def _program(rng: random.Random) -> tuple[dict[str, Any], Program]:
    name, technique = rng.choice([*TECHNIQUES.items()])
    edge = rng.choice(get_args(Edge))
    filter = "columns" if technique.columns else rng.choice(technique.takes_heights)
    chosen: dict[str, Any] = {
        each: rng.choice(field.choices or (False, True))
        for each, field in static_fields(Variant).items()
    }
    # what a technique says of itself, it alone decides
    chosen |= {"displaced": technique is not flat, "columns": technique.columns}
    variant = Variant(**chosen)
    bindings: Any = {displace: technique, surface_at: SURFACES[variant.surface]}
    told = {"technique": name, **chosen, "map.edge": edge, "map.filter": filter}
    return told, Program(pixel, bindings, edge, filter, variant)
