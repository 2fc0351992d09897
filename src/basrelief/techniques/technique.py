"""What a technique is: one function, `(field, ray, settings) -> Hit`, and the slot it is bound to.

Mark your own with `@technique` in a file of its own and name it with `--technique FILE.py:NAME`:

    @technique()
    def top_half(field: HeightField, ray: Ray, settings: Halving) -> Hit: ...

`settings` is a record (`@struct`) whose fields users turn; a technique without any takes `Nothing`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, ParamSpec, TypeVar

from basrelief.lang import HeightField, Shader, Texture, TypeSlot, slot, struct
from basrelief.techniques.bake import Bake
from basrelief.techniques.ray import Hit, Ray

P = ParamSpec("P")
R = TypeVar("R")
Projection = Literal["full", "biased", "limited"]


class Settings(TypeSlot):
    """The settings record of whichever technique is bound."""


@struct
class Nothing:
    """The settings of a technique that has none."""


@slot
def displace(field: HeightField, baked: Texture, ray: Ray, settings: Settings) -> Hit:
    """Find where the view ray ends in the height field, by what is baked where that is needed."""


class Technique(Shader[P, R]):
    """A technique with what it prefers where nothing else is said."""

    reference_height: float = 1.0
    """The height that lies on the polygon."""
    projection: Projection = "full"
    most_reads: int = 0
    """Heights read at most with the default settings, a first idea of the cost."""
    bake: Bake | None = None
    """The table that it reads, baked from the heights."""
    columns: bool = False
    """Whether it takes each texel for a box (`techniques.columns`), and no bilinear surface."""

    @property
    def takes_heights(self) -> tuple[str, ...]:
        """The ways to read heights that it can be drawn with."""
        if self.columns:
            return ("sharp",)
        if self.bake is not None:
            return ("sharp", "mip") if self.bake.all_levels else ("sharp",)
        return ("sharp", "smooth", "mip")

    @property
    def settings(self) -> Any:
        """The record of its settings."""
        parameters, _ = self.signature
        return list(parameters.values())[-1]


def technique(
    *,
    reference_height: float = 1.0,
    projection: Projection = "full",
    most_reads: int = 0,
    bake: Bake | None = None,
    columns: bool = False,
) -> Callable[[Callable[P, R]], Technique[P, R]]:
    """Mark a shader as a technique; `reference_height` and `projection` are its defaults.

    `most_reads` says how many heights it reads at most with its default settings, `bake` what is
    baked for it, as `CONE_MAP`: such a technique takes `(field, baked, ray, settings)`. With
    `columns` the object's normals and shadows are those of boxes, one for each texel.
    Raises TypeError for a bake that is no declaration.
    """
    if not (bake is None or isinstance(bake, Bake)):
        raise TypeError(f"bake is {bake!r}: give a declaration, as CONE_MAP of {__package__}")

    def mark(function: Callable[P, R]) -> Technique[P, R]:
        made: Technique[P, R] = Technique(function)
        made.reference_height, made.projection, made.most_reads = (
            reference_height,
            projection,
            most_reads,
        )
        made.bake, made.columns = bake, columns
        return made

    return mark
