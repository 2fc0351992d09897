"""Techniques: functions `(field, ray, settings) -> Hit`, and the slot that they are bound to.

Mark a technique of your own with `@technique` in a file of its own and select it with
`--technique FILE.py:NAME`:

    @technique()
    def top_half(field: HeightField, ray: Ray, settings: Halving) -> Hit: ...

`settings` is a record (`@struct`) whose fields are the technique's settings; a technique without
any takes `Nothing`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from basrelief.lang import HeightField, Shader, Texture, TypeSlot, slot, struct
from basrelief.settings.kinds import Projection
from basrelief.techniques.bake import Bake
from basrelief.techniques.ray import Hit, Ray

P = ParamSpec("P")
R = TypeVar("R")


class Settings(TypeSlot):
    """The settings record of the bound technique."""


@struct
class Nothing:
    """The settings of a technique that has none."""


@slot
def displace(field: HeightField, baked: Texture, ray: Ray, settings: Settings) -> Hit:
    """The slot of the technique: the hit of a ray on the height field.

    Parameters
    ----------
    field : HeightField
        The heights, 0 to 1.
    baked : Texture
        The technique's table; a technique without a bake leaves this parameter out.
    ray : Ray
        The ray in texture space.
    settings : Settings
        The technique's settings record.

    Returns
    -------
    Hit
        Where the ray ends.
    """


class Technique(Shader[P, R]):
    """A shader marked as a technique, with its defaults.

    Attributes
    ----------
    reference_height : float
        The default height that lies on the polygon, 0 to 1.
    projection : {"full", "biased", "limited"}
        The default projection.
    most_reads : int
        The largest number of heights read with the default settings, a first measure of cost.
    bake : Bake or None
        The declaration of the table that it reads.
    columns : bool
        Whether its height field is one column per texel (`techniques.columns`) instead of the
        bilinear surface.
    exact : bool
        Whether it finds the first hit of every ray; it then traces the rays of hard shadows too.
    """

    reference_height: float = 1.0
    projection: Projection = "full"
    most_reads: int = 0
    bake: Bake | None = None
    columns: bool = False
    exact: bool = False

    @property
    def takes_heights(self) -> tuple[str, ...]:
        """The values of `heights` that it supports."""
        if self.columns:
            return ("sharp",)
        if self.bake is not None:
            return ("sharp", "mip") if self.bake.all_levels else ("sharp",)
        return ("sharp", "smooth", "mip")

    @property
    def solves_cells(self) -> bool:
        """Whether it solves whole cells or columns, which it reads as texels with any filter."""
        return self.exact or self.columns

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
    exact: bool = False,
) -> Callable[[Callable[P, R]], Technique[P, R]]:
    """Mark a shader as a technique.

    Parameters
    ----------
    reference_height : float, default 1.0
        The default height that lies on the polygon, 0 to 1.
    projection : {"full", "biased", "limited"}, default "full"
        The default projection.
    most_reads : int, default 0
        The largest number of heights read with the default settings.
    bake : Bake, optional
        The table that the technique reads, for example `CONE_MAP`. Such a technique takes
        `(field, baked, ray, settings)`.
    columns : bool, default False
        Whether the height field is one column per texel; the object's normals and self-shadows are
        then those of columns.
    exact : bool, default False
        Whether the technique finds the first hit of every ray. It then traces the rays of hard
        shadows too, from the top of the relief down to the point, in place of a march.

    Returns
    -------
    callable
        The decorator.

    Raises
    ------
    TypeError
        If `bake` is not a `Bake`.
    """
    if not (bake is None or isinstance(bake, Bake)):
        raise TypeError(f"bake is {bake!r}: give a declaration, as CONE_MAP of {__package__}")

    def mark(function: Callable[P, R]) -> Technique[P, R]:
        marked: Technique[P, R] = Technique(function)
        marked.reference_height, marked.projection, marked.most_reads = (
            reference_height,
            projection,
            most_reads,
        )
        marked.bake, marked.columns, marked.exact = bake, columns, exact
        return marked

    return mark
