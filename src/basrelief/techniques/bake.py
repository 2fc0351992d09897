"""Bakes: tables computed once from a height map, for the techniques that read them.

Declare a bake next to its shaders and pass it to the technique, `@technique(bake=CONE_MAP)`. The
function that runs its passes is listed in `basrelief.baking.tables`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from basrelief.lang import Shader


@dataclass(frozen=True, eq=False)
class Bake:
    """The declaration of a bake. Two declarations are equal only if they are the same object.

    Attributes
    ----------
    name : str
        The name on the command line, in the viewer and in messages.
    programs : tuple of Shader
        The entry of each pass, in order.
    all_levels : bool
        Whether the table can hold records of all mip levels. Its techniques then read the level of
        the ray, by `ray_level` and `patch_heights` of `techniques.height`.
    """

    name: str
    programs: tuple[Shader[..., Any], ...]
    all_levels: bool = False
