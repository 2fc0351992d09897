"""Tangent frames, and the one place where tangent space becomes texture space.

Tangent space: x along +u, y up in the picture (−v), z along the outward normal.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, copysign, cross, dot, normalize, shader, struct


@struct
class Frame:
    """An orthonormal frame on a surface, in object space, and how a tile of the texture lies in it.

    The bitangent is cross(normal, tangent) · w, the handedness w being −1 where the texture is
    mirrored. A tile is `width` = |∂P/∂u| wide, `height` high across that, and slanted by `shear`:
    ∂P/∂v = shear · tangent − height · bitangent.
    """

    tangent: Vec3
    bitangent: Vec3
    normal: Vec3
    width: float
    height: float
    shear: float


@shader
def tangent_frame(normal: Vec3, along_u: Vec3, along_v: Vec3) -> Frame:
    """The frame of a unit normal and the derivatives ∂P/∂u and ∂P/∂v, neither along the other."""
    tangent = normalize(along_u - normal * dot(normal, along_u))
    across = cross(normal, tangent)
    down = dot(across, along_v)
    return Frame(
        tangent=tangent,
        bitangent=across * copysign(1.0, -down),
        normal=normal,
        width=dot(tangent, along_u),
        height=abs(down),
        shear=dot(tangent, along_v),
    )


@shader
def aspect(frame: Frame) -> float:
    """The width of a tile ÷ its height."""
    return frame.width / frame.height


@shader
def to_tangent(frame: Frame, v: Vec3) -> Vec3:
    """A vector in tangent space: the frame's transpose is its inverse."""
    return Vec3(dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal))


@shader
def from_tangent(frame: Frame, v: Vec3) -> Vec3:
    """A tangent-space vector in object space."""
    return frame.tangent * v.x + frame.bitangent * v.y + frame.normal * v.z


@shader
def to_texture(frame: Frame, move: Vec2) -> Vec2:
    """A move in tangent space, in units of object space, as a move of texture coordinates.

    The two equations ∂P/∂u · du + ∂P/∂v · dv = move, solved; v runs down where y runs up.
    """
    dv = -move.y / frame.height
    return Vec2((move.x - frame.shear * dv) / frame.width, dv)
