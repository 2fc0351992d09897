"""Tangent frames, and the one place where tangent space becomes texture space.

Tangent space: x along +u, y up in the picture (−v), z along the outward normal.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, copysign, cross, dot, length, normalize, shader, struct


@struct
class Frame:
    """An orthonormal frame on a surface, in object space, and the texture's scale there.

    The bitangent is cross(normal, tangent) · w, the handedness w being −1 where the texture is
    mirrored. `width` is |∂P/∂u|, the width of one tile; `aspect` is |∂P/∂u| ÷ |∂P/∂v|.
    """

    tangent: Vec3
    bitangent: Vec3
    normal: Vec3
    width: float
    aspect: float


@shader
def frame_of(normal: Vec3, along_u: Vec3, along_v: Vec3) -> Frame:
    """The frame of a unit normal and the derivatives ∂P/∂u and ∂P/∂v, none of length 0."""
    tangent = normalize(along_u - normal * dot(normal, along_u))
    across = cross(normal, tangent)
    handedness = copysign(1.0, -dot(across, along_v))
    width = length(along_u)
    return Frame(tangent, across * handedness, normal, width, width / length(along_v))


@shader
def to_tangent(frame: Frame, v: Vec3) -> Vec3:
    """A vector in tangent space: the frame's transpose is its inverse."""
    return Vec3(dot(v, frame.tangent), dot(v, frame.bitangent), dot(v, frame.normal))


@shader
def from_tangent(frame: Frame, v: Vec3) -> Vec3:
    """A tangent-space vector in object space."""
    return frame.tangent * v.x + frame.bitangent * v.y + frame.normal * v.z


@shader
def to_texture(move: Vec2, aspect: float) -> Vec2:
    """A move in tangent space, in tile widths, as a move of texture coordinates.

    v runs down where y runs up, and a tile may be as wide as it likes: both are settled here.
    """
    return Vec2(move.x, -move.y * aspect)
