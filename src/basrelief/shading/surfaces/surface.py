"""What a surface is: where it is asked for, what it answers, and the slot that it is bound to.

A surface reads a material's maps at one displaced place. Its numbers are a record of its own, as a
technique's settings are.
"""

from __future__ import annotations

from basrelief.lang import (
    Texture,
    TypeSlot,
    Vec2,
    Vec3,
    Vec4,
    copysign,
    resources,
    shader,
    slot,
    struct,
)
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.variant import Variant


@struct
class Spot:
    """A place on the relief.

    `uv` are the displaced coordinates of the height map, `footprint` how far a pixel reaches there.
    `height` is that of the hit, 0 to 1, and `found` whether there was one. `slope` is the relief's
    unit normal in tangent space, where a program needs it, else (0, 0, 1); `deep` the height in
    tile widths; `aspect` that of the frame.
    """

    uv: Vec2
    footprint: Footprint
    height: float
    found: bool
    slope: Vec3
    deep: float
    aspect: float


@struct
class MapPlaces:
    """How each map lies beside the height map: the ratio of their tilings (xy), a shift (zw).

    `layer_slant` is how much more the layer's normals are stretched along v than the main ones.
    """

    base_color: Vec4
    normal: Vec4
    response: Vec4
    emission: Vec4
    layer: Vec4
    layer_slant: float


@struct
class Surface:
    """What the surface is made of at one place; `normal` in tangent space."""

    base_color: Vec3
    opacity: float
    normal: Vec3
    occlusion: float
    roughness: float
    metallic: float
    emission: Vec3


@resources
class SurfaceMaps:
    """The maps of a material but for its heights, and of the layer over it.

    Linear colour with opacity; tangent-space normals; occlusion, roughness, metallic and the mask
    of the layer; the light that is sent out.
    """

    base_color: Texture
    normal: Texture
    response: Texture
    emission: Texture
    layer_color: Texture
    layer_normal: Texture


class SurfaceSettings(TypeSlot):
    """The numbers of whichever surface is bound."""


@slot
def surface_at(
    spot: Spot,
    surface_parameters: SurfaceSettings,
    places: MapPlaces,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """What the surface is made of at a place."""


# --- where each map is read ----------------------------------------------------------------------


@shader
def spot_on_map(spot: Spot, place: Vec4, variant: Variant) -> Spot:
    """The same spot in the coordinates of one map."""
    return retiled(spot, place) if variant.own_tilings else spot


@shader
def retiled(spot: Spot, place: Vec4) -> Spot:
    """Each map has its own tiling and shift.

    The offset is scaled with the tiling, so that what is displaced stays glued together:
    catlike's offset · (detail tiling ÷ main tiling).
    """
    ratio = place.xy
    footprint = Footprint(spot.footprint.dx * ratio, spot.footprint.dy * ratio)
    return Spot(
        uv=spot.uv * ratio + place.zw,
        footprint=footprint,
        height=spot.height,
        found=spot.found,
        slope=spot.slope,
        deep=spot.deep * ratio.x,
        aspect=spot.aspect * ratio.y / ratio.x,
    )


@shader
def turned(normal: Vec3, place: Vec4, variant: Variant) -> Vec3:
    """A normal of one map in the directions of the height map."""
    return mirrored_with(normal, place) if variant.own_tilings else normal


@shader
def mirrored_with(normal: Vec3, place: Vec4) -> Vec3:
    """Mirrored where the one map's tiling is, and the other's is not."""
    return Vec3(normal.x * copysign(1.0, place.x), normal.y * copysign(1.0, place.y), normal.z)
