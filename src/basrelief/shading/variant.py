"""Static conditions of the pixel shaders."""

from __future__ import annotations

from basrelief.lang import static
from basrelief.settings.kinds import (
    AlphaKind,
    EdgeKind,
    FogKind,
    LayerOffsetKind,
    MappingKind,
    OcclusionKind,
    Projection,
    ShadingModel,
    ShadowsKind,
    ShadowsOnKind,
    ShapeKind,
    SurfaceKind,
)
from basrelief.shading.maps import AvailableMaps


@static
class Variant(AvailableMaps):
    """The options of `Object` and `Scene` that select a pixel's code.

    All others are numbers or maps, which never change a program. A program also depends on its
    slots, technique and surface, and on the edge and filter of its maps.

    `displaced`: the object has a relief; `columns`: its height field is one column per texel;
    `exact_shadows`: its technique traces the rays of hard shadows; `fades`: it fades with distance.
    `own_tilings`: maps have tilings of their own; `layer`: there is a second layer. `shadow_maps`:
    other objects cast shadows on this one. `depth_only`: the picture is a depth map, which needs
    distance and opacity alone. Of the values of `edge` only "clip" matters here; the others are the
    edge of the maps.
    """

    # --- of the object
    shape: ShapeKind = "plane"
    displaced: bool = False
    columns: bool = False
    exact_shadows: bool = False
    projection: Projection = "full"
    fades: bool = False
    edge: EdgeKind = "wrap"
    alpha: AlphaKind = "blend"
    # --- of its surface
    surface: SurfaceKind = "standard"
    mapping: MappingKind = "planar"
    own_tilings: bool = False
    layer: bool = False
    layer_offset: LayerOffsetKind = "scaled"
    # --- of the scene
    shadows: ShadowsKind = "none"
    shadow_maps: bool = False
    shadows_on: ShadowsOnKind = "relief"
    shading_model: ShadingModel = "ggx"
    occlusion_kind: OcclusionKind = "ambient"
    fog_mode: FogKind = "none"
    depth_only: bool = False
