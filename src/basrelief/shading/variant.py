"""The choices on which the shaders of a pixel branch."""

from __future__ import annotations

from basrelief.lang import static
from basrelief.shading.kinds import (
    AlphaKind,
    EdgeKind,
    FogKind,
    MappingKind,
    OcclusionKind,
    ShadingModel,
    ShadowsKind,
    ShadowsOnKind,
    ShapeKind,
    SurfaceKind,
)
from basrelief.techniques.technique import Projection


@static
class Variant:
    """What decides which code runs for a pixel, as `Object` and `Scene` have it.

    Everything else is a number or a map, and turns no program into another. Beside it a program has
    its technique and surface, which are slots, and the edge and filter of its maps.

    `displaced` says whether there is a relief, `columns` whether each texel of it is a box, `fades`
    whether it fades with distance; `own_tilings` whether maps have tilings of their own, `layer`
    whether there is a second one; `X_map` whether there is such a map; `shadow_maps` whether other
    objects cast shadows on this one; `depth_only` whether the picture is a depth map, in which only
    distance and opacity count. Of `edge` only "clip" matters beside the edge of the maps.
    """

    # --- of the object
    shape: ShapeKind = "plane"
    displaced: bool = False
    columns: bool = False
    projection: Projection = "full"
    fades: bool = False
    edge: EdgeKind = "wrap"
    alpha: AlphaKind = "blend"
    # --- of its surface
    surface: SurfaceKind = "standard"
    mapping: MappingKind = "planar"
    own_tilings: bool = False
    layer: bool = False
    base_color_map: bool = False
    normal_map: bool = False
    response_map: bool = False
    emission_map: bool = False
    layer_color_map: bool = False
    layer_normal_map: bool = False
    # --- of the scene
    shadows: ShadowsKind = "none"
    shadow_maps: bool = False
    shadows_on: ShadowsOnKind = "relief"
    shading_model: ShadingModel = "ggx"
    occlusion_kind: OcclusionKind = "ambient"
    fog_mode: FogKind = "none"
    depth_only: bool = False
