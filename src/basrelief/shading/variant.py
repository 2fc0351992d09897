"""The choices on which the shaders of a pixel branch, with their menus."""

from __future__ import annotations

from typing import Literal

from basrelief.lang import static, static_fields

AlphaMode = Literal["blend", "mask", "opaque"]
ShadowKind = Literal["none", "hard", "soft"]
ShadingModel = Literal["ggx", "phong"]
OcclusionKind = Literal["ambient", "directional"]
FogMode = Literal["none", "linear", "exponential", "exponential_squared"]


@static
class Variant:
    """What decides which code runs for a pixel, as `Object` and `Scene` have it.

    Everything else is a number or a map, and turns no program into another. `displaced` says
    whether there is a relief, `boxed` whether each texel of it is a box.
    """

    displaced: bool = False
    boxed: bool = False
    alpha: AlphaMode = "blend"
    shadows: ShadowKind = "none"
    shading_model: ShadingModel = "ggx"
    occlusion_kind: OcclusionKind = "ambient"
    fog: FogMode = "none"


MENUS: dict[str, tuple[str, ...]] = {
    name: tuple(map(str, menu)) for name, (_, menu) in static_fields(Variant).items() if menu
}
"""The values of each choice that has a name for each."""
