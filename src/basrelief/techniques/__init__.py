"""The techniques, one file for each family; a file put here is discovered.

A technique computes where a view ray hits a height field. In reading order:

- `ray.py`: the ray in texture space and the hit, `height.py`: the height field.
- `offset.py`: one read. `march.py`: equal steps. `refine.py`: a second search in the last step.
- `cone.py`: leaps over baked cones. `exact.py`: leaps over proven bounds, with cells solved.
- `texel.py`: columns, one per texel, on `columns.py`.
- `projection.py`: the direction of the ray. `edge.py`: coordinates outside a map.
- `technique.py`: the decorator and the slot. `own.py`: a technique from a file of the user's.
- `*_bake.py`: the shaders that compute tables, normals and horizons from the heights.
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


def _discovered() -> Iterator[Technique[..., Hit]]:
    """The techniques defined in the files of this package."""
    for file in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{file.name}")
        for value in vars(module).values():
            if isinstance(value, Technique) and value.__module__ == module.__name__:
                yield value


TECHNIQUES: dict[str, Technique[..., Hit]] = {
    item.name: item for item in sorted(_discovered(), key=lambda item: item.most_reads)
}
"""All techniques by name, from the cheapest on."""
SYNONYMS = {
    "none": "flat", "normal_mapping": "flat", "bump": "flat", "bump_mapping": "flat",
    "parallax": "offset", "parallax_mapping": "offset", "bump_offset": "offset",
    "parallax_offset": "offset", "offset_limiting": "offset_limited",
    "spm": "steep", "steep_parallax": "steep", "steep_parallax_mapping": "steep",
    "pom": "parallax_occlusion", "parallax_occlusion_mapping": "parallax_occlusion",
    "rm": "relief", "relief_mapping": "relief", "rpm": "relief", "relief_parallax": "relief",
    "relief_parallax_mapping": "relief", "binary": "relief", "binary_search": "relief",
    "secant_method": "secant", "interval_mapping": "secant",
    "contact_refinement": "contact", "contact_refinement_parallax": "contact", "cpm": "contact",
    "csm": "cone", "cone_map": "cone", "cone_stepping": "cone", "cone_step_mapping": "cone",
    "rcsm": "relaxed_cone", "relaxed_cone_stepping": "relaxed_cone",
    "relaxed_cone_step_mapping": "relaxed_cone",
    "ray_marching": "fixed_length", "raymarch": "fixed_length",
    "qdm": "exact", "quadtree_displacement_mapping": "exact", "maximum_mipmaps": "exact",
    "pixel_art": "texel", "voxel": "texel", "voxels": "texel",
}  # fmt: skip
"""Names from papers and engines, and the technique that each one means or comes closest to."""
BAKES: dict[str, Bake] = {
    item.bake.name: item.bake for item in TECHNIQUES.values() if item.bake is not None
}
"""The bakes of all techniques by name."""
