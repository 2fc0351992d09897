"""The choices on which the shaders of a pixel branch."""

from __future__ import annotations

from basrelief.lang import static
from basrelief.shading.kinds import AlphaKind, FogKind, OcclusionKind, ShadingModel, ShadowsKind


@static
class Variant:
    """What decides which code runs for a pixel, as `Object` and `Scene` have it.

    Everything else is a number or a map, and turns no program into another. `displaced` says
    whether there is a relief, `boxed` whether each texel of it is a box.
    """

    displaced: bool = False
    boxed: bool = False
    alpha: AlphaKind = "blend"
    shadows: ShadowsKind = "none"
    shading_model: ShadingModel = "ggx"
    occlusion_kind: OcclusionKind = "ambient"
    fog: FogKind = "none"
