"""Maps that surfaces read, and the static conditions that say which of them exist."""

from __future__ import annotations

from basrelief.lang import Texture, resources, static


@resources
class SurfaceMaps:
    """The maps of a material without its heights, and those of the second layer.

    `base_color` is linear, with opacity; `normal` in tangent space; `response` holds occlusion,
    roughness, metallic and the mask of the layer; `emission` is linear.
    """

    base_color: Texture
    normal: Texture
    response: Texture
    emission: Texture
    layer_color: Texture
    layer_normal: Texture


@static
class AvailableMaps:
    """Static conditions: `X_map` says whether the map X of `SurfaceMaps` exists."""

    base_color_map: bool = False
    normal_map: bool = False
    response_map: bool = False
    emission_map: bool = False
    layer_color_map: bool = False
    layer_normal_map: bool = False
