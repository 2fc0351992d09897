"""Every technique, one file a family; a file that is put here is found.

Read `offset.py` first, then `march.py`; `technique.py` says what a technique is.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator

from basrelief.lang import HeightField, Texture, setting, struct
from basrelief.techniques.bake import Bake
from basrelief.techniques.cone import cone, relaxed_cone
from basrelief.techniques.cone_bake import CONE_MAP, RELAXED_CONE_MAP
from basrelief.techniques.exact import exact
from basrelief.techniques.exact_bake import BOUNDS
from basrelief.techniques.height import height_under
from basrelief.techniques.march import fixed_length, parallax_occlusion, relief, steep
from basrelief.techniques.offset import flat, offset, offset_limited
from basrelief.techniques.ray import Hit, Ray, at, height_at, hit_at, t_at
from basrelief.techniques.refine import contact, secant
from basrelief.techniques.technique import Nothing, Technique, displace, technique
from basrelief.techniques.texel import texel

__all__ = [
    "BAKES", "BOUNDS", "CONE_MAP", "RELAXED_CONE_MAP", "TECHNIQUES", "Bake", "HeightField", "Hit",
    "Nothing", "Ray", "Technique", "Texture", "at", "cone", "contact", "displace", "exact",
    "fixed_length", "flat", "height_at", "height_under", "hit_at", "offset", "offset_limited",
    "parallax_occlusion", "relaxed_cone", "relief", "secant", "setting", "steep", "struct", "t_at",
    "technique", "texel",
]  # fmt: skip


def _found() -> Iterator[Technique[..., Hit]]:
    """The techniques that the files of this folder define."""
    for file in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{file.name}")
        for made in vars(module).values():
            if isinstance(made, Technique) and made.__module__ == module.__name__:
                yield made


TECHNIQUES: dict[str, Technique[..., Hit]] = {
    made.name: made for made in sorted(_found(), key=lambda each: each.most_reads)
}
"""The techniques by name, from the cheapest on."""
BAKES: dict[str, Bake] = {
    made.bake.name: made.bake for made in TECHNIQUES.values() if made.bake is not None
}
"""What the techniques have baked, by name."""
