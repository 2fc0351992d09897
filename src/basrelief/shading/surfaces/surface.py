"""The surface slot: material properties at a point of the relief.

A surface samples a material's maps at one displaced point. Its settings are a record of its own, as
a technique's are.
"""

from __future__ import annotations

from basrelief.lang import (
    TypeSlot,
    Vec2,
    Vec3,
    Vec4,
    copysign,
    shader,
    slot,
    struct,
)
from basrelief.shading.maps import SurfaceMaps
from basrelief.shading.ray_differentials import Footprint
from basrelief.shading.variant import Variant


@struct
class SurfacePoint:
    """A point of the relief that a surface is evaluated at.

    `uv` are the displaced coordinates on the height map and `offset` their offset from those of the
    polygon, `footprint` the pixel footprint there, `height` that of the surface, 0 to 1, and
    `found` whether there is a hit. `relief_normal` is the relief's unit normal in tangent space
    where a program needs it, else (0, 0, 1); `height_in_tiles` the height in tile widths; `aspect`
    the width of a tile ÷ its height.
    """

    uv: Vec2
    offset: Vec2
    footprint: Footprint
    height: float
    found: bool
    relief_normal: Vec3
    height_in_tiles: float
    aspect: float


@struct
class MapTilings:
    """The tiling of each map relative to the height map: the ratio of the tilings (xy) and a shift
    (zw).

    `layer_normal_stretch` is the stretch of the layer's normals along v relative to the material's.
    """

    base_color: Vec4
    normal: Vec4
    response: Vec4
    emission: Vec4
    layer: Vec4
    layer_normal_stretch: float


@struct
class Surface:
    """Material properties at a point; `normal` is in tangent space."""

    base_color: Vec3
    opacity: float
    normal: Vec3
    occlusion: float
    roughness: float
    metallic: float
    emission: Vec3
    specular: Vec3
    shininess: float


class SurfaceSettings(TypeSlot):
    """The settings record of the bound surface."""


@slot
def surface_at(
    point: SurfacePoint,
    surface_parameters: SurfaceSettings,
    tilings: MapTilings,
    maps: SurfaceMaps,
    variant: Variant,
) -> Surface:
    """The material properties at a point."""


# --- tilings of single maps ----------------------------------------------------------------------


@shader
def point_on_map(point: SurfacePoint, tiling: Vec4, variant: Variant) -> SurfacePoint:
    """The point in the coordinates of one map."""
    return retiled(point, tiling) if variant.own_tilings else point


@shader
def retiled(point: SurfacePoint, tiling: Vec4) -> SurfacePoint:
    """The point in the coordinates of a map with a tiling and shift of its own.

    The parallax offset is scaled with the tiling, so that all maps stay aligned: catlike's
    offset · (detail tiling ÷ main tiling).
    """
    ratio = tiling.xy
    footprint = Footprint(point.footprint.dx * ratio, point.footprint.dy * ratio)
    return SurfacePoint(
        uv=point.uv * ratio + tiling.zw,
        offset=point.offset * ratio,
        footprint=footprint,
        height=point.height,
        found=point.found,
        relief_normal=point.relief_normal,
        height_in_tiles=point.height_in_tiles * ratio.x,
        aspect=point.aspect * ratio.y / ratio.x,
    )


@shader
def point_on_layer(point: SurfacePoint, tiling: Vec4, variant: Variant) -> SurfacePoint:
    """The point in the coordinates of the second layer.

    Its offset is scaled with the tiling, or for comparison it is that of the material, which
    catlike shows as a mistake, or none.
    """
    scaled = retiled(point, tiling)
    if variant.layer_offset == "unscaled":
        return with_offset(scaled, point.offset)
    if variant.layer_offset == "none":
        return with_offset(scaled, Vec2(0.0))
    return scaled


@shader
def with_offset(point: SurfacePoint, offset: Vec2) -> SurfacePoint:
    """The point with another parallax offset."""
    return SurfacePoint(
        uv=point.uv - point.offset + offset,
        offset=offset,
        footprint=point.footprint,
        height=point.height,
        found=point.found,
        relief_normal=point.relief_normal,
        height_in_tiles=point.height_in_tiles,
        aspect=point.aspect,
    )


@shader
def oriented_normal(normal: Vec3, tiling: Vec4, variant: Variant) -> Vec3:
    """A normal of one map, oriented as the height map."""
    return mirrored_normal(normal, tiling) if variant.own_tilings else normal


@shader
def mirrored_normal(normal: Vec3, tiling: Vec4) -> Vec3:
    """A normal mirrored along each axis on which only one of the two tilings is mirrored."""
    return Vec3(normal.x * copysign(1.0, tiling.x), normal.y * copysign(1.0, tiling.y), normal.z)
