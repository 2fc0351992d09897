"""Random variants, as a page chooses them and as the library has them."""

from __future__ import annotations

import random
from typing import Any

from basrelief.shading.choices import Choices
from basrelief.techniques import TECHNIQUES, flat
from basrelief.viewer.printed import answers


def random_choices(count: int, seed: int) -> list[tuple[dict[str, Any], Choices]]:
    """So many choices twice over: with the text and bools of a page, and as a record."""
    every = answers(TECHNIQUES)
    rng = random.Random(seed)
    found = []
    for _ in range(count):
        picked = {name: rng.choice([*each.items()]) for name, each in every.items()}
        # what a technique says of itself, it alone decides
        technique = picked["technique"][1]
        for name, value in (("displaced", technique is not flat), ("boxed", technique.boxes)):
            picked[name] = (str(value).lower(), value)
        told = {
            name: value if isinstance(value, bool) else text
            for name, (text, value) in picked.items()
        }
        found.append((told, Choices(**{name: value for name, (_, value) in picked.items()})))
    return found
