"""Tangent frames, and the only conversion from tangent space to texture space.

Tangent space: x along +u, y up in the picture (−v), z along the outward normal.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, copysign, cross, dot, normalize, shader, struct


@struct
class TangentFrame:
    """An orthonormal frame on a surface, in object space, and the texture's tile in that frame.

    The bitangent is cross(normal, tangent) · w; the handedness w is −1 where the texture is
    mirrored. A tile is `width` = |∂P/∂u| wide, `height` high perpendicular to that, and sheared by
    `shear`: ∂P/∂v = shear · tangent − height · bitangent.
    """

    tangent: Vec3
    bitangent: Vec3
    normal: Vec3
    width: float
    height: float
    shear: float


@shader
def tangent_frame(normal: Vec3, along_u: Vec3, along_v: Vec3) -> TangentFrame:
    """The frame of a unit normal and the derivatives ∂P/∂u and ∂P/∂v, which are not parallel."""
    tangent = normalize(along_u - normal * dot(normal, along_u))
    bitangent = cross(normal, tangent)
    down = dot(bitangent, along_v)
    return TangentFrame(
        tangent=tangent,
        bitangent=bitangent * copysign(1.0, -down),
        normal=normal,
        width=dot(tangent, along_u),
        height=abs(down),
        shear=dot(tangent, along_v),
    )


@shader
def aspect(frame: TangentFrame) -> float:
    """The width of a tile ÷ its height."""
    return frame.width / frame.height


@shader
def to_tangent(frame: TangentFrame, v: Vec3) -> Vec3:
    """An object-space vector in tangent space; the frame is orthonormal."""
    return Vec3(dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal))


@shader
def from_tangent(frame: TangentFrame, v: Vec3) -> Vec3:
    """A tangent-space vector in object space."""
    return frame.tangent * v.x + frame.bitangent * v.y + frame.normal * v.z


@shader
def to_texture(frame: TangentFrame, offset: Vec2) -> Vec2:
    """An offset in tangent space, in object units, as an offset of texture coordinates.

    Solves ∂P/∂u · du + ∂P/∂v · dv = offset. v points down, y points up.
    """
    dv = -offset.y / frame.height
    return Vec2((offset.x - frame.shear * dv) / frame.width, dv)
