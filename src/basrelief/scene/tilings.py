"""Tilings of maps, and the second layer."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from basrelief.errors import InputError
from basrelief.scene.checks import FAR, NEAR
from basrelief.settings import setting

if TYPE_CHECKING:
    from basrelief.material import Material

TILES_CONTROL = {"low": 0.1, "high": 32.0, "step": 0.1}
SHIFT_CONTROL = {"low": -1.0, "high": 1.0, "step": 0.01}
"""Ranges and steps of the viewer's sliders."""


@dataclass(frozen=True)
class Tiling:
    """Placement of a map on a shape.

    Parameters
    ----------
    tiles : (float, float), default (1, 1)
        Number of tiles along u and v over the whole shape; not 0, mirrored if negative.
    shift : (float, float), default (0, 0)
        Shift in tiles along u and v.
    """

    tiles: tuple[float, float] = setting(default=(1.0, 1.0), control=TILES_CONTROL, spelling="UxV")
    shift: tuple[float, float] = setting(default=(0.0, 0.0), control=SHIFT_CONTROL, spelling="U,V")

    def checked(self, owner: str) -> Tiling:
        """The tiling itself; raises InputError for numbers out of range."""
        if not all(NEAR <= abs(n) <= FAR for n in self.tiles):
            raise InputError(f"{owner} {self.tiles}: give finite numbers other than 0")
        if not all(abs(n) <= FAR for n in self.shift):
            raise InputError(f"shift {self.shift}: give finite numbers")
        return self

    @property
    def repeats(self) -> bool:
        """Whether coordinates leave 0 … 1; mirrored tiles do, since they lie below 0."""
        return any(self.shift) or not all(0.0 < tiles <= 1.0 for tiles in self.tiles)

    def shifted(self, u: float, v: float) -> Tiling:
        """The tiling shifted by (u, v) in texture coordinates of the shape."""
        offset = (self.tiles[0] * u, self.tiles[1] * v)
        return replace(self, shift=(self.shift[0] + offset[0], self.shift[1] + offset[1]))


@dataclass(frozen=True, eq=False)
class Layer:
    """A second material over the first, of which colour and normals are used.

    On the standard surface it is a detail layer, on a landscape the material of the mountains.

    Parameters
    ----------
    material : Material
        Material of the layer.
    tiling : Tiling, default Tiling((10, 10))
        Placement of its maps on the shape.
    """

    material: Material
    tiling: Tiling = field(default_factory=lambda: Tiling((10.0, 10.0)))


OWN_TILINGS = ("base_color", "normal", "response", "emission")
"""Maps that may have a tiling of their own; response is occlusion, roughness and metallic."""
