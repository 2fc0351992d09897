"""What rays are traced through where an object is more than a formula.

The shapes of `shading.shapes` are formulas and read none of it. The entries take it all the same,
so that a shape made of triangles changes neither them nor what engines and pages do: a program has
only those buffers that it reads.
"""

from __future__ import annotations

from basrelief.lang import Buffer, Vec2, Vec3, resources, struct


@struct
class Vertex:
    """A corner of triangles, in object space, with its unit normal and texture coordinates."""

    position: Vec3
    normal: Vec3
    uv: Vec2


@resources
class Geometry:
    """The buffers of an object's geometry; three vertices in a row are a triangle."""

    vertices: Buffer[Vertex]
