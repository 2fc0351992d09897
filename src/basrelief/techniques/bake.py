"""A bake: a table computed once from the heights of a map, for techniques that read it.

Declare it beside its shaders and name it on the technique, `@technique(bake=CONE_MAP)`. The
function that runs its passes is listed in `basrelief.baking.tables`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from basrelief.lang import Shader


@dataclass(frozen=True, eq=False)
class Bake:
    """The declaration of a bake; two are the same only if they are one object."""

    name: str
    """Its name on the command line, in the viewer and in messages."""
    programs: tuple[Shader[..., Any], ...]
    """The entry of each pass, from the first on."""
    all_levels: bool = False
    """Whether the table can go on with the lower levels of the map; its techniques then read the
    level that a ray asks for, by `level_under` and `patch_of`."""
