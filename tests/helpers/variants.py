"""Random variants of the pixel program, as names of a page and as programs of the library."""

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
    """Random programs, each as the names that a page uses, and as the library's program."""
    rng = random.Random(seed)
    return [_program(rng) for _ in range(count)]


def _program(rng: random.Random) -> tuple[dict[str, Any], Program]:
    name, technique = rng.choice([*TECHNIQUES.items()])
    edge = rng.choice(get_args(Edge))
    filter = "columns" if technique.columns else rng.choice(technique.takes_heights)
    choices: dict[str, Any] = {
        each: rng.choice(field.choices or (False, True))
        for each, field in static_fields(Variant).items()
    }
    # these fields follow from the technique
    choices |= {"displaced": technique is not flat, "columns": technique.columns}
    variant = Variant(**choices)
    bindings: Any = {displace: technique, surface_at: SURFACES[variant.surface]}
    names = {"technique": name, **choices, "map.edge": edge, "map.filter": filter}
    return names, Program(pixel, bindings, edge, filter, variant)
